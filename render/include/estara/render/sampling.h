// Where in a pixel the samples lie.
#pragma once

#include <glm/glm.hpp>

#include <cmath>
#include <cstdint>
#include <span>
#include <vector>

#include "estara/shaders/kernel.h"

namespace estara {

/// Positions inside a pixel, in pixels, [0, 1)^2: the same in every pixel and every frame, so that
/// nothing flickers that stands still.
///
/// One sample is the pixel's centre. More are a Hammersley set (x = (i + 1/2) / n, y = the radical
/// inverse of i in base 2, moved to be centred), shifted around the pixel's edges by the seed.
///
/// @param spp   samples a pixel, >= 1
/// @param seed  0: not shifted; other seeds give other shifts (never of a single sample)
std::vector<glm::vec2> sample_pattern(int spp, std::uint32_t seed);

/// Means of samples' places x, y from the pixel's centre and of their products.
struct PlaceMoments {
    glm::vec2 mean{0.0f};
    float xx = 0.0f, xy = 0.0f, yy = 0.0f;
};
PlaceMoments moments_of(std::span<const glm::vec2> pattern);

/// How the weights of n samples must lean to make their weighted mean place `target`: sample i at
/// x_i counts (1 - g . (x_i - mean)) / n, with g = S^-1 (mean - target) and S their covariance. The
/// weights' sum is 1, and a pixel of them is exact for colours that are linear in it (the
/// regression estimator: Cochran, "Sampling Techniques", 1977, chapter 7). g is cut short where a
/// weight would be negative, and 0 for less than a thousandth of a pixel, which is rounding.
glm::vec2 slant(const PlaceMoments& samples, const glm::vec2& target) noexcept;

/// The pixel divided into as many rectangles of equal area as it has samples, one sample of the
/// pattern in each: where a point that is not of the pattern stands in for one of its samples.
///
/// With n = m 2^j samples there are m columns and 2^j rows: of n consecutive points of the pattern
/// each such rectangle holds one. j is chosen so that they are as square as can be. They are
/// shifted with the pattern, around the pixel's edges.
class SampleStrata {
public:
    SampleStrata(int spp, std::uint32_t seed);

    int count() const noexcept { return m_columns * m_rows; }
    int columns() const noexcept { return m_columns; }
    int rows() const noexcept { return m_rows; }
    glm::vec2 shift() const noexcept { return m_shift; }
    /// The column (or row) of a place in the pixel, one of its coordinates, [0, 1).
    ESTARA_KERNEL static int cell(float place, float shift, int cells) noexcept {
        const float moved = place - shift;
        const int c = int((moved - std::floor(moved)) * float(cells));
        return c < cells ? c : cells - 1;  // rounding
    }
    /// The sample of the pattern in a rectangle, given as column + columns * row.
    int sample(int rectangle) const noexcept { return m_sample[std::size_t(rectangle)]; }

private:
    int m_columns, m_rows;
    glm::vec2 m_shift;
    std::vector<int> m_sample;  ///< by rectangle, row by row
};

}  // namespace estara
