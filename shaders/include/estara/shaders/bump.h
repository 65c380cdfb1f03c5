// Normals and tangents that a shader makes itself: of a surface that a height field moves.
#pragma once

#include <glm/glm.hpp>

#include <cmath>

#include "estara/shaders/kernel.h"
#include "estara/shaders/math.h"

namespace estara {

/// The unit normal of the surface that is moved by a height along its normal N: N tilted against
/// the part of the height's gradient that lies in the surface (Blinn 1978, "Simulation of Wrinkled
/// Surfaces"; first order in the height, so that the surface's own curvature is left out).
/// @param N         unit length
/// @param gradient  change of the height with the point, same space as N
ESTARA_KERNEL glm::vec3 bumped(const glm::vec3& N, const glm::vec3& gradient) noexcept {
    return unit_vector_or(N - (gradient - glm::dot(gradient, N) * N), N);
}

/// Unit vector in the plane normal to N in which u grows; where dPdu does not say (there are no
/// texture coordinates, or it is parallel to N) a tangent that depends on N alone.
/// @param N  unit length
ESTARA_KERNEL glm::vec3 tangent_along(const glm::vec3& dPdu, const glm::vec3& N) noexcept {
    const glm::vec3 u = unit_vector_or(dPdu, glm::vec3(0.0f));
    const glm::vec3 along = u - glm::dot(u, N) * N;
    // Below this length the difference is rounding.
    const bool usable = glm::dot(along, along) > 1e-6f;
    const bool upright = std::fabs(N.z) > 0.7f;
    const glm::vec3 any = glm::cross(select(upright, {1, 0, 0}, {0, 0, 1}), N);
    return unit_vector_or(select(usable, along, any), {1, 0, 0});
}

}  // namespace estara
