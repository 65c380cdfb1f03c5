// Points to try shaders at, the same on every machine, and shaders baked at them.
#pragma once

#include <glm/glm.hpp>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <random>
#include <string>
#include <vector>

#include "estara/shaders/batch.h"
#include "estara/shaders/registry.h"

namespace estara::test {

/// Uniform random numbers. Not the distributions of the standard library: their results differ from
/// one implementation to the next.
class Random {
public:
    explicit Random(std::uint32_t seed) : m_engine(seed) {}
    float unit() { return float(m_engine() >> 8) * 0x1p-24f; }  ///< [0, 1)
    float within(float lo, float hi) { return lo + (hi - lo) * unit(); }
    glm::vec3 point(float extent) {
        const float x = within(-extent, extent), y = within(-extent, extent);
        return {x, y, within(-extent, extent)};
    }
    /// Uniform on the unit sphere.
    glm::vec3 direction() {
        glm::vec3 d = point(1.0f);
        while (glm::dot(d, d) > 1.0f || glm::dot(d, d) < 1e-4f) d = point(1.0f);
        return d / std::sqrt(glm::dot(d, d));
    }

private:
    std::mt19937 m_engine;
};

/// A full batch of points in a box of half width `extent`, whose uv lies in [-extent, extent]^2.
inline SurfaceBatch random_batch(std::uint32_t seed, float extent = 4.0f,
                                 float filter_width = 0.01f) {
    Random random(seed);
    SurfaceBatch batch{};
    batch.size = SurfaceBatch::capacity;
    batch.filter_width = filter_width;
    for (int i = 0; i < batch.size; ++i) {
        const glm::vec3 P = random.point(extent), N = random.direction();
        const glm::vec2 uv(random.within(-extent, extent), random.within(-extent, extent));
        batch.set(i, P, N, uv, random.direction());
    }
    return batch;
}

/// Puts point `from` of one batch at place `to` of another.
inline void copy_point(const SurfaceBatch& source, int from, SurfaceBatch& target, int to) {
    target.set(to, {source.P[0][from], source.P[1][from], source.P[2][from]},
               {source.N[0][from], source.N[1][from], source.N[2][from]},
               {source.uv[0][from], source.uv[1][from]},
               {source.dPdu[0][from], source.dPdu[1][from], source.dPdu[2][from]});
}

/// What no shader bakes: planes are filled with it first.
inline constexpr float untouched = -12345.0f;

/// planes[k * SurfaceBatch::capacity + i], see BoundShader::bake().
inline std::vector<float> bake(const BoundShader& shader, const SurfaceBatch& batch) {
    std::vector<float> planes(std::size_t(shader.info().baked_floats) * SurfaceBatch::capacity,
                              untouched);
    shader.bake(batch, planes.data());
    return planes;
}

inline bool same_bits(const std::vector<float>& a, const std::vector<float>& b) {
    return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(float)) == 0;
}

/// Mean, spread and quantiles of a sample.
class Sample {
public:
    void add(double x) {
        m_values.push_back(x);
        m_sum += x;
        m_sum2 += x * x;
    }
    double mean() const { return m_sum / double(m_values.size()); }
    double deviation() const {
        return std::sqrt(m_sum2 / double(m_values.size()) - mean() * mean());
    }
    /// The value that a share `q` of the sample lies below.
    double quantile(double q) {
        const auto at = m_values.begin() + std::ptrdiff_t(q * double(m_values.size()));
        std::nth_element(m_values.begin(), at, m_values.end());
        return *at;
    }
    double largest() { return quantile(1.0 - 1e-9); }
    /// Share of the sample above x.
    double above(double x) const {
        return double(std::count_if(m_values.begin(), m_values.end(),
                                    [x](double v) { return v > x; })) /
               double(m_values.size());
    }

private:
    std::vector<double> m_values;
    double m_sum = 0, m_sum2 = 0;
};

/// Pearson's correlation of pairs.
class Correlation {
public:
    void add(double x, double y) {
        m_n += 1, m_x += x, m_y += y, m_xx += x * x, m_yy += y * y, m_xy += x * y;
    }
    double value() const {
        const double xy = m_xy / m_n - m_x * m_y / m_n / m_n;
        const double xx = m_xx / m_n - m_x * m_x / m_n / m_n,
                     yy = m_yy / m_n - m_y * m_y / m_n / m_n;
        return xy / std::sqrt(xx * yy);
    }

private:
    double m_n = 0, m_x = 0, m_y = 0, m_xx = 0, m_yy = 0, m_xy = 0;
};

}  // namespace estara::test
