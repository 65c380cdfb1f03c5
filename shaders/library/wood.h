#pragma once

#include "estara/shaders/lobes.h"
#include "estara/shaders/noise.h"
#include "estara/shaders/shader.h"

namespace estara {

/// Growth rings around the object's x axis, after the RenderMan Companion's listing 16.15 (Upstill
/// 1990; the code is ours). Dark rings shine more than light wood, so the
/// weight of the highlight is a channel beside the colour.
struct Wood {
    static constexpr std::string_view name = "wood";
    static constexpr std::string_view summary = "growth rings around the object's x axis";

    float ringscale = 10.0f;
    glm::vec3 lightwood{0.3f, 0.12f, 0.03f};
    glm::vec3 darkwood{0.05f, 0.01f, 0.005f};
    float Ka = 0.2f, Kd = 0.4f, Ks = 0.6f, roughness = 0.1f;

    static constexpr auto params() {
        return std::tuple{
            Param{"ringscale", &Wood::ringscale, Part::bake, Unit::per_length, 0.0f, 1e6f,
                  "rings per unit of radius"},
            Param{"lightwood", &Wood::lightwood, Part::bake, Unit::color, 0.0f, 1.0f,
                  "colour between the rings"},
            Param{"darkwood", &Wood::darkwood, Part::bake, Unit::color, 0.0f, 1.0f,
                  "colour of the rings"},
            Param{"Ka", &Wood::Ka, Part::view, Unit::none, 0.0f, 10.0f, "weight of ambient light"},
            Param{"Kd", &Wood::Kd, Part::view, Unit::none, 0.0f, 10.0f, "weight of diffuse light"},
            Param{"Ks", &Wood::Ks, Part::view, Unit::none, 0.0f, 10.0f, "weight of the highlight"},
            Param{"roughness", &Wood::roughness, Part::view, Unit::none, 0.001f, 1.0f,
                  "width of the highlight"},
        };
    }

    struct Baked {
        glm::vec3 color;
        float specular;
    };
    static constexpr auto channels() {
        return std::tuple{Channel{"color", &Baked::color, "diffuse reflectance, linear Rec. 709"},
                          Channel{"specular", &Baked::specular,
                                  "weight of the highlight: .7 between the rings, 1 on one"}};
    }

    ESTARA_KERNEL Baked bake(const SurfacePoint& x) const noexcept {
        const glm::vec3 q = x.P + vnoise(x.P);
        const float rings = ringscale * std::sqrt(q.y * q.y + q.z * q.z);
        const float wavy = rings + noise(rings);
        const float phase = wavy - std::floor(wavy);
        const float r = smoothstep(0.0f, 0.8f, phase) - smoothstep(0.83f, 1.0f, phase);
        return {mix(lightwood, darkwood, r), 0.3f * r + 0.7f};
    }

    bool glossy() const noexcept { return Ks > 0.0f; }
    float highlight_cosine() const noexcept { return highlight_edge(roughness, Ks); }

    ESTARA_KERNEL glm::vec3 view(const Baked& b, const Seen& seen) const noexcept {
        return matte(b.color, Ka, Kd, seen) + b.specular * Ks * specular(seen, roughness);
    }
};

}  // namespace estara
