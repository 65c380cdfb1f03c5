#pragma once

#include "estara/shaders/bump.h"
#include "estara/shaders/lobes.h"
#include "estara/shaders/noise.h"
#include "estara/shaders/shader.h"

namespace estara {

/// A wall of blocks in courses, with mortar, ragged edges and pits.
///
/// The paper names it and gives no source; formula, parameters and colours are ours, after Gritz's
/// family of brick shaders. On texture coordinates, or solid: courses of blocks along y that the
/// surface is cut out of. Edges are soft over a quarter of the mortar's thickness. With `bump` the
/// normal follows the height bump * blockheight / 30 * (rise from mortar to block) * (1 - pit), and
/// the shader is a layered one.
struct Blocks {
    static constexpr std::string_view name = "blocks";
    static constexpr std::string_view summary =
        "wall of blocks in mortar, on uv or solid (layered with bump)";

    static constexpr int automatic = -1, on_uv = 0, solid = 1;

    int variant = automatic;
    float Ka = 0.7f, Kd = 0.7f;
    float blockwidth = 0.3f, blockheight = 0.15f, mortarthickness = 0.01f;
    float jagged = 0.04f, blockvary = 0.25f, pitting = 0.5f;
    glm::vec3 blockcolor{0.72f, 0.70f, 0.64f};
    glm::vec3 mortarcolor{0.45f, 0.43f, 0.40f};
    float bump = 0.0f;

    static constexpr auto params() {
        return std::tuple{
            Param{"variant", &Blocks::variant, Part::bake, Unit::none, -1.0f, 1.0f,
                  "0: on texture coordinates; 1: solid; -1: 0 if the mesh has any, else 1"},
            Param{"Ka", &Blocks::Ka, Part::view, Unit::none, 0.0f, 10.0f,
                  "weight of ambient light"},
            Param{"Kd", &Blocks::Kd, Part::view, Unit::none, 0.0f, 10.0f,
                  "weight of diffuse light"},
            Param{"blockwidth", &Blocks::blockwidth, Part::bake, Unit::length, 1e-6f, 1e6f,
                  "width of a block, and its depth (of u in variant 0)"},
            Param{"blockheight", &Blocks::blockheight, Part::bake, Unit::length, 1e-6f, 1e6f,
                  "height of a block (of v in variant 0)"},
            Param{"mortarthickness", &Blocks::mortarthickness, Part::bake, Unit::length, 1e-6f,
                  1e6f, "mortar between two blocks"},
            Param{"jagged", &Blocks::jagged, Part::bake, Unit::none, 0.0f, 1.0f,
                  "how far edges stray, in heights of a block"},
            Param{"blockvary", &Blocks::blockvary, Part::bake, Unit::none, 0.0f, 1.0f,
                  "how much darker than blockcolor a block may be"},
            Param{"pitting", &Blocks::pitting, Part::bake, Unit::none, 0.0f, 1.0f,
                  "how dark and deep pits are"},
            Param{"blockcolor", &Blocks::blockcolor, Part::bake, Unit::color, 0.0f, 1.0f,
                  "colour of the lightest blocks"},
            Param{"mortarcolor", &Blocks::mortarcolor, Part::bake, Unit::color, 0.0f, 1.0f,
                  "lightest colour of the mortar"},
            Param{"bump", &Blocks::bump, Part::bake, Unit::none, 0.0f, 10.0f,
                  "relief; 1 sets mortar back by a thirtieth of a block's height"},
        };
    }

    struct Baked {
        glm::vec3 color;
        glm::vec3 normal;
    };
    static constexpr auto channels() {
        return std::tuple{Channel{"color", &Baked::color, "diffuse reflectance, linear Rec. 709"},
                          Channel{"normal", &Baked::normal, "normal of the relief (with bump)",
                                  ChannelKind::normal}};
    }

    bool perturbs_normal() const noexcept { return bump > 0.0f; }
    bool layered() const noexcept { return bump > 0.0f; }
    Domain domain() const noexcept {
        return variant == solid && !layered() ? Domain::point : Domain::surface;
    }
    bool needs_uv() const noexcept { return variant == on_uv; }

    Blocks resolved(bool has_uv) const noexcept {
        Blocks s = *this;
        if (s.variant == automatic) s.variant = has_uv ? on_uv : solid;
        return s;
    }

