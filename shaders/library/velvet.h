#pragma once

#include "estara/shaders/lobes.h"
#include "estara/shaders/shader.h"

namespace estara {

/// Velvet (Westin's RenderMan shader): light comes back along the way it came, and the pile shines
/// where it is seen from the side.
///
/// Its record is one colour and nearly all of its work depends on the view, so that keeping the
/// record gains nothing.
struct Velvet {
    static constexpr std::string_view name = "velvet";
    static constexpr std::string_view summary = "velvet with a bright rim (layered)";

    float Ka = 0.05f, Kd = 0.1f, backscatter = 0.1f, edginess = 10.0f;
    glm::vec3 sheen{0.25f};
    float roughness = 0.1f;
    glm::vec3 Cs{0.4f, 0.05f, 0.12f};  // RSL's surface colour; this default is ours

    static constexpr auto params() {
        return std::tuple{
            Param{"Ka", &Velvet::Ka, Part::view, Unit::none, 0.0f, 10.0f,
                  "weight of ambient light"},
            Param{"Kd", &Velvet::Kd, Part::view, Unit::none, 0.0f, 10.0f,
                  "weight of diffuse light"},
            Param{"backscatter", &Velvet::backscatter, Part::view, Unit::none, 0.0f, 10.0f,
                  "weight of light sent back to its source"},
            Param{"edginess", &Velvet::edginess, Part::view, Unit::none, 0.0f, 100.0f,
                  "how narrow the rim is"},
            Param{"sheen", &Velvet::sheen, Part::view, Unit::color, 0.0f, 10.0f,
                  "colour of the rim and of light sent back"},
            Param{"roughness", &Velvet::roughness, Part::view, Unit::none, 0.001f, 1.0f,
                  "width of the light sent back"},
            Param{"Cs", &Velvet::Cs, Part::bake, Unit::color, 0.0f, 1.0f, "colour of the cloth"},
        };
    }

    struct Baked {
        glm::vec3 color;
    };
    static constexpr auto channels() {
        return std::tuple{Channel{"color", &Baked::color, "diffuse reflectance, linear Rec. 709"}};
    }

    bool layered() const noexcept { return true; }

    ESTARA_KERNEL Baked bake(const SurfacePoint&) const noexcept { return {Cs}; }

    ESTARA_KERNEL glm::vec3 view(const Baked& b, const Seen& seen) const noexcept {
        glm::vec3 returned(0.0f);
        for (std::size_t k = 0; k < seen.lights.size(); ++k) {
            const Light& light = seen.lights[k];
            const float cosine = clamp(glm::dot(light.L, seen.V.vec()), 0.0f, 1.0f);
            returned += light.Cl * power(cosine, 1.0f / roughness);
        }
        const float facing = clamp(glm::dot(seen.N, seen.V.vec()), 0.0f, 1.0f);
        const float rim = power(1.0f - facing * facing, 0.5f * edginess);
        return matte(b.color, Ka, Kd, seen) + sheen * (backscatter * returned + rim * seen.E);
    }
};

}  // namespace estara
