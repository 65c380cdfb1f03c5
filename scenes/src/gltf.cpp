// glTF 2.0: nodes, objects, cameras and lights of the file's scene.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>

#include "gltf.h"
#include "gltf_unshown.h"

namespace estara {
namespace {

class GltfReader {
public:
    GltfReader(const std::string& path, bool allow_outside) {
        m_scene.path = path;
        m_model = parse_gltf(path, allow_outside, m_scene.warnings);
    }

    Scene run() {
        read_nodes();
        read_animations(m_model, m_ours, m_scene);
        for (std::size_t i = 0; i < m_model.nodes.size(); ++i) {
            if (m_ours[i] >= 0) read_contents(m_model.nodes[i], i, m_ours[i]);
        }
        tell_left_out();
        if (m_scene.instances.empty()) fail("no triangles; the scene shows no mesh");
        add_what_is_missing();
        return std::move(m_scene);
    }

private:
    [[noreturn]] void fail(const std::string& what) const {
        throw Error(fmt::format("{}: {}", m_scene.path, what));
    }
    void warn(const std::string& what) {
        m_scene.warnings.push_back(fmt::format("{}: {}", m_scene.path, what));
    }
    std::string at(const char* kind, const std::string& name, std::size_t index) const {
        return fmt::format("{}: {}", m_scene.path, gltf_name(kind, name, index));
    }

    // --- nodes ---

    /// The nodes that no other has for a child, or those that the file's scene names.
    std::vector<int> roots() const {
        if (!m_model.scenes.empty()) {
            const int shown = m_model.defaultScene == -1 ? 0 : m_model.defaultScene;
            return gltf_element(m_model.scenes, shown, m_scene.path, "scene").nodes;
        }
        std::vector<bool> is_child(m_model.nodes.size(), false);
        for (const tinygltf::Node& node : m_model.nodes) {
            for (const int child : node.children) {
                if (child >= 0 && std::size_t(child) < is_child.size()) {
                    is_child[std::size_t(child)] = true;
                }
            }
        }
        std::vector<int> found;
        for (std::size_t i = 0; i < is_child.size(); ++i) {
            if (!is_child[i]) found.push_back(int(i));
        }
        if (found.empty() && !m_model.nodes.empty()) fail("its nodes are their own descendants");
        return found;
    }

    /// Parents before children, with a stack of our own: a hierarchy may be deep.
    void read_nodes() {
        m_ours.assign(m_model.nodes.size(), -1);
        struct Step {
            int node, parent;
        };
        std::vector<Step> steps;
        const std::vector<int> first = roots();
        for (auto i = first.rbegin(); i != first.rend(); ++i) steps.push_back({*i, -1});
        while (!steps.empty()) {
            const Step step = steps.back();
            steps.pop_back();
            const std::size_t index = std::size_t(step.node);
            const tinygltf::Node& node =
                gltf_element(m_model.nodes, step.node, m_scene.path, "node");
            if (m_ours[index] >= 0) {
                fail(fmt::format("{} has two parents or is its own descendant",
                                 gltf_name("node", node.name, index)));
            }
            m_ours[index] = int(m_scene.nodes.size());
            const bool below_hidden = step.parent >= 0 && m_hidden[std::size_t(step.parent)];
            m_scene.nodes.push_back(read_node(node, index, step.parent));
            m_hidden.push_back(below_hidden || is_hidden(node));
            for (auto i = node.children.rbegin(); i != node.children.rend(); ++i) {
                steps.push_back({*i, m_ours[index]});
            }
        }
    }

    /// Numbers of a property that may be left out; the result is empty then.
    template <class T = float>
    std::vector<T> property(const std::vector<double>& values, std::size_t count, const char* name,
                            const std::string& where) const {
        if (!values.empty() && values.size() != count) {
            throw Error(fmt::format("{}: {} numbers in \"{}\"; it needs {}", where, values.size(),
                                    name, count));
        }
        std::vector<T> result;
        for (const double value : values) {
            result.push_back(T(value));
            if (!std::isfinite(float(value))) {
                throw Error(fmt::format("{}: \"{}\" is not finite", where, name));
            }
        }
        return result;
    }

