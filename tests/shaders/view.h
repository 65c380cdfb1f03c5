// Looking at a shader in a test: only a class of the name Camera can make a ViewDirection.
#pragma once

#include <glm/glm.hpp>

#include <span>

#include "estara/shaders/seen.h"

namespace estara {

/// Stands for the renderer's camera, which this folder cannot see.
class Camera {
public:
    /// @param v  unit vector towards the eye
    static ViewDirection direction(const glm::vec3& v) { return ViewDirection(v); }
};

namespace test {

/// A point seen along V with some light on it; N, V and the lights' L are unit vectors.
inline Seen seen(const glm::vec3& N, const glm::vec3& V, std::span<const Light> lights) {
    glm::vec3 E(0.0f);
    for (const Light& light : lights) E += light.Cl * glm::max(0.0f, glm::dot(N, light.L));
    return {N, Camera::direction(V), E, glm::vec3(0.3f, 0.2f, 0.1f), lights};
}

}  // namespace test
}  // namespace estara
