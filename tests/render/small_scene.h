// Scenes made in code.
#pragma once

#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <string>

#include "../text_of.h"
#include "estara/scenes/error.h"
#include "estara/scenes/scene.h"

namespace estara::test {

/// A sphere around 0 of `segments` by `2 segments` quads, smooth.
inline Mesh sphere(float radius, int segments = 24) {
    Mesh mesh;
    const float pi = 3.14159265f;
    for (int i = 0; i <= segments; ++i) {
        for (int j = 0; j < 2 * segments; ++j) {
            const float theta = pi * float(i) / float(segments);
            const float phi = pi * float(j) / float(segments);
            const glm::vec3 n(std::sin(theta) * std::cos(phi), std::cos(theta),
                              -std::sin(theta) * std::sin(phi));
            mesh.P.push_back(radius * n);
            mesh.N.push_back(n);
        }
    }
    const auto at = [&](int i, int j) { return unsigned(i * 2 * segments + j % (2 * segments)); };
    for (int i = 0; i < segments; ++i) {
        for (int j = 0; j < 2 * segments; ++j) {
            mesh.triangles.push_back({at(i, j), at(i + 1, j), at(i + 1, j + 1)});
            mesh.triangles.push_back({at(i, j), at(i + 1, j + 1), at(i, j + 1)});
        }
    }
    return mesh;
}

/// An object that wears `shader`, or nothing for "".
inline Object object(const std::string& name, Mesh mesh, const std::string& shader = "",
                     std::vector<Setting> settings = {}) {
    Object made;
    made.name = made.mesh_name = name;
    made.mesh = std::move(mesh);
    made.choice = {shader, settings, "test.glb: material \"" + name + "\""};
    if (shader.empty()) {
        const Setting color{"Cs", {0.5f, 0.5f, 0.5f}};
        made.shader = bind_shader("plastic", std::span(&color, 1), false).shader;
    } else {
        made.shader = bind_choice(made.choice, made.mesh.has_uv());
    }
    return made;
}

/// The objects at the world's origin, a camera "main" at (0, 0, 4) that looks at it, ambient
/// light 1.
inline Scene scene_of(std::vector<Object> objects) {
    Scene scene;
    scene.path = "test.glb";
    scene.nodes.emplace_back();
    Node eye;
    eye.translation = {0.0f, 0.0f, 4.0f};
    scene.nodes.push_back(eye);
    for (std::size_t i = 0; i < objects.size(); ++i) scene.instances.push_back({int(i), 0});
    scene.objects = std::move(objects);
    scene.cameras.push_back({"main", 1, 0.8f});
    scene.ambient = glm::vec3(1.0f);
    return scene;
}

/// A directional light along `direction` of Cl = 1 (683 lux are 1 W/m^2 here).
inline void add_sun(Scene& scene, const glm::quat& rotation) {
    Node node;
    node.rotation = rotation;
    scene.nodes.push_back(node);
    SceneLight sun;
    sun.name = "sun";
    sun.type = LightType::directional;
    sun.node = int(scene.nodes.size()) - 1;
    sun.intensity = 683.0f * 3.14159265f;
    scene.lights.push_back(sun);
}

/// A new empty folder, removed at the end.
class Folder {
public:
    Folder() {
        std::string name =
            (std::filesystem::temp_directory_path() / "estara-render-XXXXXX").string();
        if (mkdtemp(name.data()) == nullptr) throw std::runtime_error("no temporary folder");
        m_path = name;
    }
    ~Folder() {
        std::error_code ignored;
        std::filesystem::permissions(m_path, std::filesystem::perms::owner_all, ignored);
        std::filesystem::remove_all(m_path, ignored);
    }
    Folder(const Folder&) = delete;
    Folder& operator=(const Folder&) = delete;
    std::string operator/(const std::string& name) const { return (m_path / name).string(); }

private:
    std::filesystem::path m_path;
};

/// What an Error says, or "no error".
template <class Body>
std::string error_of(Body body) {
    try {
        body();
    } catch (const Error& error) {
        return error.what();
    }
    return "no error";
}

}  // namespace estara::test
