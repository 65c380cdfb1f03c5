// RayScene on Embree 3: the only file that knows it.
#include "estara/scenes/ray_scene.h"

#include <embree3/rtcore.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstddef>
#include <glm/gtc/type_ptr.hpp>
#include <limits>
#include <string>
#include <type_traits>
#include <vector>

#include "estara/scenes/error.h"
#include "estara/shaders/math.h"
#include "estara/shaders/wide.h"

namespace estara {

namespace {

/// Rays that are handled together: the lanes of batches are padded to as many.
constexpr int group = 32;
static_assert(batch_capacity % group == 0);
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

/// The acceleration structure of one instance's bent mesh. From pose to pose it is refitted, which
/// takes a fraction of a build's time; it is built anew once vertices have moved so far from where
/// they were built that its boxes would overlap too much.
class BentScene {
public:
    BentScene(const Mesh& mesh, const BentMesh& bent, const std::string& where)
        : m_scene(rtcNewScene(device())),
          m_geometry(rtcNewGeometry(device(), RTC_GEOMETRY_TYPE_TRIANGLE)) {
        rtcSetSceneFlags(m_scene.get(), RTC_SCENE_FLAG_ROBUST | RTC_SCENE_FLAG_DYNAMIC);
        // Of this quality alone Embree looks at that of geometries.
        rtcSetSceneBuildQuality(m_scene.get(), RTC_BUILD_QUALITY_LOW);
        m_vertices = static_cast<glm::vec3*>(
            rtcSetNewGeometryBuffer(m_geometry.get(), RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                                    sizeof(glm::vec3), mesh.P.size()));
        check_embree(where);
        rtcSetSharedGeometryBuffer(m_geometry.get(), RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                                   mesh.triangles.data(), 0, sizeof(glm::uvec3),
                                   mesh.triangles.size());
        rtcSetGeometryBuildQuality(m_geometry.get(), RTC_BUILD_QUALITY_REFIT);
        rtcAttachGeometry(m_scene.get(), m_geometry.get());
        build(bent.P);
        check_embree(where);
    }

    RTCScene scene() const noexcept { return m_scene.get(); }

    /// Counts in `update` what was done.
    void move(const BentMesh& bent, const std::string& where, GeometryUpdate& update) {
        if (std::equal(bent.P.begin(), bent.P.end(), m_vertices)) return;
        // Measured on the bent cylinder of the tests: refitted rays take 1.1 times as long there.
        constexpr float farthest = 0.1f;  // of the diagonal
        if (moved(bent.P) > farthest * m_diagonal) {
            build(bent.P);
            ++update.rebuilds;
        } else {
            commit(bent.P);
            ++update.refits;
        }
        check_embree(where);
    }

private:
    void commit(const std::vector<glm::vec3>& P) {
        std::copy(P.begin(), P.end(), m_vertices);
        rtcUpdateGeometryBuffer(m_geometry.get(), RTC_BUFFER_TYPE_VERTEX, 0);
        rtcCommitGeometry(m_geometry.get());
        rtcCommitScene(m_scene.get());
    }

    void build(const std::vector<glm::vec3>& P) {
        m_built = P;
        glm::vec3 low(P.front()), high(low);
        for (const glm::vec3& p : P) {
            low = glm::min(low, p);
            high = glm::max(high, p);
        }
        m_diagonal = glm::distance(low, high);
        // A refitted geometry is built anew when its triangles may have changed.
        rtcUpdateGeometryBuffer(m_geometry.get(), RTC_BUFFER_TYPE_INDEX, 0);
        commit(P);
    }

    float moved(const std::vector<glm::vec3>& P) const noexcept {
        float farthest = 0.0f;
        for (std::size_t i = 0; i < P.size(); ++i) {
            const glm::vec3 way = P[i] - m_built[i];
            farthest = std::max(farthest, glm::dot(way, way));
        }
        return std::sqrt(farthest);
    }

