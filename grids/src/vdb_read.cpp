// A .vdb file to TextureGrid.
//
// OpenVDB reads what a grid says of itself; voxels and values are taken from the file's bytes.
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <openvdb/io/io.h>
#include <openvdb/openvdb.h>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_sort.h>
#include <tbb/task_group.h>

#include <algorithm>
#include <atomic>
#include <boost/interprocess/streams/bufferstream.hpp>
#include <cmath>
#include <exception>
#include <map>
#include <new>
#include <set>

#include "blocks.h"
#include "estara/scenes/error.h"
#include "estara/scenes/large_pages.h"
#include "estara/shaders/math.h"
#include "vdb_bytes.h"
#include "vdb_names.h"
#include "vdb_tree.h"

namespace estara {
namespace {

using openvdb::GridBase;
using openvdb::Vec3s;

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

/// A grid without its tree, and where that is.
struct OpenGrid {
    const StoredGrid* stored = nullptr;
    GridBase::Ptr grid;
    std::uint32_t compression = 0;
    std::uint64_t topology = 0;  ///< position of the tree's first byte
};

/// Reads the objects of a file.
class Reader {
public:
    Reader(const std::string& path, const MappedFile& file, const VdbLayout& layout)
        : m_path(path), m_file(file), m_bytes(file.bytes()) {
        for (const StoredGrid& stored : layout.grids) {
            m_grids.emplace(stored.name, open_grid(stored, layout));
        }
    }

    std::vector<TextureGrid> objects() {
        // Of each object and shader, one that describes it.
        std::map<std::pair<std::string, std::string>, const GridBase*> heads;
        std::vector<std::string> names;
        for (const auto& [name, open] : m_grids) {
            names.push_back(clamped(name));
            const auto shader = open.grid->getMetadata<openvdb::StringMetadata>(key::shader);
            if (!shader) continue;
            const auto object = meta<std::string>(*open.grid, key::object);
            heads.emplace(std::pair{object, shader->value()}, open.grid.get());
            m_objects.insert(object);
        }
        if (heads.empty()) {
            if (names.size() > 10) names.resize(10);
            if (names.empty()) names.push_back("no grids");
            throw Error(fmt::format("{}: not made by estara-bake (no grid has {}); it has: {}",
                                    m_path, key::shader, fmt::join(names, ", ")));
        }
        std::vector<TextureGrid> grids;
        for (const auto& [of, head] : heads) grids.push_back(read_object(*head));
        return grids;
    }

private:
    [[noreturn]] void fail(const std::string& what) const {
        throw Error(fmt::format("{}: {}; bake it again", m_path, what));
    }

