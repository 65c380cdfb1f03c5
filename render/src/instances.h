// The matrices of a frame's instances.
#pragma once

#include <glm/glm.hpp>

#include <vector>

#include "estara/scenes/offset.h"
#include "estara/scenes/scene.h"

namespace estara {

struct PosedInstance {
    int object;  ///< index into Scene::objects
    glm::mat4 world_from_object;
    glm::mat3 world_from_normal;  ///< inverse transpose up to a positive factor
    float largest_scale;          ///< world length of the longest image of a unit vector
    SurfaceOffset offset;         ///< of rays that leave it
    bool is_there;                ///< can_be_hit()
};

std::vector<PosedInstance> pose_instances(const Scene& scene, const Pose& pose);

}  // namespace estara