    ScenePtr m_scene;
    GeometryPtr m_geometry;
    glm::vec3* m_vertices = nullptr;  ///< of the geometry
    std::vector<glm::vec3> m_built;   ///< as they were when it was built
    float m_diagonal = 0.0f;
};

/// What Embree cannot be told of a batch's rays, and what it must be told in its own way.
struct alignas(64) Prepared {
    int valid[batch_capacity];    ///< -1 or 0: the ray can hit something; no NaN anywhere
    int octant[batch_capacity];   ///< a bit for each negative component of its direction
    float scale[batch_capacity];  ///< of the direction: Embree's t times this is the ray's own
};

/// A power of two that brings a direction into the range that Embree's reciprocals bear.
float direction_scale(float size) noexcept {
    return std::ldexp(1.0f, std::clamp(-std::ilogb(size), -126, 127));
}

void prepare(const RayBatch& rays, Prepared& out) noexcept {
    const int size = rays.size;
    const int lanes = (size + group - 1) / group * group;
    const RayBatch* const in = &rays;
    Prepared* const to = &out;
    int unusual = 0;  // directions that are very long or very short: nearly never
    int* const found = &unusual;
    wide([=]() ESTARA_LOOP {
        int any = 0;
#pragma GCC ivdep
        for (int i = 0; i < lanes; ++i) {
            const float x = in->direction[0][i], y = in->direction[1][i], z = in->direction[2][i];
            const float ax = std::fabs(x), ay = std::fabs(y), az = std::fabs(z);
            const float tmin = in->tmin[i], tmax = in->tmax[i];
            const float larger = ax > ay ? ax : ay;
            const float length = larger > az ? larger : az;
            const bool finite = is_finite(in->origin[0][i]) & is_finite(in->origin[1][i]) &
                                is_finite(in->origin[2][i]) & is_finite(x) & is_finite(y) &
                                is_finite(z);
            const bool valid = finite & (length > 0.0f) & (tmin < infinity) & (tmin <= tmax) &
                               (tmax >= 0.0f) & (i < size);
            to->valid[i] = valid ? -1 : 0;
            to->octant[i] = (x < 0.0f ? 1 : 0) | (y < 0.0f ? 2 : 0) | (z < 0.0f ? 4 : 0);
            to->scale[i] = 1.0f;
            any |= (valid & !((length > 1e-6f) & (length < 1e6f))) ? 1 : 0;
        }
        *found = any;
    });
    if (unusual == 0) return;
    for (int i = 0; i < size; ++i) {
        const float length =
            std::max({std::abs(rays.direction[0][i]), std::abs(rays.direction[1][i]),
                      std::abs(rays.direction[2][i])});
        if (out.valid[i] && !(length > 1e-6f && length < 1e6f)) {
            out.scale[i] = direction_scale(length);
        }
    }
}

/// Whether Embree traces packets of 16 as such: on AVX-512. Embree is asked, not instruction_set():
/// it chooses its own code, whatever ours has been compiled for.
bool has_native_16() noexcept {
    static const bool has =
        rtcGetDeviceProperty(device(), RTC_DEVICE_PROPERTY_NATIVE_RAY16_SUPPORTED) != 0;
    return has;
}

/// Embree's functions for packets of so many rays, and whether several packets that go the same way
/// are traced as one stream: an eighth to a fifth faster on AVX2 (measured). Not on AVX-512: there
/// Embree 3.13.5 does not return from some coherent packets of occlusion rays, and streams of
/// primary rays have not been tried.
struct Packet8 {
    static constexpr int width = 8;
    static constexpr bool has_streams = true;
    using Ray = RTCRay8;
    using RayHit = RTCRayHit8;
    static constexpr auto intersect = rtcIntersect8;
    static constexpr auto occluded = rtcOccluded8;
};
struct Packet16 {
    static constexpr int width = 16;
    static constexpr bool has_streams = false;
    using Ray = RTCRay16;
    using RayHit = RTCRayHit16;
    static constexpr auto intersect = rtcIntersect16;
    static constexpr auto occluded = rtcOccluded16;
};

/// Whether some rays all go into the same octant: what Embree's coherent traversal is good at.
bool same_octant(const Prepared& prepared, int first, int count) noexcept {
    int any = 0, all = 7;  // bits of octants that some ray has, that every ray has
    for (int j = first; j < first + count; ++j) {
        any |= prepared.octant[j] & prepared.valid[j];
        all &= prepared.octant[j] | ~prepared.valid[j];
    }
    return any == all;
}

/// Writes rays [first, first + width) the way Embree takes them.
template <class Packet>
void fill(const RayBatch& rays, const Prepared& prepared, int first,
          typename Packet::Ray& out) noexcept {
    for (int i = 0; i < Packet::width; ++i) {
        const int j = first + i;
        const float scale = prepared.scale[j];
        // Embree looks at rays that are not valid too, in streams and where it cuts a packet in
        // two: they are given to it as empty ones, without NaN.
        const bool valid = prepared.valid[j] != 0;
        const auto given = [valid](float value, float otherwise) {
            return valid ? value : otherwise;
        };
        out.org_x[i] = given(rays.origin[0][j], 0.0f);
        out.org_y[i] = given(rays.origin[1][j], 0.0f);
        out.org_z[i] = given(rays.origin[2][j], 0.0f);
        out.dir_x[i] = given(rays.direction[0][j] * scale, 0.0f);
        out.dir_y[i] = given(rays.direction[1][j] * scale, 0.0f);
        out.dir_z[i] = given(rays.direction[2][j] * scale, 1.0f);
        out.tnear[i] = given((rays.tmin[j] > 0.0f ? rays.tmin[j] : 0.0f) / scale, 1.0f);
        out.tfar[i] = given(rays.tmax[j] / scale, 0.0f);
        out.time[i] = 0.0f;
        out.mask[i] = ~0u;
        out.id[i] = unsigned(i);
        out.flags[i] = 0;
    }
}

RTCIntersectContext context_with(RTCIntersectContextFlags flags) noexcept {
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    context.flags = flags;
    return context;
}

template <class Packet>
void intersect_group(RTCScene scene, const RayBatch& rays, const Prepared& prepared, int first,
                     HitBatch& hits) {
    constexpr int width = Packet::width, packets = group / width;
    std::array<typename Packet::RayHit, packets> trace;
    for (int p = 0; p < packets; ++p) {
        fill<Packet>(rays, prepared, first + p * width, trace[p].ray);
        std::fill_n(trace[p].hit.geomID, width, RTC_INVALID_GEOMETRY_ID);
        std::fill_n(trace[p].hit.instID[0], width, RTC_INVALID_GEOMETRY_ID);
    }
    if (Packet::has_streams && same_octant(prepared, first, group)) {
        RTCIntersectContext context = context_with(RTC_INTERSECT_CONTEXT_FLAG_COHERENT);
        rtcIntersectNM(scene, &context, reinterpret_cast<RTCRayHitN*>(trace.data()), width, packets,
                       sizeof trace[0]);
    } else {
        for (int p = 0; p < packets; ++p) {
            // Primary rays take half the time this way (measured on the still life).
            RTCIntersectContext context =
                context_with(same_octant(prepared, first + p * width, width)
                                 ? RTC_INTERSECT_CONTEXT_FLAG_COHERENT
                                 : RTC_INTERSECT_CONTEXT_FLAG_INCOHERENT);
            Packet::intersect(prepared.valid + first + p * width, scene, &context, &trace[p]);
        }
    }
    static_assert(Hit::none == RTC_INVALID_GEOMETRY_ID);
    for (int p = 0; p < packets; ++p) {
        for (int i = 0; i < width; ++i) {
            const int j = first + p * width + i;
            hits.instance[j] = trace[p].hit.instID[0][i];
            hits.triangle[j] = trace[p].hit.primID[i];
            hits.b1[j] = trace[p].hit.u[i];
            hits.b2[j] = trace[p].hit.v[i];
            hits.t[j] = trace[p].ray.tfar[i] * prepared.scale[j];
        }
    }
}

template <class Packet>
void occluded_group(RTCScene scene, const RayBatch& rays, const Prepared& prepared, int first,
                    std::uint8_t* blocked) {
    constexpr int width = Packet::width, packets = group / width;
    std::array<typename Packet::Ray, packets> trace;
    for (int p = 0; p < packets; ++p) {
        fill<Packet>(rays, prepared, first + p * width, trace[p]);
    }
    if (Packet::has_streams && same_octant(prepared, first, group)) {
        RTCIntersectContext context = context_with(RTC_INTERSECT_CONTEXT_FLAG_COHERENT);
        rtcOccludedNM(scene, &context, reinterpret_cast<RTCRayN*>(trace.data()), width, packets,
                      sizeof trace[0]);
    } else {
        for (int p = 0; p < packets; ++p) {
            RTCIntersectContext context = context_with(RTC_INTERSECT_CONTEXT_FLAG_INCOHERENT);
            Packet::occluded(prepared.valid + first + p * width, scene, &context, &trace[p]);
        }
    }
    // Embree says "blocked" by an infinitely negative end of the ray.
    const int count = std::min(group, rays.size - first);
    for (int i = 0; i < count; ++i) {
        blocked[first + i] = prepared.valid[first + i] && trace[i / width].tfar[i % width] < 0.0f;
    }
}

/// Calls trace(packet, prepared, first) for every group of a batch's rays.
template <class Trace>
void for_each_group(const RayBatch& rays, const Trace& trace) {
    const bool by_16 = has_native_16();
    Prepared prepared;
    prepare(rays, prepared);
    for (int first = 0; first < rays.size; first += group) {
        if (by_16) {
            trace(Packet16(), prepared, first);
        } else {
            trace(Packet8(), prepared, first);
        }
    }
}

/// Calls trace(batch, first) for as many batches as the rays fill.
template <class Trace>
void in_batches(std::span<const Ray> rays, const Trace& trace) {
    const auto batch = std::make_unique<RayBatch>();
    for (std::size_t first = 0; first < rays.size(); first += RayBatch::capacity) {
        batch->size = 0;
        const std::size_t last = std::min(first + RayBatch::capacity, rays.size());
        for (std::size_t i = first; i < last; ++i) batch->push(rays[i]);
        trace(*batch, first);
    }
}

}  // namespace

struct RayScene::Impl {
    const Scene& scene;
    std::vector<ScenePtr> meshes;                  ///< by object
    std::vector<float> sizes;                      ///< by object: largest coordinate
    ScenePtr top;                                  ///< geometry i is instance i
    std::vector<GeometryPtr> instances;            ///< by instance
    std::vector<std::unique_ptr<BentScene>> bent;  ///< by instance; null until it first bends
    std::vector<RTCScene> shown;                   ///< by instance
    GeometryUpdate update;
    glm::dvec3 origin{0.0};

