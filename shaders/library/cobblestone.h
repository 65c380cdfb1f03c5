#pragma once

#include "estara/shaders/lobes.h"
#include "estara/shaders/noise.h"
#include "estara/shaders/shader.h"

namespace estara {

/// Cobbles in mortar: the paper's Listing 1, on Advanced RenderMan's Voronoi cells (Apodaca & Gritz
/// 1999). On texture coordinates as published, or solid: the same cells in three dimensions, for
/// meshes that have none (the solid variant and the default values are ours).
struct Cobblestone {
    static constexpr std::string_view name = "cobblestone";
    static constexpr std::string_view summary =
        "cobbles of varying shade in mortar, on uv or solid";

    static constexpr int automatic = -1, on_uv = 0, solid = 1;

    int variant = automatic;
    float Kd = 0.8f, jitter = 0.75f;
    float sscale = 10.0f, tscale = 10.0f, txtscale = 1.0f;
    glm::vec3 selfCol{0.5f, 0.47f, 0.42f};
    glm::vec3 varCol{0.8f, 0.75f, 0.7f};
    float Ka = 0.2f, Ks = 0.2f, roughness = 0.2f;

    static constexpr auto params() {
        return std::tuple{
            Param{"variant", &Cobblestone::variant, Part::bake, Unit::none, -1.0f, 1.0f,
                  "0: on texture coordinates; 1: solid; -1: 0 if the mesh has any, else 1"},
            Param{"Kd", &Cobblestone::Kd, Part::view, Unit::none, 0.0f, 10.0f,
                  "weight of diffuse light"},
            Param{"jitter", &Cobblestone::jitter, Part::bake, Unit::none, 0.0f, 1.0f,
                  "how far a cobble strays from the lattice"},
            Param{"sscale", &Cobblestone::sscale, Part::bake, Unit::none, 0.0f, 1e6f,
                  "cobbles along u (variant 0)"},
            Param{"tscale", &Cobblestone::tscale, Part::bake, Unit::none, 0.0f, 1e6f,
                  "cobbles along v (variant 0)"},
            Param{"txtscale", &Cobblestone::txtscale, Part::bake, Unit::per_length, 0.0f, 1e6f,
                  "cobbles per unit of length (variant 1)"},
            Param{"selfCol", &Cobblestone::selfCol, Part::bake, Unit::color, 0.0f, 1.0f,
                  "twice the colour of the mortar"},
            Param{"varCol", &Cobblestone::varCol, Part::bake, Unit::color, 0.0f, 0.8f,
                  "colour of a cobble of medium shade; the lightest are 1.25 times that"},
            Param{"Ka", &Cobblestone::Ka, Part::view, Unit::none, 0.0f, 10.0f,
                  "weight of ambient light"},
            Param{"Ks", &Cobblestone::Ks, Part::view, Unit::none, 0.0f, 10.0f,
                  "weight of the highlight"},
            Param{"roughness", &Cobblestone::roughness, Part::view, Unit::none, 0.001f, 1.0f,
                  "width of the highlight"},
        };
    }

    struct Baked {
        glm::vec3 color;
    };
    static constexpr auto channels() {
        return std::tuple{Channel{"color", &Baked::color, "diffuse reflectance, linear Rec. 709"}};
    }

    Domain domain() const noexcept { return variant == solid ? Domain::point : Domain::surface; }

    Cobblestone resolved(bool has_uv) const noexcept {
        Cobblestone s = *this;
        if (s.variant == automatic) s.variant = has_uv ? on_uv : solid;
        return s;
    }

    /// A cobble's colour by how far the point is inside it and by the cobble's own random number.
    ESTARA_KERNEL glm::vec3 paint(float border_distance, float shade) const noexcept {
        return mix(0.5f * selfCol, (shade + 1.5f) * 0.5f * varCol,
                   smoothstep(0.03f, 0.07f, border_distance));
    }

    ESTARA_KERNEL Baked bake(const SurfacePoint& x) const noexcept {
        // The offsets keep the shades apart from the numbers that placed the cells (Listing 1).
        if (variant == solid) {
            const Voronoi<glm::vec3> v = voronoi(x.P * txtscale, jitter);
            return {paint(v.f2 - v.f1, cellnoise(v.feature1 + glm::vec3(-67.0f, 55.0f, 0.0f)))};
        }
        const Voronoi<glm::vec2> v = voronoi(glm::vec2(x.uv.x * sscale, x.uv.y * tscale), jitter);
        return {paint(v.f2 - v.f1, cellnoise(v.feature1 + glm::vec2(-67.0f, 55.0f)))};
    }

    bool glossy() const noexcept { return Ks > 0.0f; }
    float highlight_cosine() const noexcept { return highlight_edge(roughness, Ks); }

    ESTARA_KERNEL glm::vec3 view(const Baked& b, const Seen& seen) const noexcept {
        return plastic(b.color, Ka, Kd, Ks, roughness, glm::vec3(1.0f), seen);
    }
};

}  // namespace estara
