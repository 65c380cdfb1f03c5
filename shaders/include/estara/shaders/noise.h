// Noise, cellnoise, Voronoi cells and turbulence: what patterns are made of.
//
// Lattice points get their random numbers from an integer hash instead of the usual permutation
// table: a table lookup per corner cannot be made wide cheaply, and the table repeats every 256.
#pragma once

#include <glm/glm.hpp>

#include <bit>
#include <cmath>
#include <cstdint>

#include "estara/shaders/kernel.h"
#include "estara/shaders/math.h"

namespace estara {

namespace detail {

/// Whole and fractional part of a coordinate. Beyond +-2^24, where floats have no fraction left,
/// the whole part is 0 so that it fits an int (all cells there are cell 0); NaN gives a NaN
/// fraction.
struct Lattice {
    int cell;
    float offset;
};
ESTARA_KERNEL Lattice lattice(float x) noexcept {
    const float whole = std::floor(x);
    return {int(std::fabs(whole) <= 0x1p24f ? whole : 0.0f), x - whole};
}

/// 32-bit finaliser; constants of Wellons 2018, "Prospecting for Hash Functions" (lowbias32).
ESTARA_KERNEL std::uint32_t scramble(std::uint32_t h) noexcept {
    h = (h ^ (h >> 16)) * 0x7feb352du;
    h = (h ^ (h >> 15)) * 0x846ca68bu;
    return h ^ (h >> 16);
}

/// What a coordinate brings to the hash of cells, and what the next one does. The multipliers are
/// odd and unrelated, so that the products of small coordinates do not cancel in the xor. The
/// summands move the lattice off zero: a number and its negative differ in the bits above their
/// lowest one, so that without them the signs of x and y would cancel in every third cell,
/// hash(-x, -y, z) = hash(x, y, z). (Our choice of constants; the histogram, the correlations and
/// the symmetries are tested.)
struct Bits {
    std::uint32_t here, next;
};
ESTARA_KERNEL Bits axis_bits(int cell, std::uint32_t factor, std::uint32_t summand) noexcept {
    const std::uint32_t here = std::uint32_t(cell) * factor + summand;
    return {here, here + factor};
}
ESTARA_KERNEL Bits x_bits(int x) noexcept { return axis_bits(x, 0x8da6b343u, 0x6c8e9cf5u); }
ESTARA_KERNEL Bits y_bits(int y) noexcept { return axis_bits(y, 0xd8163841u, 0x3ad8025fu); }
/// `seed` gives independent sets of random bits.
ESTARA_KERNEL Bits z_bits(int z, std::uint32_t seed) noexcept {
    const Bits bits = axis_bits(z, 0xcb1ab31fu, 0x2545f491u);
    const std::uint32_t set = seed * 0x9e3779b9u;
    return {bits.here ^ set, bits.next ^ set};
}

/// A cell's random bits.
ESTARA_KERNEL std::uint32_t hash(int x, int y, int z, std::uint32_t seed) noexcept {
    return scramble(x_bits(x).here ^ y_bits(y).here ^ z_bits(z, seed).here);
}

/// The upper 24 bits as a float in [0, 1).
ESTARA_KERNEL float unit_float(std::uint32_t h) noexcept { return float(int(h >> 8)) * 0x1p-24f; }

/// 6t^5 - 15t^4 + 10t^3 (Perlin 2002, "Improving Noise").
ESTARA_KERNEL float fade(float t) noexcept { return t * t * t * (t * (t * 6.0f - 15.0f) + 10.0f); }

ESTARA_KERNEL float lerp(float t, float a, float b) noexcept { return a + t * (b - a); }

/// Flips the sign of x where bit 0 of h is set.
ESTARA_KERNEL float signed_by(std::uint32_t h, float x) noexcept {
    return std::bit_cast<float>(std::bit_cast<std::uint32_t>(x) ^ (h << 31));
}

/// Whether a bit of h is set; computed as a sign, for that is what blend instructions look at.
ESTARA_KERNEL bool has_bit(std::uint32_t h, int bit) noexcept { return int(h << (31 - bit)) < 0; }

/// (x, y, z) . one of the twelve edge directions of a cube, four of them twice (Perlin 2002). Of
/// h's last four bits: u is x, or y from 8 on; v is y below 4, x for 12 and 14, else z.
ESTARA_KERNEL float gradient(std::uint32_t h, float x, float y, float z) noexcept {
    const float u = has_bit(h, 3) ? y : x;
    const float z_or_x = (h & 13u) == 12u ? x : z;
    const float v = (h & 12u) == 0u ? y : z_or_x;
    return signed_by(h, u) + signed_by(h >> 1, v);
}

/// (x, y) . one of eight directions (+-1, +-2), (+-2, +-1).
ESTARA_KERNEL float gradient(std::uint32_t h, float x, float y) noexcept {
    const bool swapped = has_bit(h, 2);
    const float u = swapped ? y : x, v = swapped ? x : y;
    return signed_by(h, u) + 2.0f * signed_by(h >> 1, v);
}

/// x times a slope of +-1 ... +-8.
ESTARA_KERNEL float gradient(std::uint32_t h, float x) noexcept {
    return signed_by(h >> 3, float(int(1u + (h & 7u))) * x);
}

}  // namespace detail

/// Gradient noise of a number, about [-1, 1], mean 0, exactly 0 at whole coordinates.
/// Perlin 2002; amplitude factors .188, .507, .936 for one to three dimensions, with which the
/// values fill the range.
/// @param seed  another seed, another noise, independent of the first
ESTARA_KERNEL float snoise(float x, std::uint32_t seed = 0) noexcept {
    using namespace detail;
    const Lattice a = lattice(x);
    const Bits X = x_bits(a.cell);
    const std::uint32_t yz = y_bits(0).here ^ z_bits(0, seed).here;
    const float g0 = gradient(scramble(X.here ^ yz), a.offset);
    const float g1 = gradient(scramble(X.next ^ yz), a.offset - 1.0f);
    return 0.188f * lerp(fade(a.offset), g0, g1);
}

ESTARA_KERNEL float snoise(const glm::vec2& p, std::uint32_t seed = 0) noexcept {
    using namespace detail;
    const Lattice a = lattice(p.x), b = lattice(p.y);
    const float x = a.offset, y = b.offset, u = fade(x);
    const Bits X = x_bits(a.cell), Y = y_bits(b.cell);
    const std::uint32_t Z = z_bits(0, seed).here;
    const float g00 = gradient(scramble(X.here ^ Y.here ^ Z), x, y);
    const float g10 = gradient(scramble(X.next ^ Y.here ^ Z), x - 1.0f, y);
    const float g01 = gradient(scramble(X.here ^ Y.next ^ Z), x, y - 1.0f);
    const float g11 = gradient(scramble(X.next ^ Y.next ^ Z), x - 1.0f, y - 1.0f);
    return 0.507f * lerp(fade(y), lerp(u, g00, g10), lerp(u, g01, g11));
}

ESTARA_KERNEL float snoise(const glm::vec3& p, std::uint32_t seed = 0) noexcept {
    using namespace detail;
    const Lattice a = lattice(p.x), b = lattice(p.y), c = lattice(p.z);
    const float x = a.offset, y = b.offset, z = c.offset, u = fade(x), v = fade(y);
    const Bits X = x_bits(a.cell), Y = y_bits(b.cell), Z = z_bits(c.cell, seed);
    const float g000 = gradient(scramble(X.here ^ Y.here ^ Z.here), x, y, z);
    const float g100 = gradient(scramble(X.next ^ Y.here ^ Z.here), x - 1.0f, y, z);
    const float g010 = gradient(scramble(X.here ^ Y.next ^ Z.here), x, y - 1.0f, z);
    const float g110 = gradient(scramble(X.next ^ Y.next ^ Z.here), x - 1.0f, y - 1.0f, z);
    const float g001 = gradient(scramble(X.here ^ Y.here ^ Z.next), x, y, z - 1.0f);
    const float g101 = gradient(scramble(X.next ^ Y.here ^ Z.next), x - 1.0f, y, z - 1.0f);
    const float g011 = gradient(scramble(X.here ^ Y.next ^ Z.next), x, y - 1.0f, z - 1.0f);
    const float g111 = gradient(scramble(X.next ^ Y.next ^ Z.next), x - 1.0f, y - 1.0f, z - 1.0f);
    const float near = lerp(v, lerp(u, g000, g100), lerp(u, g010, g110));
    const float far = lerp(v, lerp(u, g001, g101), lerp(u, g011, g111));
    return 0.936f * lerp(fade(z), near, far);
}

/// Noise with its gradient.
struct NoiseSlope {
    float value;
    glm::vec3 gradient;  ///< change of value with the point, up to about 4 in length
};

namespace detail {

/// The vector whose product with (x, y, z) is gradient(h, x, y, z).
ESTARA_KERNEL glm::vec3 gradient_vector(std::uint32_t h) noexcept {
    const float u = signed_by(h, 1.0f), v = signed_by(h >> 1, 1.0f);
    const bool u_is_y = has_bit(h, 3), v_is_x = (h & 13u) == 12u, v_is_y = (h & 12u) == 0u;
    return {select(u_is_y, 0.0f, u) + select(v_is_x, v, 0.0f),
            select(u_is_y, u, 0.0f) + select(v_is_y, v, 0.0f), select(v_is_y | v_is_x, 0.0f, v)};
}

/// What a corner of the lattice adds at an offset from it, and its gradient.
ESTARA_KERNEL NoiseSlope corner(std::uint32_t h, float x, float y, float z) noexcept {
    return {gradient(h, x, y, z), gradient_vector(h)};
}

ESTARA_KERNEL glm::vec3 lerp(float t, const glm::vec3& a, const glm::vec3& b) noexcept {
    return a + t * (b - a);
}

/// The derivative of fade().
ESTARA_KERNEL float fade_slope(float t) noexcept {
    const float s = t * (1.0f - t);
    return 30.0f * s * s;
}

}  // namespace detail

/// snoise(p, seed), to the bit, and its gradient, from one hash a corner. The corners' gradients
/// are interpolated as their values are, and the weights' own change is added.
ESTARA_KERNEL NoiseSlope snoise_gradient(const glm::vec3& p, std::uint32_t seed = 0) noexcept {
    using namespace detail;
    const Lattice a = lattice(p.x), b = lattice(p.y), c = lattice(p.z);
    const float x = a.offset, y = b.offset, z = c.offset;
    const float u = fade(x), v = fade(y), w = fade(z);
    const Bits X = x_bits(a.cell), Y = y_bits(b.cell), Z = z_bits(c.cell, seed);
    const NoiseSlope g000 = corner(scramble(X.here ^ Y.here ^ Z.here), x, y, z);
    const NoiseSlope g100 = corner(scramble(X.next ^ Y.here ^ Z.here), x - 1.0f, y, z);
    const NoiseSlope g010 = corner(scramble(X.here ^ Y.next ^ Z.here), x, y - 1.0f, z);
    const NoiseSlope g110 = corner(scramble(X.next ^ Y.next ^ Z.here), x - 1.0f, y - 1.0f, z);
    const NoiseSlope g001 = corner(scramble(X.here ^ Y.here ^ Z.next), x, y, z - 1.0f);
    const NoiseSlope g101 = corner(scramble(X.next ^ Y.here ^ Z.next), x - 1.0f, y, z - 1.0f);
    const NoiseSlope g011 = corner(scramble(X.here ^ Y.next ^ Z.next), x, y - 1.0f, z - 1.0f);
    const NoiseSlope g111 =
        corner(scramble(X.next ^ Y.next ^ Z.next), x - 1.0f, y - 1.0f, z - 1.0f);

    const float near0 = lerp(u, g000.value, g100.value), near1 = lerp(u, g010.value, g110.value);
    const float far0 = lerp(u, g001.value, g101.value), far1 = lerp(u, g011.value, g111.value);
    const float near = lerp(v, near0, near1), far = lerp(v, far0, far1);
    const float x_near = lerp(v, g100.value - g000.value, g110.value - g010.value);
    const float x_far = lerp(v, g101.value - g001.value, g111.value - g011.value);
    const glm::vec3 of_weights(fade_slope(x) * lerp(w, x_near, x_far),
                               fade_slope(y) * lerp(w, near1 - near0, far1 - far0),
                               fade_slope(z) * (far - near));
    const glm::vec3 near_gradient =
        lerp(v, lerp(u, g000.gradient, g100.gradient), lerp(u, g010.gradient, g110.gradient));
    const glm::vec3 far_gradient =
        lerp(v, lerp(u, g001.gradient, g101.gradient), lerp(u, g011.gradient, g111.gradient));
    return {0.936f * lerp(w, near, far),
            0.936f * (lerp(w, near_gradient, far_gradient) + of_weights)};
}

/// RSL's noise: snoise mapped to [0, 1], mean .5, exactly .5 at lattice points. For glm's float,
/// vec2 and vec3.
template <class Point>
ESTARA_KERNEL float noise(const Point& p, std::uint32_t seed = 0) noexcept {
    return 0.5f + 0.5f * snoise(p, seed);
}

/// Three independent noises, each in [0, 1]: vector or colour valued noise. The components are
/// told apart by the hash's seed, which is a shift of the lattice without its rounding.
template <class Point>
ESTARA_KERNEL glm::vec3 vnoise(const Point& p) noexcept {
    return {noise(p, 1u), noise(p, 2u), noise(p, 3u)};
}

/// Constant in each unit cell, uniform on [0, 1).
ESTARA_KERNEL float cellnoise(const glm::vec2& p, std::uint32_t seed = 0) noexcept {
    using namespace detail;
    return unit_float(hash(lattice(p.x).cell, lattice(p.y).cell, 0, seed));
}
ESTARA_KERNEL float cellnoise(const glm::vec3& p, std::uint32_t seed = 0) noexcept {
    using namespace detail;
    return unit_float(hash(lattice(p.x).cell, lattice(p.y).cell, lattice(p.z).cell, seed));
}

/// The two nearest feature points of a jittered lattice, one point to a cell.
template <class Point>
struct Voronoi {
    float f1, f2;    ///< distances to the nearest and the second nearest
    Point feature1;  ///< the nearest
};

namespace detail {

template <class Point>
ESTARA_KERNEL void keep_nearest(Voronoi<Point>& v, const Point& feature, float d2) noexcept {
    const bool first = d2 < v.f1;
    v.f2 = first ? v.f1 : (d2 < v.f2 ? d2 : v.f2);
    v.f1 = first ? d2 : v.f1;
    for (int c = 0; c < Point::length(); ++c) {
        v.feature1[c] = first ? feature[c] : v.feature1[c];
    }
}

}  // namespace detail

/// Worley's F1 and F2 (Apodaca & Gritz 1999, "Advanced RenderMan", chapter 10): the feature point
/// of a cell is its centre moved by jitter * (cellnoise - 1/2).
///
/// Searches the 3^n cells around the point, as the source does. That is not exact: a nearer point
/// can hide two cells away (f1 reaches 1.17), which shows as rare, tiny seams; they are accepted,
/// because a 5^n search costs three to five times as much.
/// @param jitter  [0, 1]
ESTARA_KERNEL Voronoi<glm::vec2> voronoi(const glm::vec2& p, float jitter) noexcept {
    using namespace detail;
    const glm::ivec2 cell(lattice(p.x).cell, lattice(p.y).cell);
    Voronoi<glm::vec2> v{1e30f, 1e30f, p};
#pragma GCC unroll 9
    for (int n = 0; n < 9; ++n) {
        const int x = cell.x + n % 3 - 1, y = cell.y + n / 3 - 1;
        const glm::vec2 feature(float(x) + 0.5f + jitter * (unit_float(hash(x, y, 0, 1u)) - 0.5f),
                                float(y) + 0.5f + jitter * (unit_float(hash(x, y, 0, 2u)) - 0.5f));
        const float dx = feature.x - p.x, dy = feature.y - p.y;
        keep_nearest(v, feature, dx * dx + dy * dy);
    }
    return {std::sqrt(v.f1), std::sqrt(v.f2), v.feature1};
}

ESTARA_KERNEL Voronoi<glm::vec3> voronoi(const glm::vec3& p, float jitter) noexcept {
    using namespace detail;
    const glm::ivec3 cell(lattice(p.x).cell, lattice(p.y).cell, lattice(p.z).cell);
    Voronoi<glm::vec3> v{1e30f, 1e30f, p};
#pragma GCC unroll 27
    for (int n = 0; n < 27; ++n) {
        const int x = cell.x + n % 3 - 1, y = cell.y + n / 3 % 3 - 1, z = cell.z + n / 9 - 1;
        const glm::vec3 feature(float(x) + 0.5f + jitter * (unit_float(hash(x, y, z, 1u)) - 0.5f),
                                float(y) + 0.5f + jitter * (unit_float(hash(x, y, z, 2u)) - 0.5f),
                                float(z) + 0.5f + jitter * (unit_float(hash(x, y, z, 3u)) - 0.5f));
        const float dx = feature.x - p.x, dy = feature.y - p.y, dz = feature.z - p.z;
        keep_nearest(v, feature, dx * dx + dy * dy + dz * dz);
    }
    return {std::sqrt(v.f1), std::sqrt(v.f2), v.feature1};
}

/// How many terms clamped turbulence has at filter width w: m + 1 with m = ceil(log2(1 / 2w)), at
/// least 1 and at most 24 (a float has no detail beyond).
/// @param w  filter width in units of the turbulence's lattice, > 0
inline int octaves_for(float w) noexcept {
    const float m = std::ceil(std::log2(0.5f / w));
    return m >= 0.0f ? (m > 23.0f ? 24 : int(m) + 1) : 1;
}

/// What a term of turbulence is made of.
enum class Phi {
    noise,     ///< noise, mean .5
    deviation  ///< |noise - 1/2|: creases along its zeros, which become veins
};

/// Term k of turbulence clamped at the filter width (after Upstill 1990,
/// "The RenderMan Companion"): 2^-k phi(2^k q), where octaves finer than twice the width are left
/// out and the last one is faded in. The factor clamp(2^-k / w - 1, 0, 1) is 1 for the whole
/// octaves, beta for the last and 0 beyond, so one expression serves all terms. The turbulence is
/// the sum over k < octaves_for(w); terms more than that change nothing.
/// @param q  position in units of the lattice
/// @param w  filter width in the same units, > 0: a voxel's edge, never a pixel's
/// @param k  [0, 24)
template <Phi phi>
ESTARA_KERNEL float turbulence_term(const glm::vec3& q, float w, int k) noexcept {
    const float frequency = float(1 << k), amplitude = 1.0f / frequency;
    const float n = snoise(q * frequency);
    const float term = phi == Phi::noise ? 0.5f + 0.5f * n : std::fabs(0.5f * n);
    return amplitude * clamp(amplitude / w - 1.0f, 0.0f, 1.0f) * term;
}

}  // namespace estara
