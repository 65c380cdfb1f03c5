// Scalar functions against double precision, with the error bounds that math.h states.
#include "estara/shaders/math.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "reference.h"
#include "sampling.h"

namespace estara {
namespace {

TEST(Mod, LiesInZeroToBAlsoForNegativeNumbers) {
    EXPECT_EQ(mod(5.5f, 2.0f), 1.5f);
    EXPECT_EQ(mod(-0.5f, 2.0f), 1.5f);
    EXPECT_EQ(mod(-4.0f, 2.0f), 0.0f);
    test::Random random(1);
    for (int i = 0; i < 200000; ++i) {
        const float b = std::exp2(random.within(-20.0f, 20.0f));
        const float x = random.within(-1.0f, 1.0f) * std::exp2(random.within(-30.0f, 30.0f));
        const float r = mod(x, b);
        ASSERT_GE(r, 0.0f) << x << " mod " << b;
        ASSERT_LT(r, b) << x << " mod " << b;
    }
}

// The product b floor(x / b) is rounded, and the quotient may be rounded up to a whole number: the
// result is off by a rounding of x, on the circle of length b.
TEST(Mod, IsRightUpToTheRoundingOfItsArgument) {
    test::Random random(2);
    for (int i = 0; i < 200000; ++i) {
        const float b = std::exp2(random.within(-5.0f, 5.0f)), x = random.within(-1e3f, 1e3f);
        const double off = std::abs(double(mod(x, b)) - reference::mod(x, b));
        ASSERT_LE(std::min(off, b - off), 0x1p-23 * std::abs(x) + 0x1p-24 * b) << x << " mod " << b;
    }
}

TEST(Step, IsOneFromTheEdgeOn) {
    EXPECT_EQ(step(0.5f, std::nextafter(0.5f, 0.0f)), 0.0f);
    EXPECT_EQ(step(0.5f, 0.5f), 1.0f);
    EXPECT_EQ(step(-1.0f, -2.0f), 0.0f);
}

TEST(Smoothstep, IsTheCubicBetweenItsEdges) {
    EXPECT_EQ(smoothstep(1.0f, 3.0f, 1.0f), 0.0f);
    EXPECT_EQ(smoothstep(1.0f, 3.0f, 2.0f), 0.5f);
    EXPECT_EQ(smoothstep(1.0f, 3.0f, 3.0f), 1.0f);
    EXPECT_EQ(smoothstep(1.0f, 3.0f, -1e30f), 0.0f);
    EXPECT_EQ(smoothstep(1.0f, 3.0f, 1e30f), 1.0f);
    test::Random random(3);
    for (int i = 0; i < 200000; ++i) {
        const float a = random.within(-2.0f, 2.0f), width = random.within(0.01f, 2.0f);
        const float b = a + width, x = a + width * random.within(-0.2f, 1.2f);
        // Rounding of x - a and b - a, steepened by at most 3/2 over the width.
        ASSERT_NEAR(smoothstep(a, b, x), reference::smoothstep(a, b, x), 3e-7)
            << a << " " << b << " " << x;
    }
}

TEST(Smoothstep, WithoutAWidthIsAStep) {
    EXPECT_EQ(smoothstep(2.0f, 2.0f, 1.9f), 0.0f);
    EXPECT_EQ(smoothstep(2.0f, 2.0f, 2.0f), 1.0f);
}

/// The mean of f over a box of width w around x, by the midpoint rule.
template <class F>
double box_average(F f, double x, double w) {
    const int n = 4000;
    double sum = 0;
    for (int i = 0; i < n; ++i) sum += f(x - w / 2 + (i + 0.5) * w / n);
    return sum / n;
}

TEST(Filterstep, IsTheBoxAverageOfStep) {
    test::Random random(4);
    for (int i = 0; i < 500; ++i) {
        const float edge = random.within(-1.0f, 1.0f), w = random.within(0.1f, 3.0f);
        const float x = random.within(-3.0f, 3.0f);
        const double average =
            box_average([&](double t) { return reference::step(edge, t); }, x, w);
        ASSERT_NEAR(filterstep(edge, x, w), average, 2.6e-4)
            << edge << " " << x << " " << w;  // 1 / n
    }
}

TEST(FilteredSmoothstep, IsTheBoxAverageOfSmoothstep) {
    test::Random random(5);
    for (int i = 0; i < 2000; ++i) {
        const float a = random.within(-1.0f, 1.0f), width = random.within(0.1f, 2.0f),
                    b = a + width;
        const float w = std::exp2(random.within(-5.0f, 2.0f)), x = random.within(-3.0f, 3.0f);
        const double average =
            box_average([&](double t) { return reference::smoothstep(a, b, t); }, x, w);
        const double bound = 1e-6 + 5e-7 * (width + std::abs(x)) / w;
        ASSERT_NEAR(filtered_smoothstep(a, b, x, w), average, bound)
            << a << " " << b << " " << x << " " << w;
    }
}

/// Calls check(x) for every float near 1 and for some thousands in each octave of normal floats.
template <class Check>
void for_normal_floats(Check check) {
    const auto near_one = [](std::uint32_t b) { return b >= 0x3f000000u && b < 0x40000000u; };
    const std::uint32_t stride = 4099, fine = 7;
    for (std::uint32_t b = 0x00800000u; b < 0x7f800000u; b += near_one(b) ? fine : stride) {
        check(std::bit_cast<float>(b));
    }
    check(std::numeric_limits<float>::min());
    check(std::numeric_limits<float>::max());
}

TEST(Log2Kernel, KeepsItsBoundOverAllNormalFloats) {
    double worst = 0;
    float at = 0;
    for_normal_floats([&](float x) {
        const double exact = std::log2(double(x));
        const double share = std::abs(log2_kernel(x) - exact) / (2e-7 + std::abs(exact) * 0x1p-23);
        if (share > worst) worst = share, at = x;
    });
    EXPECT_LT(worst, 1.0) << "error as a share of the bound, at x = " << at;
}

TEST(Log2Kernel, IsExactAtPowersOfTwo) {
    for (int e = -126; e <= 127; ++e) EXPECT_EQ(log2_kernel(std::ldexp(1.0f, e)), float(e));
}

TEST(Exp2Kernel, KeepsItsBoundFromMinus126To127) {
    double worst = 0;
    float at = 0;
    for (int i = 0; i <= 253 * 8192; ++i) {
        const float x = -126.0f + float(i) / 8192.0f;
        const double exact = std::exp2(double(x));
        const double error = std::abs(exp2_kernel(x) - exact) / exact;
        if (error > worst) worst = error, at = x;
    }
    EXPECT_LT(worst, 3e-7) << "relative error, at x = " << at;
}

TEST(Exp2Kernel, StopsAtTheEndsOfTheNormalFloats) {
    EXPECT_EQ(exp2_kernel(-126.0f), 0x1p-126f);
    EXPECT_EQ(exp2_kernel(std::nextafter(-126.0f, -200.0f)), 0.0f);
    EXPECT_EQ(exp2_kernel(-std::numeric_limits<float>::infinity()), 0.0f);
    EXPECT_EQ(exp2_kernel(127.0f), 0x1p127f);
    EXPECT_EQ(exp2_kernel(1e30f), 0x1p127f);
    EXPECT_EQ(exp2_kernel(0.0f), 1.0f);
}

/// Tries power() at x^y with a normal result.
class PowerErrors {
public:
    void add(float x, float y) {
        const double log2_exact = double(y) * std::log2(double(x));
        if (std::abs(log2_exact) > 125.9) return;
        const double exact = std::exp2(log2_exact);
        const double error = std::abs(power(x, y) - exact) / exact;
        m_share = std::max(m_share, error / (1e-6 + 2e-7 * std::abs(log2_exact)));
        m_worst = std::max(m_worst, error);
        if (std::abs(log2_exact) <= 5.0) m_medium = std::max(m_medium, error);
    }
    double share() const { return m_share; }
    double worst() const { return m_worst; }
    double medium() const { return m_medium; }  ///< of results in [1/32, 32]

private:
    double m_share = 0, m_worst = 0, m_medium = 0;
};

TEST(Power, KeepsItsBound) {
    PowerErrors errors;
    test::Random random(6);
    for (int i = 0; i < 1000000; ++i) {
        const float y = std::exp2(random.within(-7.0f, 10.0f));
        errors.add(random.unit() + 0x1p-25f, y);                              // in [0, 1)
        errors.add(1.0f - std::exp2(random.within(-24.0f, 0.0f)) * 0.5f, y);  // close to 1
        errors.add(std::exp2(random.within(-126.0f, 127.0f)), y);             // everything
    }
    EXPECT_LT(errors.share(), 1.0) << "error as a share of 1e-6 + 2e-7 |y log2 x|";
    EXPECT_LT(errors.worst(), 2.6e-5);
    EXPECT_LT(errors.medium(), 2e-6);
}

TEST(Power, HasTheUsualEnds) {
    EXPECT_EQ(power(0.0f, 0.0f), 1.0f);
    EXPECT_EQ(power(0.0f, 0.01f), 0.0f);
    EXPECT_EQ(power(1e-39f, 0.5f), 0.0f);  // below the normal floats
    EXPECT_EQ(power(1.0f, 1000.0f), 1.0f);
    EXPECT_EQ(power(0.5f, 1000.0f), 0.0f);  // the result is below the normal floats
    EXPECT_EQ(power(0.3f, 0.0f), 1.0f);
    EXPECT_EQ(power(0.25f, 0.5f), 0.5f);
}

TEST(Power, OfANumberInZeroToOneStaysThere) {
    test::Random random(7);
    for (int i = 0; i < 1000000; ++i) {
        const float y = std::exp2(random.within(-7.0f, 10.0f));
        const float x = i % 2 == 0 ? random.unit() : 1.0f - random.unit() * 1e-6f;
        const float r = power(x, y);
        ASSERT_GE(r, 0.0f) << x << " ^ " << y;
        ASSERT_LE(r, 1.0f) << x << " ^ " << y;
    }
}

TEST(Mix, EndsExactlyAndStaysBetweenOnes) {
    EXPECT_EQ(mix(0.1f, 0.7f, 0.0f), 0.1f);
    EXPECT_EQ(mix(0.1f, 0.7f, 1.0f), 0.7f);
    test::Random random(8);
    for (int i = 0; i < 100000; ++i) ASSERT_LE(mix(1.0f, 1.0f, random.unit()), 1.0f);
}

TEST(SmoothstepSlope, IsTheDerivativeOfSmoothstep) {
    for (int i = 0; i <= 100; ++i) {
        const double x = -0.5 + 0.03 * i + 1e-5, h = 1e-6;
        const double slope =
            (reference::smoothstep(0.2, 1.7, x + h) - reference::smoothstep(0.2, 1.7, x - h)) /
            (2 * h);
        EXPECT_NEAR(smoothstep_slope(0.2f, 1.7f, float(x)), slope, 2e-6) << x;
    }
    EXPECT_EQ(smoothstep_slope(1.0f, 1.0f, 1.0f), 0.0f);
}

TEST(ExpKernel, KeepsItsBound) {
    double worst = 0;
    for (int i = 0; i <= 175 * 8192; ++i) {
        const float x = -87.0f + float(i) / 8192.0f;
        const double exact = std::exp(double(x));
        const double bound = 4e-7 + 1e-7 * std::abs(double(x));
        worst = std::max(worst, std::abs(exp_kernel(x) - exact) / exact / bound);
    }
    EXPECT_LT(worst, 1.0) << "relative error as a share of the bound";
    EXPECT_EQ(exp_kernel(0.0f), 1.0f);
    EXPECT_EQ(exp_kernel(-1e30f), 0.0f);
}

TEST(SincosDegrees, KeepsItsBound) {
    test::Random random(9);
    for (int i = 0; i < 1000000; ++i) {
        const float degrees = random.within(-1.0f, 1.0f) * (i % 2 == 0 ? 360.0f : 1e6f);
        const double radians = double(degrees) * (3.14159265358979323846 / 180);
        const double bound = 1e-7 + std::abs(double(degrees)) * 0x1p-30;
        const SinCos both = sincos_degrees(degrees);
        ASSERT_NEAR(both.sin, std::sin(radians), bound) << degrees;
        ASSERT_NEAR(both.cos, std::cos(radians), bound) << degrees;
    }
}

TEST(SincosDegrees, IsExactAtQuartersOfACircle) {
    for (int quarter = -8; quarter <= 8; ++quarter) {
        const SinCos both = sincos_degrees(90.0f * float(quarter));
        const int turned = ((quarter % 4) + 4) % 4;
        EXPECT_EQ(both.sin, turned == 1 ? 1.0f : turned == 3 ? -1.0f : 0.0f) << quarter;
        EXPECT_EQ(both.cos, turned == 0 ? 1.0f : turned == 2 ? -1.0f : 0.0f) << quarter;
    }
}

TEST(UnitVectorOr, IsOfUnitLengthOrTheOther) {
    const glm::vec3 other(0.0f, 0.6f, 0.8f);
    test::Random random(10);
    for (int i = 0; i < 10000; ++i) {
        const glm::vec3 d = random.direction() * std::exp2(random.within(-49.0f, 49.0f));
        const glm::vec3 unit = unit_vector_or(d, other);
        ASSERT_NEAR(glm::length(unit), 1.0f, 1e-6f);
        ASSERT_GT(glm::dot(unit, d) / glm::length(d), 0.999999f);
    }
    EXPECT_EQ(unit_vector_or(glm::vec3(0.0f), other), other);
    EXPECT_EQ(unit_vector_or(glm::vec3(1e30f), other), other);
    EXPECT_EQ(unit_vector_or(glm::vec3(std::nanf("")), other), other);
}

}  // namespace
}  // namespace estara
