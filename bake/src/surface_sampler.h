// Random points on a mesh.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <random>
#include <vector>

#include "estara/scenes/mesh.h"

namespace estara {

/// Points on a mesh, uniform by area. Immutable: any thread may ask.
class SurfaceSampler {
public:
    explicit SurfaceSampler(const Mesh& mesh) : m_mesh(mesh), m_area(mesh.triangles.size()) {
        double sum = 0.0;
        for (std::size_t t = 0; t < m_area.size(); ++t) {
            const glm::uvec3& c = mesh.triangles[t];
            const glm::dvec3 a(mesh.P[c.x]);
            sum += 0.5 * glm::length(
                             glm::cross(glm::dvec3(mesh.P[c.y]) - a, glm::dvec3(mesh.P[c.z]) - a));
            m_area[t] = sum;
        }
    }

    /// Points that callers ask for in each batch but the last, which may have fewer. Not the
    /// capacity of a shader's batch: with another number the points, and every error that is
    /// measured at them, would be others.
    static constexpr std::size_t batch_size = 512;

    /// Points of one batch of many. Each batch has a generator of its own, so that its points do
    /// not depend on who works on which.
    void points(std::uint64_t seed, std::uint64_t batch, std::size_t count,
                std::vector<MeshPoint>& out) const {
        std::mt19937_64 random(seed * 0x9e3779b97f4a7c15u + batch);
        std::uniform_real_distribution<double> uniform;
        out.clear();
        for (std::size_t i = 0; i < count; ++i) {
            const double x = uniform(random), y = uniform(random), z = uniform(random);
            out.push_back(at({x, y, z}));
        }
    }

private:
    /// @param u  three numbers in [0, 1)
    MeshPoint at(const glm::dvec3& u) const {
        const auto found = std::upper_bound(m_area.begin(), m_area.end(), u.x * m_area.back());
        const auto triangle =
            std::min<std::size_t>(std::size_t(found - m_area.begin()), m_area.size() - 1);
        const double root = std::sqrt(u.y);  // Turk 1990, "Generating Random Points in Triangles"
        return mesh_point(m_mesh, std::uint32_t(triangle), float(root * (1.0 - u.z)),
                          float(root * u.z));
    }

    const Mesh& m_mesh;
    std::vector<double> m_area;  ///< of the triangles up to and with this one
};

}  // namespace estara