    explicit Impl(const Scene& s) : scene(s), meshes(s.objects.size()), bent(s.instances.size()) {
        for (const Object& object : s.objects) sizes.push_back(largest_coordinate(object.mesh.P));
        tbb::parallel_for(std::size_t{0}, meshes.size(), [&](std::size_t i) {
            meshes[i] = mesh_scene(scene.objects[i], name_of(i));
        });
        top.reset(rtcNewScene(device()));
        rtcSetSceneFlags(top.get(), RTC_SCENE_FLAG_ROBUST);
        for (std::size_t i = 0; i < scene.instances.size(); ++i) attach(i);
        check_embree(scene.path);
    }

    std::string name_of(std::size_t object) const {
        return scene.path + ": object \"" + scene.objects[object].name + "\"";
    }

    void attach(std::size_t i) {
        GeometryPtr geometry(rtcNewGeometry(device(), RTC_GEOMETRY_TYPE_INSTANCE));
        shown.push_back(meshes[scene.instances[i].object].get());
        rtcSetGeometryInstancedScene(geometry.get(), shown.back());
        rtcAttachGeometryByID(top.get(), geometry.get(), unsigned(i));
        instances.push_back(std::move(geometry));
    }

    /// The structure of an instance's mesh, bent or not.
    RTCScene structure_of(std::size_t i, const BentMesh* bent_mesh) {
        const auto object = std::size_t(scene.instances[i].object);
        const Mesh& mesh = scene.objects[object].mesh;
        if (!bent_mesh || mesh.triangles.empty()) return meshes[object].get();
        if (!bent[i]) {
            bent[i] = std::make_unique<BentScene>(mesh, *bent_mesh, name_of(object));
            ++update.rebuilds;
        } else {
            bent[i]->move(*bent_mesh, name_of(object), update);
        }
        return bent[i]->scene();
    }

