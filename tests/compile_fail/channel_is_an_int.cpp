// EXPECT: a channel is a float or a vec3
#include "estara/shaders/shader.h"

using namespace estara;

// A channel that no grid can hold.
struct Chalk {
    float lightness = 0.9f;
    static constexpr auto params() {
        return std::tuple{
            Param{"lightness", &Chalk::lightness, Part::bake, Unit::none, 0.0f, 1.0f, ""}};
    }

    struct Baked {
        int color;
    };
    static constexpr auto channels() { return std::tuple{Channel{"color", &Baked::color, ""}}; }

    float octave(const SurfacePoint& x, int k) const noexcept { return x.P.x / float(1 << k); }
    Baked bake(const SurfacePoint&) const noexcept { return {int(lightness)}; }
    glm::vec3 view(const Baked& b, const Seen& s) const noexcept { return float(b.color) * s.E; }
};

static_assert(is_shader<Chalk>());
