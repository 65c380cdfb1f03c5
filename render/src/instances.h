// The matrices of a frame's instances.
#pragma once

#include <glm/glm.hpp>

#include <vector>

#include "estara/scenes/deformation.h"
#include "estara/scenes/offset.h"
#include "estara/scenes/scene.h"

namespace estara {

struct PosedInstance {
    int object;  ///< index into Scene::objects
    const Mesh* mesh;
    const BentMesh* bent;         ///< the mesh as it is bent; null: as it is
    glm::mat4 world_from_object;  ///< or from the bent mesh
    glm::mat3 world_from_normal;  ///< inverse transpose up to a positive factor
    float largest_scale;          ///< world length of the longest image of a unit vector
    SurfaceOffset offset;         ///< of rays that leave it
    bool is_there;                ///< can_be_hit()
};

/// @param pose  outlives the result
std::vector<PosedInstance> pose_instances(const Scene& scene, const Pose& pose);

}  // namespace estara
