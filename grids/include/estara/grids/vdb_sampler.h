// OpenVDB's own trilinear sampler on a baked file: slow, plain, and the oracle that BrickPyramid
// is tested against.
#pragma once

#include <glm/glm.hpp>

#include <memory>
#include <string>

namespace estara {

class VdbSampler {
public:
    /// Opens the grids of one object ("" in a file of one) and one of its shaders, or the first
    /// that is not its irradiance. Error as read_vdb().
    VdbSampler(const std::string& path, const std::string& object, const std::string& shader = "");
    ~VdbSampler();
    VdbSampler(const VdbSampler&) = delete;
    VdbSampler& operator=(const VdbSampler&) = delete;

    int levels() const noexcept;

    /// tools::BoxSampler on every channel, one after the other. One thread at a time.
    /// @param out  one float a component, as BrickPyramid::lookup
    /// @return     whether all eight voxels are active
    bool lookup(const glm::vec3& P, int level, float* out) const;

private:
    struct Impl;
    std::unique_ptr<Impl> m_impl;
};

}  // namespace estara
