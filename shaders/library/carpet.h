#pragma once

#include "estara/shaders/lobes.h"
#include "estara/shaders/noise.h"
#include "estara/shaders/shader.h"

namespace estara {

/// Carpet: a speckled nap, soft scuffs over it.
///
/// The parameters of SGI's and Pixar's carpet (their public manual page); the formula is ours:
/// scuffs are turbulence, the nap is noise in two shades, faded to their mean where it is finer
/// than the filter width.
struct Carpet {
    static constexpr std::string_view name = "carpet";
    static constexpr std::string_view summary = "speckled nap with soft scuffs";

    float Kd = 0.6f, Ka = 0.1f;
    float scuff = 1.0f, nap = 1.0f;
    glm::vec3 Cs{0.42f, 0.12f, 0.1f};  // RSL's surface colour; this default is ours

    static constexpr auto params() {
        return std::tuple{
            Param{"Kd", &Carpet::Kd, Part::view, Unit::none, 0.0f, 10.0f,
                  "weight of diffuse light"},
            Param{"Ka", &Carpet::Ka, Part::view, Unit::none, 0.0f, 10.0f,
                  "weight of ambient light"},
            Param{"scuff", &Carpet::scuff, Part::bake, Unit::per_length, 0.0f, 1e6f,
                  "how densely scuffs lie"},
            Param{"nap", &Carpet::nap, Part::bake, Unit::length, 1e-4f, 1e6f,
                  "a hundred times the size of a speckle"},
            Param{"Cs", &Carpet::Cs, Part::bake, Unit::color, 0.0f, 1.0f, "colour of the pile"},
        };
    }

    struct Baked {
        glm::vec3 color;
    };
    static constexpr auto channels() {
        return std::tuple{Channel{"color", &Baked::color, "diffuse reflectance, linear Rec. 709"}};
    }

    int octaves(float filter_width) const noexcept { return octaves_for(filter_width * scuff); }
    ESTARA_KERNEL float octave(const SurfacePoint& x, int k) const noexcept {
        return turbulence_term<Phi::deviation>(x.P * scuff, x.filter_width * scuff, k);
    }

    ESTARA_KERNEL Baked bake(const SurfacePoint& x) const noexcept {
        const float worn = x.octave_sum + 0.5f;
        const float scuffed = worn < 1.0f ? worn : 1.0f;
        // The two shades are equally frequent, so .8 is their mean. The fade is the one of Advanced
        // RenderMan's noise (Apodaca & Gritz 1999, chapter 11), by the width in speckles.
        const float speckles = 100.0f / nap;
        const float shade = step(0.0f, snoise(x.P * speckles)) * 0.4f + 0.6f;
        const float pile = mix(shade, 0.8f, smoothstep(0.2f, 0.75f, x.filter_width * speckles));
        return {Cs * (scuffed * pile)};
    }

    bool glossy() const noexcept { return false; }  // matte

    ESTARA_KERNEL glm::vec3 view(const Baked& b, const Seen& seen) const noexcept {
        return matte(b.color, Ka, Kd, seen);
    }
};

}  // namespace estara
