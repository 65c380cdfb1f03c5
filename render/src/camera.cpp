#include "estara/render/camera.h"

#include <cmath>
#include <limits>

namespace estara {

Ray Camera::primary_ray(float x, float y) const noexcept {
    return {m_pose.eye, m_pose.direction(x, y, m_width, m_height), 0.0f,
            std::numeric_limits<float>::infinity()};
}

Sight Camera::sight(const glm::vec3& P) const noexcept {
    // A difference of floats is exact to half an ulp, so float does where the square is a float.
    const glm::vec3 near = m_pose.eye - P;
    const float square = glm::dot(near, near);
    if (square > 1e-30f && square < 1e30f) {
        const float length = std::sqrt(square);
        return {ViewDirection(near / length), length};
    }
    const glm::dvec3 v = glm::dvec3(m_pose.eye) - glm::dvec3(P);
    const double length = glm::length(v);
    return {ViewDirection(length > 0.0 ? glm::vec3(v / length) : -m_pose.forward), float(length)};
}

}  // namespace estara
