// TextureGrid to OpenVDB grids to a .vdb file.
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <openvdb/io/File.h>
#include <openvdb/openvdb.h>
#include <openvdb/tools/SignedFloodFill.h>
#include <tbb/parallel_for.h>

#include <cmath>
#include <filesystem>
#include <functional>
#include <set>
#include <stdexcept>

#define XXH_INLINE_ALL
#include <xxhash.h>

#include "blocks.h"
#include "estara/scenes/program.h"
#include "vdb_bytes.h"
#include "vdb_names.h"

namespace estara {
namespace {

using openvdb::Coord;
using openvdb::FloatGrid;
using openvdb::GridBase;
using openvdb::Vec3s;
using openvdb::Vec3SGrid;

/// A tree with the level's voxels, leaf by leaf.
/// @param value  value(row) of the active voxel of that row
template <class GridT, class Value>
typename GridT::Ptr build(const GridLevel& level, const typename GridT::ValueType& background,
                          const Value& value) {
    using Leaf = typename GridT::TreeType::LeafNodeType;
    std::vector<std::unique_ptr<Leaf>> leaves(level.blocks.size());
    tbb::parallel_for(std::size_t{0}, leaves.size(), [&](std::size_t b) {
        const Block& block = level.blocks[b];
        const Coord origin(block.origin.x, block.origin.y, block.origin.z);
        leaves[b] = std::make_unique<Leaf>(origin, background, false);
        typename Leaf::NodeMaskType mask;
        for (openvdb::Index w = 0; w < 8; ++w) {
            mask.template getWord<std::uint64_t>(w) = block.active.words[w];
        }
        leaves[b]->setValueMask(mask);
        std::uint64_t row = block.first;
        for_each_bit(block.active, [&](int x, int y, int z) {
            const auto bit = openvdb::Index(BlockMask::bit(x, y, z));
            leaves[b]->buffer().setValue(bit, value(row++));
        });
    });
    auto grid = GridT::create(background);
    for (std::unique_ptr<Leaf>& leaf : leaves) grid->tree().addLeaf(leaf.release());
    return grid;
}

template <class T>
void put(GridBase& to, const std::string& name, const T& value) {
    to.insertMeta(name, openvdb::TypedMetadata<T>(value));
}

/// What every grid of an object says about itself.
void describe(const TextureGrid& from, int level, bool half, GridBase& to) {
    const double voxel = std::ldexp(from.voxel_size, level);
    auto transform = openvdb::math::Transform::createLinearTransform(voxel);
    transform->postTranslate({from.origin.x, from.origin.y, from.origin.z});
    to.setTransform(transform);
    to.setSaveFloatAsHalf(half);
    const std::string tool = from.tool_version.empty() ? version : from.tool_version;
    to.setCreator("estara-bake " + tool);
    put(to, key::version, tool);
    put(to, key::shader, from.shader);
    put(to, key::shader_digest, from.shader_digest);
    put(to, key::mesh_digest, from.mesh_digest);
    put(to, key::object, from.object);
    put(to, key::closed, from.closed);
    put(to, key::voxel_size, from.voxel_size);
    put(to, key::level, std::int32_t(level));
    put(to, key::levels, std::int32_t(from.levels.size()));
    std::vector<std::string> names;
    for (const GridChannel& channel : from.channels) names.push_back(channel.name);
    put(to, key::channels, fmt::format("{}", fmt::join(names, ",")));
    names.clear();
    for (const auto& [name, value] : from.params) {
        names.push_back(name);
        const std::string full = key::param_prefix + name;
        if (value.size() == 3) put(to, full, Vec3s(value[0], value[1], value[2]));
        if (value.size() == 1) put(to, full, value[0]);
    }
    put(to, key::params, fmt::format("{}", fmt::join(names, ",")));
}

void describe_errors(const ErrorFigures& errors, GridBase& to) {
    put(to, key::error_mean, errors.mean);
    put(to, key::error_rmse, errors.rmse);
    put(to, key::error_p99, errors.p99);
    put(to, key::error_p999, errors.p999);
    put(to, key::error_max, errors.max);
    put(to, key::error_samples, std::int64_t(errors.samples));
}

/// One grid that is to be: its name and how to build it.
struct Plan {
    std::string name;
    std::function<GridBase::Ptr()> build;
};

GridBase::Ptr build_channel(const TextureGrid& from, int level, std::size_t channel,
                            std::size_t first_float, const std::vector<float>& means, bool half) {
    const GridLevel& source = from.levels[std::size_t(level)];
    const auto stored = [half](float v) { return half ? nearest_half(v) : v; };
    const auto* plane = source.planes.data() + first_float;
    const float* mean = means.data() + first_float;
    GridBase::Ptr grid;
    if (from.channels[channel].components == 3) {
        const auto vector =
            build<Vec3SGrid>(source, Vec3s(mean[0], mean[1], mean[2]), [&](std::uint64_t row) {
                return Vec3s(stored(plane[0][row]), stored(plane[1][row]), stored(plane[2][row]));
            });
        vector->setVectorType(openvdb::VEC_INVARIANT);
        grid = vector;
    } else {
        grid = build<FloatGrid>(source, mean[0],
                                [&](std::uint64_t row) { return stored(plane[0][row]); });
    }
    grid->setGridClass(openvdb::GRID_UNKNOWN);
    describe(from, level, half, *grid);
    put(*grid, key::channel, from.channels[channel].name);
    if (level == 0 && channel < from.errors.size()) describe_errors(from.errors[channel], *grid);
    return grid;
}

/// Half the thickness of the shell that stands for an open surface, voxels. At a surface point the
/// interpolated |distance| is up to about 1/2 (a plane midway between two layers of voxels): at
/// 0.55 vdb_render shows holes, at 0.75 next to none; the thicker, the more of its hits lie beyond
/// the band.
constexpr double shell = 0.75;

/// The level set. An open surface has no inside, and signs that end at the band's edge look like a
/// second, ragged surface from behind: it becomes a thin closed shell instead.
GridBase::Ptr build_surface(const TextureGrid& from, bool half) {
    const auto outside = float(3.0 * from.voxel_size), thin = float(shell * from.voxel_size);
    auto grid = build<FloatGrid>(from.levels[0], outside, [&](std::uint64_t row) {
        const float d = from.distance[row];
        const float value = from.closed ? d : std::abs(d) - thin;
        return half ? nearest_half(value) : value;
    });
    if (from.closed) openvdb::tools::signedFloodFill(grid->tree());
    grid->setGridClass(openvdb::GRID_LEVEL_SET);
    describe(from, 0, half, *grid);
    return grid;
}

GridBase::Ptr build_density(const TextureGrid& from, bool half) {
    auto grid = build<FloatGrid>(from.levels[0], 0.0f, [](std::uint64_t) { return 1.0f; });
    grid->setGridClass(openvdb::GRID_FOG_VOLUME);
    describe(from, 0, half, *grid);
    return grid;
}

void check_writable(const std::string& path, const TextureGrid& grid) {
    const std::string title = grid.object.empty() ? path : path + ": object \"" + grid.object + '"';
    if (grid.levels.empty() || grid.levels[0].blocks.empty()) {
        throw Error(title + ": there are no voxels to write");
    }
    for (const GridLevel& level : grid.levels) {
        bool fits = level.planes.size() == std::size_t(grid.floats());
        for (const auto& plane : level.planes) fits = fits && plane.size() == level.voxels();
        if (!fits) throw std::invalid_argument("write_vdb: planes that do not match the voxels");
    }
    if (!grid.distance.empty() && grid.distance.size() != grid.levels[0].voxels()) {
        throw std::invalid_argument("write_vdb: distances that do not match the voxels");
    }
    check_finite(grid, title);
}

/// Channels level by level, then surface and density, of every object.
std::vector<Plan> plans(const std::string& path, const std::vector<TextureGrid>& grids, bool half) {
    std::vector<Plan> result;
    for (const TextureGrid& grid : grids) {
        const std::string object = grids.size() == 1 ? "" : grid.object;
        check_writable(path, grid);
        const std::vector<float> means = plane_means(grid);
        std::size_t first = 0;
        for (std::size_t c = 0; c < grid.channels.size(); ++c) {
            for (int n = 0; n < int(grid.levels.size()); ++n) {
                result.push_back({grid_name(grid.channels[c].name, object, n),
                                  [&grid, n, c, first, means, half] {
                                      return build_channel(grid, n, c, first, means, half);
                                  }});
            }
            first += std::size_t(grid.channels[c].components);
        }
        if (!grid.distance.empty()) {
            result.push_back({grid_name("surface", object, 0),
                              [&grid, half] { return build_surface(grid, half); }});
        }
        result.push_back(
            {grid_name("density", object, 0), [&grid, half] { return build_density(grid, half); }});
    }
    std::set<std::string> names;
    for (const Plan& plan : result) {
        if (names.insert(plan.name).second) continue;
        throw Error(
            fmt::format("{}: two grids would be called \"{}\"; rename an object", path, plan.name));
    }
    return result;
}

std::vector<GridBase::Ptr> build_all(const std::vector<Plan>& plan) {
    std::vector<GridBase::Ptr> grids(plan.size());
    tbb::parallel_for(std::size_t{0}, plan.size(), [&](std::size_t i) {
        grids[i] = plan[i].build();
        grids[i]->setName(plan[i].name);
    });
    return grids;
}

template <class GridT>
std::uint64_t digest_values(const GridT& grid) {
    XXH3_state_t state;
    XXH3_64bits_reset(&state);
    std::vector<typename GridT::ValueType> values;
    for (auto leaf = grid.tree().cbeginLeaf(); leaf; ++leaf) {
        const Coord origin = leaf->origin();
        values.clear();
        for (auto it = leaf->cbeginValueOn(); it; ++it) values.push_back(*it);
        XXH3_64bits_update(&state, origin.data(), 3 * sizeof(openvdb::Int32));
        for (openvdb::Index w = 0; w < 8; ++w) {
            const auto word = leaf->getValueMask().template getWord<std::uint64_t>(w);
            XXH3_64bits_update(&state, &word, sizeof word);
        }
        XXH3_64bits_update(&state, values.data(), values.size() * sizeof values[0]);
    }
    return XXH3_64bits_digest(&state);
}

/// Digest of a grid's active voxels: coordinates and values.
std::uint64_t digest(const GridBase& grid) {
    if (const auto* colors = dynamic_cast<const Vec3SGrid*>(&grid)) return digest_values(*colors);
    if (const auto* numbers = dynamic_cast<const FloatGrid*>(&grid)) return digest_values(*numbers);
    return 0;
}

std::uint32_t compression_flags(Compression compression) {
    using namespace openvdb::io;
    switch (compression) {
        case Compression::zip:
            return COMPRESS_ZIP | COMPRESS_ACTIVE_MASK;
        case Compression::blosc:
            return COMPRESS_BLOSC | COMPRESS_ACTIVE_MASK;
        case Compression::none:
            return COMPRESS_NONE | COMPRESS_ACTIVE_MASK;
    }
    return COMPRESS_NONE;
}

/// The layout of the file just written. OpenVDB does not notice a full disk: write() and close()
/// return, and the file is short.
VdbLayout written_layout(const std::string& path, const std::string& temporary, std::size_t grids) {
    VdbLayout layout;
    try {
        layout = vdb_layout(temporary);
        const bool whole = layout.needed <= layout.size && layout.grids.size() == grids;
        if (whole && layout.digest_at != 0) return layout;
    } catch (
        const Error&) {  // it is about the temporary file, whose name means nothing to the user
    }
    std::error_code ignored;
    const std::uintmax_t size = std::filesystem::file_size(temporary, ignored);
    throw Error(fmt::format("{}: the disk is full or the file was cut short: only {} bytes arrived",
                            path, ignored ? 0 : size),
                ExitStatus::failed);
}

/// Reads the file back and compares it with the digests of what was to be written.
void check_content(const std::string& path, const std::string& temporary,
                   const std::vector<Plan>& plan, const std::vector<std::uint64_t>& digests) {
    openvdb::io::File file(temporary);
    file.open(false);
    for (std::size_t i = 0; i < plan.size(); ++i) {
        const bool same =
            file.hasGrid(plan[i].name) && digest(*file.readGrid(plan[i].name)) == digests[i];
        if (same) continue;
        throw Error(
            fmt::format("{}: grid \"{}\" read back is not what was written: is the disk faulty?",
                        path, plan[i].name),
            ExitStatus::failed);
    }
}

}  // namespace

std::uint64_t write_vdb(const std::string& path, const std::vector<TextureGrid>& grids,
                        const VdbWriteOptions& options) {
    openvdb::initialize();
    const std::vector<Plan> plan = plans(path, grids, options.half);
    if (plan.empty()) throw Error(fmt::format("{}: there is nothing to write", path));
    PendingFile pending(path);
    VdbLayout layout;
    try {
        std::vector<std::uint64_t> digests(plan.size());
        {
            const std::vector<GridBase::Ptr> built = build_all(plan);
            tbb::parallel_for(std::size_t{0}, built.size(),
                              [&](std::size_t i) { digests[i] = digest(*built[i]); });
            openvdb::MetaMap about;
            about.insertMeta(digest_key, openvdb::StringMetadata(digest_placeholder));
            openvdb::io::File file(pending.path());
            file.setCompression(compression_flags(options.compression));
            file.write(built, about);
            file.close();
        }
        layout = written_layout(path, pending.path(), plan.size());
        check_content(path, pending.path(), plan, digests);
    } catch (const openvdb::Exception& e) {
        throw Error(fmt::format("{}: it cannot be written: {}", path, reason(e)),
                    ExitStatus::failed);
    }
    seal_vdb(pending.path(), layout);
    pending.commit();
    return layout.size;
}

}  // namespace estara
