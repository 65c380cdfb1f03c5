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

/// Peak memory of a bake in bytes per active voxel of level 0: the band while it is built, and for
/// each float of the record all levels, the lookup structure and the file's trees. Measured 138
/// bytes with three floats and 171 with four, at 4 and at 17 million voxels (estara-bake --stats,
/// peak_memory).
constexpr double bytes_per_voxel = 45.0, bytes_per_float = 34.0;

/// The points of a block that are baked, in row order.
void fill_batch(SurfaceBatch& batch, const Mesh& mesh, Domain domain, const SurfaceBand& band,
                const Block& block) {
    batch.size = 0;
    batch.filter_width = float(band.voxel_size);
    for_each_bit(block.active, [&](int x, int y, int z) {
        const std::uint64_t row = block.first + std::uint64_t(batch.size);
        const glm::vec2 b = band.barycentrics[row];
        const MeshPoint m = mesh_point(mesh, band.triangle[row], b.x, b.y);
        const glm::vec3 voxel = band.position(block.origin + glm::ivec3(x, y, z));
        batch.set(batch.size++, domain == Domain::point ? voxel : m.P, m.N, m.uv, tangent(mesh, m));
    });
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
            if (!std::all_of(plane, plane + batch.size, [](float v) { return std::isfinite(v); }))
                finite = false;
            std::copy(plane, plane + batch.size,
                      level.planes[std::size_t(k)].begin() + std::ptrdiff_t(block.first));
        }
        if (done) done(std::uint64_t(batch.size));
    });
    if (!finite) {
        throw Error(
            fmt::format("shader '{}' gives values that are not finite on this surface with {}",
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
    check_voxel_size(mesh, voxel_size);
    const double coarse = std::max(voxel_size, double(bounds(mesh).diagonal()) / 128.0);
    const double scale = coarse / voxel_size;
    const double voxels = double(surface_band(mesh, coarse).voxels()) * scale * scale;
    const double bytes = voxels * (bytes_per_voxel + bytes_per_float * shader.baked_floats);
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

}  // namespace estara
