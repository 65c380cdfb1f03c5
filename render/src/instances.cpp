#include "instances.h"

#include "estara/scenes/matrix.h"
#include "estara/scenes/ray_scene.h"

namespace estara {

std::vector<PosedInstance> pose_instances(const Scene& scene, const Pose& pose) {
    std::vector<PosedInstance> posed;
    posed.reserve(scene.instances.size());
    for (std::size_t i = 0; i < scene.instances.size(); ++i) {
        const glm::mat4& m = pose.world_from_instance[i];
        const glm::dmat3 linear{glm::mat3(m)};
        const int object = scene.instances[i].object;
        posed.push_back({object, &scene.objects[std::size_t(object)].mesh, pose.bent[i].get(), m,
                         glm::mat3(normal_matrix(linear)), float(largest_singular_value(linear)),
                         SurfaceOffset(m), can_be_hit(m)});
    }
    return posed;
}

}  // namespace estara
