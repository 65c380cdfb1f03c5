// RayScene on Embree 3: the only file that knows it.
#include "estara/scenes/ray_scene.h"

#include <embree3/rtcore.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <glm/gtc/type_ptr.hpp>
#include <limits>
#include <type_traits>
#include <vector>

#include "estara/scenes/error.h"

namespace estara {

namespace {

constexpr int packet = 16;
constexpr float infinity = std::numeric_limits<float>::infinity();

struct Release {
    void operator()(RTCScene scene) const noexcept { rtcReleaseScene(scene); }
    void operator()(RTCGeometry geometry) const noexcept { rtcReleaseGeometry(geometry); }
};
using ScenePtr = std::unique_ptr<std::remove_pointer_t<RTCScene>, Release>;
using GeometryPtr = std::unique_ptr<std::remove_pointer_t<RTCGeometry>, Release>;

/// The process's one device. Never released: it outlives every RayScene.
RTCDevice device() {
    static const RTCDevice shared = [] {
        const RTCDevice fresh = rtcNewDevice(nullptr);
        if (!fresh) throw Error("Embree does not start on this machine", ExitStatus::failed);
        return fresh;
    }();
    return shared;
}

/// Throws what Embree has complained about on this thread since the last call.
void check_embree(const std::string& where) {
    const RTCError error = rtcGetDeviceError(device());
    if (error == RTC_ERROR_NONE) return;
    if (error == RTC_ERROR_OUT_OF_MEMORY)
        throw Error(where + ": out of memory while its ray structure was built",
                    ExitStatus::failed);
    throw Error(where + ": Embree refuses its geometry (error " + std::to_string(int(error)) + ")",
                ExitStatus::failed);
}

/// A mesh's triangles. Vertices are copied: Embree reads 16 bytes at the last one, which a
/// vector of vec3 does not have.
GeometryPtr triangle_geometry(const Mesh& mesh, const std::string& where) {
    GeometryPtr geometry(rtcNewGeometry(device(), RTC_GEOMETRY_TYPE_TRIANGLE));
    void* vertices = rtcSetNewGeometryBuffer(geometry.get(), RTC_BUFFER_TYPE_VERTEX, 0,
                                             RTC_FORMAT_FLOAT3, sizeof(glm::vec3), mesh.P.size());
    check_embree(where);
    std::copy(mesh.P.begin(), mesh.P.end(), static_cast<glm::vec3*>(vertices));
    rtcSetSharedGeometryBuffer(geometry.get(), RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                               mesh.triangles.data(), 0, sizeof(glm::uvec3), mesh.triangles.size());
    rtcSetGeometryBuildQuality(geometry.get(), RTC_BUILD_QUALITY_HIGH);
    rtcCommitGeometry(geometry.get());
    return geometry;
}

/// The acceleration structure of one mesh, in its object's space. Built once and traced for many
/// frames, so quality goes before building time.
ScenePtr mesh_scene(const Object& object, const std::string& where) {
    ScenePtr scene(rtcNewScene(device()));
    rtcSetSceneFlags(scene.get(), RTC_SCENE_FLAG_ROBUST);
    rtcSetSceneBuildQuality(scene.get(), RTC_BUILD_QUALITY_HIGH);
    if (!object.mesh.triangles.empty())
        rtcAttachGeometry(scene.get(), triangle_geometry(object.mesh, where).get());
    rtcCommitScene(scene.get());
    check_embree(where);
    return scene;
}

/// Whether Embree can take rays to object space and back: no axis has collapsed, nothing overflows.
bool invertible(const glm::mat4& world_from_object) noexcept {
    for (int c = 0; c < 4; ++c)
        for (int r = 0; r < 3; ++r)
            if (!std::isfinite(world_from_object[c][r])) return false;
    const glm::dvec3 x(world_from_object[0]), y(world_from_object[1]), z(world_from_object[2]);
    const double volume = std::abs(glm::dot(glm::cross(x, y), z));
    // Axes turned into one plane leave a volume of rounding errors, 1e-7 of their lengths' product.
    constexpr double flat = 1e-6;
    if (!(volume > flat * glm::length(x) * glm::length(y) * glm::length(z))) return false;
    return std::isnormal(float(volume));  // Embree divides by it in float
}

/// Whether a ray can hit anything at all; false for NaN anywhere.
bool traceable(const Ray& ray) noexcept {
    const auto finite = [](const glm::vec3& v) {
        return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
    };
    return finite(ray.origin) && finite(ray.direction) && ray.direction != glm::vec3(0.0f) &&
           ray.tmin < infinity && ray.tmin <= ray.tmax && ray.tmax >= 0.0f;
}

/// A power of two that brings a direction into the range that Embree's reciprocals bear; nearly
/// always 1.
float direction_scale(const glm::vec3& d) noexcept {
    const float size = std::max({std::abs(d.x), std::abs(d.y), std::abs(d.z)});
    if (size > 1e-6f && size < 1e6f) return 1.0f;
    return std::ldexp(1.0f, std::clamp(-std::ilogb(size), -126, 127));
}

/// Up to 16 rays the way Embree takes them.
struct Lanes {
    alignas(64) int valid[packet];
    float scale[packet];  ///< of the direction: Embree's t times this is the ray's own
};

void fill(std::span<const Ray> rays, Lanes& lanes, RTCRay16& out) noexcept {
    const int count = int(rays.size());
    for (int i = 0; i < packet; ++i) {
        const bool valid = i < count && traceable(rays[i]);
        const Ray& ray = rays[i < count ? i : 0];
        const float scale = valid ? direction_scale(ray.direction) : 1.0f;
        lanes.valid[i] = valid ? -1 : 0;
        lanes.scale[i] = scale;
        out.org_x[i] = ray.origin.x;
        out.org_y[i] = ray.origin.y;
        out.org_z[i] = ray.origin.z;
        out.dir_x[i] = ray.direction.x * scale;
        out.dir_y[i] = ray.direction.y * scale;
        out.dir_z[i] = ray.direction.z * scale;
        out.tnear[i] = std::max(ray.tmin, 0.0f) / scale;
        out.tfar[i] = ray.tmax / scale;
        out.time[i] = 0.0f;
        out.mask[i] = ~0u;
        out.id[i] = unsigned(i);
        out.flags[i] = 0;
    }
}

/// Whether the rays go into the same octant, which is what Embree's coherent traversal is good at.
bool coherent(const Lanes& lanes, const RTCRay16& rays) noexcept {
    unsigned seen = 0;  // one bit an octant
    for (int i = 0; i < packet; ++i) {
        const int octant = int(rays.dir_x[i] < 0.0f) | int(rays.dir_y[i] < 0.0f) << 1 |
                           int(rays.dir_z[i] < 0.0f) << 2;
        if (lanes.valid[i]) seen |= 1u << octant;
    }
    return (seen & (seen - 1)) == 0;
}

RTCIntersectContext context_with(RTCIntersectContextFlags flags) noexcept {
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    context.flags = flags;
    return context;
}

}  // namespace

struct RayScene::Impl {
    const Scene& scene;
    std::vector<ScenePtr> meshes;        ///< by object
    ScenePtr top;                        ///< geometry i is instance i
    std::vector<GeometryPtr> instances;  ///< by instance

