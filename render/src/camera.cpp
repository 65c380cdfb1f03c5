#include "estara/render/camera.h"

#include <limits>

namespace estara {

Ray Camera::primary_ray(float x, float y) const noexcept {
    return {m_pose.eye, m_pose.direction(x, y, m_width, m_height), 0.0f,
            std::numeric_limits<float>::infinity()};
}

// In double: the square of a float's length overflows beyond 1e19 and vanishes below 1e-19.
ViewDirection Camera::view_direction(const glm::vec3& P) const noexcept {
    const glm::dvec3 v = glm::dvec3(m_pose.eye) - glm::dvec3(P);
    const double length = glm::length(v);
    return ViewDirection(length > 0.0 ? glm::vec3(v / length) : -m_pose.forward);
}

float Camera::distance(const glm::vec3& P) const noexcept {
    return float(glm::distance(glm::dvec3(m_pose.eye), glm::dvec3(P)));
}

}  // namespace estara
