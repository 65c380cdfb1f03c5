#include "estara/bake/bake.h"

#include <tbb/parallel_invoke.h>

#include <algorithm>

#include "estara/bake/surface_band.h"
#include "estara/scenes/program.h"
#include "shade.h"

namespace estara {

namespace {

/// Peak memory of a bake in bytes: for an active voxel of level 0 the distance, its share of the
/// blocks and what writing takes; for each float of the record the planes of all levels; for a
/// triangle its mesh, and its places in blocks. Then the bricks around the points where the error
/// is measured, and the pieces of the file that are being packed. From 2 to 12 million voxels the
/// peak was 10 to 17 % below this (estara-bake --stats, peak_memory, less program_bytes); at half a
/// million 5 MiB above it, of which 4 are the program's.
constexpr double bytes_per_voxel = 9.0, bytes_per_float = 7.5, bytes_per_triangle = 148.0;
constexpr double checking_bytes_per_voxel = 8.0, most_checking_bytes = 64e6;

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
    const double voxels = double(count_voxels(mesh, coarse)) * scale * scale;
    const double bytes = voxels * (bytes_per_voxel + bytes_per_float * shader.baked_floats) +
                         std::min(voxels * checking_bytes_per_voxel, most_checking_bytes) +
                         bytes_per_triangle * double(mesh.triangles.size());
    return {std::uint64_t(voxels), std::uint64_t(bytes)};
}

TextureGrid bake_mesh(const Mesh& mesh, const BoundShader& shader, double voxel_size, bool half,
                      const VoxelsDone& done) {
    SurfaceBand band;
    TextureGrid grid;
    // A shader of points is evaluated at the voxels themselves.
    const bool on_surface = shader.domain() != Domain::point;
    tbb::parallel_invoke([&] { band = surface_band(mesh, voxel_size, on_surface); },
                         [&] { grid.closed = is_closed(mesh); },
                         [&] { describe(grid, mesh, shader); });
    grid.voxel_size = voxel_size;
    grid.origin = band.origin;
    shade(mesh, shader, band, grid, done);
    grid.distance = std::move(band.distance);
    grid.levels.front().blocks = std::move(band.blocks);
    grid.levels.front().cells = std::move(band.cells);
    band = {};  // before the levels need memory
    add_levels(grid);
    if (half) round_to_half(grid);
    return grid;
}

}  // namespace estara