    explicit Impl(const Scene& s) : scene(s), meshes(s.objects.size()) {
        tbb::parallel_for(std::size_t{0}, meshes.size(), [&](std::size_t i) {
            const Object& object = scene.objects[i];
            meshes[i] = mesh_scene(object, scene.path + ": object \"" + object.name + "\"");
        });
        top.reset(rtcNewScene(device()));
        rtcSetSceneFlags(top.get(), RTC_SCENE_FLAG_ROBUST);
        for (std::size_t i = 0; i < scene.instances.size(); ++i) attach(i);
        check_embree(scene.path);
    }

    void attach(std::size_t i) {
        GeometryPtr geometry(rtcNewGeometry(device(), RTC_GEOMETRY_TYPE_INSTANCE));
        rtcSetGeometryInstancedScene(geometry.get(), meshes[scene.instances[i].object].get());
        rtcAttachGeometryByID(top.get(), geometry.get(), unsigned(i));
        instances.push_back(std::move(geometry));
    }

    void move(std::size_t i, const glm::mat4& world_from_object) {
        const RTCGeometry geometry = instances[i].get();
        if (!invertible(world_from_object)) return rtcDisableGeometry(geometry);
        rtcEnableGeometry(geometry);
        rtcSetGeometryTransform(geometry, 0, RTC_FORMAT_FLOAT4X4_COLUMN_MAJOR,
                                glm::value_ptr(world_from_object));
        rtcCommitGeometry(geometry);
    }

