// The error of a bake at points it never saw.
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <random>
#include <vector>

#include "estara/bake/bake.h"

namespace estara {

namespace {

/// Points on a mesh, uniform by area.
class SurfaceSampler {
public:
    explicit SurfaceSampler(const Mesh& mesh) : m_mesh(mesh), m_area(mesh.triangles.size()) {
        double sum = 0.0;
        for (std::size_t t = 0; t < m_area.size(); ++t) {
            const glm::uvec3& c = mesh.triangles[t];
            const glm::dvec3 a(mesh.P[c.x]);
            sum += 0.5 * glm::length(
                             glm::cross(glm::dvec3(mesh.P[c.y]) - a, glm::dvec3(mesh.P[c.z]) - a));
            m_area[t] = sum;
        }
    }

    /// @param u  three numbers in [0, 1)
    MeshPoint at(const glm::dvec3& u) const {
        const auto found = std::upper_bound(m_area.begin(), m_area.end(), u.x * m_area.back());
        const auto triangle =
            std::min<std::size_t>(std::size_t(found - m_area.begin()), m_area.size() - 1);
        const double root = std::sqrt(u.y);  // Turk 1990, "Generating Random Points in Triangles"
        return mesh_point(m_mesh, std::uint32_t(triangle), float(root * (1.0 - u.z)),
                          float(root * u.z));
    }

private:
    const Mesh& m_mesh;
    std::vector<double> m_area;  ///< of the triangles up to and with this one
};

/// The value below which a fraction of the (reordered) values lies.
double quantile(std::vector<float>& values, double fraction) {
    const auto at = values.begin() + std::ptrdiff_t(fraction * double(values.size() - 1));
    std::nth_element(values.begin(), at, values.end());
    return *at;
}

ErrorFigures figures(std::vector<float>& errors, std::uint64_t samples) {
    ErrorFigures f;
    double sum = 0.0, squares = 0.0;
    for (const float e : errors) {
        sum += e;
        squares += double(e) * e;
    }
    f.mean = sum / double(errors.size());
    f.rmse = std::sqrt(squares / double(errors.size()));
    f.p99 = quantile(errors, 0.99);
    f.p999 = quantile(errors, 0.999);
    f.max = *std::max_element(errors.begin(), errors.end());
    f.samples = samples;
    return f;
}

}  // namespace

std::vector<ErrorFigures> measure_error(const Mesh& mesh, const BoundShader& shader,
                                        const BrickPyramid& pyramid, double filter_width,
                                        std::uint64_t samples, std::uint64_t seed) {
    const SurfaceSampler sampler(mesh);
    const auto floats = std::size_t(shader.info().baked_floats);
    std::vector<std::vector<float>> errors(floats, std::vector<float>(samples));
    constexpr std::uint64_t batch_size = SurfaceBatch::capacity;

    tbb::parallel_for(
        std::uint64_t{0}, (samples + batch_size - 1) / batch_size, [&](std::uint64_t b) {
            // A generator for each batch: the points do not depend on who works on which batch.
            std::mt19937_64 random(seed * 0x9e3779b97f4a7c15u + b);
            std::uniform_real_distribution<double> uniform;
            thread_local SurfaceBatch batch;
            thread_local std::vector<float> planes;
            planes.resize(floats * batch_size);
            batch.size = int(std::min(batch_size, samples - b * batch_size));
            batch.filter_width = float(filter_width);
            for (int i = 0; i < batch.size; ++i) {
                const double x = uniform(random), y = uniform(random), z = uniform(random);
                const MeshPoint m = sampler.at({x, y, z});
                batch.set(i, m.P, m.N, m.uv, tangent(mesh, m));
            }
            shader.bake(batch, planes.data());
            for (int i = 0; i < batch.size; ++i) {
                std::array<float, BrickPyramid::max_floats> value{};
                pyramid.lookup({batch.P[0][i], batch.P[1][i], batch.P[2][i]}, 0, value.data());
                for (std::size_t k = 0; k < floats; ++k) {
                    const float exact = planes[k * batch_size + std::size_t(i)];
                    errors[k][b * batch_size + std::uint64_t(i)] = std::abs(value[k] - exact);
                }
            }
        });

    std::vector<ErrorFigures> result;
    std::size_t first = 0;
    for (const ChannelInfo& channel : shader.info().channels) {
        std::vector<float> all;
        for (int c = 0; c < channel.components; ++c) {
            all.insert(all.end(), errors[first + std::size_t(c)].begin(),
                       errors[first + std::size_t(c)].end());
        }
        result.push_back(figures(all, samples));
        first += std::size_t(channel.components);
    }
    return result;
}

}  // namespace estara
