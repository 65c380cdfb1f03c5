// What tells one scene from another.
#include <fmt/format.h>
#include <xxhash.h>

#include <type_traits>

#include "estara/scenes/scene.h"

namespace estara {
namespace {

class Digest {
public:
    template <class T>
    void add(const T& value) {
        static_assert(std::is_trivially_copyable_v<T>);
        m_bytes.append(reinterpret_cast<const char*>(&value), sizeof value);
    }
    template <class T>
    void add(const std::vector<T>& values) {
        add(values.size());
        m_bytes.append(reinterpret_cast<const char*>(values.data()), values.size() * sizeof(T));
    }
    void add(const std::string& text) {
        add(text.size());
        m_bytes += text;
    }
    template <class T>
    void add(const Track<T>& track) {
        add(int(track.interpolation));
        add(track.times);
        add(track.values);
    }
    std::string text() const {
        return fmt::format("{:016x}", XXH3_64bits(m_bytes.data(), m_bytes.size()));
    }

private:
    std::string m_bytes;
};

void add_node(const Node& node, Digest& to) {
    to.add(node.parent);
    to.add(node.translation);
    to.add(node.rotation);
    to.add(node.scale);
    to.add(node.matrix.value_or(glm::dmat4(0.0)));
    to.add(node.translations);
    to.add(node.rotations);
    to.add(node.scales);
    to.add(node.weights);
    for (const Track<float>& track : node.weight_tracks) to.add(track);
}

void add_object(const Object& object, Digest& to) {
    to.add(mesh_digest(object.mesh));
    to.add(object.shader ? shader_digest(*object.shader) : std::string());
    if (object.shader) to.add(object.shader->values());
    to.add(object.weights);
    to.add(object.bends.influences.joint);
    to.add(object.bends.influences.weight);
    for (const MorphTarget& target : object.bends.targets) {
        to.add(target.P);
        to.add(target.N);
    }
}

}  // namespace

std::string scene_digest(const Scene& scene) {
    Digest digest;
    for (const Node& node : scene.nodes) add_node(node, digest);
    for (const Object& object : scene.objects) add_object(object, digest);
    digest.add(scene.instances);
    for (const Skin& skin : scene.skins) {
        digest.add(skin.joints);
        digest.add(skin.joint_from_rest);
    }
    for (const SceneCamera& camera : scene.cameras) {
        digest.add(camera.node);
        digest.add(camera.yfov);
    }
    for (const SceneLight& light : scene.lights) {
        digest.add(int(light.type));
        digest.add(light.node);
        digest.add(light.color);
        for (const float v : {light.intensity, light.range, light.inner_cone, light.outer_cone}) {
            digest.add(v);
        }
        digest.add(light.shadow);
    }
    digest.add(scene.ambient);
    return digest.text();
}

}  // namespace estara
