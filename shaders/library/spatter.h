#pragma once

#include "estara/shaders/lobes.h"
#include "estara/shaders/noise.h"
#include "estara/shaders/shader.h"

namespace estara {

/// Enamel ware: specks of several sizes on a base colour.
///
/// The look and the parameters of SGI's and Pixar's spatter (their public manual page); the formula
/// is ours: each size is twice the last, and a speck is where its noise exceeds .7. Discontinuous
/// where a speck ends.
struct Spatter {
    static constexpr std::string_view name = "spatter";
    static constexpr std::string_view summary = "enamel with specks of several sizes";

    float Ka = 1.0f, Kd = 0.5f, Ks = 0.7f, roughness = 0.2f;
    float specksize = 0.01f;
    int sizes = 5;
    glm::vec3 basecolor{0.1f, 0.1f, 0.5f};
    glm::vec3 spattercolor{1.0f};

    static constexpr auto params() {
        return std::tuple{
            Param{"Ka", &Spatter::Ka, Part::view, Unit::none, 0.0f, 10.0f,
                  "weight of ambient light"},
            Param{"Kd", &Spatter::Kd, Part::view, Unit::none, 0.0f, 10.0f,
                  "weight of diffuse light"},
            Param{"Ks", &Spatter::Ks, Part::view, Unit::none, 0.0f, 10.0f,
                  "weight of the highlight"},
            Param{"roughness", &Spatter::roughness, Part::view, Unit::none, 0.001f, 1.0f,
                  "width of the highlight"},
            Param{"specksize", &Spatter::specksize, Part::bake, Unit::length, 1e-6f, 1e6f,
                  "size of the smallest specks"},
            Param{"sizes", &Spatter::sizes, Part::bake, Unit::none, 1.0f, 8.0f,
                  "number of sizes, each twice the last"},
            Param{"basecolor", &Spatter::basecolor, Part::bake, Unit::color, 0.0f, 1.0f,
                  "colour of the enamel"},
            Param{"spattercolor", &Spatter::spattercolor, Part::bake, Unit::color, 0.0f, 1.0f,
                  "colour of the specks"},
        };
    }

    struct Baked {
        glm::vec3 color;
    };
    static constexpr auto channels() {
        return std::tuple{Channel{"color", &Baked::color, "diffuse reflectance, linear Rec. 709"}};
    }

    int octaves(float /*filter_width*/) const noexcept { return sizes; }

    /// 1 in a speck of size k.
    ESTARA_KERNEL float octave(const SurfacePoint& x, int k) const noexcept {
        const float theta = 0.7f;  // specks of one size cover 6 %, of five 26 % (library_test.cpp)
        return step(theta, noise(x.P / (specksize * float(1 << k))));
    }

    ESTARA_KERNEL Baked bake(const SurfacePoint& x) const noexcept {
        return {select(x.octave_sum > 0.0f, spattercolor, basecolor)};
    }

    bool glossy() const noexcept { return Ks > 0.0f; }
    float highlight_cosine() const noexcept { return highlight_edge(roughness, Ks); }

    ESTARA_KERNEL glm::vec3 view(const Baked& b, const Seen& seen) const noexcept {
        return plastic(b.color, Ka, Kd, Ks, roughness, glm::vec3(1.0f), seen);
    }
};

}  // namespace estara
