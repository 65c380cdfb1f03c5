// The scene model: what estara-bake and estara-render know of the world. Lengths are in the
// scene's own unit (metres in glTF), angles in radians, colours linear Rec. 709, y is up.
#pragma once

#include <glm/glm.hpp>
#include <glm/gtc/quaternion.hpp>

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "estara/scenes/deformation.h"
#include "estara/scenes/light.h"
#include "estara/scenes/mesh.h"
#include "estara/shaders/registry.h"

namespace estara {

/// What a material says about its shader, as the user wrote it.
struct ShaderChoice {
    std::string name;  ///< empty: the material names none
    std::vector<Setting> settings;
    std::string where;  ///< "scene.glb: material \"table\"", for messages
};

/// A mesh with its material: what is baked, and what grids are named after.
struct Object {
    std::string name;  ///< unique in the scene; letters, digits, '_', '-' and '.' only (else '_')
    std::string mesh_name;       ///< as in the file; messages and --object know it too
    Mesh mesh;                   ///< at rest
    Deformation bends;           ///< how it can bend; empty: not at all
    std::vector<float> weights;  ///< of the morph targets where a node gives none
    ShaderChoice choice;
    glm::vec3 base_color{0.5f};  ///< glTF baseColorFactor; what an object without shader shows
    BoundShaderPtr shader;       ///< choice bound; `plastic` with Cs = base_color without one
    bool wears_shader() const noexcept { return !choice.name.empty(); }
};

enum class Interpolation { linear, step, cubic_spline };

/// Key frames of one property. cubic_spline has three values a key: in-tangent, value, out-tangent.
template <class T>
struct Track {
    Interpolation interpolation = Interpolation::linear;
    std::vector<float> times;  ///< seconds, strictly ascending
    std::vector<T> values;
    bool empty() const noexcept { return times.empty(); }
};

/// A coordinate frame in the hierarchy. Either TRS, animated or not, or a fixed matrix.
struct Node {
    std::string name;
    int parent = -1;  ///< index into Scene::nodes, smaller than the node's own; -1: the world
    glm::dvec3 translation{0.0};  ///< in double: a world may be far from its origin
    glm::quat rotation{1.0f, 0.0f, 0.0f, 0.0f};
    glm::vec3 scale{1.0f};
    std::optional<glm::dmat4> matrix;  ///< instead of the three above
    Track<glm::vec3> translations, scales;
    Track<glm::quat> rotations;
    std::vector<float> weights;               ///< of its mesh's morph targets; empty: the object's
    std::vector<Track<float>> weight_tracks;  ///< by morph target; empty: not animated
};

struct Instance {
    int object = 0;  ///< index into Scene::objects
    int node = 0;    ///< index into Scene::nodes
    int skin = -1;   ///< index into Scene::skins: its joints move the mesh, the node does not
};

/// A perspective camera that looks along its node's -z with y up.
struct SceneCamera {
    std::string name;
    int node = 0;
    float yfov = 0.8f;  ///< vertical field of view, radians, (0, pi)
};

/// KHR_lights_punctual: shines along its node's -z.
struct SceneLight {
    std::string name;
    LightType type = LightType::point;
    int node = 0;
    glm::vec3 color{1.0f};
    float intensity = 1.0f;  ///< lux (directional) or candela, as the file says; photometric
    float range = 0.0f;      ///< beyond it the light has no effect; 0: no limit
    float inner_cone = 0.0f, outer_cone = 0.7853982f;  ///< radians from the axis, spots only
    bool shadow = true;                                ///< extras {"shadow": false} switch it off
};

/// Frame f shows the time f / fps.
struct FrameRange {
    int first = 1, last = 1;  ///< inclusive
    int step = 1;
    std::vector<int>
        list{};  ///< ascending, from first to last; empty: each step from one to the other
    int count() const noexcept {
        return list.empty() ? (last - first) / step + 1 : int(list.size());
    }
    int at(int i) const noexcept { return list.empty() ? first + i * step : list[std::size_t(i)]; }
};

struct Scene {
    std::string path;         ///< as the user named the file
    std::vector<Node> nodes;  ///< parents before children
    std::vector<Object> objects;
    std::vector<Instance> instances;
    std::vector<Skin> skins;
    std::vector<SceneCamera> cameras;
    std::vector<SceneLight> lights;
    std::optional<double> fps;  ///< frames a second, if the file says (scene extras "fps")
    glm::vec3 ambient{
        0.0f};  ///< RSL's ambient light, added to every surface (scene extras "ambient")
    std::vector<std::string> warnings;  ///< what the file has and this project does not show
};

/// Everything that moves, at one time. World space is seen from an origin of the caller's choice.
struct Pose {
    std::vector<glm::mat4> world_from_node;      ///< by node
    std::vector<glm::mat4> world_from_instance;  ///< by instance: from its mesh, or its bent mesh
    /// By instance: its mesh as it is bent; null: the mesh as it is. What a node squeezes flat is
    /// bent too: rays cannot be taken to the object's space and back then.
    std::vector<std::shared_ptr<const BentMesh>> bent;
    glm::dvec3 origin{0.0};  ///< what (0, 0, 0) is in the scene
};

/// Matrices are multiplied in double, and rounded once they are seen from the origin: give that of
/// the camera, and nothing near it loses digits, however far from the world's origin it is.
/// @param time    seconds; before the first and after the last key a track holds its end values
/// @param origin  world; becomes (0, 0, 0)
Pose pose_at(const Scene& scene, double time, const glm::dvec3& origin = glm::dvec3(0.0));

/// Where a node is at one time: an origin for pose_at().
glm::dvec3 place_of(const Scene& scene, int node, double time);

/// Whether an instance's mesh bends at some time: it has a skin, or morph targets with a weight.
bool bends(const Scene& scene, const Instance& instance);

/// Vertices of an instance's mesh, which its matrix takes to the world.
inline const std::vector<glm::vec3>& placed_vertices(const Scene& scene, const Pose& pose,
                                                     std::size_t instance) {
    const BentMesh* const bent = pose.bent[instance].get();
    return bent ? bent->P : scene.objects[std::size_t(scene.instances[instance].object)].mesh.P;
}

/// The frames of the scene's animation: from the first key to the last at `fps` frames a second;
/// 1-1 for a scene without animation.
FrameRange animated_frames(const Scene& scene, double fps);

/// The common rate of frames on which all keys lie if they do not at 24 a second; or nothing.
std::optional<double> rate_of_keys(const Scene& scene);

/// 16 hex digits that change whenever anything of the scene does that may be seen.
std::string scene_digest(const Scene& scene);

/// Frames a second: what the user gives, else the scene, else 24, with a warning in
/// scene.warnings if its keys fit another rate.
double frame_rate(Scene& scene, const std::optional<double>& given);

/// Sets parameters of all objects that wear their shader. Error for one that none wears, and as
/// bind_choice().
/// @param settings  names as "wood.ringscale"
void set_parameters(Scene& scene, const std::vector<Setting>& settings);

std::vector<PosedLight> posed_lights(const Scene& scene, const Pose& pose);

/// A camera's geometry at one time: a pinhole, world space.
struct PinholePose {
    glm::vec3 eye;
    glm::vec3 right, up, forward;  ///< orthonormal
    float tan_half_yfov;