    Node read_node(const tinygltf::Node& from, std::size_t index, int parent) const {
        const std::string where = at("node", from.name, index);
        Node node;
        node.name = from.name.empty() ? fmt::format("node_{}", index) : from.name;
        node.parent = parent;
        node.weights = property(from.weights, from.weights.size(), "weights", where);
        const auto matrix = property<double>(from.matrix, 16, "matrix", where);
        if (!matrix.empty()) {
            node.matrix = glm::dmat4(0.0);
            for (int k = 0; k < 16; ++k) (*node.matrix)[k / 4][k % 4] = matrix[std::size_t(k)];
            return node;
        }
        const auto t = property<double>(from.translation, 3, "translation", where);
        const auto r = property(from.rotation, 4, "rotation", where);
        const auto s = property(from.scale, 3, "scale", where);
        if (!t.empty()) node.translation = {t[0], t[1], t[2]};
        if (!s.empty()) node.scale = {s[0], s[1], s[2]};
        if (!r.empty()) {
            node.rotation = glm::quat(r[3], r[0], r[1], r[2]);
            const float length = glm::length(node.rotation);
            if (!(length > 0.0f)) throw Error(fmt::format("{}: \"rotation\" is zero", where));
            node.rotation = node.rotation / length;
        }
        return node;
    }

    // --- what hangs on them ---

    void read_contents(const tinygltf::Node& node, std::size_t index, int ours) {
        if (node.camera != -1) read_camera(node.camera, ours);
        if (m_hidden[std::size_t(ours)]) return;
        if (node.mesh != -1) read_mesh(node, index, ours);
        const auto light = node.extensions.find("KHR_lights_punctual");
        if (light == node.extensions.end()) return;
        const tinygltf::Value& number = light->second.Get("light");
        read_light(number.IsInt() ? number.GetNumberAsInt() : -1, ours);
    }

    void read_mesh(const tinygltf::Node& node, std::size_t index, int ours) {
        warn_of_shader(node.extras_json_string, at("node", node.name, index), m_scene.warnings);
        (void)gltf_element(m_model.meshes, node.mesh, m_scene.path, "mesh");
        const Dequantization how =
            dequantization_of(m_model, node, m_scene.nodes[std::size_t(ours)]);
        const int skin = skin_of(node);
        const std::vector<int>& objects = objects_of(node.mesh, how);
        for (const int place : places_of(node, index, ours, how)) {
            for (const int object : objects) {
                const bool follows = skin >= 0 && check_skin(object, skin);
                m_scene.instances.push_back({object, place, follows ? skin : -1});
            }
        }
    }

    /// The nodes that show a node's mesh: itself, or one below it for each of its instances, or one
    /// that takes back what the mesh has been dequantised with.
    std::vector<int> places_of(const tinygltf::Node& node, std::size_t index, int ours,
                               const Dequantization& how) {
        std::vector<Node> below = instances_of_node(m_model, node, at("node", node.name, index));
        const bool is_instanced = node.extensions.contains("EXT_mesh_gpu_instancing");
        if (!is_instanced && how.is_identity()) return {ours};
        if (!is_instanced) below.resize(1);
        std::vector<int> places;
        for (Node& one : below) {
            one.parent = ours;
            one.name = m_scene.nodes[std::size_t(ours)].name;
            one.weights = m_scene.nodes[std::size_t(ours)].weights;
            one.weight_tracks = m_scene.nodes[std::size_t(ours)].weight_tracks;
            places.push_back(int(m_scene.nodes.size()));
            m_scene.nodes.push_back(std::move(one));
            if (how.is_identity()) continue;
            Node back;
            back.parent = places.back();
            back.name = m_scene.nodes.back().name;
            back.weights = m_scene.nodes.back().weights;
            back.weight_tracks = m_scene.nodes.back().weight_tracks;
            glm::dmat4 there(1.0);
            for (int c = 0; c < 3; ++c) there[c][c] = 1.0 / double(how.scale[c]);
            there[3] = glm::dvec4(-glm::dvec3(how.translation) / glm::dvec3(how.scale), 1.0);
            back.matrix = there;
            places.back() = int(m_scene.nodes.size());
            m_scene.nodes.push_back(std::move(back));
        }
        return places;
    }

