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

}  // namespace

std::vector<glm::vec2> sample_pattern(int spp, std::uint32_t seed) {
    if (spp == 1) return {glm::vec2(0.5f)};
    // Multiples of the two numbers of the R2 sequence (powers of 1/1.3247...): seeds spread evenly.
    const double shift_x = seed * 0.7548776662466927, shift_y = seed * 0.5698402909980532;
    std::vector<glm::vec2> pattern(static_cast<std::size_t>(spp));
    for (int i = 0; i < spp; ++i) {
        const double x = (i + 0.5) / spp;
        const double y = radical_inverse(std::uint32_t(i)) + 0.5 / spp;
        pattern[std::size_t(i)] = {wrapped(x + shift_x), wrapped(y + shift_y)};
    }
    return pattern;
}

}  // namespace estara
