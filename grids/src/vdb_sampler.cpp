// OpenVDB's own lookup on a baked file.
#include "estara/grids/vdb_sampler.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <openvdb/io/File.h>
#include <openvdb/openvdb.h>
#include <openvdb/tools/Interpolation.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <vector>

#include "estara/grids/texture_grid.h"
#include "estara/scenes/error.h"
#include "vdb_names.h"

namespace estara {
namespace {

using openvdb::FloatGrid;
using openvdb::Vec3SGrid;

/// Index beyond which there is no voxel; read_vdb() lets none pass.
constexpr double far_away = 1 << 30;

/// A grid with the accessor that makes neighbouring lookups cheap.
template <class GridT>
struct Channel {
    typename GridT::ConstPtr grid;
    typename GridT::ConstAccessor accessor;

    explicit Channel(typename GridT::ConstPtr g) : grid(std::move(g)), accessor(grid->tree()) {}

    typename GridT::ValueType sample(const openvdb::Vec3d& index) const {
        return openvdb::tools::BoxSampler::sample(accessor, index);
    }
};

/// One channel of one level: one of the two is there.
struct AnyChannel {
    std::unique_ptr<Channel<Vec3SGrid>> color;
    std::unique_ptr<Channel<FloatGrid>> number;
};

AnyChannel open_channel(openvdb::io::File& file, const std::string& name) {
    const openvdb::GridBase::ConstPtr grid = file.readGrid(name);
    AnyChannel channel;
    if (auto color = openvdb::gridConstPtrCast<Vec3SGrid>(grid)) {
        channel.color = std::make_unique<Channel<Vec3SGrid>>(color);
    } else {
        channel.number =
            std::make_unique<Channel<FloatGrid>>(openvdb::gridConstPtrCast<FloatGrid>(grid));
    }
    return channel;
}

template <class GridT>
bool all_active(const Channel<GridT>& channel, const openvdb::Vec3d& index) {
    const openvdb::Coord base = openvdb::Coord::floor(index);
    for (int n = 0; n < 8; ++n) {
        if (!channel.accessor.isValueOn(base.offsetBy(n >> 2, (n >> 1) & 1, n & 1))) return false;
    }
    return true;
}

}  // namespace

struct VdbSampler::Impl {
    std::vector<std::vector<AnyChannel>> levels;  // by level, by channel
    std::vector<openvdb::math::Transform::ConstPtr> transforms;
};

VdbSampler::VdbSampler(const std::string& path, const std::string& object,
                       const std::string& shader)
    : m_impl(std::make_unique<Impl>()) {
    const std::vector<TextureGrid> grids = read_vdb(path);  // makes sure that all is there
    std::set<std::string> objects;
    for (const TextureGrid& grid : grids) objects.insert(grid.object);
    const std::string& wanted = object.empty() && objects.size() == 1 ? *objects.begin() : object;
    if (!objects.contains(wanted)) {
        std::vector<std::string> names;
        for (const std::string& name : objects) names.push_back('"' + name + '"');
        throw Error(
            fmt::format("{}: no object \"{}\"; it has: {}", path, object, fmt::join(names, ", ")));
    }
    const auto found = std::find_if(grids.begin(), grids.end(), [&](const TextureGrid& grid) {
        return grid.object == wanted &&
               (shader.empty() ? grid.shader != "irradiance" : grid.shader == shader);
    });
    if (found == grids.end()) {
        throw Error(
            fmt::format("{}: object \"{}\" has no colours of shader \"{}\"", path, wanted, shader));
    }
    openvdb::io::File file(path);
    file.open(false);
    for (int n = 0; n < int(found->levels.size()); ++n) {
        std::vector<AnyChannel>& channels = m_impl->levels.emplace_back();
        for (const GridChannel& channel : found->channels) {
            const std::string suffix = object_suffix(objects, wanted);
            channels.push_back(open_channel(file, grid_name(channel.name, suffix, n)));
        }
        const AnyChannel& first = channels.front();
        m_impl->transforms.push_back(first.color ? first.color->grid->transformPtr()
                                                 : first.number->grid->transformPtr());
    }
}

VdbSampler::~VdbSampler() = default;

int VdbSampler::levels() const noexcept { return int(m_impl->levels.size()); }

bool VdbSampler::lookup(const glm::vec3& P, int level, float* out) const {
    const auto n = std::size_t(level);
    const openvdb::Vec3d index = m_impl->transforms[n]->worldToIndex(openvdb::Vec3d(P.x, P.y, P.z));
    bool active = true;
    for (const AnyChannel& channel : m_impl->levels[n]) {
        if (channel.color) {
            const openvdb::Vec3s value = channel.color->sample(index);
            for (int c = 0; c < 3; ++c) *out++ = value[c];
            active = active && all_active(*channel.color, index);
        } else {
            *out++ = channel.number->sample(index);
            active = active && all_active(*channel.number, index);
        }
    }
    return active;
}

}  // namespace estara
