// The error of a bake at points it never saw.
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <random>
#include <span>
#include <vector>

#include "estara/bake/bake.h"
#include "estara/grids/bricks.h"

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

ErrorFigures figures(std::vector<float>& errors, std::uint64_t samples) {
    ErrorFigures f;
    double sum = 0.0, squares = 0.0;
    for (const float e : errors) {
        sum += e;
        squares += double(e) * e;
    }
    f.mean = sum / double(errors.size());
    f.rmse = std::sqrt(squares / double(errors.size()));
    // The values below which a fraction lies; each search leaves the larger ones behind it.
    const auto quantile = [&](double fraction) {
        return errors.begin() + std::ptrdiff_t(fraction * double(errors.size() - 1));
    };
    const auto p99 = quantile(0.99), p999 = quantile(0.999);
    std::nth_element(errors.begin(), p99, errors.end());
    f.p99 = *p99;
    std::nth_element(p99, p999, errors.end());
    f.p999 = *p999;
    f.max = *std::max_element(p999, errors.end());
    f.samples = samples;
    return f;
}

constexpr std::size_t batch_size = SurfaceBatch::capacity;

/// Points and what the shader gives there.
struct Reference {
    std::vector<glm::vec3> P;
    std::vector<std::vector<float>> values;  ///< [float of the record][point]
};

Reference evaluate(const Mesh& mesh, const BoundShader& shader, double filter_width,
                   std::uint64_t samples, std::uint64_t seed) {
    const SurfaceSampler sampler(mesh);
    const auto floats = std::size_t(shader.info().baked_floats);
    Reference reference{std::vector<glm::vec3>(samples), {}};
    reference.values.assign(floats, std::vector<float>(samples));
    const bool needs_tangent = shader.domain() == Domain::surface;
    tbb::parallel_for(std::size_t{0}, (samples + batch_size - 1) / batch_size, [&](std::size_t b) {
        // A generator for each batch: the points do not depend on who works on which batch.
        std::mt19937_64 random(seed * 0x9e3779b97f4a7c15u + b);
        std::uniform_real_distribution<double> uniform;
        thread_local SurfaceBatch batch;
        thread_local std::vector<float> planes;
        planes.resize(floats * batch_size);
        const std::size_t first = b * batch_size;
        batch.size = int(std::min(batch_size, samples - first));
        batch.filter_width = float(filter_width);
        for (int i = 0; i < batch.size; ++i) {
            const double x = uniform(random), y = uniform(random), z = uniform(random);
            const MeshPoint m = sampler.at({x, y, z});
            batch.set(i, m.P, m.N, m.uv, needs_tangent ? tangent(mesh, m) : glm::vec3(1, 0, 0));
            reference.P[first + std::size_t(i)] = m.P;
        }
        shader.bake(batch, planes.data());
        for (std::size_t k = 0; k < floats; ++k) {
            std::copy_n(planes.begin() + std::ptrdiff_t(k * batch_size), batch.size,
                        reference.values[k].begin() + std::ptrdiff_t(first));
        }
    });
    return reference;
}

/// Replaces values by their distance from what a lookup on the finest level gives.
void subtract_lookup(const BrickPyramid& pyramid, Reference& reference) {
    const std::size_t samples = reference.P.size(), floats = reference.values.size();
    static constexpr std::array<float, batch_size> finest{};  // footprints
    tbb::parallel_for(std::size_t{0}, (samples + batch_size - 1) / batch_size, [&](std::size_t b) {
        const std::size_t first = b * batch_size, count = std::min(batch_size, samples - first);
        std::array<float, BrickPyramid::max_floats * batch_size> planes;
        std::array<std::uint8_t, batch_size> found;
        pyramid.lookup(std::span(reference.P).subspan(first, count), std::span(finest).first(count),
                       planes.data(), batch_size, found.data());
        for (std::size_t k = 0; k < floats; ++k) {
            for (std::size_t i = 0; i < count; ++i) {
                float& value = reference.values[k][first + i];
                value = std::abs(planes[k * batch_size + i] - value);
            }
        }
    });
}

}  // namespace

std::vector<ErrorFigures> measure_error(const Mesh& mesh, const BoundShader& shader,
                                        const TextureGrid& grid, std::uint64_t samples,
                                        std::uint64_t seed) {
    Reference reference = evaluate(mesh, shader, grid.voxel_size, samples, seed);
    subtract_lookup(BrickPyramid(grid), reference);
    const std::vector<std::vector<float>>& errors = reference.values;

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
