#pragma once

#include "estara/shaders/lobes.h"
#include "estara/shaders/shader.h"

namespace estara {

/// RSL's standard plastic: one colour and a highlight. What objects without a shader wear.
struct Plastic {
    static constexpr std::string_view name = "plastic";
    static constexpr std::string_view summary =
        "one colour with a highlight (objects without a shader)";

    float Ka = 1.0f, Kd = 0.5f, Ks = 0.5f, roughness = 0.1f;
    glm::vec3 specularcolor{1.0f};
    glm::vec3 Cs{0.5f};

    static constexpr auto params() {
        return std::tuple{
            Param{"Ka", &Plastic::Ka, Part::view, Unit::none, 0.0f, 10.0f,
                  "weight of ambient light"},
            Param{"Kd", &Plastic::Kd, Part::view, Unit::none, 0.0f, 10.0f,
                  "weight of diffuse light"},
            Param{"Ks", &Plastic::Ks, Part::view, Unit::none, 0.0f, 10.0f,
                  "weight of the highlight"},
            Param{"roughness", &Plastic::roughness, Part::view, Unit::none, 0.001f, 1.0f,
                  "width of the highlight"},
            Param{"specularcolor", &Plastic::specularcolor, Part::view, Unit::color, 0.0f, 10.0f,
                  "colour of the highlight"},
            Param{"Cs", &Plastic::Cs, Part::bake, Unit::color, 0.0f, 1.0f, "colour of the surface"},
        };
    }

    struct Baked {
        glm::vec3 color;
    };
    static constexpr auto channels() {
        return std::tuple{Channel{"color", &Baked::color, "diffuse reflectance, linear Rec. 709"}};
    }

    ESTARA_KERNEL Baked bake(const SurfacePoint&) const noexcept { return {Cs}; }

    bool glossy() const noexcept { return Ks > 0.0f; }
    float highlight_cosine() const noexcept {
        return highlight_edge(roughness, Ks * largest(specularcolor));
    }

    ESTARA_KERNEL glm::vec3 view(const Baked& b, const Seen& seen) const noexcept {
        return plastic(b.color, Ka, Kd, Ks, roughness, specularcolor, seen);
    }
};

}  // namespace estara
