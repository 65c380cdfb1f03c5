#pragma once

#include <algorithm>

#include "estara/shaders/lobes.h"
#include "estara/shaders/noise.h"
#include "estara/shaders/shader.h"

namespace estara {

/// Dark green marble with sharp veins (Gritz 1994): a
/// turbulent substrate, veins along the zeros of a warped noise, and a mask that interrupts them.
/// The dearest of the solid shaders: 29 noises at a filter width of .01.
struct Greenmarble {
    static constexpr std::string_view name = "greenmarble";
    static constexpr std::string_view summary = "dark green marble with sharp yellow veins";

    float Ka = 0.1f, Kd = 0.6f, Ks = 0.4f, roughness = 0.01f;
    glm::vec3 darkcolor{0.01f, 0.12f, 0.004f};
    glm::vec3 lightcolor{0.06f, 0.18f, 0.02f};
    glm::vec3 veincolor{0.47f, 0.57f, 0.03f};
    float veinfreq = 1.0f, sharpness = 25.0f;

    static constexpr auto params() {
        return std::tuple{
            Param{"Ka", &Greenmarble::Ka, Part::view, Unit::none, 0.0f, 10.0f,
                  "weight of ambient light"},
            Param{"Kd", &Greenmarble::Kd, Part::view, Unit::none, 0.0f, 10.0f,
                  "weight of diffuse light"},
            Param{"Ks", &Greenmarble::Ks, Part::view, Unit::none, 0.0f, 10.0f,
                  "weight of the highlight"},
            Param{"roughness", &Greenmarble::roughness, Part::view, Unit::none, 0.001f, 1.0f,
                  "width of the highlight"},
            Param{"darkcolor", &Greenmarble::darkcolor, Part::bake, Unit::color, 0.0f, 1.0f,
                  "dark colour of the substrate"},
            Param{"lightcolor", &Greenmarble::lightcolor, Part::bake, Unit::color, 0.0f, 1.0f,
                  "light colour of the substrate"},
            Param{"veincolor", &Greenmarble::veincolor, Part::bake, Unit::color, 0.0f, 1.0f,
                  "colour of the veins"},
            Param{"veinfreq", &Greenmarble::veinfreq, Part::bake, Unit::per_length, 0.0f, 1e6f,
                  "how densely veins lie"},
            Param{"sharpness", &Greenmarble::sharpness, Part::bake, Unit::none, 0.1f, 1000.0f,
                  "how thin veins are"},
        };
    }

    struct Baked {
        glm::vec3 color;
    };
    static constexpr auto channels() {
        return std::tuple{Channel{"color", &Baked::color, "diffuse reflectance, linear Rec. 709"}};
    }

    int octaves(float filter_width) const noexcept {
        return std::max(warp_octaves, octaves_for(filter_width));
    }

    /// The substrate's turbulence, and what warps the veins. Not in bake(): 18 noises in one piece
    /// of code are more than a core's instruction cache holds.
    ESTARA_KERNEL OctaveTerm octave(const SurfacePoint& x, int k) const noexcept {
        const float substrate = turbulence_term<Phi::deviation>(x.P, x.filter_width, k);
        if (k >= warp_octaves) return {substrate, glm::vec4(0.0f)};
        const float frequency = float(1 << k);
        const glm::vec3 warp = (vnoise(x.P * frequency) - 0.5f) * (1.0f / frequency);
        return {substrate, glm::vec4(warp, 0.0f)};
    }

    ESTARA_KERNEL Baked bake(const SurfacePoint& x) const noexcept {
        const glm::vec3 substrate =
            mix(darkcolor, lightcolor, smoothstep(0.1f, 0.35f, x.octave_sum));

        const glm::vec3 offset = glm::vec3(35.2f, -21.9f, 6.25f) + glm::vec3(x.octave_more);
        const glm::vec3 warped = (x.P + offset) * veinfreq;

        float veins = 0.0f;
#pragma GCC unroll 3
        for (int k = 0; k < 3; ++k) {
            const float ridge = 1.0f - std::fabs(snoise(warped * float(1 << k)));
            const float vein =
                power(smoothstep(0.8f, 1.0f, ridge), sharpness) * (1.0f / float(1 << k));
            veins += (1.0f - veins) * vein;
        }
        const float mask =
            smoothstep(-0.1f, 0.05f, snoise((warped + glm::vec3(-4.4f, 8.34f, 27.1f)) * 2.0f));
        return {mix(substrate, veincolor, veins * mask)};
    }

    bool glossy() const noexcept { return Ks > 0.0f; }
    float highlight_cosine() const noexcept { return highlight_edge(roughness, Ks); }

    ESTARA_KERNEL glm::vec3 view(const Baked& b, const Seen& seen) const noexcept {
        return plastic(b.color, Ka, Kd, Ks, roughness, glm::vec3(1.0f), seen);
    }

private:
    static constexpr int warp_octaves = 6;
};

}  // namespace estara
