// TextureGrid to a .vdb file.
//
// OpenVDB makes the header, the metadata and the topology, a grid at a time; the values go from the
// planes to the file in small pieces, packed by all threads.
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <openvdb/io/Archive.h>
#include <openvdb/io/Compression.h>
#include <openvdb/io/GridDescriptor.h>
#include <openvdb/openvdb.h>
#include <tbb/parallel_pipeline.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <functional>
#include <set>
#include <sstream>
#include <stdexcept>

#include "blocks.h"
#include "estara/scenes/program.h"
#include "vdb_bytes.h"
#include "vdb_names.h"
#include "vdb_output.h"
#include "vdb_shell.h"
#include "vdb_values.h"

namespace estara {
namespace {

using openvdb::FloatGrid;
using openvdb::GridBase;
using openvdb::Vec3s;
using openvdb::Vec3SGrid;

template <class T>
void put(GridBase& to, const std::string& name, const T& value) {
    to.insertMeta(name, openvdb::TypedMetadata<T>(value));
}

/// Uniform scale and translation. OpenVDB's own makers of transforms refuse voxels below 1.4e-5 as
/// if they had no size; a transform that is read has none of their checks.
openvdb::math::Transform::Ptr lattice_transform(double voxel, const glm::dvec3& origin) {
    using openvdb::Vec3d;
    const Vec3d scale(voxel), translation(origin.x, origin.y, origin.z);
    std::stringstream bytes;
    openvdb::io::setCurrentVersion(bytes);
    openvdb::writeString(bytes, openvdb::math::UniformScaleTranslateMap::mapType());
    // In the order of ScaleTranslateMap::read().
    const Vec3d inverse(1.0 / voxel);
    for (const Vec3d& v : {translation, scale, scale, inverse, inverse * inverse, 0.5 * inverse}) {
        bytes.write(reinterpret_cast<const char*>(&v), sizeof v);
    }
    auto transform = openvdb::math::Transform::createLinearTransform();
    transform->read(bytes);
    return transform;
}

/// What every grid of an object says about itself.
void describe(const TextureGrid& from, int level, bool half, GridBase& to) {
    const double voxel = std::ldexp(from.voxel_size, level);
    to.setTransform(lattice_transform(voxel, from.origin));
    to.setSaveFloatAsHalf(half);
    const std::string tool = from.tool_version.empty() ? version : from.tool_version;
    to.setCreator("estara-bake " + tool);
    put(to, key::version, tool);
    put(to, key::shader, from.shader);
    put(to, key::shader_digest, from.shader_digest);
    put(to, key::mesh_digest, from.mesh_digest);
    put(to, key::object, from.object);
    if (!from.lights_digest.empty()) put(to, key::lights_digest, from.lights_digest);
    if (!from.request.empty()) put(to, key::request, from.request);
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

/// A grid that is to be: what it says of itself, and its values.
struct Plan {
    std::string name;
    const TextureGrid* from;
    int level;
    int components;
    /// All but the values. May set `inside`: voxels of each block whose value is -background.
    std::function<GridBase::Ptr(const std::vector<const Block*>&, std::vector<BlockMask>& inside)>
        shell;
    /// Writes values of active voxels, `components` floats each.
    std::function<void(std::uint64_t row, std::size_t count, float* out)> values;
};

Plan channel_plan(const TextureGrid& from, int level, std::size_t channel, std::size_t first_float,
                  const std::vector<float>& means, bool half) {
    const auto* plane = from.levels[std::size_t(level)].planes.data() + first_float;
    Plan plan;
    plan.from = &from;
    plan.level = level;
    plan.components = from.channels[channel].components;
    plan.values = [plane, half, n = std::size_t(plan.components)](std::uint64_t row,
                                                                  std::size_t count, float* out) {
        for (std::size_t c = 0; c < n; ++c) {
            const float* from_row = plane[c].data() + row;
            for (std::size_t i = 0; i < count; ++i) {
                out[n * i + c] = half ? nearest_half(from_row[i]) : from_row[i];
            }
        }
    };
    plan.shell = [=, &from,
                  mean = std::vector<float>(means.begin() + std::ptrdiff_t(first_float),
                                            means.end())](const auto& blocks, auto&) {
        GridBase::Ptr grid;
        if (from.channels[channel].components == 3) {
            grid = color_shell(blocks, Vec3s(mean[0], mean[1], mean[2]));
            grid->setVectorType(openvdb::VEC_INVARIANT);
        } else {
            grid = number_shell(blocks, mean[0]);
        }
        grid->setGridClass(openvdb::GRID_UNKNOWN);
        describe(from, level, half, *grid);
        put(*grid, key::channel, from.channels[channel].name);
        const bool measured = level == 0 && channel < from.errors.size();
        if (measured) describe_errors(from.errors[channel], *grid);
        return grid;
    };
    return plan;
}

/// Half the thickness of the shell that stands for an open surface, voxels. At a surface point the
/// interpolated |distance| is up to about 1/2 (a plane midway between two layers of voxels): at
/// 0.55 vdb_render shows holes, at 0.75 next to none; the thicker, the more of its hits lie beyond
/// the band.
constexpr double shell = 0.75;

/// The level set. An open surface has no inside, and signs that end at the band's edge look like a
/// second, ragged surface from behind: it becomes a thin closed shell instead.
Plan surface_plan(const TextureGrid& from, bool half) {
    const auto outside = float(3.0 * from.voxel_size), thin = float(shell * from.voxel_size);
    const auto value = [&from, half, thin](std::uint64_t row) {
        const float d = from.distance[row];
        const float v = from.closed ? d : std::abs(d) - thin;
        return half ? nearest_half(v) : v;
    };
    Plan plan;
    plan.from = &from;
    plan.level = 0;
    plan.components = 1;
    plan.values = [value](std::uint64_t row, std::size_t count, float* out) {
        for (std::size_t i = 0; i < count; ++i) out[i] = value(row + i);
    };
    plan.shell = [&from, half, outside, value](const auto& blocks, auto& inside) {
        const openvdb::FloatGrid::Ptr grid = number_shell(blocks, outside);
        if (from.closed) inside = fill_inside(blocks, value, *grid);
        grid->setGridClass(openvdb::GRID_LEVEL_SET);
        describe(from, 0, half, *grid);
        return grid;
    };
    return plan;
}

Plan density_plan(const TextureGrid& from, bool half) {
    Plan plan;
    plan.from = &from;
    plan.level = 0;
    plan.components = 1;
    plan.values = [](std::uint64_t, std::size_t count, float* out) {
        std::fill_n(out, count, 1.0f);
    };
    plan.shell = [&from, half](const auto& blocks, auto&) {
        const openvdb::FloatGrid::Ptr grid = number_shell(blocks, 0.0f);
        grid->setGridClass(openvdb::GRID_FOG_VOLUME);
        describe(from, 0, half, *grid);
        return grid;
    };
    return plan;
}

/// Throws what is wrong with a grid.
/// @return  its finite_means()
std::vector<float> check_writable(const std::string& path, const TextureGrid& grid) {
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
    return finite_means(grid, title);
}

/// Channels level by level, then surface and density, of every TextureGrid.
std::vector<Plan> plans(const std::string& path, const std::vector<TextureGrid>& grids, bool half) {
    std::set<std::string> objects;
    for (const TextureGrid& grid : grids) objects.insert(grid.object);
    std::vector<Plan> result;
    for (const TextureGrid& grid : grids) {
        const std::vector<float> means = check_writable(path, grid);
        const auto add = [&](const std::string& what, Plan plan) {
            plan.name = grid_name(what, object_suffix(objects, grid.object), plan.level);
            result.push_back(std::move(plan));
        };
        std::size_t first = 0;
        for (std::size_t c = 0; c < grid.channels.size(); ++c) {
            for (int n = 0; n < int(grid.levels.size()); ++n) {
                add(grid.channels[c].name, channel_plan(grid, n, c, first, means, half));
            }
            first += std::size_t(grid.channels[c].components);
        }
        if (grid.distance.empty()) continue;
        add("surface", surface_plan(grid, half));
        add("density", density_plan(grid, half));
    }
    std::set<std::string> names;
    for (const Plan& plan : result) {
        if (names.insert(plan.name).second) continue;
        throw Error(
            fmt::format("{}: two grids would be called \"{}\"; rename an object", path, plan.name));
    }
    return result;
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

/// Makes OpenVDB's own header.
struct Header : openvdb::io::Archive {
    static void write(std::ostream& to) { Header().writeHeader(to, true); }
};

/// The bytes of a leaf: voxels and values.
/// @param inside  inactive voxels whose value is -background
void append_leaf(const Plan& plan, const Block& block, const BlockMask& inside,
                 ValueEncoder& encoder, std::string& out) {
    const auto append = [&out](const auto& what) {
        out.append(reinterpret_cast<const char*>(&what), sizeof what);
    };
    append(block.active.words);
    BlockMask outside;
    for (std::size_t w = 0; w < 8; ++w) {
        outside.words[w] = ~(block.active.words[w] | inside.words[w]);
    }
    if (!inside.any()) {
        append(std::int8_t{openvdb::io::NO_MASK_OR_INACTIVE_VALS});
    } else if (!outside.any()) {
        append(std::int8_t{openvdb::io::NO_MASK_AND_MINUS_BG});
    } else {
        append(std::int8_t{openvdb::io::MASK_AND_NO_INACTIVE_VALS});
        append(outside.words);
    }
    std::array<float, 512 * 3> values;
    const auto count = std::size_t(block.active.count());
    plan.values(block.first, count, values.data());
    encoder.append(values.data(), count, out);
}

/// Writes the leaves of a grid: many at a time, but in order, and never many in memory.
void append_leaves(const Plan& plan, const std::vector<const Block*>& blocks,
                   const std::vector<BlockMask>& inside, const ValueFormat& format,
                   CheckedOutput& file) {
    constexpr std::size_t at_once = 512;  // a megabyte of colours
    std::size_t next = 0;
    const auto some = [&](tbb::flow_control& control) {
        const std::size_t first = next;
        if (first >= blocks.size()) control.stop();
        next += at_once;
        return first;
    };
    const auto packed = [&](std::size_t first) {
        std::string bytes;
        ValueEncoder encoder(format);
        for (std::size_t b = first; b < std::min(first + at_once, blocks.size()); ++b) {
            append_leaf(plan, *blocks[b], inside.empty() ? BlockMask{} : inside[b], encoder, bytes);
        }
        return bytes;
    };
    const auto write = [&](const std::string& bytes) { file.append(bytes); };
    using tbb::filter_mode;
    tbb::parallel_pipeline(
        4 * std::size_t(tbb::this_task_arena::max_concurrency()),
        tbb::make_filter<void, std::size_t>(filter_mode::serial_in_order, some) &
            tbb::make_filter<std::size_t, std::string>(filter_mode::parallel, packed) &
            tbb::make_filter<std::string, void>(filter_mode::serial_in_order, write));
}

/// What OpenVDB adds to a grid's metadata when it writes one.
template <class GridT>
void add_statistics(std::uint32_t compression, GridT& grid) {
    grid.addStatsMetadata();
    using Leaf = typename GridT::TreeType::LeafNodeType;
    const openvdb::Index64 buffers =
        openvdb::Index64(grid.tree().leafCount()) * Leaf::SIZE * sizeof(typename Leaf::ValueType);
    put(grid, GridBase::META_FILE_MEM_BYTES, openvdb::Int64(grid.memUsage() + buffers));
    put(grid, GridBase::META_FILE_COMPRESSION, openvdb::io::compressionToString(compression));
}

/// Appends a grid as OpenVDB's Archive::writeGrid() does, except that its values are not in it, and
/// that zip serves fog volumes too: ours is constant.
void append_grid(const Plan& plan, std::uint32_t compression, CheckedOutput& file) {
    const std::vector<const Block*> blocks =
        in_tree_order(plan.from->levels[std::size_t(plan.level)]);
    std::vector<BlockMask> inside;
    const GridBase::Ptr grid = plan.shell(blocks, inside);
    // Neither does OpenVDB zip distances: they do not shrink.
    if (grid->getGridClass() == openvdb::GRID_LEVEL_SET) {
        compression &= ~std::uint32_t{openvdb::io::COMPRESS_ZIP};
    }
    grid->setName(plan.name);
    if (const auto colors = openvdb::gridPtrCast<Vec3SGrid>(grid)) {
        add_statistics(compression, *colors);
    } else {
        add_statistics(compression, *openvdb::gridPtrCast<FloatGrid>(grid));
    }
    openvdb::io::GridDescriptor descriptor(plan.name, grid->type(), grid->saveFloatAsHalf());
    const auto described = [&descriptor] {
        std::ostringstream to;
        descriptor.writeHeader(to);
        descriptor.writeStreamPos(to);
        return to.str();
    };
    const std::uint64_t start = file.size();
    file.append(described());
    descriptor.setGridPos(std::int64_t(file.size()));
    {
        std::ostringstream to;
        openvdb::io::setDataCompression(to, compression);
        to.write(reinterpret_cast<const char*>(&compression), sizeof compression);
        grid->writeMeta(to);
        grid->writeTransform(to);
        grid->writeTopology(to);
        file.append(to.view());
    }
    descriptor.setBlockPos(std::int64_t(file.size()));
    append_leaves(plan, blocks, inside, {compression, plan.components, grid->saveFloatAsHalf()},
                  file);
    descriptor.setEndPos(std::int64_t(file.size()));
    file.replace(start, described());
}

/// Compares the file with what was written, and puts its digest in.
void check_and_seal(const std::string& path, const std::string& temporary, std::size_t grids,
                    const CheckedOutput& output) {
    VdbLayout layout;
    std::string digest;
    {
        const MappedFile file(temporary);
        output.check(file);
        layout = vdb_layout(path, file);
        const bool whole = layout.needed == layout.size && layout.grids.size() == grids;
        if (!whole || layout.digest_at == 0) {
            throw std::logic_error("write_vdb: the list of grids is not what was written");
        }
        digest = vdb_digest(file, layout);
    }
    std::fstream file(temporary, std::ios::binary | std::ios::in | std::ios::out);
    file.seekp(std::streamoff(layout.digest_at));
    file.write(digest.data(), std::streamsize(digest.size()));
    file.close();
    if (!file) throw Error(fmt::format("{}: it cannot be written", path), ExitStatus::failed);
}

}  // namespace

std::uint64_t write_vdb(const std::string& path, const std::vector<TextureGrid>& grids,
                        const VdbWriteOptions& options) {
    openvdb::initialize();
    const std::vector<Plan> plan = plans(path, grids, options.half);
    if (plan.empty()) throw Error(fmt::format("{}: there is nothing to write", path));
    PendingFile pending(path);
    CheckedOutput file(pending.path(), path);
    try {
        std::ostringstream start;
        Header::write(start);
        openvdb::MetaMap about;
        about.insertMeta(digest_key, openvdb::StringMetadata(digest_placeholder));
        about.writeMeta(start);
        const auto count = std::int32_t(plan.size());
        start.write(reinterpret_cast<const char*>(&count), sizeof count);
        file.append(start.view());
        const std::uint32_t compression = compression_flags(options.compression);
        for (const Plan& grid : plan) append_grid(grid, compression, file);
    } catch (const openvdb::Exception& e) {
        throw Error(fmt::format("{}: it cannot be written: {}", path, reason(e)),
                    ExitStatus::failed);
    }
    file.close();
    check_and_seal(path, pending.path(), plan.size(), file);
    pending.commit();
    return file.size();
}

}  // namespace estara
