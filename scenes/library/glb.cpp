#include "glb.h"

#include <tiny_gltf.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <glm/gtc/type_precision.hpp>
#include <numbers>
#include <sstream>

#include "estara/scenes/error.h"
#include "estara/scenes/program.h"

namespace estara::examples {

namespace {

using tinygltf::Value;

constexpr double lumens_per_watt = 683.0;

std::vector<double> numbers(const glm::dvec3& v) { return {v.x, v.y, v.z}; }

Value value(const std::vector<double>& components) {
    if (components.size() == 1) return Value(components[0]);
    Value::Array array;
    for (const double x : components) array.emplace_back(x);
    return Value(array);
}

}  // namespace

double lux_for(double Cl) { return Cl * std::numbers::pi * lumens_per_watt; }

double candela_for(double Cl, double distance) { return lux_for(Cl) * distance * distance; }

glm::quat looking_along(const glm::vec3& forward) {
    return glm::quatLookAt(glm::normalize(forward), glm::vec3(0.0f, 1.0f, 0.0f));
}

struct GlbBuilder::Impl {
    tinygltf::Model model;
    std::vector<unsigned char>& bytes() { return model.buffers[0].data; }

    template <class T>
    int add_accessor(const std::vector<T>& values, int component, int type, int target);
    int add_times(const std::vector<float>& times);
    void set_bounds(int accessor, const std::vector<glm::vec3>& values);
    void animate(int node, const std::string& path, int input, int output);
};

GlbBuilder::GlbBuilder() : m_impl(std::make_unique<Impl>()) {
    tinygltf::Model& model = m_impl->model;
    model.asset.version = "2.0";
    model.asset.generator = std::string("estara-scenes ") + version;
    model.buffers.emplace_back();
    model.scenes.emplace_back();
    model.defaultScene = 0;
}

GlbBuilder::~GlbBuilder() = default;

/// Appends values to the one buffer. @param target  0 for none
template <class T>
int GlbBuilder::Impl::add_accessor(const std::vector<T>& values, int component, int type,
                                   int target) {
    static_assert(sizeof(T) % 4 == 0, "glTF wants accessors aligned to four bytes");
    tinygltf::BufferView view;
    view.buffer = 0;
    view.byteOffset = bytes().size();
    view.byteLength = values.size() * sizeof(T);
    view.target = target;
    const auto* first = reinterpret_cast<const unsigned char*>(values.data());
    bytes().insert(bytes().end(), first, first + view.byteLength);
    model.bufferViews.push_back(view);

    tinygltf::Accessor accessor;
    accessor.bufferView = int(model.bufferViews.size()) - 1;
    accessor.componentType = component;
    accessor.type = type;
    accessor.count = values.size();
    model.accessors.push_back(accessor);
    return int(model.accessors.size()) - 1;
}

void GlbBuilder::Impl::set_bounds(int accessor, const std::vector<glm::vec3>& values) {
    glm::vec3 low(values.front()), high(low);
    for (const glm::vec3& v : values) {
        low = glm::min(low, v);
        high = glm::max(high, v);
    }
    model.accessors[accessor].minValues = numbers(low);
    model.accessors[accessor].maxValues = numbers(high);
}

int GlbBuilder::Impl::add_times(const std::vector<float>& times) {
    const int index = add_accessor(times, TINYGLTF_COMPONENT_TYPE_FLOAT, TINYGLTF_TYPE_SCALAR, 0);
    model.accessors[index].minValues = {times.front()};
    model.accessors[index].maxValues = {times.back()};
    return index;
}

void GlbBuilder::Impl::animate(int node, const std::string& path, int input, int output) {
    if (model.animations.empty()) model.animations.emplace_back();
    tinygltf::Animation& animation = model.animations[0];
    tinygltf::AnimationSampler sampler;
    sampler.input = input;
    sampler.output = output;
    sampler.interpolation = "LINEAR";
    animation.samplers.push_back(sampler);
    tinygltf::AnimationChannel channel;
    channel.sampler = int(animation.samplers.size()) - 1;
    channel.target_node = node;
    channel.target_path = path;
    animation.channels.push_back(channel);
}

int GlbBuilder::add_node(const std::string& name, const Placement& at) {
    tinygltf::Model& model = m_impl->model;
    tinygltf::Node node;
    node.name = name;
    node.translation = numbers(at.translation);
    node.rotation = {at.rotation.x, at.rotation.y, at.rotation.z, at.rotation.w};
    node.scale = {at.scale, at.scale, at.scale};
    const int index = int(model.nodes.size());
    model.nodes.push_back(node);
    (at.parent < 0 ? model.scenes[0].nodes : model.nodes[at.parent].children).push_back(index);
    return index;
}

int GlbBuilder::add_material(const Material& material) {
    tinygltf::Material out;
    out.name = material.name;
    out.pbrMetallicRoughness.baseColorFactor = numbers(material.base_color);
    out.pbrMetallicRoughness.baseColorFactor.push_back(1.0);
    out.pbrMetallicRoughness.metallicFactor = 0.0;
    Value::Object params, extras{{"shader", Value(material.shader)}};
    for (const auto& [name, components] : material.params) params[name] = value(components);
    if (!params.empty()) extras["params"] = Value(params);
    out.extras = Value(extras);
    m_impl->model.materials.push_back(out);
    return int(m_impl->model.materials.size()) - 1;
}

int GlbBuilder::add_mesh(const std::string& name, const Mesh& mesh, int material,
                         const Deformation& bends) {
    tinygltf::Model& model = m_impl->model;
    constexpr int real = TINYGLTF_COMPONENT_TYPE_FLOAT, vertices = TINYGLTF_TARGET_ARRAY_BUFFER;
    tinygltf::Primitive primitive;
    primitive.mode = TINYGLTF_MODE_TRIANGLES;
    primitive.material = material;
    const int positions = m_impl->add_accessor(mesh.P, real, TINYGLTF_TYPE_VEC3, vertices);
    m_impl->set_bounds(positions, mesh.P);
    primitive.attributes["POSITION"] = positions;
    primitive.attributes["NORMAL"] =
        m_impl->add_accessor(mesh.N, real, TINYGLTF_TYPE_VEC3, vertices);
    if (mesh.has_uv())
        primitive.attributes["TEXCOORD_0"] =
            m_impl->add_accessor(mesh.uv, real, TINYGLTF_TYPE_VEC2, vertices);
    const auto* corners = reinterpret_cast<const std::uint32_t*>(mesh.triangles.data());
    primitive.indices = m_impl->add_accessor(
        std::vector<std::uint32_t>(corners, corners + 3 * mesh.triangles.size()),
        TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT, TINYGLTF_TYPE_SCALAR,
        TINYGLTF_TARGET_ELEMENT_ARRAY_BUFFER);
    if (bends.influences.count == 4) {
        const std::size_t count = mesh.P.size();
        const auto* joints = reinterpret_cast<const glm::u16vec4*>(bends.influences.joint.data());
        const auto* weights = reinterpret_cast<const glm::vec4*>(bends.influences.weight.data());
        primitive.attributes["JOINTS_0"] = m_impl->add_accessor(
            std::vector<glm::u16vec4>(joints, joints + count),
            TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT, TINYGLTF_TYPE_VEC4, vertices);
        primitive.attributes["WEIGHTS_0"] = m_impl->add_accessor(
            std::vector<glm::vec4>(weights, weights + count), real, TINYGLTF_TYPE_VEC4, vertices);
    }
    tinygltf::Mesh out;
    for (const MorphTarget& target : bends.targets) {
        const int moved = m_impl->add_accessor(target.P, real, TINYGLTF_TYPE_VEC3, vertices);
        m_impl->set_bounds(moved, target.P);
        primitive.targets.push_back(
            {{"POSITION", moved},
             {"NORMAL", m_impl->add_accessor(target.N, real, TINYGLTF_TYPE_VEC3, vertices)}});
        out.weights.push_back(0.0);
    }
    out.name = name;
    out.primitives.push_back(primitive);
    model.meshes.push_back(out);
    return int(model.meshes.size()) - 1;
}

int GlbBuilder::add_object(const std::string& name, int mesh, const Placement& placement) {
    const int node = add_node(name, placement);
    m_impl->model.nodes[node].mesh = mesh;
    return node;
}

int GlbBuilder::add_camera(const std::string& name, double yfov, const Placement& placement) {
    tinygltf::Model& model = m_impl->model;
    tinygltf::Camera camera;
    camera.name = name;
    camera.type = "perspective";
    camera.perspective.yfov = yfov;
    camera.perspective.aspectRatio = 16.0 / 9.0;
    camera.perspective.znear = 0.01;
    camera.perspective.zfar = 1000.0;  // written as 0 if left out, which other readers believe
    model.cameras.push_back(camera);
    const int node = add_node(name, placement);
    model.nodes[node].camera = int(model.cameras.size()) - 1;
    return node;
}

int GlbBuilder::add_lamp(const Lamp& lamp, const Placement& placement) {
    tinygltf::Model& model = m_impl->model;
    tinygltf::Light light;
    light.name = lamp.name;
    light.type = lamp.type;
    light.color = numbers(lamp.color);
    light.intensity = lamp.intensity;
    light.spot.innerConeAngle = lamp.inner_cone;
    light.spot.outerConeAngle = lamp.outer_cone;
    if (!lamp.shadow) light.extras = Value(Value::Object{{"shadow", Value(false)}});
    model.lights.push_back(light);
    const int node = add_node(lamp.name, placement);
    model.nodes[node].extensions["KHR_lights_punctual"] =
        Value(Value::Object{{"light", Value(int(model.lights.size()) - 1)}});
    return node;
}

void GlbBuilder::add_skin(int node, const std::vector<int>& joints,
                          const std::vector<glm::mat4>& rest) {
    std::vector<glm::mat4> joint_from_rest;
    for (const glm::mat4& m : rest) joint_from_rest.push_back(glm::inverse(m));
    tinygltf::Skin skin;
    skin.joints = joints;
    skin.inverseBindMatrices =
        m_impl->add_accessor(joint_from_rest, TINYGLTF_COMPONENT_TYPE_FLOAT, TINYGLTF_TYPE_MAT4, 0);
    m_impl->model.skins.push_back(skin);
    m_impl->model.nodes[node].skin = int(m_impl->model.skins.size()) - 1;
}

void GlbBuilder::animate_rotation(int node, const std::vector<float>& times,
                                  const std::vector<glm::quat>& values) {
    std::vector<glm::vec4> xyzw;  // glTF's order; glm's own depends on a macro
    for (const glm::quat& q : values) xyzw.emplace_back(q.x, q.y, q.z, q.w);
    const int input = m_impl->add_times(times);
    const int output =
        m_impl->add_accessor(xyzw, TINYGLTF_COMPONENT_TYPE_FLOAT, TINYGLTF_TYPE_VEC4, 0);
    m_impl->animate(node, "rotation", input, output);
}

void GlbBuilder::animate_translation(int node, const std::vector<float>& times,
                                     const std::vector<glm::vec3>& values) {
    const int input = m_impl->add_times(times);
    const int output =
        m_impl->add_accessor(values, TINYGLTF_COMPONENT_TYPE_FLOAT, TINYGLTF_TYPE_VEC3, 0);
    m_impl->animate(node, "translation", input, output);
}

void GlbBuilder::animate_weights(int node, const std::vector<float>& times,
                                 const std::vector<float>& values) {
    const int input = m_impl->add_times(times);
    const int output =
        m_impl->add_accessor(values, TINYGLTF_COMPONENT_TYPE_FLOAT, TINYGLTF_TYPE_SCALAR, 0);
    m_impl->animate(node, "weights", input, output);
}

void GlbBuilder::set_ambient(const glm::dvec3& ambient) {
    m_impl->model.scenes[0].extras = Value(Value::Object{{"ambient", value(numbers(ambient))}});
}

void GlbBuilder::write(const std::string& path) const {
    PendingFile pending(path);
    std::ostringstream file;
    constexpr bool pretty = false, binary = true;
    tinygltf::TinyGLTF writer;
    const bool written = writer.WriteGltfSceneToStream(&m_impl->model, file, pretty, binary);
    if (!written || !file) throw Error(path + ": cannot be made", ExitStatus::failed);
    pending.write(file.view());
    pending.commit();
}

}  // namespace estara::examples
