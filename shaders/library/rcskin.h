#pragma once

#include "estara/shaders/bump.h"
#include "estara/shaders/lobes.h"
#include "estara/shaders/noise.h"
#include "estara/shaders/shader.h"
#include "estara/shaders/spline.h"

namespace estara {

/// Skin in four layers: pores, a base colour, blemishes that scatter light under the surface, and
/// oil on top (Cortes 2002, "RCSkin"; its subsurface part after Pharr 2001, "Layer Media for
/// Surface Shaders"). The paper's Listing 2, with the constants of the published shader: (H.N)^4
/// and .2 where the paper prints (H.L)^4 and 2.
///
/// The spline of blemishes runs through skincolor plus a grey; a Catmull-Rom spline commutes with
/// that sum, so one number is interpolated instead of a colour.
struct RCSkin {
    static constexpr std::string_view name = "RCSkin";
    static constexpr std::string_view summary = "skin with pores, blemishes and oil (layered)";

    float Kd = 0.1f;
    glm::vec3 skincolor{0.7f, 0.56f, 0.52f};
    glm::vec3 sheenColor{1.0f};
    float blemishfreq = 12.0f, blemishthresh = 4.0f, blemishopac = 1.0f;
    float eta = 1.01f, thickness = 1.0f;
    float angle = 180.0f, oily = 1.5f, xrough = 0.3f, yrough = 0.5f;
    float poresfreq = 60.0f, poresthresh = 3.0f, poresdepth = -0.001f;
    float maxfreq = 8.0f;
    float brightness = 1.0f;

    static constexpr auto params() {
        return std::tuple{
            Param{"Kd", &RCSkin::Kd, Part::view, Unit::none, 0.0f, 10.0f,
                  "weight of diffuse light"},
            Param{"skincolor", &RCSkin::skincolor, Part::bake, Unit::color, 0.0f, 1.0f,
                  "colour of the skin"},
            Param{"sheenColor", &RCSkin::sheenColor, Part::view, Unit::color, 0.0f, 10.0f,
                  "colour of light reflected by the skin"},
            Param{"blemishfreq", &RCSkin::blemishfreq, Part::bake, Unit::per_length, 0.0f, 1e6f,
                  "how densely blemishes lie"},
            Param{"blemishthresh", &RCSkin::blemishthresh, Part::bake, Unit::none, 0.1f, 20.0f,
                  "how rare blemishes are"},
            Param{"blemishopac", &RCSkin::blemishopac, Part::view, Unit::none, 0.0f, 1.0f,
                  "how much of the base colour the blemishes' layer hides"},
            Param{"eta", &RCSkin::eta, Part::view, Unit::none, 1.0f, 4.0f,
                  "index of refraction of the skin"},
            Param{"thickness", &RCSkin::thickness, Part::view, Unit::none, 0.0f, 100.0f,
                  "of the layer that scatters, in mean free paths"},
            Param{"angle", &RCSkin::angle, Part::bake, Unit::none, -360.0f, 360.0f,
                  "degrees by which the oil's x direction is turned from that of u"},
            Param{"oily", &RCSkin::oily, Part::view, Unit::none, 0.0f, 10.0f,
                  "weight of the oil's highlight, in tenths"},
            Param{"xrough", &RCSkin::xrough, Part::view, Unit::none, 0.01f, 1.0f,
                  "width of the oil's highlight along x"},
            Param{"yrough", &RCSkin::yrough, Part::view, Unit::none, 0.01f, 1.0f,
                  "width of the oil's highlight along y"},
            Param{"poresfreq", &RCSkin::poresfreq, Part::bake, Unit::per_length, 0.0f, 1e6f,
                  "how densely pores lie"},
            Param{"poresthresh", &RCSkin::poresthresh, Part::bake, Unit::none, 1.0f, 20.0f,
                  "how small pores are"},
            Param{"poresdepth", &RCSkin::poresdepth, Part::bake, Unit::length, -1.0f, 1.0f,
                  "height of the pores' rims; negative: of their floors"},
            Param{"maxfreq", &RCSkin::maxfreq, Part::bake, Unit::none, 1.0f, 64.0f,
                  "detail of pores and blemishes: octaves of frequencies below this"},
            Param{"brightness", &RCSkin::brightness, Part::view, Unit::none, 0.0f, 10.0f,
                  "weight of diffuse light and oil"},
        };
    }

    struct Baked {
        glm::vec3 color;
        glm::vec3 Xdir, Ydir;
        glm::vec3 N_N;
    };
    static constexpr auto channels() {
        return std::tuple{
            Channel{"color", &Baked::color, "colour of the blemishes, linear Rec. 709"},
            Channel{"Xdir", &Baked::Xdir, "the oil's x direction", ChannelKind::direction},
            Channel{"Ydir", &Baked::Ydir, "the oil's y direction", ChannelKind::direction},
            Channel{"N_N", &Baked::N_N, "normal of the surface with pores", ChannelKind::normal}};
    }

