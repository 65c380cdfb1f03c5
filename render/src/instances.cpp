#include "instances.h"

#include "estara/scenes/matrix.h"
#include "estara/scenes/ray_scene.h"

namespace estara {

std::vector<PosedInstance> pose_instances(const Scene& scene, const Pose& pose) {
    std::vector<PosedInstance> posed;
    posed.reserve(scene.instances.size());
    for (const Instance& instance : scene.instances) {
        const glm::mat4& m = pose.world_from_node[std::size_t(instance.node)];
        const glm::dmat3 linear{glm::mat3(m)};
        posed.push_back({instance.object, m, glm::mat3(normal_matrix(linear)),
                         float(largest_singular_value(linear)), SurfaceOffset(m), can_be_hit(m)});
    }
    return posed;
}

}  // namespace estara
