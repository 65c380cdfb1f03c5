// What the glTF materials of objects without a shader ask for and this project does not show.
// Private to this folder.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "gltf.h"

namespace estara {

/// Collects features over all objects: a warning for each feature, which names the objects.
class UnshownFeatures {
public:
    /// Notes what an object's material and vertices ask for. Of an object that wears a shader
    /// nothing: the shader takes the material's place.
    /// @param material  of the model; null: none
    void note(const Object& object, const tinygltf::Primitive& primitive,
              const tinygltf::Material* material);

    /// A line for each feature, in alphabetical order.
    std::vector<std::string> lines() const;

private:
    void add(const std::string& feature, const std::string& object);

    std::map<std::string, std::vector<std::string>> m_objects;  ///< by feature, each once
};

}  // namespace estara
