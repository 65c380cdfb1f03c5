// The structure that rendering looks colours up in: TextureGrid flattened into bricks.
#pragma once

#include <glm/glm.hpp>

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "estara/grids/texture_grid.h"

namespace estara {

/// A pyramid of bricks. Immutable after construction: any number of threads may look up at once,
/// and a lookup is three table reads, two of them nearly always cached, and eight neighbouring
/// voxels.
class BrickPyramid {
public:
    static constexpr int max_floats = 8;

    /// Copies the values of all levels, quantised per brick and float to 16 bits between the
    /// smallest and the largest value found there (error at most range / 131070, plus rounding).
    /// Runs in parallel. Error if the grid has more than max_floats floats or an extent beyond
    /// 2^18.
    explicit BrickPyramid(const TextureGrid& grid);
    ~BrickPyramid();
    BrickPyramid(BrickPyramid&&) noexcept;
    BrickPyramid& operator=(BrickPyramid&&) noexcept;

    int floats() const noexcept { return m_floats; }
    int levels() const noexcept;
    double voxel_size() const noexcept { return m_voxel_size; }
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

    /// lookup(P[i], footprints[i]) for each point, with the same bits. Faster than one by one where
    /// the bricks are not in the cache: the voxels of many points are asked of memory at once, and
    /// computed with when they arrive.
    /// @param planes  float c of point i becomes planes[c * stride + i]
    /// @param found   1 or 0, what lookup() returns for the point
    void lookup(std::span<const glm::vec3> P, std::span<const float> footprints, float* planes,
                std::size_t stride, std::uint8_t* found) const noexcept;

    /// The (fractional) level for a footprint, in [0, levels() - 1]: log2(footprint / voxel) plus
    /// level_bias.
    float level_for(float footprint) const noexcept;

    /// Added to the level: a lookup blurs over two voxels, so the matching level is too soft. RMSE
    /// of frame 17 of the still life against 256 samples a pixel, at 4 samples a pixel: .00475 with
    /// bias 0, .00470 with -1/2, .00472 with -1; at 1 sample .0102, .0104, .0112 (README.md,
    /// "Speed and error", has the command).
    static constexpr float level_bias = -0.5f;

private:
    struct Level;
    struct Tap;
    bool blend(const Tap& fine, const Tap& coarse, float weight, float* out) const noexcept;

    std::vector<Level> m_levels;
    int m_floats = 0;
    double m_voxel_size = 1.0;
    glm::dvec3 m_origin{0.0};
    std::array<float, max_floats> m_mean{};
};

}  // namespace estara
