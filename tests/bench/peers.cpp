// Compiled twice, into libraries of their own (CMakeLists.txt): the linker must not take an inline
// function of one for the other.
#include "peers.h"

#include <nanovdb/util/OpenToNanoVDB.h>
#include <nanovdb/util/SampleFromVoxels.h>
#include <openvdb/openvdb.h>
#include <openvdb/tools/Interpolation.h>

namespace estara::bench {
namespace {

class Opened final : public Peers {
public:
    explicit Opened(const std::string& path) {
        openvdb::initialize();
        openvdb::io::File file(path);
        file.open();
        m_grid = openvdb::gridPtrCast<openvdb::Vec3SGrid>(file.readGrid("color"));
        m_nano = nanovdb::openToNanoVDB(openvdb::GridBase::Ptr(m_grid));
    }

    void openvdb(std::span<const glm::vec3> P, glm::vec3* colors) const override {
        using Accessor = openvdb::Vec3SGrid::ConstAccessor;
        const Accessor accessor = m_grid->getConstAccessor();
        const openvdb::tools::GridSampler<Accessor, openvdb::tools::BoxSampler> sampler(
            accessor, m_grid->transform());
        for (std::size_t i = 0; i < P.size(); ++i) {
            const openvdb::Vec3s c = sampler.wsSample(openvdb::Vec3R(P[i].x, P[i].y, P[i].z));
            colors[i] = {c[0], c[1], c[2]};
        }
    }

    void nanovdb(std::span<const glm::vec3> P, glm::vec3* colors) const override {
        const auto& grid = *m_nano.grid<nanovdb::Vec3f>();
        const auto accessor = grid.getAccessor();
        const nanovdb::SampleFromVoxels<std::decay_t<decltype(accessor)>, 1, false> sampler(
            accessor);
        for (std::size_t i = 0; i < P.size(); ++i) {
            const auto at = grid.worldToIndexF(nanovdb::Vec3f(P[i].x, P[i].y, P[i].z));
            const nanovdb::Vec3f c = sampler(at);
            colors[i] = {c[0], c[1], c[2]};
        }
    }

    std::uint64_t openvdb_bytes() const override { return m_grid->memUsage(); }
    std::uint64_t nanovdb_bytes() const override { return m_nano.size(); }

private:
    openvdb::Vec3SGrid::Ptr m_grid;
    nanovdb::GridHandle<nanovdb::HostBuffer> m_nano;
};

}  // namespace

[[gnu::visibility("default")]] std::unique_ptr<Peers> ESTARA_PEERS(const std::string& path) {
    return std::make_unique<Opened>(path);
}

}  // namespace estara::bench
