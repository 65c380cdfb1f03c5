// EXPECT: octave() takes a SurfacePoint and an int and returns a float or an OctaveTerm; it is const and noexcept
#include "estara/shaders/shader.h"

using namespace estara;

// octave() is not noexcept: it would not be called, and its sum be 0.
struct Chalk {
    float lightness = 0.9f;
    static constexpr auto params() {
        return std::tuple{
            Param{"lightness", &Chalk::lightness, Part::bake, Unit::none, 0.0f, 1.0f, ""}};
    }

    struct Baked {
        glm::vec3 color;
    };
    static constexpr auto channels() { return std::tuple{Channel{"color", &Baked::color, ""}}; }

    float octave(const SurfacePoint& x, int k) const { return x.P.x / float(1 << k); }
    Baked bake(const SurfacePoint& x) const noexcept {
        return {glm::vec3(lightness * x.octave_sum)};
    }
    glm::vec3 view(const Baked& b, const Seen& s) const noexcept { return b.color * s.E; }
};

static_assert(is_shader<Chalk>());
