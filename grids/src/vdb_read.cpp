// A .vdb file to TextureGrid.
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <openvdb/io/File.h>
#include <openvdb/openvdb.h>
#include <tbb/parallel_for.h>

#include <cmath>
#include <new>

#include "blocks.h"
#include "estara/scenes/error.h"
#include "vdb_bytes.h"
#include "vdb_names.h"

namespace estara {
namespace {

using openvdb::Coord;
using openvdb::FloatGrid;
using openvdb::GridBase;
using openvdb::Vec3s;
using openvdb::Vec3SGrid;

constexpr int max_index = 1 << 30;
constexpr int max_levels = 31;

std::vector<std::string> split(const std::string& list) {
    std::vector<std::string> words;
    for (std::size_t at = 0; at < list.size();) {
        const std::size_t comma = std::min(list.find(',', at), list.size());
        words.push_back(list.substr(at, comma - at));
        at = comma + 1;
    }
    return words;
}

/// Reads the objects of an open file.
class Reader {
public:
    explicit Reader(const std::string& path) : m_path(path), m_file(path) { m_file.open(false); }

    std::vector<TextureGrid> objects() {
        std::map<std::string, GridBase::ConstPtr> heads;  // of each object, one that describes it
        std::vector<std::string> names;
        const openvdb::GridPtrVecPtr all = m_file.readAllGridMetadata();
        for (const GridBase::Ptr& grid : *all) {
            names.push_back(clamped(grid->getName()));
            if (grid->getMetadata<openvdb::StringMetadata>(key::shader)) {
                heads.emplace(meta<std::string>(*grid, key::object), grid);
            }
        }
        if (heads.empty()) {
            if (names.size() > 10) names.resize(10);
            if (names.empty()) names.push_back("no grids");
            throw Error(fmt::format("{}: not made by estara-bake (no grid has {}); it has: {}",
                                    m_path, key::shader, fmt::join(names, ", ")));
        }
        m_is_alone = heads.size() == 1;
        std::vector<TextureGrid> grids;
        for (const auto& [object, head] : heads) grids.push_back(read_object(*head));
        return grids;
    }

private:
    [[noreturn]] void fail(const std::string& what) const {
        throw Error(fmt::format("{}: {}; bake it again", m_path, what));
    }

    template <class T>
    T meta(const GridBase& grid, const std::string& name) const {
        const auto found = grid.getMetadata<openvdb::TypedMetadata<T>>(name);
        if (!found) fail(fmt::format("grid \"{}\" has no valid {}", clamped(grid.getName()), name));
        return found->value();
    }

    TextureGrid read_object(const GridBase& head) {
        TextureGrid to;
        to.object = meta<std::string>(head, key::object);
        to.voxel_size = meta<double>(head, key::voxel_size);
        to.closed = meta<bool>(head, key::closed);
        to.shader = meta<std::string>(head, key::shader);
        to.shader_digest = meta<std::string>(head, key::shader_digest);
        to.mesh_digest = meta<std::string>(head, key::mesh_digest);
        to.tool_version = meta<std::string>(head, key::version);
        read_params(head, to);
        const openvdb::Vec3d origin = head.transform().indexToWorld(openvdb::Vec3d(0.0));
        to.origin = {origin.x(), origin.y(), origin.z()};
        const bool placed =
            std::isfinite(to.origin.x) && std::isfinite(to.origin.y) && std::isfinite(to.origin.z);
        if (!placed || !(to.voxel_size > 0.0) || !std::isfinite(to.voxel_size)) {
            fail(fmt::format("grid \"{}\" has no valid transform", clamped(head.getName())));
        }
        const std::int32_t levels = meta<std::int32_t>(head, key::levels);
        if (levels < 1 || levels > max_levels)
            fail(fmt::format("it says it has {} levels", levels));
        to.levels.resize(std::size_t(levels));
        for (const std::string& channel : split(meta<std::string>(head, key::channels))) {
            to.channels.push_back({channel, 0});
            for (int n = 0; n < levels; ++n) read_channel(n, to);
        }
        if (to.channels.empty()) fail("it says it has no channels");
        check_finite(to, m_path);
        return to;
    }

    void read_params(const GridBase& head, TextureGrid& to) const {
        for (const std::string& name : split(meta<std::string>(head, key::params))) {
            const std::string full = key::param_prefix + name;
            if (head.getMetadata<openvdb::Vec3SMetadata>(full)) {
                const auto v = meta<Vec3s>(head, full);
                to.params.push_back({name, {v.x(), v.y(), v.z()}});
            } else {
                to.params.push_back({name, {meta<float>(head, full)}});
            }
        }
    }

