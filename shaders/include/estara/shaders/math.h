// Scalar functions of RSL, and the two transcendental ones that bake() may use. All of them are
// free of branches on data and give the same bits on every instruction set.
#pragma once

#include <glm/glm.hpp>

#include <bit>
#include <cmath>
#include <cstdint>

#include "estara/shaders/kernel.h"

namespace estara {

ESTARA_KERNEL float clamp(float x, float lo, float hi) noexcept {
    return x < lo ? lo : (x > hi ? hi : x);
}

/// (1 - t) a + t b.
ESTARA_KERNEL float mix(float a, float b, float t) noexcept { return (1.0f - t) * a + t * b; }
ESTARA_KERNEL glm::vec3 mix(const glm::vec3& a, const glm::vec3& b, float t) noexcept {
    return (1.0f - t) * a + t * b;
}

/// x - b floor(x / b), in [0, b) for b > 0, also for negative x.
ESTARA_KERNEL float mod(float x, float b) noexcept {
    const float r = x - b * std::floor(x / b);
    return r < 0.0f ? 0.0f : (r >= b ? 0.0f : r);  // rounding may leave [0, b) by one ulp
}

ESTARA_KERNEL float largest(const glm::vec3& v) noexcept {
    const float xy = v.x > v.y ? v.x : v.y;
    return xy > v.z ? xy : v.z;
}

/// Whether a number is neither infinite nor NaN. (std::isfinite is a call in some loops.)
ESTARA_KERNEL bool is_finite(float v) noexcept { return v - v == 0.0f; }

/// a if so, else b, without a branch.
ESTARA_KERNEL float select(bool so, float a, float b) noexcept { return so ? a : b; }
ESTARA_KERNEL glm::vec3 select(bool so, const glm::vec3& a, const glm::vec3& b) noexcept {
    return {so ? a.x : b.x, so ? a.y : b.y, so ? a.z : b.z};
}

/// 0 if x < edge, else 1.
ESTARA_KERNEL float step(float edge, float x) noexcept { return x < edge ? 0.0f : 1.0f; }

/// 0 below a, 1 from b on, 3t^2 - 2t^3 between; a < b. For a == b it is step(a, x).
ESTARA_KERNEL float smoothstep(float a, float b, float x) noexcept {
    const float width = b - a;
    const float t = clamp((x - a) / (width > 0.0f ? width : 1.0f), 0.0f, 1.0f);
    return width > 0.0f ? t * t * (3.0f - 2.0f * t) : step(a, x);
}

/// The derivative of smoothstep(a, b, x) with x; 0 for a == b.
ESTARA_KERNEL float smoothstep_slope(float a, float b, float x) noexcept {
    const float width = b - a, positive = width > 0.0f ? width : 1.0f;
    const float t = clamp((x - a) / positive, 0.0f, 1.0f);
    return width > 0.0f ? 6.0f * t * (1.0f - t) / positive : 0.0f;
}

/// step(edge, x) averaged over a box of width w > 0 around x.
ESTARA_KERNEL float filterstep(float edge, float x, float w) noexcept {
    return clamp((x + 0.5f * w - edge) / w, 0.0f, 1.0f);
}

/// smoothstep(a, b, x) averaged over a box of width w > 0 around x; a < b. Integrates
/// G(t) = t^3 - t^4 / 2, the primitive of 3t^2 - 2t^3, over the part of the box inside [a, b] and
/// adds the length beyond b. Absolute error below
/// 1e-6 + 5e-7 (b - a + |x|) / w (tested): differences are divided by w, so narrow boxes lose
/// digits.
ESTARA_KERNEL float filtered_smoothstep(float a, float b, float x, float w) noexcept {
    const float left = x - 0.5f * w, right = x + 0.5f * w, width = b - a;
    const float t0 = clamp((left - a) / width, 0.0f, 1.0f);
    const float t1 = clamp((right - a) / width, 0.0f, 1.0f);
    const float inside =
        width * (t1 * t1 * t1 * (1.0f - 0.5f * t1) - t0 * t0 * t0 * (1.0f - 0.5f * t0));
    const float beyond = right > b ? right - (left > b ? left : b) : 0.0f;
    return clamp((inside + beyond) / w, 0.0f, 1.0f);
}

/// log2(x) for normal x > 0. Absolute error below 2e-7 + |log2 x| 2^-23 (tested).
///
/// x = 2^e m with m in [sqrt(1/2), sqrt(2)); log2(m) by the series of 2 atanh((m-1)/(m+1)), cut
/// after the ninth power, where the rest is below 1e-9.
ESTARA_KERNEL float log2_kernel(float x) noexcept {
    const std::uint32_t bits = std::bit_cast<std::uint32_t>(x);
    const std::uint32_t shifted = bits + (0x3f800000u - 0x3f3504f3u);  // 0x3f3504f3 is sqrt(1/2)
    const int exponent = int(shifted >> 23) - 127;
    const float m = std::bit_cast<float>((shifted & 0x007fffffu) + 0x3f3504f3u);
    const float s = (m - 1.0f) / (m + 1.0f);
    const float s2 = s * s;
    const float series =
        1.0f + s2 * (1.0f / 3 + s2 * (1.0f / 5 + s2 * (1.0f / 7 + s2 * (1.0f / 9))));
    return float(exponent) + 2.88539008f * s * series;  // 2 / ln 2
}

/// 2^x; 0 below -126, 2^127 above 127. Relative error below 3e-7 (tested).
///
/// Taylor series of e^(f ln 2) for the fraction f in [-1/2, 1/2], cut after the seventh power,
/// where the rest is below 6e-9; the whole part goes into the exponent.
ESTARA_KERNEL float exp2_kernel(float x) noexcept {
    const float limited = x >= -126.0f ? (x > 127.0f ? 127.0f : x) : -126.0f;  // NaN too
    const float whole = std::floor(limited + 0.5f);
    const float f = (limited - whole) * 0.693147181f;
    const float series =
        1.0f +
        f * (1.0f +
             f * (1.0f / 2 +
                  f * (1.0f / 6 +
                       f * (1.0f / 24 + f * (1.0f / 120 + f * (1.0f / 720 + f * (1.0f / 5040)))))));
    const float scale = std::bit_cast<float>(std::uint32_t(int(whole) + 127) << 23);
    return x >= -126.0f ? series * scale : (x < -126.0f ? 0.0f : x);
}

/// exp(x). 0 below e^-87. Relative error below 4e-7 + 1e-7 |x| (tested).
ESTARA_KERNEL float exp_kernel(float x) noexcept { return exp2_kernel(1.44269504f * x); }

/// x^y for x >= 0; 0^0 = 1, x below the normal floats counts as 0, and so does a result below them.
/// Relative error below 1e-6 + 2e-7 |y log2 x| (tested): 2.6e-5 at worst, 2e-6 where the result
/// lies in [1/32, 32]. Stands for std::pow in bake(), where one call would keep the whole loop
/// scalar.
ESTARA_KERNEL float power(float x, float y) noexcept {
    const float smallest = 1.17549435e-38f;
    const float r = exp2_kernel(y * log2_kernel(x < smallest ? smallest : x));
    return y == 0.0f ? 1.0f : (x < smallest ? 0.0f : r);
}

struct SinCos {
    float sin, cos;
};

/// Sine and cosine of an angle in degrees, exact at whole quarters of a circle. Absolute error
/// below 1e-7 up to 360, 1e-7 + |degrees| 2^-30 up to 1e6 (tested).
///
/// Taylor series in [-45, 45] degrees, cut after the ninth and eighth power, where the rest is
/// below 3e-8; quarters are taken out in degrees, where they are whole numbers.
ESTARA_KERNEL SinCos sincos_degrees(float degrees) noexcept {
    const float quarters = std::floor(degrees / 90.0f + 0.5f);
    const float x = (degrees - 90.0f * quarters) * 0.0174532925f;
    const float x2 = x * x;
    const float s = x * (1.0f - x2 / 6 * (1.0f - x2 / 20 * (1.0f - x2 / 42 * (1.0f - x2 / 72))));
    const float c = 1.0f - x2 / 2 * (1.0f - x2 / 12 * (1.0f - x2 / 30 * (1.0f - x2 / 56)));
    const int quarter = int(quarters) & 3;
    const bool odd = (quarter & 1) != 0;
    const float sine = odd ? c : s, cosine = odd ? s : c;
    return {(quarter & 2) != 0 ? -sine : sine, quarter == 1 || quarter == 2 ? -cosine : cosine};
}

/// v at unit length, or `otherwise` where v is too short or too long to tell its direction.
ESTARA_KERNEL glm::vec3 unit_vector_or(const glm::vec3& v, const glm::vec3& otherwise) noexcept {
    const float length2 = glm::dot(v, v);
    const bool usable = length2 > 1e-30f && length2 < 1e30f;
    const float scale = 1.0f / std::sqrt(usable ? length2 : 1.0f);
    return select(usable, v * scale, otherwise);
}

}  // namespace estara
