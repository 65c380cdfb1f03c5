// The parts of the glTF reader. Private to this folder.
//
// tinygltf takes the file apart and checks almost no index; every one is checked here before it is
// followed. `where` is what a message begins with: 'scene.glb: mesh "vase"'.
#pragma once

#include <tiny_gltf.h>

#include <cstdint>
#include <string>
#include <tuple>
#include <vector>

#include "loaders.h"

namespace estara {

/// Parses the file and what it refers to, but images. Error if it is not glTF 2.0, is truncated,
/// or requires an extension that this does not read.
tinygltf::Model parse_gltf(const std::string& path, bool allow_outside,
                           std::vector<std::string>& warnings);

/// 'mesh "vase"', or 'mesh 3' for one without a name.
std::string gltf_name(const char* kind, const std::string& name, std::size_t index);

/// Element i of a list that the file refers to by number. Error if it is not there.
template <class T>
const T& gltf_element(const std::vector<T>& list, int i, const std::string& where,
                      const char* what);
[[noreturn]] void fail_no_element(const std::string& where, const char* what, int i,
                                  std::size_t count);

/// An accessor's values as floats, `components` for each of its elements; integers are scaled to
/// [0, 1] or [-1, 1] if it is normalised. Error if they are not of that many components, not all
/// in the buffer, or not all finite.
std::vector<float> read_floats(const tinygltf::Model& model, int accessor, int components,
                               const std::string& where);

/// An accessor's values as indices.
std::vector<std::uint32_t> read_indices(const tinygltf::Model& model, int accessor,
                                        const std::string& where);

/// Whether a primitive is made of triangles, not of points or lines.
bool has_triangles(const tinygltf::Primitive& primitive);

/// A primitive of triangles, with the vertices it uses only, and how they bend: into the object.
void read_primitive(const tinygltf::Model& model, const tinygltf::Primitive& primitive,
                    const std::string& where, Object& object);

/// How a primitive's vertices bend; each of its arrays is of that many.
Deformation read_deformation(const tinygltf::Model& model, const tinygltf::Primitive& primitive,
                             std::size_t vertices, const std::string& where);

/// @param ours  index into scene.nodes by index in the file; -1 for nodes that are not shown
Skin read_skin(const tinygltf::Model& model, int index, const std::vector<int>& ours,
               const std::string& path);

/// Error if an object's vertices follow joints that a skin does not have.
void check_joints(const Object& object, const Skin& skin, const std::string& where);

/// KHR_node_visibility: whether a node hides itself and all below it.
bool is_hidden(const tinygltf::Node& node);

/// EXT_mesh_gpu_instancing: nodes to hang below one, each of which shows its mesh; none without.
std::vector<Node> instances_of_node(const tinygltf::Model& model, const tinygltf::Node& node,
                                    const std::string& where);

/// What a node does to quantised positions to make them those of its mesh.
///
/// KHR_mesh_quantization: positions are integers, and a node brings them back to size. Patterns are
/// painted in object space, so that this belongs into the mesh: the node's scale, if it is not
/// animated, and its translation, if it does not turn or move (exporters give the node of a
/// quantised mesh both).
struct Dequantization {
    glm::vec3 scale{1.0f}, translation{0.0f};
    bool is_identity() const noexcept {
        return scale == glm::vec3(1.0f) && translation == glm::vec3(0.0f);
    }
    bool operator<(const Dequantization& b) const noexcept {
        const auto key = [](const Dequantization& d) {
            return std::tie(d.scale.x, d.scale.y, d.scale.z, d.translation.x, d.translation.y,
                            d.translation.z);
        };
        return key(*this) < key(b);
    }
};
/// @param ours  the node as it has been read, with its keys
Dequantization dequantization_of(const tinygltf::Model& model, const tinygltf::Node& node,
                                 const Node& ours);
void dequantize(Object& object, const Dequantization& how);

/// What a material says: the shader and the colour. An index of -1 is no material.
void read_material(const tinygltf::Model& model, int index, const std::string& where,
                   Object& object, std::vector<std::string>& warnings);

/// Warns of a shader that is named where none is looked for.
void warn_of_shader(const std::string& extras, const std::string& where,
                    std::vector<std::string>& warnings);

/// The scene's extras "ambient" and "fps", if it has them.
std::optional<glm::vec3> read_ambient(const tinygltf::Scene& scene, const std::string& where);
std::optional<double> read_fps(const tinygltf::Scene& scene, const std::string& where);

/// Puts the key frames into the nodes.
/// @param ours  index into scene.nodes by index in the file; -1 for nodes that are not shown
void read_animations(const tinygltf::Model& model, const std::vector<int>& ours, Scene& scene);

template <class T>
const T& gltf_element(const std::vector<T>& list, int i, const std::string& where,
                      const char* what) {
    if (i < 0 || std::size_t(i) >= list.size()) fail_no_element(where, what, i, list.size());
    return list[std::size_t(i)];
}

}  // namespace estara
