// EXPECT: a channel that is a normal or a direction is a vec3, and a normal is the last channel
#include "estara/shaders/shader.h"

using namespace estara;

// A normal with a channel behind it.
struct Chalk {
    float lightness = 0.9f;
    static constexpr auto params() {
        return std::tuple{
            Param{"lightness", &Chalk::lightness, Part::bake, Unit::none, 0.0f, 1.0f, ""}};
    }

    struct Baked {
        glm::vec3 normal;
        glm::vec3 color;
    };
    static constexpr auto channels() {
        return std::tuple{Channel{"normal", &Baked::normal, "", ChannelKind::normal},
                          Channel{"color", &Baked::color, ""}};
    }

    float octave(const SurfacePoint& x, int k) const noexcept { return x.P.x / float(1 << k); }
    Baked bake(const SurfacePoint& x) const noexcept {
        return {x.N, glm::vec3(lightness * x.octave_sum)};
    }
    glm::vec3 view(const Baked& b, const Seen& s) const noexcept { return b.color * s.E; }
};

static_assert(is_shader<Chalk>());
