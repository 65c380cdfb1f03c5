#pragma once

#include "estara/shaders/lobes.h"
#include "estara/shaders/noise.h"
#include "estara/shaders/shader.h"
#include "estara/shaders/spline.h"

namespace estara {

/// Marble in four colours, which a spline runs through along the turbulence.
///
/// The paper names it and gives no source; formula, parameters and colours are ours, after the
/// RenderMan Companion's blue marble (Upstill 1990).
struct Colormarble {
    static constexpr std::string_view name = "colormarble";
    static constexpr std::string_view summary = "marble in four colours";

    float Ks = 0.4f, Kd = 0.6f, Ka = 0.1f, roughness = 0.1f;
    float txtscale = 1.0f;
    glm::vec3 pale{0.90f, 0.86f, 0.78f};
    glm::vec3 medium{0.80f, 0.66f, 0.52f};
    glm::vec3 middark{0.55f, 0.34f, 0.26f};
    glm::vec3 dark{0.25f, 0.14f, 0.12f};

    static constexpr auto params() {
        return std::tuple{
            Param{"Ks", &Colormarble::Ks, Part::view, Unit::none, 0.0f, 10.0f,
                  "weight of the highlight"},
            Param{"Kd", &Colormarble::Kd, Part::view, Unit::none, 0.0f, 10.0f,
                  "weight of diffuse light"},
            Param{"Ka", &Colormarble::Ka, Part::view, Unit::none, 0.0f, 10.0f,
                  "weight of ambient light"},
            Param{"roughness", &Colormarble::roughness, Part::view, Unit::none, 0.001f, 1.0f,
                  "width of the highlight"},
            Param{"txtscale", &Colormarble::txtscale, Part::bake, Unit::per_length, 0.0f, 1e6f,
                  "how densely the pattern lies"},
            Param{"pale", &Colormarble::pale, Part::bake, Unit::color, 0.0f, 1.0f,
                  "lightest colour, the most frequent"},
            Param{"medium", &Colormarble::medium, Part::bake, Unit::color, 0.0f, 1.0f,
                  "second lightest colour"},
            Param{"middark", &Colormarble::middark, Part::bake, Unit::color, 0.0f, 1.0f,
                  "second darkest colour"},
            Param{"dark", &Colormarble::dark, Part::bake, Unit::color, 0.0f, 1.0f,
                  "darkest colour"},
        };
    }

    struct Baked {
        glm::vec3 color;
    };
    static constexpr auto channels() {
        return std::tuple{Channel{"color", &Baked::color, "diffuse reflectance, linear Rec. 709"}};
    }

    int octaves(float filter_width) const noexcept { return octaves_for(filter_width * txtscale); }
    ESTARA_KERNEL float octave(const SurfacePoint& x, int k) const noexcept {
        return turbulence_term<Phi::noise>(x.P * txtscale, x.filter_width * txtscale, k);
    }

    ESTARA_KERNEL Baked bake(const SurfacePoint& x) const noexcept {
        const std::array<glm::vec3, 13> knots{pale,    pale,    medium, medium, medium, pale, pale,
                                              middark, middark, dark,   dark,   pale,   dark};
        const glm::vec3 color = spline(4.0f * x.octave_sum - 3.0f, knots);
        return {glm::vec3(clamp(color.x, 0.0f, 1.0f), clamp(color.y, 0.0f, 1.0f),
                          clamp(color.z, 0.0f, 1.0f))};
    }

    bool glossy() const noexcept { return Ks > 0.0f; }
    float highlight_cosine() const noexcept { return highlight_edge(roughness, Ks); }

    ESTARA_KERNEL glm::vec3 view(const Baked& b, const Seen& seen) const noexcept {
        return plastic(b.color, Ka, Kd, Ks, roughness, glm::vec3(1.0f), seen);
    }
};

}  // namespace estara