    Domain domain() const noexcept { return Domain::surface; }
    /// Without texture coordinates the oil's directions depend on the normal alone.
    bool needs_uv() const noexcept { return false; }
    bool layered() const noexcept { return true; }

    /// Octaves of frequency 1, 2, 4 ... below maxfreq.
    int octaves(float /*filter_width*/) const noexcept {
        int count = 0;
        while (float(1 << count) < maxfreq) ++count;
        return count;
    }

    /// tau(q), the sum of |snoise(f q)| / f: of the blemishes, then of the pores with its gradient
    /// in q.
    ESTARA_KERNEL OctaveTerm octave(const SurfacePoint& x, int k) const noexcept {
        const float f = float(1 << k), amplitude = 1.0f / f;
        const float blemishes = snoise(x.P * (blemishfreq * f));
        const NoiseSlope pores = snoise_gradient(x.P * (poresfreq * f));
        const glm::vec3 slope = pores.gradient * select(pores.value < 0.0f, -1.0f, 1.0f);
        return {amplitude * std::fabs(blemishes),
                {slope.x, slope.y, slope.z, amplitude * std::fabs(pores.value)}};
    }

    ESTARA_KERNEL Baked bake(const SurfacePoint& x) const noexcept {
        // Layer 0: the height is poresdepth tau^poresthresh.
        const glm::vec3 slope(x.octave_more.x, x.octave_more.y, x.octave_more.z);
        const float steepness =
            poresdepth * poresthresh * power(x.octave_more.w, poresthresh - 1.0f) * poresfreq;
        const glm::vec3 N = bumped(x.N, steepness * slope);

        // Layer 2.
        constexpr std::array e{.05f, .0f, -.05f, .05f, -.05f, .0f, -.05f, -.1f, -.05f, -.1f, .05f};
        const float shade = spline(power(x.octave_sum, blemishthresh), e);
        const glm::vec3 color(clamp(skincolor.x + shade, 0.0f, 1.0f),
                              clamp(skincolor.y + shade, 0.0f, 1.0f),
                              clamp(skincolor.z + shade, 0.0f, 1.0f));

        // Layer 3.
        const glm::vec3 u = tangent_along(x.dPdu, N), v = glm::cross(N, u);
        const SinCos turn = sincos_degrees(angle);
        const glm::vec3 X = turn.cos * u + turn.sin * v;
        return {color, X, glm::cross(N, X), N};
    }

    ESTARA_KERNEL glm::vec3 view(const Baked& b, const Seen& seen) const noexcept {
        const glm::vec3 V = seen.V.vec();
        const Fresnel eye = fresnel(-V, seen.N, 1.0f / eta);
        const float Kr = reflected(eye), Kt = 1.0f - Kr;
        glm::vec3 blemishes(0.0f);
        for (std::size_t k = 0; k < seen.lights.size(); ++k) {
            const Light& light = seen.lights[k];
            const glm::vec3 arriving =
                light.Cl * clamp(glm::dot(light.L, seen.N), 0.0f, 1.0f);  // 0 from behind
            const float cosine = clamp(glm::dot(half_vector(light.L, V), seen.N), 0.0f, 1.0f);
            const float cosine2 = cosine * cosine;
            const Fresnel in = fresnel(-light.L, seen.N, 1.0f / eta);
            const float Kt2 = 1.0f - reflected(in);
            const float scattered = single_scatter(eye.T, in.T, seen.N, 0.8f, 0.8f, thickness) +
                                    single_scatter(eye.T, in.T, seen.N, 0.3f, 0.5f, thickness) +
                                    single_scatter(eye.T, in.T, seen.N, 0.0f, 0.4f, thickness);
            blemishes += arriving * (Kr * (cosine2 * cosine2 + 0.2f) * sheenColor +
                                     Kt * Kt2 * scattered * b.color);
        }
        const glm::vec3 skin = mix(skincolor * seen.glow, blemishes, blemishopac);
        const glm::vec3 oil = ward(seen, b.Xdir, b.Ydir, xrough, yrough);
        return skin + brightness * (0.1f * oily * oil + Kd * seen.E);
    }

private:
    /// Share of light that the skin reflects: Fresnel's, with that at small angles taken away.
    ESTARA_KERNEL static float reflected(const Fresnel& f) noexcept {
        return smoothstep(0.0f, 0.5f, f.Kr);
    }
};

}  // namespace estara
