// Where a ray that leaves a surface starts.
#pragma once

#include <glm/glm.hpp>

#include <algorithm>
#include <cmath>

namespace estara {

/// Moves points off an instance's surface by more than the rounding error with which they were
/// computed, so that a ray from there does not meet the surface again and does not skip what is
/// near. Made once for an instance and frame: what depends on the matrix alone is computed here.
/// (Bound after Pharr, Jakob & Humphreys 2016, "Physically Based Rendering", section 3.9. Differs:
/// the rounding of the moved point is in the bound, instead of taking the next float outwards.)
class SurfaceOffset {
public:
    explicit SurfaceOffset(const glm::mat4& world_from_object) noexcept;

    /// P moved to the side of N; by less than 64 ulps of P's largest coordinate where object and
    /// world sizes are alike. P itself on an instance whose matrix is singular.
    /// @param P         hit point, world, = world_from_object * P_object computed in float
    /// @param N         unit geometric normal on the side the ray leaves to, world
    /// @param P_object  only magnitudes count; for a triangle that is large compared with
    ///        |P_object| (aslant through the origin) give the largest magnitudes of its vertices
    glm::vec3 from(const glm::vec3& P, const glm::vec3& N,
                   const glm::vec3& P_object) const noexcept {
        const float distance = glm::dot(glm::abs(N), error_bound(glm::abs(P), glm::abs(P_object)));
        if (!std::isfinite(distance)) return P;  // singular: there is no surface to leave
        return P + distance * N;
    }

private:
    /// Bound of the distance, by world axis, between P and the surface as a ray from P meets it.
    glm::vec3 error_bound(const glm::vec3& P, const glm::vec3& P_object) const noexcept {
        // Along an axis in which the object has no extent (a floor in y = 0) the other terms
        // vanish; the triangle test takes its products from the other axes all the same, and its
        // distance of next to 0 is a hit.
        const glm::vec3 reach = m_there * P_object;
        const glm::vec3 size = reach + m_shift;
        const glm::vec3 least(m_least * std::max({size.x, size.y, size.z}));
        return glm::max(m_of_reach * reach + m_of_P * P + m_fixed, least);
    }

    glm::mat3 m_there;  ///< magnitudes of the matrix
    glm::vec3 m_shift;  ///< and of its translation
    float m_of_reach, m_least;
    glm::mat3 m_of_P;
    glm::vec3 m_fixed;
};

}  // namespace estara