    /// Reads one level of the last channel of `to`.
    void read_channel(int level, TextureGrid& to) {
        GridChannel& channel = to.channels.back();
        const std::string name = grid_name(channel.name, m_is_alone ? "" : to.object, level);
        if (!m_file.hasGrid(name)) fail(fmt::format("grid \"{}\" is missing", clamped(name)));
        const GridBase::ConstPtr grid = m_file.readGrid(name);
        const auto colors = openvdb::gridConstPtrCast<Vec3SGrid>(grid);
        const auto numbers = openvdb::gridConstPtrCast<FloatGrid>(grid);
        const int components = colors ? 3 : numbers ? 1 : 0;
        if (level == 0) channel.components = components;
        if (components == 0 || components != channel.components) {
            fail(
                fmt::format("grid \"{}\" has values of type {}", clamped(name), grid->valueType()));
        }
        GridLevel& out = to.levels[std::size_t(level)];
        if (colors) {
            take_values(name, *colors, 3, out);
        } else {
            take_values(name, *numbers, 1, out);
        }
        if (level == 0) read_errors(*grid, to);
    }

    void read_errors(const GridBase& grid, TextureGrid& to) const {
        if (!grid.getMetadata<openvdb::DoubleMetadata>(key::error_rmse)) return;
        ErrorFigures errors;
        errors.mean = meta<double>(grid, key::error_mean);
        errors.rmse = meta<double>(grid, key::error_rmse);
        errors.p99 = meta<double>(grid, key::error_p99);
        errors.p999 = meta<double>(grid, key::error_p999);
        errors.max = meta<double>(grid, key::error_max);
        errors.samples = std::uint64_t(meta<std::int64_t>(grid, key::error_samples));
        to.errors.resize(to.channels.size());
        to.errors.back() = errors;
    }

    /// Appends a grid's planes to a level. The first channel says which voxels there are; the
    /// others must have the same.
    template <class GridT>
    void take_values(const std::string& name, const GridT& grid, std::size_t components,
                     GridLevel& to) const {
        using Leaf = typename GridT::TreeType::LeafNodeType;
        std::vector<const Leaf*> leaves;
        grid.tree().getNodes(leaves);
        std::erase_if(leaves, [](const Leaf* leaf) { return leaf->isEmpty(); });
        std::sort(leaves.begin(), leaves.end(),
                  [](const Leaf* a, const Leaf* b) { return a->origin() < b->origin(); });
        if (grid.tree().hasActiveTiles())
            fail(fmt::format("grid \"{}\" was pruned", clamped(name)));
        std::vector<Block> blocks = blocks_of(name, leaves);
        if (to.planes.empty())
            to.blocks = std::move(blocks);
        else
            check_same_voxels(name, blocks, to.blocks);
        const std::size_t first = to.planes.size();
        to.planes.resize(first + components, std::vector<float>(to.voxels()));
        tbb::parallel_for(std::size_t{0}, leaves.size(), [&](std::size_t b) {
            std::uint64_t row = to.blocks[b].first;
            for (auto it = leaves[b]->cbeginValueOn(); it; ++it, ++row) {
                const auto value = *it;
                if constexpr (std::is_same_v<GridT, Vec3SGrid>) {
                    for (std::size_t c = 0; c < 3; ++c) to.planes[first + c][row] = value[int(c)];
                } else {
                    to.planes[first][row] = value;
                }
            }
        });
    }

    template <class Leaf>
    std::vector<Block> blocks_of(const std::string& name,
                                 const std::vector<const Leaf*>& leaves) const {
        if (leaves.empty()) fail(fmt::format("grid \"{}\" has no voxels", clamped(name)));
        std::vector<Block> blocks(leaves.size());
        std::uint64_t rows = 0;
        for (std::size_t b = 0; b < leaves.size(); ++b) {
            const Coord o = leaves[b]->origin();
            blocks[b].origin = {o.x(), o.y(), o.z()};
            for (openvdb::Index w = 0; w < 8; ++w) {
                blocks[b].active.words[w] =
                    leaves[b]->getValueMask().template getWord<std::uint64_t>(w);
            }
            blocks[b].first = rows;
            rows += std::uint64_t(blocks[b].active.count());
            for (int axis = 0; axis < 3; ++axis) {
                if (o[axis] < 0 || o[axis] >= max_index) {
                    fail(fmt::format("grid \"{}\" has voxels out of range", clamped(name)));
                }
            }
        }
        return blocks;
    }

    void check_same_voxels(const std::string& name, const std::vector<Block>& a,
                           const std::vector<Block>& b) const {
        const bool same =
            std::equal(a.begin(), a.end(), b.begin(), b.end(), [](const Block& p, const Block& q) {
                return p.origin == q.origin && p.active == q.active;
            });
        if (!same)
            fail(fmt::format("grid \"{}\" has other voxels than its fellows", clamped(name)));
    }

    std::string m_path;
    openvdb::io::File m_file;
    bool m_is_alone = false;  // one object: grids have plain names
};

}  // namespace

std::vector<TextureGrid> read_vdb(const std::string& path) {
    const VdbLayout layout = check_vdb_bytes(path);
    openvdb::initialize();
    try {
        return Reader(path).objects();
    } catch (const openvdb::Exception& e) {
        throw Error(fmt::format("{}: damaged: {}; bake it again", path, reason(e)));
    } catch (const std::bad_alloc&) {
        if (layout.digest_at != 0) throw;  // its bytes are right: there is too little memory
        throw Error(fmt::format("{}: damaged, or too large for the memory there is", path));
    }
}

}  // namespace estara
