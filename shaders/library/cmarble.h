#pragma once

#include <algorithm>

#include "estara/shaders/lobes.h"
#include "estara/shaders/noise.h"
#include "estara/shaders/shader.h"

namespace estara {

/// White marble with thin coloured veins along the creases of turbulence.
///
/// The parameters of SGI's and Pixar's cmarble (their public manual page); the formula is ours.
/// Away from a vein the colour Cs loses its saturation and becomes light, as in HSV.
struct Cmarble {
    static constexpr std::string_view name = "cmarble";
    static constexpr std::string_view summary = "white marble with thin coloured veins";

    float Ka = 0.1f, Kd = 0.6f, Ks = 0.4f, roughness = 0.1f;
    float veining = 1.0f;
    glm::vec3 Cs{0.5f, 0.26f, 0.16f};  // RSL's surface colour; this default is ours

    static constexpr auto params() {
        return std::tuple{
            Param{"Ka", &Cmarble::Ka, Part::view, Unit::none, 0.0f, 10.0f,
                  "weight of ambient light"},
            Param{"Kd", &Cmarble::Kd, Part::view, Unit::none, 0.0f, 10.0f,
                  "weight of diffuse light"},
            Param{"Ks", &Cmarble::Ks, Part::view, Unit::none, 0.0f, 10.0f,
                  "weight of the highlight"},
            Param{"roughness", &Cmarble::roughness, Part::view, Unit::none, 0.001f, 1.0f,
                  "width of the highlight"},
            Param{"veining", &Cmarble::veining, Part::bake, Unit::per_length, 0.0f, 1e6f,
                  "how densely veins lie"},
            Param{"Cs", &Cmarble::Cs, Part::bake, Unit::color, 0.0f, 1.0f, "colour of the veins"},
        };
    }

    struct Baked {
        glm::vec3 color;
    };
    static constexpr auto channels() {
        return std::tuple{Channel{"color", &Baked::color, "diffuse reflectance, linear Rec. 709"}};
    }

    int octaves(float filter_width) const noexcept { return octaves_for(filter_width * veining); }
    ESTARA_KERNEL float octave(const SurfacePoint& x, int k) const noexcept {
        return turbulence_term<Phi::deviation>(x.P * veining, x.filter_width * veining, k);
    }

    ESTARA_KERNEL Baked bake(const SurfacePoint& x) const noexcept {
        const float T = x.octave_sum;
        const float value = std::max(Cs.x, std::max(Cs.y, Cs.z));  // v of HSV
        // A colour of value v is v (1 - s (1 - hue)): so Cs / v keeps its hue when it is drawn
        // towards 1, and no conversion to HSV and back is needed. Black has no hue.
        const glm::vec3 full =
            select(value > 0.0f, Cs / (value > 0.0f ? value : 1.0f), glm::vec3(1.0f));
        const float faded = smoothstep(0.03f, 0.2f, T);
        const float light = 0.8f + 0.2f * smoothstep(0.35f, 0.6f, T);
        return {mix(full, glm::vec3(1.0f), faded) * mix(value, light, smoothstep(0.08f, 0.25f, T))};
    }

    bool glossy() const noexcept { return Ks > 0.0f; }
    float highlight_cosine() const noexcept { return highlight_edge(roughness, Ks); }

    ESTARA_KERNEL glm::vec3 view(const Baked& b, const Seen& seen) const noexcept {
        return plastic(b.color, Ka, Kd, Ks, roughness, glm::vec3(1.0f), seen);
    }
};

}  // namespace estara