    void move(std::size_t i, const Pose& pose) {
        const RTCGeometry geometry = instances[i].get();
        const glm::mat4& world_from_object = pose.world_from_instance[i];
        if (!can_be_hit(world_from_object)) return rtcDisableGeometry(geometry);
        check_extent(i, pose);
        const RTCScene now = structure_of(i, pose.bent[i].get());
        if (now != shown[i]) rtcSetGeometryInstancedScene(geometry, now);
        shown[i] = now;
        rtcEnableGeometry(geometry);
        rtcSetGeometryTransform(geometry, 0, RTC_FORMAT_FLOAT4X4_COLUMN_MAJOR,
                                glm::value_ptr(world_from_object));
        rtcCommitGeometry(geometry);
    }

    /// Embree's assertions abort the program at 1.844e18. Error for an instance that reaches there.
    void check_extent(std::size_t i, const Pose& pose) const {
        constexpr float farthest = 1e18f;
        const auto object = std::size_t(scene.instances[i].object);
        const glm::mat4& m = pose.world_from_instance[i];
        const float size = pose.bent[i] ? largest_coordinate(pose.bent[i]->P) : sizes[object];
        for (int r = 0; r < 3; ++r) {
            const float reach = (std::abs(m[0][r]) + std::abs(m[1][r]) + std::abs(m[2][r])) * size +
                                std::abs(m[3][r]);
            if (reach <= farthest) continue;
            throw Error(name_of(object) +
                        ": its node puts it farther away than rays can be traced");
        }
    }