    /// Unnormalised direction through the image at (x, y) in pixels, (0, 0) the upper left corner:
    /// its component along forward is 1.
    ESTARA_KERNEL glm::vec3 direction(float x, float y, int width, int height) const noexcept {
        const float pixel = 2.0f * tan_half_yfov / float(height);
        return forward + right * ((x - 0.5f * float(width)) * pixel) +
               up * ((0.5f * float(height) - y) * pixel);
    }

    /// Where direction() goes through the image on its way to P, world: x and y in pixels, z the
    /// distance along forward, > 0 in front of the eye.
    ESTARA_KERNEL glm::vec3 project(const glm::vec3& P, int width, int height) const noexcept {
        const glm::vec3 d = P - eye;
        const float z = glm::dot(d, forward);
        const float scale = 0.5f * float(height) / (tan_half_yfov * z);
        return {0.5f * float(width) + glm::dot(d, right) * scale,
                0.5f * float(height) - glm::dot(d, up) * scale, z};
    }

    /// Angle between neighbouring pixels at the image centre, radians (the largest in the image).
    float pixel_angle(int height) const noexcept;
};

PinholePose pinhole_pose(const Scene& scene, const SceneCamera& camera, const Pose& pose);

/// Index of the camera of that name; the first one for "". Error with the names there are.
int find_camera(const Scene& scene, const std::string& name);

/// Indices of an object's instances.
std::vector<int> instances_of(const Scene& scene, int object);

/// Objects that a bake of `shader` means: those matching any glob (by object, mesh or node name;
/// * and ?), or without globs those wearing the shader, or all if none wears any shader at all.
/// Error, with the names there are, if a glob matches nothing or nothing is left.
std::vector<int> select_objects(const Scene& scene, const std::string& shader,
                                const std::vector<std::string>& globs);

/// Binds choice's shader for a mesh. All problems in one Error, each behind choice.where.
BoundShaderPtr bind_choice(const ShaderChoice& choice, bool has_uv);

}  // namespace estara
