#include "estara/bake/bake.h"

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <atomic>
#include <cmath>

#include "estara/bake/surface_band.h"
#include "estara/scenes/error.h"
#include "estara/scenes/program.h"

namespace estara {

namespace {

/// Peak memory of a bake in bytes per active voxel of level 0, beside 4 bytes for each float of the
/// record: the band while it is built, all levels, the lookup structure, the file's trees. Measured
/// on meshes from 0.3 to 10 million voxels (tests/bake, Bake.StaysBelowItsMemoryEstimate).
constexpr double bytes_per_voxel = 150.0;

/// The points of a block that are baked, in row order.
void fill_batch(SurfaceBatch& batch, const Mesh& mesh, Domain domain, const SurfaceBand& band,
                const Block& block) {
    batch.size = 0;
    batch.filter_width = float(band.voxel_size);
    for (int bit = 0; bit < SurfaceBatch::capacity; ++bit) {
        if (!block.active.test(bit)) continue;
        const std::uint64_t row = block.first + std::uint64_t(batch.size);
        const glm::vec2 b = band.barycentrics[row];
        const MeshPoint m = mesh_point(mesh, band.triangle[row], b.x, b.y);
        const glm::ivec3 voxel = block.origin + glm::ivec3(bit >> 6, (bit >> 3) & 7, bit & 7);
        batch.set(batch.size++, domain == Domain::point ? band.position(voxel) : m.P, m.N, m.uv, m.dPdu);
    }
}

void shade(TextureGrid& grid, const Mesh& mesh, const BoundShader& shader, const SurfaceBand& band,
           const VoxelsDone& done) {
    GridLevel& level = grid.levels.front();
    const int floats = shader.info().baked_floats;
    level.planes.assign(std::size_t(floats), std::vector<float>(band.voxels()));
    std::atomic<bool> finite{true};
    tbb::parallel_for(std::size_t{0}, band.blocks.size(), [&](std::size_t b) {
        thread_local SurfaceBatch batch;
        thread_local std::vector<float> planes;
        planes.resize(std::size_t(floats) * SurfaceBatch::capacity);
        const Block& block = band.blocks[b];
        fill_batch(batch, mesh, shader.domain(), band, block);
        shader.bake(batch, planes.data());
        for (int k = 0; k < floats; ++k) {
            const float* const plane = planes.data() + k * SurfaceBatch::capacity;
            if (!std::all_of(plane, plane + batch.size, [](float v) { return std::isfinite(v); })) finite = false;
            std::copy(plane, plane + batch.size, level.planes[std::size_t(k)].begin() + std::ptrdiff_t(block.first));
        }
        if (done) done(std::uint64_t(batch.size));
    });
    if (!finite) {
        throw Error(fmt::format("shader '{}' gives values that are not finite on this surface with {}",
                                shader.info().name, describe_values(shader)));
    }
}

void describe(TextureGrid& grid, const Mesh& mesh, const BoundShader& shader) {
    grid.shader = shader.info().name;
    grid.shader_digest = shader_digest(shader);
    grid.mesh_digest = mesh_digest(mesh);
    grid.tool_version = version;
    for (const ChannelInfo& channel : shader.info().channels) {
        grid.channels.push_back({std::string(channel.name), channel.components});
    }
    const std::vector<glm::vec3> values = shader.values();
    for (std::size_t i = 0; i < values.size(); ++i) {
        const ParamInfo& param = shader.info().params[i];
        std::vector<float> value{values[i].x};
        if (param.components() == 3) value = {values[i].x, values[i].y, values[i].z};
        grid.params.emplace_back(std::string(param.name), std::move(value));
    }
}

}  // namespace

BakeEstimate estimate_bake(const Mesh& mesh, const ShaderInfo& shader, double voxel_size) {
    const double coarse = std::max(voxel_size, double(bounds(mesh).diagonal()) / 128.0);
    const double scale = coarse / voxel_size;
    const double voxels = double(surface_band(mesh, coarse).voxels()) * scale * scale;
    const double bytes = voxels * (bytes_per_voxel + 4.0 * shader.baked_floats);
    return {std::uint64_t(voxels), std::uint64_t(bytes)};
}

TextureGrid bake_mesh(const Mesh& mesh, const BoundShader& shader, double voxel_size, bool half,
                      const VoxelsDone& done) {
    SurfaceBand band = surface_band(mesh, voxel_size);
    TextureGrid grid;
    grid.voxel_size = voxel_size;
    grid.origin = band.origin;
    grid.closed = is_closed(mesh);
    describe(grid, mesh, shader);
    grid.levels.emplace_back();
    shade(grid, mesh, shader, band, done);
    grid.levels.front().blocks = std::move(band.blocks);
    grid.levels.front().cells = std::move(band.cells);
    grid.distance = std::move(band.distance);
    add_levels(grid);
    if (half) round_to_half(grid);
    return grid;
}

BoundedBake bake_to_error(const Mesh& mesh, const BoundShader& shader, double max_error, bool half,
                          std::uint64_t max_bytes, std::uint64_t seed, const VoxelsDone& done) {
    if (!(max_error > 0.0)) throw Error(fmt::format("--max-error {}: must be above 0", max_error));
    const double diagonal = bounds(mesh).diagonal();
    BoundedBake best;
    double size = diagonal / 128.0, previous_size = 0.0, previous_error = 0.0;
    for (;;) {
        const std::uint64_t bytes = estimate_bake(mesh, shader.info(), size).bytes;
        if (bytes > max_bytes) {
            throw Error(fmt::format("RMSE {:.3g} is out of reach: it needs a voxel of about {:.3g}, so {} of "
                                    "memory and --max-memory is {}; a voxel of {:.3g} reached {:.3g}",
                                    max_error, size, format_bytes(bytes), format_bytes(max_bytes),
                                    previous_size, previous_error),
                        ExitStatus::failed);
        }
        TextureGrid grid = bake_mesh(mesh, shader, size, half, done);
        grid.errors = measure_error(mesh, shader, BrickPyramid(grid), size, error_samples, seed);
        ++best.attempts;
        double error = 0.0;
        for (const ErrorFigures& e : grid.errors) error = std::max(error, e.rmse);
        if (error <= max_error) {
            best.grid = std::move(grid);
            return best;
        }
        // error ~ size^slope: 2 where the shader is smooth and resolved, 1/2 at its discontinuities.
        const double measured = previous_error > error
                                    ? std::log(previous_error / error) / std::log(previous_size / size)
                                    : 0.5;
        const double slope = std::clamp(measured, 0.5, 2.0);
        previous_size = size;
        previous_error = error;
        size *= std::clamp(0.95 * std::pow(max_error / error, 1.0 / slope), 0.25, 0.9);
    }
}

}  // namespace estara
