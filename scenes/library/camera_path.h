// A camera that walks.
#pragma once

#include <glm/glm.hpp>

#include <span>

#include "glb.h"

namespace estara::examples {

/// Where a camera is and what it looks at.
struct Shot {
    glm::vec3 eye, aim;
};

/// Point of a uniform cubic B-spline that starts and ends in the first and last shot, at rest
/// there: what is between is passed near, not through, without a jolt.
/// @param part  how much of the path has passed, [0, 1]
Shot shot_at(std::span<const Shot> shots, double part);

/// Adds a camera that goes along the shots in `path_frames` frames, with a key on each.
/// @param yfov   vertical field of view, radians
/// @param shots  never straight down or up
void add_walking_camera(GlbBuilder& out, double yfov, std::span<const Shot> shots);

}  // namespace estara::examples