    ESTARA_KERNEL Baked bake(const SurfacePoint& x) const noexcept {
        // Texture coordinates are a plane through blocks that have no end. A factor of 0 or 1, as
        // choices that are the same for all points would be compiled into a loop for each.
        const float depths = float(variant == solid), flat = 1.0f - depths;
        const glm::vec3 q = depths * x.P + flat * glm::vec3(x.uv.x, x.uv.y, 0.0f);

        // Ragged edges: the wall is looked up a little beside the point.
        const float ripples = 3.0f / blockheight, reach = jagged * blockheight;
        const NoiseSlope wx = snoise_gradient(q * ripples, 1u);
        const NoiseSlope wy = snoise_gradient(q * ripples, 2u);
        const NoiseSlope wz = snoise_gradient(q * ripples, 3u);

        // Every other course is shifted by half a block.
        const Joint course = joint(q.y + reach * wy.value, blockheight + mortarthickness);
        const float pitch = blockwidth + mortarthickness;
        const float shift = 0.5f * pitch * mod(course.cell, 2.0f);
        const Joint across = joint(q.x + reach * wx.value + shift, pitch);
        const Joint along = joint(q.z + reach * wz.value + shift, pitch);

        // The nearest joint counts; distances in thicknesses of mortar, from its edge.
        const bool from_x = across.distance < course.distance;
        const float nearest = select(from_x, across.distance, course.distance);
        const float behind = along.distance + flat * 1e30f;
        const bool from_z = behind < nearest;
        const float inside = select(from_z, behind, nearest) / mortarthickness - 0.5f;

        const float shade =
            1.0f -
            blockvary * cellnoise(glm::vec3(across.cell, course.cell, depths * along.cell) + 0.5f);
        const float pits = 8.0f / blockheight;
        const NoiseSlope grain = snoise_gradient(q * pits, 4u);
        const float pit = pitting * smoothstep(0.2f, 0.45f, grain.value);
        const glm::vec3 block = blockcolor * (shade * (1.0f - 0.5f * pit));
        const glm::vec3 mortar = mortarcolor * (0.925f + 0.075f * clamp(grain.value, -1.0f, 1.0f));
        const glm::vec3 color = mix(mortar, block, smoothstep(0.0f, 0.25f, inside));

        // The relief's slope: of the rise along the way from the joint, and of the pit.
        const float depth = bump * blockheight / 30.0f;
        const float side = select(from_z, along.side, select(from_x, across.side, course.side));
        const glm::vec3 axis(select(from_x & !from_z, 1.0f, 0.0f),
                             select(!from_x & !from_z, 1.0f, 0.0f), select(from_z, 1.0f, 0.0f));
        const glm::vec3 wave =
            select(from_z, wz.gradient, select(from_x, wx.gradient, wy.gradient));
        const glm::vec3 away = side * (axis + reach * ripples * wave);
        const float rise = smoothstep(0.0f, 1.0f, inside);
        const glm::vec3 of_rise =
            smoothstep_slope(0.0f, 1.0f, inside) / mortarthickness * (1.0f - pit) * away;
        const glm::vec3 of_pit =
            rise * pitting * pits * smoothstep_slope(0.2f, 0.45f, grain.value) * grain.gradient;
        const glm::vec3 slope = depth * (of_rise - of_pit);

        // On texture coordinates the relief is stretched with them, so that its slope stays the
        // same. dPdv is not known: it is taken to be as long as dPdu and orthogonal to it.
        const glm::vec3 u = tangent_along(x.dPdu, x.N), v = glm::cross(x.N, u);
        return {color, bumped(x.N, depths * slope + flat * (slope.x * u + slope.y * v))};
    }

    bool glossy() const noexcept { return false; }  // matte

    ESTARA_KERNEL glm::vec3 view(const Baked& b, const Seen& seen) const noexcept {
        return matte(b.color, Ka, Kd, seen);
    }

private:
    /// Where a coordinate lies between two joints.
    struct Joint {
        float cell;      ///< number of the block
        float distance;  ///< to the middle of the nearer joint
        float side;      ///< change of the distance with the coordinate, 1 or -1
    };
    ESTARA_KERNEL static Joint joint(float coordinate, float pitch) noexcept {
        const float cell = std::floor(coordinate / pitch);
        const float after = coordinate - cell * pitch, before = pitch - after;
        return {cell, after < before ? after : before, after < before ? 1.0f : -1.0f};
    }
};

}  // namespace estara
