// Scenes made by hand for the tests of rays.
#pragma once

#include <glm/glm.hpp>
#include <glm/gtc/quaternion.hpp>

#include <numbers>
#include <random>
#include <vector>

#include "estara/scenes/scene.h"

namespace estara::test {

/// A scene of objects without shaders; instance i is object i under matrices[i].
inline Scene scene_of(const std::vector<Mesh>& meshes, const std::vector<glm::mat4>& matrices) {
    Scene scene;
    scene.path = "by hand";
    for (std::size_t i = 0; i < meshes.size(); ++i) {
        Object object;
        object.name = "object" + std::to_string(i);
        object.mesh = meshes[i];
        scene.objects.push_back(object);
        Node node;
        node.matrix = matrices[i];
        scene.nodes.push_back(node);
        scene.instances.push_back({int(i), int(i)});
    }
    return scene;
}

/// Instances at matrices; nothing bends.
inline Pose pose_of(const std::vector<glm::mat4>& matrices) {
    return {matrices, matrices, std::vector<std::shared_ptr<const BentMesh>>(matrices.size()),
            glm::dvec3(0.0)};
}

/// A sphere of radius 1 without its texture seam: rows x 2 rows quads between the poles.
inline Mesh ball(int rows) {
    Mesh mesh;
    const int columns = 2 * rows;
    constexpr double pi = std::numbers::pi;
    for (int j = 1; j < rows; ++j)
        for (int i = 0; i < columns; ++i) {
            const double up = pi * j / rows, around = 2.0 * pi * i / columns;
            mesh.P.emplace_back(std::sin(up) * std::cos(around), std::cos(up),
                                std::sin(up) * std::sin(around));
        }
    const auto north = glm::uint(mesh.P.size()), south = north + 1;
    mesh.P.emplace_back(0, 1, 0);
    mesh.P.emplace_back(0, -1, 0);
    const auto at = [&](int j, int i) { return glm::uint((j - 1) * columns + i % columns); };
    for (int i = 0; i < columns; ++i) {
        mesh.triangles.emplace_back(north, at(1, i + 1), at(1, i));
        mesh.triangles.emplace_back(south, at(rows - 1, i), at(rows - 1, i + 1));
        for (int j = 1; j < rows - 1; ++j) {
            mesh.triangles.emplace_back(at(j, i), at(j, i + 1), at(j + 1, i + 1));
            mesh.triangles.emplace_back(at(j, i), at(j + 1, i + 1), at(j + 1, i));
        }
    }
    return mesh;
}

/// A box of twelve triangles around the origin.
inline Mesh box(const glm::vec3& half) {
    Mesh mesh;
    for (int i = 0; i < 8; ++i)
        mesh.P.push_back(half * glm::vec3(i & 1 ? 1 : -1, i & 2 ? 1 : -1, i & 4 ? 1 : -1));
    mesh.triangles = {{0, 4, 6}, {0, 6, 2}, {1, 3, 7}, {1, 7, 5}, {0, 1, 5}, {0, 5, 4},
                      {2, 6, 7}, {2, 7, 3}, {0, 2, 3}, {0, 3, 1}, {4, 5, 7}, {4, 7, 6}};
    return mesh;
}

/// A rectangle in the plane z = 0 that faces +z.
inline Mesh panel(float half_width, float half_height) {
    Mesh mesh;
    mesh.P = {{-half_width, -half_height, 0},
              {half_width, -half_height, 0},
              {half_width, half_height, 0},
              {-half_width, half_height, 0}};
    mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
    return mesh;
}

inline glm::mat4 transform(const glm::vec3& translation, const glm::quat& rotation,
                           const glm::vec3& scale) {
    glm::mat4 m = glm::mat4_cast(rotation);
    for (int c = 0; c < 3; ++c) m[c] *= scale[c];
    m[3] = glm::vec4(translation, 1.0f);
    return m;
}

inline glm::quat slanted() {
    return glm::angleAxis(0.9f, glm::normalize(glm::vec3(1.0f, 2.0f, -0.5f)));
}

/// Random numbers, the same in every run and with every standard library.
class Random {
public:
    /// Uniform in [0, 1).
    double unit() { return double(m_engine() >> 11) * 0x1p-53; }
    double between(double low, double high) { return low + (high - low) * unit(); }
    glm::dvec3 direction() {
        for (;;) {
            const glm::dvec3 v(between(-1, 1), between(-1, 1), between(-1, 1));
            const double length = glm::length(v);
            if (length > 0.01 && length < 1.0) return v / length;
        }
    }
    int below(int n) { return int(unit() * n); }

private:
    std::mt19937_64 m_engine{7};
};

}  // namespace estara::test