    OpenGrid open_grid(const StoredGrid& stored, const VdbLayout& layout) const {
        OpenGrid open;
        open.stored = &stored;
        open.grid = GridBase::createGrid(stored.type);
        open.grid->setSaveFloatAsHalf(stored.half);
        ByteCursor in(m_bytes, stored.data);
        open.compression = in.number<std::uint32_t>();
        boost::interprocess::ibufferstream stream(m_bytes.data() + in.at(),
                                                  stored.buffers - in.at());
        stream.exceptions(std::ios::badbit | std::ios::failbit | std::ios::eofbit);
        openvdb::io::setVersion(stream, {layout.library_major, layout.library_minor},
                                layout.format);
        open.grid->readMeta(stream);
        // OpenVDB allocates what the length of the transform's name says.
        ByteCursor name(m_bytes.substr(0, stored.buffers), in.at() + std::uint64_t(stream.tellg()));
        name.skip(name.number<std::uint32_t>());
        open.grid->readTransform(stream);
        open.topology = in.at() + std::uint64_t(stream.tellg());
        return open;
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
        if (head.getMetadata<openvdb::StringMetadata>(key::lights_digest)) {
            to.lights_digest = meta<std::string>(head, key::lights_digest);
        }
        if (head.getMetadata<openvdb::StringMetadata>(key::request)) {
            to.request = meta<std::string>(head, key::request);
        }
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
        const std::string name =
            grid_name(channel.name, object_suffix(m_objects, to.object), level);
        const auto found = m_grids.find(name);
        if (found == m_grids.end()) fail(fmt::format("grid \"{}\" is missing", clamped(name)));
        const OpenGrid& open = found->second;
        const int components = open.grid->isType<openvdb::Vec3SGrid>()   ? 3
                               : open.grid->isType<openvdb::FloatGrid>() ? 1
                                                                         : 0;
        if (level == 0) channel.components = components;
        if (components == 0 || components != channel.components) {
            fail(fmt::format("grid \"{}\" has values of type {}", clamped(name),
                             open.grid->valueType()));
        }
        try {
            take_planes(open, components, to.levels[std::size_t(level)]);
        } catch (const BadTree& bad) {
            fail(fmt::format("grid \"{}\" {}", clamped(name), bad.what));
        } catch (const Cut&) {
            fail(fmt::format("grid \"{}\" is damaged", clamped(name)));
        }
        if (level == 0) read_errors(*open.grid, to);
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
    void take_planes(const OpenGrid& open, int components, GridLevel& to) const {
        const StoredGrid& stored = *open.stored;
        if (stored.is_instance) throw BadTree{"has no voxels of its own"};
        const ValueFormat format{open.compression, components, stored.half};
        std::vector<StoredLeaf> leaves =
            read_leaves(ByteCursor(m_bytes.substr(0, stored.buffers), open.topology),
                        ByteCursor(m_bytes.substr(0, stored.end), stored.buffers), format);
        std::erase_if(leaves, [](const StoredLeaf& leaf) { return !leaf.active.any(); });
        if (leaves.empty()) throw BadTree{"has no voxels"};
        tbb::parallel_sort(leaves.begin(), leaves.end(),
                           [](const StoredLeaf& a, const StoredLeaf& b) {
                               return comes_before(a.origin, b.origin);
                           });
        if (to.planes.empty()) {
            to.blocks = blocks_of(leaves);
        } else if (!std::equal(leaves.begin(), leaves.end(), to.blocks.begin(), to.blocks.end(),
                               [](const StoredLeaf& p, const Block& q) {
                                   return p.origin == q.origin && p.active == q.active;
                               })) {
            throw BadTree{"has other voxels than its fellows"};
        }
        const std::size_t first = to.planes.size(), count = std::size_t(components);
        to.planes.resize(first + count);
        tbb::parallel_for(std::size_t{0}, count, [&](std::size_t c) {
            std::vector<float>& plane = to.planes[first + c];
            plane.reserve(to.voxels());
            prefer_large_pages(plane.data(), to.voxels() * sizeof(float));
            plane.resize(to.voxels());
        });
        std::atomic<bool> finite{true};
        tbb::parallel_for(tbb::blocked_range<std::size_t>(0, leaves.size(), 64),
                          [&](const tbb::blocked_range<std::size_t>& some) {
                              ValueDecoder decoder(format);
                              for (std::size_t b = some.begin(); b != some.end(); ++b) {
                                  if (!scatter(leaves[b], to.blocks[b].first, decoder, count,
                                               to.planes.data() + first)) {
                                      finite = false;
                                  }
                              }
                          });
        if (!finite) throw BadTree{"has a value that is not finite"};
        m_file.forget(open.topology, stored.end);
    }

    static std::vector<Block> blocks_of(const std::vector<StoredLeaf>& leaves) {
        std::vector<Block> blocks(leaves.size());
        std::uint64_t rows = 0;
        for (std::size_t b = 0; b < leaves.size(); ++b) {
            if (b > 0 && leaves[b].origin == leaves[b - 1].origin) throw BadTree{"is damaged"};
            blocks[b] = {leaves[b].origin, leaves[b].active, rows};
            rows += std::uint64_t(leaves[b].active.count());
        }
        return blocks;
    }

    /// Puts the active values of a leaf into rows of planes. Throws BadTree.
    /// @return  whether all of them are finite
    static bool scatter(const StoredLeaf& leaf, std::uint64_t row, ValueDecoder& decoder,
                        std::size_t components, std::vector<float>* planes) {
        std::array<float, 512 * 3> values;
        const bool has_all = leaf.values.has_inactive;
        const auto stored = has_all ? std::size_t{512} : std::size_t(leaf.active.count());
        if (!decoder.decode(leaf.values, stored, values.data())) throw BadTree{"is damaged"};
        std::size_t from = 0;
        bool finite = true;
        const auto put = [&](std::size_t value) {
            for (std::size_t c = 0; c < components; ++c) {
                const float v = values[value * components + c];
                finite &= is_finite(v);
                planes[c][row] = v;
            }
            ++row;
        };
        if (has_all) {
            for_each_bit(leaf.active,
                         [&](int x, int y, int z) { put(std::size_t(BlockMask::bit(x, y, z))); });
        } else {
            while (from < stored) put(from++);
        }
        return finite;
    }

    std::string m_path;
    const MappedFile& m_file;
    std::string_view m_bytes;
    std::map<std::string, OpenGrid> m_grids;
    std::set<std::string> m_objects;
};

}  // namespace

std::vector<TextureGrid> read_vdb(const std::string& path) {
    const MappedFile file(path);
    const VdbLayout layout = whole_vdb_layout(path, file);
    openvdb::initialize();
    // The digest is one long chain: it takes the time in which one core looks for the leaves. Files
    // without a digest are read as well, so nothing depends on its being right; what it says comes
    // first.
    tbb::task_group digest;
    digest.run([&] { check_vdb_digest(path, file, layout); });
    std::vector<TextureGrid> grids;
    std::exception_ptr failure;
    try {
        grids = Reader(path, file, layout).objects();
    } catch (...) {
        failure = std::current_exception();
    }
    digest.wait();
    try {
        if (failure) std::rethrow_exception(failure);
        return grids;
    } catch (const openvdb::Exception& e) {
        damaged(path, reason(e));
    } catch (const std::ios::failure&) {
        damaged(path, "a grid's metadata are cut short");
    } catch (const Cut&) {
        damaged(path, "a grid's metadata are cut short");
    } catch (const std::bad_alloc&) {
        if (layout.digest_at != 0) throw;  // its bytes are right: there is too little memory
        throw Error(fmt::format("{}: damaged, or too large for the memory there is", path));
    }
}

}  // namespace estara
