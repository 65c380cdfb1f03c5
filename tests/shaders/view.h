// Looking at a shader in a test: only a class of the name Camera can make a ViewDirection.
#pragma once

#include <glm/glm.hpp>

#include <span>

#include "estara/shaders/batch.h"

namespace estara {

/// Stands for the renderer's camera, which this folder cannot see.
class Camera {
public:
    /// @param v  unit vector towards the eye
    static ViewDirection direction(const glm::vec3& v) { return ViewDirection(v); }
    static void set(ViewDirections& V, int i, const glm::vec3& v) {
        for (int c = 0; c < 3; ++c) V.m_v[c][i] = v[c];
    }
};

namespace test {

/// Makes point i of a batch the one that is seen so; of several lights the first is taken.
inline void set(SeenBatch& batch, int i, const Seen& seen) {
    Camera::set(batch.V, i, seen.V.vec());
    const Light light = seen.lights.empty() ? Light{{0, 0, 1}, {0, 0, 0}} : seen.lights[0];
    for (int c = 0; c < 3; ++c) {
        batch.N[c][i] = seen.N[c];
        batch.E[c][i] = seen.E[c];
        batch.L[c][i] = light.L[c];
        batch.Cl[c][i] = light.Cl[c];
    }
    batch.A = seen.A;
}

/// A point seen along V with some light on it; N, V and the lights' L are unit vectors.
inline Seen seen(const glm::vec3& N, const glm::vec3& V, std::span<const Light> lights) {
    glm::vec3 E(0.0f);
    for (const Light& light : lights) E += light.Cl * glm::max(0.0f, glm::dot(N, light.L));
    return {N, Camera::direction(V), E, glm::vec3(0.3f, 0.2f, 0.1f), lights};
}

}  // namespace test
}  // namespace estara
