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

/// The unit vector half way between two unit vectors; 0 where they are opposite and there is none.
ESTARA_KERNEL glm::vec3 half_vector(const glm::vec3& a, const glm::vec3& b) noexcept {
    const glm::vec3 h = a + b;
    const float length2 = glm::dot(h, h);
    const bool opposite = length2 < 1e-12f;
    return select(opposite, glm::vec3(0.0f), h / std::sqrt(opposite ? 1.0f : length2));
}

/// What a light alone may be wrong by where it is taken to show no highlight, for Cl = 1: far below
/// an 8-bit step, and below the rounding of a half near 1.
inline constexpr float negligible_highlight = 0x1p-20f;

/// The cosine between N and H below which weight * specular() of a light with Cl = 1 is less than
/// negligible_highlight: most of a surface, for which a highlight need not be evaluated.
/// @param roughness  (0, 1]
/// @param weight     largest component, >= 0
/// @return [0, 1], or 2 for a weight so small that there never is a highlight
ESTARA_KERNEL float highlight_edge(float roughness, float weight) noexcept {
    const float share = negligible_highlight / (weight > 0.0f ? weight : 1.0f);
    const bool ever = weight > negligible_highlight;
    return ever ? exp2_kernel(log2_kernel(share) * roughness / specular_exponent) : 2.0f;
}

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

/// What the boundary of two media does to light that crosses it.
struct Fresnel {
    float Kr;     ///< share that is reflected, [0, 1]
    float Kt;     ///< 1 - Kr
    glm::vec3 T;  ///< direction behind the boundary, unit; 0 on total reflection
};

/// RSL's fresnel() of unpolarised light, without the reflected direction (Cook & Torrance 1982, "A
/// Reflectance Model for Computer Graphics", section 3, with its two summands written out).
/// @param I    unit vector towards the surface
/// @param N    unit normal on the side that I comes from; where it faces away, I counts as grazing
/// @param eta  index of refraction where the light comes from over that behind the surface, > 0
ESTARA_KERNEL Fresnel fresnel(const glm::vec3& I, const glm::vec3& N, float eta) noexcept {
    const float c = clamp(-glm::dot(I, N), 0.0f, 1.0f), mu = 1.0f / eta;
    const float G2 = mu * mu - 1.0f + c * c;
    const bool total = G2 < 0.0f;
    const float G = std::sqrt(total ? 0.0f : G2);
    // Only mu = 1 and c = 0 make a sum of 0; nothing is reflected at mu = 1.
    const float least = 1e-30f;
    const float s_sum = c + G, p_sum = mu * mu * c + G;
    const float rs = (c - G) / (s_sum > least ? s_sum : least);
    const float rp = (mu * mu * c - G) / (p_sum > least ? p_sum : least);
    const float Kr = total ? 1.0f : clamp(0.5f * (rs * rs + rp * rp), 0.0f, 1.0f);
    // eta G is the cosine behind the boundary: eta^2 G^2 = 1 - eta^2 (1 - c^2).
    const glm::vec3 T = eta * I + (eta * c - eta * G) * N;
    return {Kr, 1.0f - Kr, select(total, glm::vec3(0.0f), T)};
}

/// Phase function of Henyey & Greenstein 1941, "Diffuse Radiation in the Galaxy", without the
/// 1 / 4 pi: its mean over the sphere is 1.
/// @param cosine  between the directions before and after, [-1, 1]; 1 is straight on
/// @param g       mean of the cosine, (-1, 1); at least a thousandth off the ends
ESTARA_KERNEL float henyey_greenstein(float cosine, float g) noexcept {
    const float d = 1.0f + g * g - 2.0f * g * clamp(cosine, -1.0f, 1.0f);
    return (1.0f - g * g) / (d * std::sqrt(d));
}

/// Light that is scattered once in a homogeneous layer and leaves it on the side it came in by
/// (Hanrahan & Krueger 1993, "Reflection from Layered Surfaces due to Subsurface Scattering", the
/// backscattered first-order term, with the 1 / 4 pi left out as in RenderMan's skin shaders).
/// @param wi, wo     unit directions in the layer: of the light, and of the eye's ray, both inwards
/// @param g          see henyey_greenstein()
/// @param albedo     [0, 1]
/// @param thickness  of the layer, in mean free paths, >= 0
ESTARA_KERNEL float single_scatter(const glm::vec3& wi, const glm::vec3& wo, const glm::vec3& n,
                                   float g, float albedo, float thickness) noexcept {
    // A direction in the layer's plane never leaves it: the limit is finite, the division not.
    const float least = 1e-4f;
    const float ci = std::fabs(glm::dot(wi, n)), co = std::fabs(glm::dot(wo, n));
    const float i = ci > least ? ci : least, o = co > least ? co : least;
    const float lost = exp_kernel(-thickness * (1.0f / i + 1.0f / o));
    return albedo * henyey_greenstein(-glm::dot(wo, wi), g) / (i + o) * (1.0f - lost);
}

/// Anisotropic highlight: the sum over the lights before the surface of
/// Cl c_i exp(-2 ((X.H)^2 + (Y.H)^2) / (1 + H.N)) / (4 a_x a_y sqrt(c_i c_r)) (Ward 1992,
/// "Measuring and Modeling Anisotropic Reflection", Eq. 5b, times pi because Cl has its 1 / pi).
/// @param x, y      unit tangents, orthogonal
/// @param a_x, a_y  width of the highlight along them, (0, 1]: standard deviation of the slope
ESTARA_KERNEL glm::vec3 ward(const Seen& seen, const glm::vec3& x, const glm::vec3& y, float a_x,
                             float a_y) noexcept {
    const float cr = clamp(glm::dot(seen.N, seen.V.vec()), 1e-4f, 1.0f);
    glm::vec3 sum(0.0f);
    for (std::size_t k = 0; k < seen.lights.size(); ++k) {
        const Light& light = seen.lights[k];
        const float ci = clamp(glm::dot(seen.N, light.L), 0.0f, 1.0f);
        const glm::vec3 H = half_vector(light.L, seen.V.vec());
        const float X = glm::dot(x, H) / a_x, Y = glm::dot(y, H) / a_y;
        const float above = 1.0f + glm::dot(H, seen.N);
        const float lobe = exp_kernel(-2.0f * (X * X + Y * Y) / (above > 1e-4f ? above : 1e-4f));
        // c_i / sqrt(c_i c_r), written so that nothing is divided by c_i = 0.
        sum += light.Cl * (lobe * std::sqrt(ci / cr));
    }
    return sum * (0.25f / (a_x * a_y));
}

}  // namespace estara
