// Bricks: the lookup structure of rendering. README.md of this folder draws it.
#include "estara/grids/bricks.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <numbers>

#include "blocks.h"
#include "brick_level.h"
#include "estara/scenes/error.h"
#include "estara/shaders/kernel.h"
#include "estara/shaders/wide.h"

namespace estara {
namespace {

template <class T>
using ByAxis = std::array<T, 3>;

/// Points that are worked on together, their voxels on their way.
constexpr std::size_t in_flight = 64;

std::string title(const TextureGrid& grid) {
    return grid.object.empty() ? "texture grid" : fmt::format("object \"{}\"", grid.object);
}

/// The blend of two levels takes a quarter of the way from one to the next, in its middle: three
/// samples in four then need one level only.
constexpr float blend_width = 0.25f;

/// BrickPyramid::level_for(): log2(footprint / voxel size) + level_bias, steepened, [0, last].
///
/// Of the logarithm's fraction only the middle is more than 0 or 1: there it is the series around
/// a mantissa of sqrt(2), 1e-8 off, and needs no division.
/// @param scale  level_scale()
ESTARA_KERNEL float fractional_level(float footprint, float scale, float last) noexcept {
    constexpr float middle = std::numbers::sqrt2_v<float>, per_ln2 = std::numbers::log2e_v<float>;
    constexpr float steepness = per_ln2 / blend_width;
    const auto bits = std::bit_cast<std::uint32_t>((footprint > 0.0f ? footprint : 0.0f) * scale);
    const auto whole = float(int(bits >> 23) - 127);
    const float mantissa = std::bit_cast<float>((bits & 0x7fffffu) | 0x3f800000u);
    const float x = (mantissa - middle) * (1.0f / middle);
    const float ln =
        ((((0.2f - x * (1.0f / 6.0f)) * x - 0.25f) * x + 1.0f / 3.0f) * x - 0.5f) * x * x + x;
    const float blend = steepness * ln + 0.5f;
    // Limits one by one, without a branch that would keep the loop from being made wide.
    const float level = whole + blend, next = whole + 1.0f;
    const float above = level > whole ? level : whole;
    const float within = above < next ? above : next;
    const float positive = within > 0.0f ? within : 0.0f;
    return positive < last ? positive : last;
}

/// What a footprint is multiplied by to get 2^level. Finite, so that no footprint makes it NaN.
float level_scale(double voxel_size) noexcept {
    constexpr double largest = std::numeric_limits<float>::max();
    return float(std::min(std::exp2(double(BrickPyramid::level_bias)) / voxel_size, largest));
}

}  // namespace

BrickPyramid::~BrickPyramid() = default;
BrickPyramid::BrickPyramid(BrickPyramid&&) noexcept = default;
BrickPyramid& BrickPyramid::operator=(BrickPyramid&&) noexcept = default;

BrickPyramid::BrickPyramid(const TextureGrid& grid, InstructionSet limit)
    : BrickPyramid(grid, nullptr, limit) {}

BrickPyramid BrickPyramid::around(const TextureGrid& grid, std::span<const glm::vec3> P) {
    return {grid, &P, InstructionSet::avx512};
}

BrickPyramid::BrickPyramid(const TextureGrid& grid, const std::span<const glm::vec3>* only,
                           InstructionSet limit)
    : m_floats(grid.floats()),
      m_voxel_size(grid.voxel_size),
      m_origin(grid.origin),
      m_limit(limit) {
    if (m_floats < 1 || m_floats > max_floats) {
        throw Error(fmt::format("{}: {} floats a voxel; a lookup takes 1 to {}", title(grid),
                                m_floats, max_floats));
    }
    const std::vector<float> means = finite_means(grid, title(grid));
    const int half = m_floats > 4 ? (m_floats + 1) / 2 : m_floats;
    m_parts.push_back({0, half, 0});
    if (half < m_floats) m_parts.push_back({half, m_floats - half, BrickPart::words(half)});

    std::vector<glm::ivec3> cells;
    if (only != nullptr) {
        for (const glm::vec3& P : *only) {
            const glm::dvec3 index = (glm::dvec3(P) - m_origin) * (1.0 / m_voxel_size);
            cells.emplace_back(glm::floor(
                glm::dvec3(within_int(index.x), within_int(index.y), within_int(index.z))));
        }
        m_levels.emplace_back(grid.levels.front(), m_parts, cells, title(grid), limit);
    } else {
        for (const GridLevel& level : grid.levels) {
            m_levels.emplace_back(level, m_parts, std::nullopt, title(grid), limit);
        }
    }
    // Scales and codes of 0: the mean everywhere.
    m_miss.assign(m_levels.front().brick_words, 0);
    for (const BrickPart& part : m_parts) {
        std::memcpy(m_miss.data() + part.offset, means.data() + part.first,
                    std::size_t(part.floats) * sizeof(float));
    }
}

int BrickPyramid::levels() const noexcept { return int(m_levels.size()); }

int BrickPyramid::code_bits(int c) const noexcept {
    const BrickPart& part = c < m_parts.front().floats ? m_parts.front() : m_parts.back();
    return code_fields(part.floats)[std::size_t(c - part.first)].bits;
}

std::uint64_t BrickPyramid::bytes() const noexcept {
    std::uint64_t sum = 0;
    for (const BrickLevel& level : m_levels) sum += level.bytes();
    return sum;
}

/// What is looked up and where it goes.
struct BrickPyramid::Batch {
    std::size_t size;  ///< points
    ByAxis<const float*> P;
    const float* footprints;  ///< null: every point on `level`
    float level;
    float* planes;
    std::size_t stride;
    std::uint8_t* found;
};

namespace {

constexpr std::size_t whole_lanes(std::size_t points) {
    return (points + lanes - 1) / lanes * lanes;
}

/// Where the values of up to n points are, each on a level of its own.
template <std::size_t n>
struct Taps {
    static constexpr std::size_t size = whole_lanes(n);
    std::array<const std::uint32_t*, size> brick;
    std::array<std::uint32_t, size> cell;  ///< place of the cell's first voxel
    ByAxis<std::array<float, size>> far;   ///< from that voxel to the next, [0, 1]
};

/// How object space becomes a level's index space.
struct ToIndex {
    glm::dvec3 origin;
    double per_voxel;
};

/// Points [begin, end), all on one level.
/// @param miss  stands for the brick that is not there
template <std::size_t n>
ESTARA_KERNEL void locate(const BrickLevel& level, const ToIndex& to_index,
                          const ByAxis<const float*>& P, std::size_t begin, std::size_t end,
                          const std::uint32_t* miss, Taps<n>& taps) noexcept {
    ByAxis<std::array<std::int32_t, n>> voxel;
    for (std::size_t axis = 0; axis < 3; ++axis) {
        const float* const p = P[axis];
        const double origin = to_index.origin[int(axis)], per_voxel = to_index.per_voxel;
        // Step by step: in one loop the compiler would make six comparisons of the two limits, and
        // choose between them as integers as well.
        std::array<double, n> index, whole;
        for (std::size_t i = begin; i < end; ++i) {
            index[i] = not_below((double(p[i]) - origin) * per_voxel);
        }
        for (std::size_t i = begin; i < end; ++i) index[i] = not_above(index[i]);
        for (std::size_t i = begin; i < end; ++i) {
            whole[i] = std::floor(index[i]);
            taps.far[axis][i] = float(index[i] - whole[i]);
        }
        for (std::size_t i = begin; i < end; ++i) voxel[axis][i] = std::int32_t(whole[i]);
    }
    std::array<std::uint32_t, n> root, middle, bottom, bit;
    const BrickIndex::Box box = level.index.box();
    for (std::size_t i = begin; i < end; ++i) {
        const auto x = std::uint32_t(voxel[0][i]), y = std::uint32_t(voxel[1][i]),
                   z = std::uint32_t(voxel[2][i]);
        const BrickIndex::Way way = box.way(x, y, z);
        root[i] = way.root;
        middle[i] = way.middle;
        bottom[i] = way.bottom;
        bit[i] = way.bit;
        taps.cell[i] = in_brick(x & 3, y & 3, z & 3);
    }
    const std::uint32_t* const words = level.words.get();
    const std::size_t brick_words = level.brick_words;
    for (std::size_t i = begin; i < end; ++i) {
        const std::uint32_t number = level.index.brick_at({root[i], middle[i], bottom[i], bit[i]});
        taps.brick[i] =
            number == BrickIndex::none ? miss : words + std::size_t(number) * brick_words;
    }
}

/// A part's floats of four points, all on one level.
template <int floats, std::size_t n>
ESTARA_KERNEL void interpolate(std::size_t offset, const Taps<n>& taps, std::size_t first,
                               Floats4* value) noexcept {
    std::array<const std::uint32_t*, lanes> part;
    std::array<std::uint32_t, lanes> cell;
    for (std::size_t i = 0; i < lanes; ++i) {
        part[i] = taps.brick[first + i] + offset;
        cell[i] = taps.cell[first + i];
    }
    ByAxis<Floats4> far;
    for (std::size_t axis = 0; axis < 3; ++axis) {
        std::memcpy(&far[axis], taps.far[axis].data() + first, sizeof far[axis]);
    }
    interpolate_cells<floats>(part, cell, far[0], far[1], far[2], value);
}

/// A part's floats of all points.
/// @param coarse  read where weight is not 0
/// @param planes  of the part's first float
template <int floats, std::size_t n>
ESTARA_KERNEL void interpolate(std::size_t offset, const Taps<n>& fine, const Taps<n>& coarse,
                               const std::array<float, Taps<n>::size>& weight, std::size_t count,
                               float* planes, std::size_t stride) noexcept {
    for (std::size_t first = 0; first < count; first += lanes) {
        Floats4 value[floats];
        interpolate<floats>(offset, fine, first, value);
        std::array<std::uint64_t, 2> any;
        std::memcpy(&any, weight.data() + first, sizeof any);
        if ((any[0] | any[1]) != 0) {
            Floats4 far_value[floats], w;
            interpolate<floats>(offset, coarse, first, far_value);
            std::memcpy(&w, weight.data() + first, sizeof w);
            for (int c = 0; c < floats; ++c) value[c] += (far_value[c] - value[c]) * w;
        }
        for (std::size_t c = 0; c < std::size_t(floats); ++c) {
            float* const plane = planes + c * stride + first;
            if (count - first >= lanes) {
                std::memcpy(plane, &value[c], sizeof value[c]);
            } else {
                for (std::size_t i = 0; i < count - first; ++i) plane[i] = value[c][int(i)];
            }
        }
    }
}

/// All points: those that follow each other on the same level together.
template <std::size_t n>
ESTARA_KERNEL void locate(const std::vector<BrickLevel>& levels, const ToIndex& finest,
                          const std::array<std::int32_t, n>& level, const ByAxis<const float*>& P,
                          std::size_t count, const std::uint32_t* miss,
                          std::span<const BrickPart> parts, Taps<n>& taps) noexcept {
    for (std::size_t begin = 0, end = 0; begin < count; begin = end) {
        while (end < count && level[end] == level[begin]) ++end;
        const double scale = std::bit_cast<float>((127 - level[begin]) << 23);  // 2^-level
        const ToIndex to_index{finest.origin, finest.per_voxel * scale};
        locate(levels[std::size_t(level[begin])], to_index, P, begin, end, miss, taps);
    }
    // The lanes that are left over see nothing.
    for (std::size_t i = count; i < whole_lanes(count); ++i) {
        taps.brick[i] = miss;
        taps.cell[i] = 0;
        for (std::array<float, Taps<n>::size>& far : taps.far) far[i] = 0.0f;
    }
    for (const BrickPart& part : parts) {
        for (std::size_t i = 0; i < count; ++i) {
            const std::uint32_t* const words = taps.brick[i] + part.offset;
            const std::uint32_t* const near = words + BrickPart::header(part.floats) + taps.cell[i];
            __builtin_prefetch(words);
            __builtin_prefetch(near);
            __builtin_prefetch(near + in_brick(0, 1, 1));
            __builtin_prefetch(near + in_brick(1, 0, 0));
            __builtin_prefetch(near + in_brick(1, 1, 1));
        }
    }
}

}  // namespace

template <std::size_t n>
ESTARA_KERNEL void BrickPyramid::lookup_batch(const BrickPyramid& pyramid,
                                              const Batch& batch) noexcept {
    const ToIndex finest{pyramid.m_origin, 1.0 / pyramid.m_voxel_size};
    const float scale = level_scale(pyramid.m_voxel_size);
    const auto last = float(pyramid.m_levels.size() - 1);
    const std::uint32_t* const miss = pyramid.m_miss.data();
    std::array<std::int32_t, n> level;
    std::array<float, Taps<n>::size> weight;
    Taps<n> fine, coarse;
    for (std::size_t first = 0; first < batch.size; first += n) {
        const std::size_t count = std::min(n, batch.size - first);
        const ByAxis<const float*> P{batch.P[0] + first, batch.P[1] + first, batch.P[2] + first};
        for (const float* plane : P) {
            constexpr std::size_t line = 64 / sizeof(float);
            for (std::size_t i = 0; i < n; i += line) __builtin_prefetch(plane + n + i);
        }
        if (batch.footprints == nullptr) {
            weight.fill(batch.level);
        } else {
            const float* const footprints = batch.footprints + first;
            for (std::size_t i = 0; i < count; ++i) {
                weight[i] = fractional_level(footprints[i], scale, last);
            }
        }
        std::int32_t blend = 0;
        for (std::size_t i = 0; i < count; ++i) {
            level[i] = std::int32_t(weight[i]);
            weight[i] -= float(level[i]);
            blend |= weight[i] > 0.0f;
        }
        for (std::size_t i = count; i < whole_lanes(count); ++i) weight[i] = 0.0f;
        locate(pyramid.m_levels, finest, level, P, count, miss, pyramid.m_parts, fine);
        std::array<std::uint8_t, n> found;  // (bytes that batch points to may alias anything)
        for (std::size_t i = 0; i < count; ++i) found[i] = fine.brick[i] != miss;
        std::memcpy(batch.found + first, found.data(), count);
        if (blend) {
            for (std::size_t i = 0; i < count; ++i) level[i] += weight[i] > 0.0f;
            locate(pyramid.m_levels, finest, level, P, count, miss, pyramid.m_parts, coarse);
            // Beside the surface one of the levels may have nothing: then the finer one alone.
            for (std::size_t i = 0; i < count; ++i) {
                const bool both = (fine.brick[i] != miss) & (coarse.brick[i] != miss);
                weight[i] = both ? weight[i] : 0.0f;
            }
        }
        for (const BrickPart& part : pyramid.m_parts) {
            const auto interpolate_part = [&]<int floats>() ESTARA_LOOP {
                interpolate<floats>(part.offset, fine, coarse, weight, count,
                                    batch.planes + std::size_t(part.first) * batch.stride + first,
                                    batch.stride);
            };
            switch (part.floats) {
                case 1:
                    interpolate_part.template operator()<1>();
                    break;
                case 2:
                    interpolate_part.template operator()<2>();
                    break;
                case 3:
                    interpolate_part.template operator()<3>();
                    break;
                default:
                    interpolate_part.template operator()<4>();
            }
        }
    }
}

template <std::size_t n>
void BrickPyramid::run(const Batch& batch) const noexcept {
    wide([this, &batch]() ESTARA_LOOP { lookup_batch<n>(*this, batch); }, m_limit);
}

bool BrickPyramid::lookup(const glm::vec3& P, int level, float* out) const noexcept {
    std::uint8_t found = 0;
    run<1>({1, {&P.x, &P.y, &P.z}, nullptr, float(level), out, 1, &found});
    return found != 0;
}

bool BrickPyramid::lookup(const glm::vec3& P, float footprint, float* out) const noexcept {
    std::uint8_t found = 0;
    run<1>({1, {&P.x, &P.y, &P.z}, &footprint, 0.0f, out, 1, &found});
    return found != 0;
}

void BrickPyramid::lookup(const float* P, std::span<const float> footprints, float* planes,
                          std::size_t stride, std::uint8_t* found) const noexcept {
    run<in_flight>({footprints.size(),
                    {P, P + stride, P + 2 * stride},
                    footprints.data(),
                    0.0f,
                    planes,
                    stride,
                    found});
}

void BrickPyramid::lookup(std::span<const glm::vec3> P, std::span<const float> footprints,
                          float* planes, std::size_t stride, std::uint8_t* found) const noexcept {
    constexpr std::size_t some = 512;
    std::array<float, 3 * some> by_axis;
    for (std::size_t first = 0; first < P.size(); first += some) {
        const std::size_t size = std::min(some, P.size() - first);
        for (std::size_t i = 0; i < size; ++i) {
            for (std::size_t c = 0; c < 3; ++c) by_axis[c * some + i] = P[first + i][int(c)];
        }
        run<in_flight>({size,
                        {by_axis.data(), by_axis.data() + some, by_axis.data() + 2 * some},
                        footprints.data() + first,
                        0.0f,
                        planes + first,
                        stride,
                        found + first});
    }
}

float BrickPyramid::level_for(float footprint) const noexcept {
    return fractional_level(footprint, level_scale(m_voxel_size), float(levels() - 1));
}

}  // namespace estara
