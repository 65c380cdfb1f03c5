#pragma once

#include "estara/shaders/lobes.h"
#include "estara/shaders/noise.h"
#include "estara/shaders/shader.h"

namespace estara {

/// Speckled stone: one noise, quantised into a few shades between two colours.
///
/// The look and the parameters of SGI's and Pixar's stone (their public manual page); the
/// formula is ours: t = noise(P / scale), rounded to nshades steps. Discontinuous where a shade
/// ends.
struct Stone {
    static constexpr std::string_view name = "stone";
    static constexpr std::string_view summary = "speckles in a few shades between two colours";

    float Ks = 0.9f, Kd = 0.8f, Ka = 0.2f, roughness = 0.3f;
    float scale = 0.02f;
    int nshades = 4;
    float exponent = 2.0f;
    glm::vec3 specularcolor{1.0f};
    glm::vec3 graincolor{0.0f};
    glm::vec3 Cs{0.65f, 0.6f, 0.55f};  // RSL's surface colour; this default is ours

    static constexpr auto params() {
        return std::tuple{
            Param{"Ks", &Stone::Ks, Part::view, Unit::none, 0.0f, 10.0f, "weight of the highlight"},
            Param{"Kd", &Stone::Kd, Part::view, Unit::none, 0.0f, 10.0f, "weight of diffuse light"},
            Param{"Ka", &Stone::Ka, Part::view, Unit::none, 0.0f, 10.0f, "weight of ambient light"},
            Param{"roughness", &Stone::roughness, Part::view, Unit::none, 0.001f, 1.0f,
                  "width of the highlight"},
            Param{"scale", &Stone::scale, Part::bake, Unit::length, 1e-6f, 1e6f,
                  "size of a speckle"},
            Param{"nshades", &Stone::nshades, Part::bake, Unit::none, 1.0f, 256.0f,
                  "number of steps between the two colours"},
            Param{"exponent", &Stone::exponent, Part::bake, Unit::none, 0.01f, 100.0f,
                  "above 1 favours graincolor, below 1 Cs"},
            Param{"specularcolor", &Stone::specularcolor, Part::view, Unit::color, 0.0f, 10.0f,
                  "colour of the highlight"},
            Param{"graincolor", &Stone::graincolor, Part::bake, Unit::color, 0.0f, 1.0f,
                  "colour of the grain"},
            Param{"Cs", &Stone::Cs, Part::bake, Unit::color, 0.0f, 1.0f, "colour of the surface"},
        };
    }

    struct Baked {
        glm::vec3 color;
    };
    static constexpr auto channels() {
        return std::tuple{Channel{"color", &Baked::color, "diffuse reflectance, linear Rec. 709"}};
    }

    ESTARA_KERNEL Baked bake(const SurfacePoint& x) const noexcept {
        const float shades = float(nshades);
        const float t = power(clamp(noise(x.P / scale), 0.0f, 1.0f), exponent);
        return {mix(graincolor, Cs, std::floor(shades * t + 0.5f) / shades)};
    }

    bool glossy() const noexcept { return Ks > 0.0f; }
    float highlight_cosine() const noexcept {
        return highlight_edge(roughness, Ks * largest(specularcolor));
    }

    ESTARA_KERNEL glm::vec3 view(const Baked& b, const Seen& seen) const noexcept {
        return plastic(b.color, Ka, Kd, Ks, roughness, specularcolor, seen);
    }
};

}  // namespace estara
