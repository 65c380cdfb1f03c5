#include "estara/render/sampling.h"

#include <cmath>

namespace estara {
namespace {

/// i's binary digits mirrored at the point, [0, 1).
double radical_inverse(std::uint32_t i) noexcept {
    double inverse = 0.0;
    for (double digit = 0.5; i != 0; i >>= 1, digit *= 0.5) inverse += digit * (i & 1u);
    return inverse;
}

// Into [0, 1), also after rounding to float.
float wrapped(double x) noexcept {
    const float f = float(x - std::floor(x));
    return f < 1.0f ? f : 0.0f;
}

/// Multiples of the two numbers of the R2 sequence (powers of 1/1.3247...): seeds spread evenly.
glm::dvec2 shift_of(int spp, std::uint32_t seed) noexcept {
    if (spp == 1) return glm::dvec2(0.0);
    return {seed * 0.7548776662466927, seed * 0.5698402909980532};
}

/// Sample i of a pattern that is not shifted.
glm::dvec2 hammersley(int i, int spp) noexcept {
    return {(i + 0.5) / spp, radical_inverse(std::uint32_t(i)) + 0.5 / spp};
}

}  // namespace

std::vector<glm::vec2> sample_pattern(int spp, std::uint32_t seed) {
    const glm::dvec2 shift = shift_of(spp, seed);
    std::vector<glm::vec2> pattern(static_cast<std::size_t>(spp));
    for (int i = 0; i < spp; ++i) {
        const glm::dvec2 p = hammersley(i, spp) + shift;
        pattern[std::size_t(i)] = {wrapped(p.x), wrapped(p.y)};
    }
    return pattern;
}

PlaceMoments moments_of(std::span<const glm::vec2> pattern) {
    glm::dvec2 mean(0.0);
    glm::dvec3 products(0.0);
    for (const glm::vec2& place : pattern) {
        const glm::dvec2 p = glm::dvec2(place) - 0.5;
        mean += p;
        products += glm::dvec3(p.x * p.x, p.x * p.y, p.y * p.y);
    }
    mean /= double(pattern.size());
    products /= double(pattern.size());
    return {mean, float(products.x), float(products.y), float(products.z)};
}

glm::vec2 slant(const PlaceMoments& samples, const glm::vec2& target) noexcept {
    const glm::vec2 mean = samples.mean, shift = mean - target;
    constexpr float nothing = 1e-3f;  // pixels
    if (!(glm::dot(shift, shift) > nothing * nothing)) return glm::vec2(0.0f);
    // A little of the pixel's own extent: few samples, or samples in one place, have no covariance.
    constexpr float least = 1e-3f;
    const float xx = samples.xx - mean.x * mean.x + least;
    const float xy = samples.xy - mean.x * mean.y;
    const float yy = samples.yy - mean.y * mean.y + least;
    const float determinant = xx * yy - xy * xy;
    if (!(determinant > 0.0f)) return glm::vec2(0.0f);
    const glm::vec2 g =
        glm::vec2(yy * shift.x - xy * shift.y, xx * shift.y - xy * shift.x) / determinant;
    const float most =
        std::abs(g.x) * (0.5f + std::abs(mean.x)) + std::abs(g.y) * (0.5f + std::abs(mean.y));
    return most > 1.0f ? g / most : g;
}

SampleStrata::SampleStrata(int spp, std::uint32_t seed) : m_columns(spp), m_rows(1) {
    while (m_columns % 2 == 0 && m_columns > m_rows) {
        m_columns /= 2;
        m_rows *= 2;
    }
    const glm::dvec2 shift = shift_of(spp, seed);
    m_shift = {wrapped(shift.x), wrapped(shift.y)};
    m_sample.resize(std::size_t(spp));
    for (int i = 0; i < spp; ++i) {
        const glm::ivec2 cell(hammersley(i, spp) * glm::dvec2(m_columns, m_rows));
        m_sample[std::size_t(cell.y * m_columns + cell.x)] = i;
    }
}

}  // namespace estara
