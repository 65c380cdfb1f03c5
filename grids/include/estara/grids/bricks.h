// The structure that rendering looks colours up in: TextureGrid flattened into bricks.
#pragma once

#include <glm/glm.hpp>

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "estara/grids/texture_grid.h"
#include "estara/shaders/registry.h"

namespace estara {

struct BrickLevel;
struct BrickPart;

/// A pyramid of bricks. Immutable after construction: any number of threads may look up at once,
/// and a lookup is three table reads, nearly always cached, and eight neighbouring voxels.
///
/// A voxel is a 32-bit word for up to four floats, two words for up to eight; float c of it a code
/// of code_bits(c) bits between the smallest and the largest value of its brick of 5^3 voxels. So a
/// lookup differs from the same interpolation of the grid's values by at most
///     (largest - smallest value of the brick) / (2 (2^code_bits(c) - 1)) + 1e-6 |largest value|,
/// the second term from float arithmetic. A float that is constant in a brick is exact.
class BrickPyramid {
public:
    static constexpr int max_floats = 8;

    /// Makes the bricks of all levels, in parallel: one for every 4^3 cells of which at least one
    /// has eight active voxels. Error if the grid has more than max_floats floats, an extent
    /// beyond 2^18 or a value that is not finite.
    /// @param limit  lookups use the widest instruction set of the machine, but none wider than
    ///               this; they have the same bits on all of them
    explicit BrickPyramid(const TextureGrid& grid, InstructionSet limit = InstructionSet::avx512);

    /// Level 0 alone and of it only the bricks that these points need: at them lookups have the
    /// same bits as those of the whole, elsewhere they may be misses. To measure a grid that is
    /// too large to be held twice.
    /// @param P  object space
    static BrickPyramid around(const TextureGrid& grid, std::span<const glm::vec3> P);

    ~BrickPyramid();
    BrickPyramid(BrickPyramid&&) noexcept;
    BrickPyramid& operator=(BrickPyramid&&) noexcept;

    int floats() const noexcept { return m_floats; }
    int levels() const noexcept;
    double voxel_size() const noexcept { return m_voxel_size; }
    /// Bits of the codes of float c: 23 for one float, 16 for two, 11, 11 and 10 for three, 8 for
    /// four; of more, the first half (rounded up) and the others each as if alone.
    int code_bits(int c) const noexcept;

    /// Of all levels and their index.
    std::uint64_t bytes() const noexcept;

    /// Trilinear value at an object-space point on one level.
    /// @param level  in [0, levels())
    /// @param out    floats() values; the grid's mean where there is no brick
    /// @return       false if the point lies in no brick: it is not on the surface that was baked
    bool lookup(const glm::vec3& P, int level, float* out) const noexcept;

    /// Value for a footprint: blends the two levels whose voxels bracket it.
    /// @param footprint  width of what a sample covers on the surface, object space; 0 and less
    ///                   mean the finest level, NaN too
    bool lookup(const glm::vec3& P, float footprint, float* out) const noexcept;

    /// lookup(point i, footprints[i]) for each point, with the same bits. Several times faster than
    /// one by one: points are located side by side, and the voxels of many are asked of memory at
    /// once and computed with when they arrive.
    /// @param P       object space, axis a of point i is P[a * stride + i]
    /// @param planes  float c of point i becomes planes[c * stride + i]
    /// @param found   1 or 0, what lookup() returns for the point
    void lookup(const float* P, std::span<const float> footprints, float* planes,
                std::size_t stride, std::uint8_t* found) const noexcept;

    /// The same for points that are not kept by axis.
    void lookup(std::span<const glm::vec3> P, std::span<const float> footprints, float* planes,
                std::size_t stride, std::uint8_t* found) const noexcept;

    /// The (fractional) level for a footprint, in [0, levels() - 1]: log2(footprint / voxel) plus
    /// level_bias, within 1e-6, its fraction steepened: 0 up to 3/8, 1 from 5/8 on.
    float level_for(float footprint) const noexcept;

    /// Added to the level: a lookup blurs over two voxels, so the matching level is too soft. RMSE
    /// of frame 17 of the still life against 256 samples a pixel, at 4 samples a pixel: .00475 with
    /// bias 0, .00470 with -1/2, .00472 with -1; at 1 sample .0102, .0104, .0112 (README.md,
    /// "Speed and error", has the command).
    static constexpr float level_bias = -0.5f;

private:
    struct Batch;

    BrickPyramid(const TextureGrid& grid, const std::span<const glm::vec3>* only,
                 InstructionSet limit);
    template <std::size_t n>  // points at once
    static void lookup_batch(const BrickPyramid& pyramid, const Batch& batch) noexcept;
    template <std::size_t n>
    void run(const Batch& batch) const noexcept;

    std::vector<BrickLevel> m_levels;
    std::vector<BrickPart> m_parts;
    int m_floats = 0;
    double m_voxel_size = 1.0;
    glm::dvec3 m_origin{0.0};
    std::vector<std::uint32_t> m_miss;  // a brick of the mean, for where there is none
    InstructionSet m_limit;
};

}  // namespace estara
