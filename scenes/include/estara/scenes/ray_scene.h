// Rays through a scene. The only door to Embree.
#pragma once

#include <glm/glm.hpp>

#include <cstdint>
#include <limits>
#include <memory>
#include <span>

#include "estara/scenes/scene.h"

namespace estara {

struct Ray {
    glm::vec3 origin;     ///< world
    glm::vec3 direction;  ///< world, any length > 0
    float tmin, tmax;     ///< in units of direction's length
};

struct Hit {
    static constexpr std::uint32_t none = ~0u;
    std::uint32_t instance = none;  ///< index into Scene::instances; none: nothing hit
    std::uint32_t triangle = 0;     ///< index into the object's mesh
    float b1 = 0.0f, b2 = 0.0f;     ///< barycentric coordinates, as mesh_point() takes them
    float t = 0.0f;
};

/// A shadow ray ends a little before its light: what holds the light is often exactly there.
inline constexpr float shadow_end = 0.9999f;

/// The ray from a point off the surface to a light.
/// @param L  unit, towards the light
inline Ray shadow_ray(const PosedLight& light, const glm::vec3& origin,
                      const glm::vec3& L) noexcept {
    if (light.type == LightType::directional) {
        return {origin, L, 0.0f, std::numeric_limits<float>::infinity()};
    }
    return {origin, light.position - origin, 0.0f, shadow_end};
}

/// Rays as structure of arrays: what is traced together is cut from it. Neighbours in it should be
/// neighbours in space.
struct alignas(64) RayBatch {
    static constexpr int capacity = batch_capacity;

    float origin[3][capacity];     ///< world
    float direction[3][capacity];  ///< world, any length > 0
    float tmin[capacity], tmax[capacity];
    int size = 0;  ///< rays in use, [0, capacity]

    void push(const Ray& ray) noexcept {
        for (int c = 0; c < 3; ++c) {
            origin[c][size] = ray.origin[c];
            direction[c][size] = ray.direction[c];
        }
        tmin[size] = ray.tmin;
        tmax[size++] = ray.tmax;
    }
};

/// As Hit, for each ray of a batch.
struct alignas(64) HitBatch {
    std::uint32_t instance[batch_capacity], triangle[batch_capacity];
    float b1[batch_capacity], b2[batch_capacity], t[batch_capacity];
};

/// Whether rays can be taken to an instance's object space and back: no axis has collapsed, nothing
/// overflows. Others cannot be hit.
bool can_be_hit(const glm::mat4& world_from_object) noexcept;

/// What set_pose() has done to the structures of meshes that bend.
struct GeometryUpdate {
    double seconds = 0.0;  ///< of all of it, instances that only move included
    int refits = 0;        ///< structures whose boxes were moved
    int rebuilds = 0;      ///< and those built anew
};

/// The scene's geometry in a two-level acceleration structure: one per mesh in object space and
/// one per bent instance, one over the instances, rebuilt for each frame.
class RayScene {
public:
    /// Builds the structures of all meshes in parallel, posed as at time 0. The scene must outlive
    /// this.
    /// Error (failed) if Embree runs out of memory.
    explicit RayScene(const Scene& scene, const glm::dvec3& origin = glm::dvec3(0.0));
    ~RayScene();
    RayScene(const RayScene&) = delete;
    RayScene& operator=(const RayScene&) = delete;

    /// Moves the instances, and bends what bends. Not while other threads trace. See
    /// can_be_hit().
    void set_pose(const Pose& pose);
    const GeometryUpdate& last_update() const noexcept;
    /// Of the pose that it has (Pose::origin).
    const glm::dvec3& origin() const noexcept;

    /// Nearest hits; rays that start near each other and go the same way are fastest (32
    /// neighbours at a time). Any thread, any number at once. Rays with NaN hit nothing.
    void intersect(const RayBatch& rays, HitBatch& hits) const;
    /// The same, hits[i] for rays[i].
    void intersect(std::span<const Ray> rays, Hit* hits) const;

    /// blocked[i] = 1 if anything lies between tmin and tmax of ray i, else 0. As intersect().
    void occluded(const RayBatch& rays, std::uint8_t* blocked) const;
    void occluded(std::span<const Ray> rays, std::uint8_t* blocked) const;

private:
    struct Impl;
    std::unique_ptr<Impl> m_impl;
};

/// For each object the smallest width that a pixel covers on it, over all frames in which some
/// pixel sees it, object space; infinity for an object no pixel of any frame sees.
///
/// Sampled with every fourth pixel in both directions (each at its centre); distances are
/// exact there, a closer point between samples is missed. Moves `rays`. Deterministic.
std::vector<float> smallest_footprints(const Scene& scene, RayScene& rays, int camera,
                                       const FrameRange& frames, double fps, int width, int height);

/// The voxel size of each object if the user gives none, object space, > 0: half its smallest
/// footprint over the frames (256 of them, evenly spread, if there are more), so that the blur of a
/// lookup stays below the pixel; 1/512 of its diagonal if no pixel sees it. Between 1/32 and
/// 1/16384 of the diagonal, and no smaller than finest_voxel_size(). Also the filter width of
/// direct evaluation, so that both have the same octaves.
std::vector<double> automatic_voxel_sizes(const Scene& scene, RayScene& rays, int camera,
                                          const FrameRange& frames, double fps, int width,
                                          int height);

}  // namespace estara