    static float largest_coordinate(const std::vector<glm::vec3>& P) noexcept {
        float largest = 0.0f;
        for (const glm::vec3& p : P) {
            largest = std::max({largest, std::abs(p.x), std::abs(p.y), std::abs(p.z)});
        }
        return largest;
    }

    void set_pose(const Pose& pose) {
        const auto start = std::chrono::steady_clock::now();
        update = {};
        origin = pose.origin;
        for (std::size_t i = 0; i < instances.size(); ++i) move(i, pose);
        rtcCommitScene(top.get());
        check_embree(scene.path);
        update.seconds =
            std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    }
};

bool can_be_hit(const glm::mat4& world_from_object) noexcept {
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

RayScene::RayScene(const Scene& scene, const glm::dvec3& origin)
    : m_impl(std::make_unique<Impl>(scene)) {
    m_impl->set_pose(pose_at(scene, 0.0, origin));
}

RayScene::~RayScene() = default;

void RayScene::set_pose(const Pose& pose) { m_impl->set_pose(pose); }

const GeometryUpdate& RayScene::last_update() const noexcept { return m_impl->update; }

const glm::dvec3& RayScene::origin() const noexcept { return m_impl->origin; }

void RayScene::intersect(const RayBatch& rays, HitBatch& hits) const {
    for_each_group(rays, [&](auto packet, const Prepared& prepared, int first) {
        intersect_group<decltype(packet)>(m_impl->top.get(), rays, prepared, first, hits);
    });
}

void RayScene::occluded(const RayBatch& rays, std::uint8_t* blocked) const {
    for_each_group(rays, [&](auto packet, const Prepared& prepared, int first) {
        occluded_group<decltype(packet)>(m_impl->top.get(), rays, prepared, first, blocked);
    });
}

void RayScene::intersect(std::span<const Ray> rays, Hit* hits) const {
    const auto found = std::make_unique<HitBatch>();
    in_batches(rays, [&](const RayBatch& batch, std::size_t first) {
        intersect(batch, *found);
        for (int i = 0; i < batch.size; ++i) {
            const bool hit = found->instance[i] != Hit::none;
            hits[first + std::size_t(i)] = hit ? Hit{found->instance[i], found->triangle[i],
                                                     found->b1[i], found->b2[i], found->t[i]}
                                               : Hit{};
        }
    });
}

void RayScene::occluded(std::span<const Ray> rays, std::uint8_t* blocked) const {
    in_batches(rays,
               [&](const RayBatch& batch, std::size_t first) { occluded(batch, blocked + first); });
}

}  // namespace estara