    /// Index into m_scene.skins of a node's skin, read once however many nodes have it; or -1.
    int skin_of(const tinygltf::Node& node) {
        if (node.skin == -1) return -1;
        const auto [place, is_new] = m_skins.try_emplace(node.skin, int(m_scene.skins.size()));
        if (is_new) {
            m_scene.skins.push_back(read_skin(m_model, node.skin, m_ours, m_scene.path));
        }
        return place->second;
    }

    /// Whether an object follows the joints of a skin. Error if these are not all there.
    bool check_skin(int index, int skin) {
        const Object& object = m_scene.objects[std::size_t(index)];
        const std::string mesh = fmt::format("mesh \"{}\"", one_line(object.mesh_name));
        if (object.bends.influences.count == 0) {
            warn(mesh + ": its node has a skin, but its vertices follow no joints; shown without");
            return false;
        }
        check_joints(object, m_scene.skins[std::size_t(skin)], m_scene.path + ": " + mesh);
        return true;
    }

    /// The objects that a mesh makes, one for each of its primitives of triangles; made once,
    /// however many nodes show the mesh.
    const std::vector<int>& objects_of(int mesh_index, const Dequantization& how) {
        const auto [place, is_new] = m_objects.try_emplace({mesh_index, how});
        if (!is_new) return place->second;
        const tinygltf::Mesh& mesh = gltf_element(m_model.meshes, mesh_index, m_scene.path, "mesh");
        const std::string where = at("mesh", mesh.name, std::size_t(mesh_index));
        warn_of_shader(mesh.extras_json_string, where, m_scene.warnings);
        for (const tinygltf::Primitive& primitive : mesh.primitives) {
            warn_of_shader(primitive.extras_json_string, where, m_scene.warnings);
            if (!has_triangles(primitive)) {
                ++m_points_and_lines;
                continue;
            }
            if (primitive.attributes.contains("JOINTS_2")) ++m_many_joints;
            Object object;
            object.mesh_name = mesh.name.empty() ? fmt::format("mesh_{}", mesh_index) : mesh.name;
            object.name = object.mesh_name;
            object.weights = property(mesh.weights, mesh.weights.size(), "weights", where);
            read_primitive(m_model, primitive, where, object);
            dequantize(object, how);
            dress(object, primitive, where);
            place->second.push_back(int(m_scene.objects.size()));
            m_scene.objects.push_back(std::move(object));
        }
        return place->second;
    }

    void dress(Object& object, const tinygltf::Primitive& primitive,
               const std::string& mesh_where) {
        const tinygltf::Material* material = nullptr;
        if (primitive.material != -1) {
            const int index = primitive.material;
            material = &gltf_element(m_model.materials, index, mesh_where, "material");
            read_material(m_model, index, at("material", material->name, std::size_t(index)),
                          object, m_scene.warnings);
        }
        m_unshown.note(object, primitive, material);
    }

    void read_camera(int index, int ours) {
        const tinygltf::Camera& from = gltf_element(m_model.cameras, index, m_scene.path, "camera");
        if (from.type != "perspective") {
            ++m_orthographic;
            return;
        }
        const double yfov = from.perspective.yfov;
        if (!(yfov > 0.0 && yfov < std::numbers::pi)) {
            throw Error(fmt::format("{}: \"yfov\" is {}; it must lie between 0 and pi",
                                    at("camera", from.name, std::size_t(index)), yfov));
        }
        const std::string& node_name = m_scene.nodes[std::size_t(ours)].name;
        m_scene.cameras.push_back({from.name.empty() ? node_name : from.name, ours, float(yfov)});
    }

