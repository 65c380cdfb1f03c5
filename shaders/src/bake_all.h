// The loop over a batch, once for every instruction set.
#pragma once

#include "bound.h"
#include "estara/shaders/noise.h"
#include "estara/shaders/shader.h"

namespace estara::detail {

/// Writes a record to column i of planes, channel by channel. (Not by copying its bytes: that
/// becomes one 16-byte move, which keeps the loop scalar.)
template <class S, std::size_t channel = 0, int plane = 0>
ESTARA_KERNEL void store(const typename S::Baked& baked, float* planes, int i) noexcept {
    constexpr auto channels = S::channels();
    if constexpr (channel < std::tuple_size_v<decltype(channels)>) {
        const auto& value = baked.*std::get<channel>(channels).member;
        float* const column = planes + plane * SurfaceBatch::capacity + i;
        if constexpr (std::is_same_v<decltype(value), const float&>) {
            column[0] = value;
            store<S, channel + 1, plane + 1>(baked, planes, i);
        } else {
            column[0 * SurfaceBatch::capacity] = value.x;
            column[1 * SurfaceBatch::capacity] = value.y;
            column[2 * SurfaceBatch::capacity] = value.z;
            store<S, channel + 1, plane + 3>(baked, planes, i);
        }
    }
}

ESTARA_KERNEL SurfacePoint point_of(const SurfaceBatch& in, int i, float filter_width,
                                    float octave_sum) noexcept {
    return {{in.P[0][i], in.P[1][i], in.P[2][i]},
            {in.N[0][i], in.N[1][i], in.N[2][i]},
            {in.uv[0][i], in.uv[1][i]},
            {in.dPdu[0][i], in.dPdu[1][i], in.dPdu[2][i]},
            filter_width,
            octave_sum};
}

/// The scalar loops that the compiler makes wide. The shader and what is uniform over the batch are
/// copied first: a store to planes could otherwise alias them.
template <class S>
ESTARA_KERNEL void bake_loop(const S shader, const SurfaceBatch& in,
                             float* __restrict planes) noexcept {
    const float filter_width = in.filter_width;
    const int size = in.size;
    if constexpr (HasOctaves<S>) {
        float sums[SurfaceBatch::capacity] = {};
        const int octaves = octaves_for(filter_width * octave_frequency_of(shader));
        for (int k = 0; k < octaves; ++k) {
            for (int i = 0; i < size; ++i) {
                sums[i] += shader.octave(point_of(in, i, filter_width, 0.0f), k);
            }
        }
        for (int i = 0; i < size; ++i) {
            store<S>(shader.bake(point_of(in, i, filter_width, sums[i])), planes, i);
        }
    } else {
        for (int i = 0; i < size; ++i) {
            store<S>(shader.bake(point_of(in, i, filter_width, 0.0f)), planes, i);
        }
    }
}

template <class S>
[[gnu::flatten]] void bake_baseline(const S& s, const SurfaceBatch& in, float* planes) noexcept {
    bake_loop(s, in, planes);
}

// Functions with a target of their own, in one translation unit, rather than a file compiled once
// per instruction set: an inline function that the linker takes from the wrong copy would be an
// illegal instruction on an older machine.
// Without optimisation there is nothing to gain and much to compile.
#if defined(__x86_64__) && defined(__OPTIMIZE__) && !defined(__clang__)
#define ESTARA_DISPATCH 1
template <class S>
[[gnu::flatten, gnu::target("arch=x86-64-v2")]] void bake_sse42(const S& s, const SurfaceBatch& in,
                                                                float* planes) noexcept {
    bake_loop(s, in, planes);
}
template <class S>
[[gnu::flatten, gnu::target("arch=x86-64-v3")]] void bake_avx2(const S& s, const SurfaceBatch& in,
                                                               float* planes) noexcept {
    bake_loop(s, in, planes);
}
template <class S>
[[gnu::flatten, gnu::target("arch=x86-64-v4,prefer-vector-width=512")]] void bake_avx512(
    const S& s, const SurfaceBatch& in, float* planes) noexcept {
    bake_loop(s, in, planes);
}
#endif

template <class S>
BakeFunction<S> bake_function([[maybe_unused]] InstructionSet limit) noexcept {
#ifdef ESTARA_DISPATCH
    if (limit >= InstructionSet::avx512 && __builtin_cpu_supports("x86-64-v4"))
        return bake_avx512<S>;
    if (limit >= InstructionSet::avx2 && __builtin_cpu_supports("x86-64-v3")) return bake_avx2<S>;
    if (limit >= InstructionSet::sse42 && __builtin_cpu_supports("x86-64-v2")) return bake_sse42<S>;
#endif
    return bake_baseline<S>;
}

}  // namespace estara::detail
