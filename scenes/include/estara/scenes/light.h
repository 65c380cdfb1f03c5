// What a light sends to a point.
#pragma once

#include <glm/glm.hpp>

#include <cmath>
#include <limits>
#include <numbers>

#include "estara/shaders/math.h"

namespace estara {

enum class LightType { directional, point, spot };

/// A light at one time, ready to illuminate.
struct PosedLight {
    LightType type;
    glm::vec3 position;   ///< world; not for directional lights
    glm::vec3 direction;  ///< unit, the way it shines, world
    glm::vec3 color;      ///< color * intensity / 683: watts per steradian (m^2 for directional)
    float range, cos_inner, cos_outer;
    bool shadow = true;  ///< whether what stands in its way matters
};

/// What of a light arrives at a point if nothing is in between.
struct LightSample {
    glm::vec3 L{0.0f};      ///< unit, from the point to the light, world
    float distance = 0.0f;  ///< to the light; infinity for directional lights
    glm::vec3 Cl{0.0f};  ///< irradiance at normal incidence / pi; 0 outside cone and range, and at
                         ///< the light itself
};

/// Share of a spot's light at an angle from its axis: KHR_lights_punctual's formula. Differs: the
/// specification's example code widens a soft edge to 0.001 of cosine, which would dim narrow
/// spots; ours takes it as it is.
ESTARA_KERNEL float cone_share(const PosedLight& light, float cosine) noexcept {
    const float width = light.cos_inner - light.cos_outer;
    const float s = (cosine - light.cos_outer) / (width > 0.0f ? width : 1.0f);
    return cosine <= light.cos_outer ? 0.0f : (cosine >= light.cos_inner ? 1.0f : s * s);
}

/// KHR_lights_punctual, "Range Property". A range of 0 has no limit.
ESTARA_KERNEL float range_window(float distance, float range) noexcept {
    const float q = distance * (1.0f / (range > 0.0f ? range : 1.0f));
    return range > 0.0f ? clamp(1.0f - q * q * q * q, 0.0f, 1.0f) : 1.0f;
}

/// Attenuation as KHR_lights_punctual recommends (inverse square, windowed by range; spot cone).
/// Free of branches on the point, for loops over many.
ESTARA_KERNEL LightSample sample_light(const PosedLight& light, const glm::vec3& point) noexcept {
    constexpr float infinity = std::numeric_limits<float>::infinity();
    constexpr float pi = std::numbers::pi_v<float>;
    const bool directional = light.type == LightType::directional;
    const glm::vec3 to_light = light.position - point;
    const float distance2 = glm::dot(to_light, to_light);
    // At the light itself there is no direction; beyond the float's range there is no light.
    const bool near = (distance2 > std::numeric_limits<float>::min()) & (distance2 < infinity);
    const float square = near ? distance2 : 1.0f;
    const float distance = std::sqrt(square), inverse = 1.0f / distance;
    const glm::vec3 L = to_light * inverse;
    const float cone =
        light.type == LightType::spot ? cone_share(light, -glm::dot(L, light.direction)) : 1.0f;
    const float share = range_window(distance, light.range) * cone * (inverse * inverse / pi);
    const float reaching = directional ? 1.0f / pi : (near ? share : 0.0f);
    LightSample sample;
    sample.L.x = directional ? -light.direction.x : (near ? L.x : 0.0f);
    sample.L.y = directional ? -light.direction.y : (near ? L.y : 0.0f);
    sample.L.z = directional ? -light.direction.z : (near ? L.z : 0.0f);
    sample.distance = directional ? infinity : (near ? distance : 0.0f);
    sample.Cl = light.color * reaching;
    return sample;
}

/// A light as it falls on a side of a surface if nothing is in between.
struct FallingLight {
    glm::vec3 L;   ///< unit, to the light, world
    glm::vec3 Cl;  ///< as LightSample has it; 0 from behind
    float cosine;  ///< <N.L>+
};

/// @param N  unit, world
ESTARA_KERNEL FallingLight falling_light(const PosedLight& light, const glm::vec3& P,
                                         const glm::vec3& N) noexcept {
    const LightSample sample = sample_light(light, P);
    const float cosine = glm::dot(N, sample.L);
    const bool faces = cosine > 0.0f;
    FallingLight falling;  // by component: a vec3 that is copied whole keeps a loop scalar
    falling.L.x = sample.L.x;
    falling.L.y = sample.L.y;
    falling.L.z = sample.L.z;
    falling.Cl.x = faces ? sample.Cl.x : 0.0f;
    falling.Cl.y = faces ? sample.Cl.y : 0.0f;
    falling.Cl.z = faces ? sample.Cl.z : 0.0f;
    falling.cosine = faces ? cosine : 0.0f;
    return falling;
}

}  // namespace estara