    void set_pose(const Pose& pose) {
        for (std::size_t i = 0; i < instances.size(); ++i)
            move(i, pose.world_from_node[scene.instances[i].node]);
        rtcCommitScene(top.get());
        check_embree(scene.path);
    }
};

RayScene::RayScene(const Scene& scene) : m_impl(std::make_unique<Impl>(scene)) {
    m_impl->set_pose(pose_at(scene, 0.0));
}

RayScene::~RayScene() = default;

void RayScene::set_pose(const Pose& pose) { m_impl->set_pose(pose); }

void RayScene::intersect(std::span<const Ray> rays, Hit* hits) const {
    for (std::size_t first = 0; first < rays.size(); first += packet) {
        const std::span<const Ray> some =
            rays.subspan(first, std::min<std::size_t>(packet, rays.size() - first));
        Lanes lanes;
        RTCRayHit16 trace;
        fill(some, lanes, trace.ray);
        std::fill_n(trace.hit.geomID, packet, RTC_INVALID_GEOMETRY_ID);
        std::fill_n(trace.hit.instID[0], packet, RTC_INVALID_GEOMETRY_ID);
        // Primary rays take half the time this way (measured on the still life).
        RTCIntersectContext context =
            context_with(coherent(lanes, trace.ray) ? RTC_INTERSECT_CONTEXT_FLAG_COHERENT
                                                    : RTC_INTERSECT_CONTEXT_FLAG_INCOHERENT);
        rtcIntersect16(lanes.valid, m_impl->top.get(), &context, &trace);
        for (std::size_t i = 0; i < some.size(); ++i) {
            const bool hit = trace.hit.geomID[i] != RTC_INVALID_GEOMETRY_ID;
            hits[first + i] = hit ? Hit{trace.hit.instID[0][i], trace.hit.primID[i], trace.hit.u[i],
                                        trace.hit.v[i], trace.ray.tfar[i] * lanes.scale[i]}
                                  : Hit{};
        }
    }
}

void RayScene::occluded(std::span<const Ray> rays, std::uint8_t* blocked) const {
    for (std::size_t first = 0; first < rays.size(); first += packet) {
        const std::span<const Ray> some =
            rays.subspan(first, std::min<std::size_t>(packet, rays.size() - first));
        Lanes lanes;
        RTCRay16 trace;
        fill(some, lanes, trace);
        // Never coherent: Embree 3.13.5 on AVX-512 then does not return from some packets.
        RTCIntersectContext context = context_with(RTC_INTERSECT_CONTEXT_FLAG_INCOHERENT);
        rtcOccluded16(lanes.valid, m_impl->top.get(), &context, &trace);
        // Embree says "blocked" by an infinitely negative end of the ray.
        for (std::size_t i = 0; i < some.size(); ++i)
            blocked[first + i] = lanes.valid[i] && trace.tfar[i] < 0.0f;
    }
}

}  // namespace estara
