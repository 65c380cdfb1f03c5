// Catmull-Rom splines over equally spaced knots, as RSL's spline().
#pragma once

#include <array>
#include <cmath>
#include <cstddef>

#include "estara/shaders/kernel.h"
#include "estara/shaders/math.h"

namespace estara {

/// Value of the curve through knots[1] (x <= 0) ... knots[n-2] (x >= 1); the outermost knots only
/// give the slope at the ends. It can overshoot the knots: clamp colours to >= 0.
/// @tparam T  float or a glm vector
template <class T, std::size_t n>
ESTARA_KERNEL T spline(float x, const std::array<T, n>& knots) noexcept {
    static_assert(n >= 4, "a Catmull-Rom spline has at least four knots");
    const int spans = int(n) - 3;
    const float z = clamp(x, 0.0f, 1.0f) * float(spans);
    const int whole = int(z);
    const int i = whole < spans ? whole : spans - 1;  // x = 1 is the end of the last span
    const float t = z - float(i);
    // Chosen, not indexed: an index that differs from point to point would keep the loop scalar.
    T a = knots[0], b = knots[1], c = knots[2], d = knots[3];
#pragma GCC unroll 16
    for (int k = 1; k < spans; ++k) {
        a = select(i == k, knots[k], a);
        b = select(i == k, knots[k + 1], b);
        c = select(i == k, knots[k + 2], c);
        d = select(i == k, knots[k + 3], d);
    }
    const T linear = 0.5f * (c - a);
    const T square = 0.5f * (2.0f * a - 5.0f * b + 4.0f * c - d);
    const T cubic = 0.5f * (3.0f * (b - c) + d - a);
    return b + t * (linear + t * (square + t * cubic));
}

}  // namespace estara
