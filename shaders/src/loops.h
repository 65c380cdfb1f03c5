// The loops over a batch: scalar code that the compiler makes wide, once for every instruction set.
#pragma once

#include <algorithm>
#include <cstdint>
#include <cstring>

#include "bound.h"
#include "estara/shaders/noise.h"
#include "estara/shaders/shader.h"
#include "estara/shaders/wide.h"

namespace estara::detail {

/// Writes a record to column i of planes, channel by channel. (Not by copying its bytes: that
/// becomes one 16-byte move, which keeps the loop scalar.)
/// @tparam normal  whether there are planes for a channel that is the normal
template <bool normal, class S, std::size_t channel = 0, int plane = 0>
ESTARA_KERNEL void store(const typename S::Baked& baked, float* planes, int i) noexcept {
    constexpr auto channels = S::channels();
    if constexpr (channel < std::tuple_size_v<decltype(channels)>) {
        if constexpr (std::get<channel>(channels).kind == ChannelKind::normal && !normal) return;
        const auto& value = baked.*std::get<channel>(channels).member;
        float* const column = planes + plane * SurfaceBatch::capacity + i;
        if constexpr (std::is_same_v<decltype(value), const float&>) {
            column[0] = value;
            store<normal, S, channel + 1, plane + 1>(baked, planes, i);
        } else {
            column[0 * SurfaceBatch::capacity] = value.x;
            column[1 * SurfaceBatch::capacity] = value.y;
            column[2 * SurfaceBatch::capacity] = value.z;
            store<normal, S, channel + 1, plane + 3>(baked, planes, i);
        }
    }
}

ESTARA_KERNEL SurfacePoint point_of(const SurfaceBatch& in, int i, float filter_width,
                                    float octave_sum,
                                    const glm::vec4& octave_more = glm::vec4(0.0f)) noexcept {
    return {{in.P[0][i], in.P[1][i], in.P[2][i]},
            {in.N[0][i], in.N[1][i], in.N[2][i]},
            {in.uv[0][i], in.uv[1][i]},
            {in.dPdu[0][i], in.dPdu[1][i], in.dPdu[2][i]},
            filter_width,
            octave_sum,
            octave_more};
}

/// How many terms the shader's sums have.
template <class S>
int octaves_of(const S& shader, float filter_width) noexcept {
    if constexpr (HasOctaveCount<S>) {
        return shader.octaves(filter_width);
    } else {
        return octaves_for(filter_width);
    }
}

/// The scalar loops that the compiler makes wide. The shader and what is uniform over the batch are
/// copied first: a store to planes could otherwise alias them.
/// @tparam normal  see store()
template <bool normal, class S>
ESTARA_KERNEL void bake_loop(const S shader, const SurfaceBatch& in, int first, int last,
                             float* __restrict planes) noexcept {
    const float filter_width = in.filter_width;
    if constexpr (HasFiveSums<S>) {
        float sums[5][SurfaceBatch::capacity] = {};
        const int octaves = octaves_of(shader, filter_width);
        for (int k = 0; k < octaves; ++k) {
            for (int i = first; i < last; ++i) {
                const OctaveTerm term = shader.octave(point_of(in, i, filter_width, 0.0f), k);
                sums[0][i] += term.value;
                sums[1][i] += term.more.x;
                sums[2][i] += term.more.y;
                sums[3][i] += term.more.z;
                sums[4][i] += term.more.w;
            }
        }
        for (int i = first; i < last; ++i) {
            const glm::vec4 more(sums[1][i], sums[2][i], sums[3][i], sums[4][i]);
            store<normal, S>(shader.bake(point_of(in, i, filter_width, sums[0][i], more)), planes,
                             i);
        }
    } else if constexpr (HasOctaves<S>) {
        float sums[SurfaceBatch::capacity] = {};
        const int octaves = octaves_of(shader, filter_width);
        for (int k = 0; k < octaves; ++k) {
            for (int i = first; i < last; ++i) {
                sums[i] += shader.octave(point_of(in, i, filter_width, 0.0f), k);
            }
        }
        for (int i = first; i < last; ++i) {
            store<normal, S>(shader.bake(point_of(in, i, filter_width, sums[i])), planes, i);
        }
    } else {
        for (int i = first; i < last; ++i) {
            store<normal, S>(shader.bake(point_of(in, i, filter_width, 0.0f)), planes, i);
        }
    }
}

/// Reads a record from column i of planes; not the normal, which is in Seen.
template <class S, std::size_t channel = 0, int plane = 0>
ESTARA_KERNEL void load(typename S::Baked& baked, const float* planes, int i) noexcept {
    constexpr auto channels = S::channels();
    if constexpr (channel < std::tuple_size_v<decltype(channels)>) {
        if constexpr (std::get<channel>(channels).kind == ChannelKind::normal) {
            (baked.*std::get<channel>(channels).member) = glm::vec3(0.0f);
            return;
        }
        auto& value = baked.*std::get<channel>(channels).member;
        const float* const column = planes + plane * SurfaceBatch::capacity + i;
        if constexpr (std::is_same_v<decltype(value), float&>) {
            value = column[0];
            load<S, channel + 1, plane + 1>(baked, planes, i);
        } else {
            value = {column[0], column[SurfaceBatch::capacity], column[2 * SurfaceBatch::capacity]};
            load<S, channel + 1, plane + 3>(baked, planes, i);
        }
    }
}

/// Point i of a batch as view() sees it.
/// @tparam lit  the batch's light alone, or what E, A and the surface itself make
template <bool lit, class S>
ESTARA_KERNEL glm::vec3 view_point(const S& shader, const float* planes, const SeenBatch& seen,
                                   const glm::vec3& A, int i) noexcept {
    typename S::Baked baked;
    load<S>(baked, planes, i);
    const Light light{{seen.L[0][i], seen.L[1][i], seen.L[2][i]},
                      {seen.Cl[0][i], seen.Cl[1][i], seen.Cl[2][i]}};
    const Seen one{{seen.N[0][i], seen.N[1][i], seen.N[2][i]},
                   seen.V[i],
                   lit ? glm::vec3(0.0f) : glm::vec3(seen.E[0][i], seen.E[1][i], seen.E[2][i]),
                   lit ? glm::vec3(0.0f) : A,
                   std::span<const Light>(&light, lit ? 1 : 0),
                   lit ? 0.0f : 1.0f};
    return shader.view(baked, one);
}

template <bool lit, class S>
ESTARA_KERNEL void view_loop(const S shader, const float* planes, const SeenBatch& seen, int first,
                             int last, float* __restrict Ci) noexcept {
    const glm::vec3 A = seen.A;
    constexpr int stride = SeenBatch::capacity;
#pragma GCC ivdep
    for (int i = first; i < last; ++i) {
        const glm::vec3 color = view_point<lit>(shader, planes, seen, A, i);
        Ci[i] = color.x;
        Ci[stride + i] = color.y;
        Ci[2 * stride + i] = color.z;
    }
}

/// Marks the points where a light of Cl > 0 is at least so near its mirror direction, N.H >=
/// cosine. H is not normalised: N.(L + V) >= cosine |L + V|.
ESTARA_KERNEL void near_loop(float cosine, const SeenBatch& seen, int first, int last,
                             std::uint8_t* __restrict near) noexcept {
    const float square = cosine * cosine;
#pragma GCC ivdep
    for (int i = first; i < last; ++i) {
        const glm::vec3 h = glm::vec3(seen.L[0][i], seen.L[1][i], seen.L[2][i]) + seen.V[i].vec();
        const float d = seen.N[0][i] * h.x + seen.N[1][i] * h.y + seen.N[2][i] * h.z;
        const bool lit = (seen.Cl[0][i] > 0.0f) | (seen.Cl[1][i] > 0.0f) | (seen.Cl[2][i] > 0.0f);
        near[i] = lit & (d > 0.0f) & (d * d >= square * glm::dot(h, h)) ? 1 : 0;
    }
}

/// What a light alone makes, where that is a highlight and nothing else: 0 where near_loop() marks
/// nothing. Runs of points without a mark are not evaluated, and most are without: neighbours in a
/// batch are so in the picture.
template <class S>
ESTARA_KERNEL void highlight_loop(const S shader, const float* planes, const SeenBatch& seen,
                                  int first, int last, float* __restrict Ci) noexcept {
    constexpr int stride = SeenBatch::capacity, step = 16;
    alignas(64) std::uint8_t near[SeenBatch::capacity + step] = {};
    near_loop(shader.highlight_cosine(), seen, first, last, near);
    const auto any = [&near](int begin) {
        std::uint64_t flags[step / 8];
        std::memcpy(flags, near + begin, step);
        return (flags[0] | flags[1]) != 0;
    };
    for (int begin = first, end = first; begin < last; begin = end) {
        const bool lit = any(begin);
        for (end += step; end < last && any(end) == lit;) end += step;
        end = std::min(end, last);
        if (!lit) {
            for (int c = 0; c < 3; ++c) {
                std::fill(Ci + c * stride + begin, Ci + c * stride + end, 0.0f);
            }
            continue;
        }
        view_loop<true>(shader, planes, seen, begin, end, Ci);
        for (int c = 0; c < 3; ++c) {
            float* const plane = Ci + c * stride;
            for (int i = begin; i < end; ++i) plane[i] = near[i] ? plane[i] : 0.0f;
        }
    }
}

template <class S>
void Loops<S>::bake(const S& shader, const SurfaceBatch& in, int first, int last, float* planes,
                    InstructionSet limit) noexcept {
    if constexpr (requires { shader.perturbs_normal(); }) {
        if (!shader.perturbs_normal()) {
            return wide([=, &in]()
                            ESTARA_LOOP { bake_loop<false>(shader, in, first, last, planes); },
                        limit);
        }
    }
    wide([=, &in]() ESTARA_LOOP { bake_loop<true>(shader, in, first, last, planes); }, limit);
}

template <class S>
void Loops<S>::view(const S& shader, const float* planes, const SeenBatch& seen, int first,
                    int last, bool lit, float* Ci, InstructionSet limit) noexcept {
    if (lit) {
        wide(
            [=, &seen]() ESTARA_LOOP {
                if constexpr (HasHighlight<S>) {
                    highlight_loop(shader, planes, seen, first, last, Ci);
                } else {
                    view_loop<true>(shader, planes, seen, first, last, Ci);
                }
            },
            limit);
    } else {
        wide([=, &seen]() ESTARA_LOOP { view_loop<false>(shader, planes, seen, first, last, Ci); },
             limit);
    }
}

}  // namespace estara::detail