    void read_light(int index, int ours) {
        const tinygltf::Light& from = gltf_element(m_model.lights, index, m_scene.path, "light");
        const std::string where = at("light", from.name, std::size_t(index));
        SceneLight light;
        light.name = from.name.empty() ? m_scene.nodes[std::size_t(ours)].name : from.name;
        light.node = ours;
        if (from.type == "directional") {
            light.type = LightType::directional;
        } else if (from.type == "spot") {
            light.type = LightType::spot;
        } else if (from.type != "point") {
            throw Error(fmt::format("{}: type '{}'; there are directional, point and spot", where,
                                    one_line(from.type)));
        }
        const auto color = property(from.color, 3, "color", where);
        if (!color.empty()) light.color = {color[0], color[1], color[2]};
        light.intensity = property({from.intensity}, 1, "intensity", where).front();
        light.range = property({from.range}, 1, "range", where).front();
        if (light.intensity < 0.0f || light.color.r < 0.0f || light.color.g < 0.0f ||
            light.color.b < 0.0f || light.range < 0.0f) {
            throw Error(fmt::format("{}: color, intensity and range must not be negative", where));
        }
        if (light.type == LightType::spot) read_cone(from.spot, where, light);
        if (from.extras.Has("shadow")) {
            if (!from.extras.Get("shadow").IsBool()) {
                throw Error(fmt::format("{}: extras \"shadow\" must be true or false", where));
            }
            light.shadow = from.extras.Get("shadow").Get<bool>();
        }
        m_scene.lights.push_back(std::move(light));
    }

    void read_cone(const tinygltf::SpotLight& from, const std::string& where, SceneLight& light) {
        const double inner = from.innerConeAngle, outer = from.outerConeAngle;
        // Half a right angle is written with any number of digits.
        constexpr double tolerance = 1e-4;
        if (!(inner >= 0.0 && inner <= outer && outer > 0.0 &&
              outer <= 0.5 * std::numbers::pi + tolerance)) {
            throw Error(
                fmt::format("{}: cone from {} to {}; it must be 0 <= innerConeAngle <= "
                            "outerConeAngle <= pi/2",
                            where, inner, outer));
        }
        light.inner_cone = float(inner);
        light.outer_cone = float(outer);
    }

    // --- and what does not ---

    void tell_left_out() {
        const auto tell = [this](int count, const char* what) {
            if (count > 0) warn(fmt::format("not shown: {} {}", count, what));
        };
        tell(m_points_and_lines, "primitives of points or lines");
        tell(m_many_joints, "primitives' joints beyond eight a vertex");
        tell(m_orthographic, "orthographic cameras");
        for (const std::string& line : m_unshown.lines()) warn(line);
    }

    void add_what_is_missing() {
        const std::string where = m_scene.path + ": scene";
        const std::size_t shown = std::size_t(std::max(m_model.defaultScene, 0));
        std::optional<glm::vec3> ambient;
        if (shown < m_model.scenes.size()) {
            ambient = read_ambient(m_model.scenes[shown], where);
            m_scene.fps = read_fps(m_model.scenes[shown], where);
        }
        m_scene.ambient = ambient.value_or(glm::vec3(0.0f));
        if (m_scene.cameras.empty()) {
            warn("no camera; one that goes round the scene in frames 1-48 is added");
            add_orbit_camera(m_scene);
        }
        if (m_scene.lights.empty() && !ambient) {
            warn("no light; a key and a fill light are added");
            add_studio_lights(m_scene);
            m_scene.ambient = glm::vec3(studio_ambient);
        }
    }

    tinygltf::Model m_model;
    Scene m_scene;
    std::vector<int> m_ours;     ///< our node by the file's; -1: not shown
    std::vector<bool> m_hidden;  ///< by our node, of those in the file
    std::map<std::pair<int, Dequantization>, std::vector<int>> m_objects;  ///< by mesh
    std::map<int, int> m_skins;  ///< index into m_scene.skins by index in the file
    int m_points_and_lines = 0, m_many_joints = 0, m_orthographic = 0;
    UnshownFeatures m_unshown;
};

}  // namespace

Scene read_gltf(const std::string& path, bool allow_outside) {
    return GltfReader(path, allow_outside).run();
}

}  // namespace estara
