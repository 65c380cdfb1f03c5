// What others offer for the same lookup: OpenVDB's own sampler, and NanoVDB's.
#pragma once

#include <glm/glm.hpp>

#include <cstdint>
#include <memory>
#include <span>
#include <string>

namespace estara::bench {

/// The grid "color" of a .vdb file, opened by OpenVDB and turned into a NanoVDB grid. One thread at
/// a time.
class Peers {
public:
    virtual ~Peers() = default;
    /// tools::GridSampler<ConstAccessor, BoxSampler> at each point, object space.
    virtual void openvdb(std::span<const glm::vec3> P, glm::vec3* colors) const = 0;
    /// SampleFromVoxels<AccT, 1, false> at each point, object space.
    virtual void nanovdb(std::span<const glm::vec3> P, glm::vec3* colors) const = 0;
    virtual std::uint64_t openvdb_bytes() const = 0;
    virtual std::uint64_t nanovdb_bytes() const = 0;
};

// The same code, compiled for any x86-64 as Debian compiles it, and for AVX2 and FMA.
std::unique_ptr<Peers> peers_baseline(const std::string& path);
std::unique_ptr<Peers> peers_avx2(const std::string& path);

}  // namespace estara::bench
