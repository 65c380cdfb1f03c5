// The error of a bake at points it never saw.
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <span>
#include <vector>

#include "error_figures.h"
#include "estara/bake/bake.h"
#include "estara/grids/bricks.h"
#include "surface_sampler.h"

namespace estara {

namespace {

constexpr std::size_t batch_size = SurfaceSampler::batch_size;
constexpr std::size_t shader_stride = SurfaceBatch::capacity;  ///< of planes that bake() fills
static_assert(batch_size <= shader_stride);

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
        thread_local SurfaceBatch batch;
        thread_local std::vector<MeshPoint> points;
        thread_local std::vector<float> planes;
        planes.resize(floats * shader_stride);
        const std::size_t first = b * batch_size;
        sampler.points(seed, b, std::min(batch_size, samples - first), points);
        batch.size = int(points.size());
        batch.filter_width = float(filter_width);
        for (int i = 0; i < batch.size; ++i) {
            const MeshPoint& m = points[std::size_t(i)];
            batch.set(i, m.P, m.N, m.uv, needs_tangent ? tangent(mesh, m) : glm::vec3(1, 0, 0));
            reference.P[first + std::size_t(i)] = m.P;
        }
        shader.bake(batch, planes.data());
        for (std::size_t k = 0; k < floats; ++k) {
            std::copy_n(planes.begin() + std::ptrdiff_t(k * shader_stride), batch.size,
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
    subtract_lookup(BrickPyramid::around(grid, reference.P), reference);
    const std::vector<std::vector<float>>& errors = reference.values;

    std::vector<ErrorFigures> result;
    std::size_t first = 0;
    for (const ChannelInfo& channel : shader.info().channels) {
        std::vector<float> all;
        for (int c = 0; c < channel.components; ++c) {
            all.insert(all.end(), errors[first + std::size_t(c)].begin(),
                       errors[first + std::size_t(c)].end());
        }
        result.push_back(error_figures(all, samples));
        first += std::size_t(channel.components);
    }
    return result;
}

}  // namespace estara
