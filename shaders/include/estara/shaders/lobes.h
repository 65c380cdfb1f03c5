// Reflection models of RSL: what view() functions close with.
#pragma once

#include <glm/glm.hpp>

#include <cmath>

#include "estara/shaders/math.h"
#include "estara/shaders/seen.h"

namespace estara {

/// The exponent of RSL's specular() is specular_exponent / roughness. The standard leaves the
/// constant open (1, 8 and 10 are in use); 8 is what PRMan-like renderers take.
inline constexpr float specular_exponent = 8.0f;

/// RSL's specular(): sum over the lights of Cl <N.H>+^(8 / roughness), H the unit half vector.
/// 0 for a light straight behind the eye's ray, where there is no half vector.
/// @param roughness  (0, 1]
ESTARA_KERNEL glm::vec3 specular(const Seen& seen, float roughness) noexcept {
    glm::vec3 sum(0.0f);
    for (std::size_t k = 0; k < seen.lights.size(); ++k) {
        const Light& light = seen.lights[k];
        const glm::vec3 h = light.L + seen.V.vec();
        const float length2 = glm::dot(h, h);
        const float cosine = glm::dot(seen.N, h) / std::sqrt(length2 < 1e-12f ? 1.0f : length2);
        // No more than 1, which rounding may exceed: a power of 8000 would not stay near it.
        const float limited = length2 < 1e-12f ? 0.0f : clamp(cosine, 0.0f, 1.0f);
        sum += light.Cl * power(limited, specular_exponent / roughness);
    }
    return sum;
}

/// Ambient and diffuse reflection of a surface of colour Cd: Cd (Ka A + Kd E).
ESTARA_KERNEL glm::vec3 matte(const glm::vec3& Cd, float Ka, float Kd, const Seen& seen) noexcept {
    return Cd * (Ka * seen.A + Kd * seen.E);
}

/// matte() and a highlight: the closing of most RSL surfaces.
ESTARA_KERNEL glm::vec3 plastic(const glm::vec3& Cd, float Ka, float Kd, float Ks, float roughness,
                                const glm::vec3& specularcolor, const Seen& seen) noexcept {
    return matte(Cd, Ka, Kd, seen) + specularcolor * Ks * specular(seen, roughness);
}

}  // namespace estara
