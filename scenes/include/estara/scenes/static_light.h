// Light that does not change during an animation: what arrives at a surface, shadows included.
#pragma once

#include <glm/glm.hpp>

#include <span>
#include <string>
#include <vector>

#include "estara/scenes/offset.h"
#include "estara/scenes/ray_scene.h"
#include "estara/scenes/scene.h"

namespace estara {

/// The name of a node that moves and carries a mesh or a light, itself or through a parent; "" if
/// only cameras move.
std::string moving_node(const Scene& scene);

/// Why an object's light cannot be baked ("it stands in the scene 3 times, ..."), or "". Whether
/// anything moves is for moving_node() to say.
std::string why_no_static_light(const Scene& scene, int object);

/// An origin for RayScene near what is lit, so that no digits are lost far from the world's.
glm::dvec3 near_origin(const Scene& scene);

/// 16 hex digits that change whenever the light on that instance may: with any light, with the
/// place of any instance and with any mesh.
std::string lights_digest(const Scene& scene, int instance);

/// The scene's lights as one instance receives them.
class StaticLight {
public:
    /// Of the scene as it is at time 0. Both must outlive this; `rays` is posed so, and stays.
    /// @param instance  one that does not bend (Pose::bent)
    StaticLight(const Scene& scene, const RayScene& rays, int instance);

    /// Diffuse irradiance / pi from all lights on the side that the normals point to: the sum of
    /// Cl <N.L>+ over the lights that are visible. Ambient and indirect light are not in it.
    /// Any thread.
    /// @param points  of the instance's mesh, object space
    void irradiance(std::span<const MeshPoint> points, glm::vec3* E) const;

private:
    StaticLight(const Scene& scene, const RayScene& rays, const Pose& pose, int instance);
    void add(const PosedLight& light, std::span<const MeshPoint> points, glm::vec3* E) const;

    const RayScene& m_rays;
    glm::mat4 m_world_from_object;
    glm::mat3 m_world_from_normal;
    SurfaceOffset m_offset;
    std::vector<PosedLight> m_lights;
};

}  // namespace estara
