// A wooden knot that flies and tumbles before a camera that stands still: its grain sticks to it.
#include <cmath>
#include <numbers>

#include "all.h"
#include "keys.h"
#include "shapes.h"

namespace estara::examples {

namespace {

using glm::dvec3;
using glm::vec3;

const Material wood{
    "wood",
    "wood",
    {{"ringscale", {14}}, {"lightwood", {0.5, 0.24, 0.09}}, {"darkwood", {0.14, 0.045, 0.015}}},
    dvec3(0.32, 0.14, 0.05)};
const Material clay{"clay",
                    "plastic",
                    {{"Ka", {0.2}}, {"Kd", {0.7}}, {"Ks", {0}}, {"Cs", {0.42, 0.4, 0.38}}},
                    dvec3(0.42, 0.4, 0.38)};

/// A low arc from left to right.
vec3 place(double part) {
    const auto x = float(2.4 * part - 1.2);
    return {x, 0.7f + 0.25f * (1.0f - x * x / 1.44f), 0.0f};
}

/// One whole turn about a slanted axis.
glm::quat turn(double part) {
    return glm::angleAxis(float(2.0 * std::numbers::pi * part),
                          glm::normalize(vec3(0.5f, 0.8f, -0.4f)));
}

void build(GlbBuilder& out) {
    const Mesh knot = torus_knot(2, 3, 0.42, 0.18, 0.11, {600, 64});
    const int object = out.add_object("knot", out.add_mesh("knot", knot, out.add_material(wood)),
                                      {place(0.0), turn(0.0)});
    out.animate_translation(object, frame_times(), frame_values<vec3>(place));
    out.animate_rotation(object, frame_times(), frame_values<glm::quat>(turn));

    const Mesh ground = rolling_ground(14.0, 0.08, 2.5, {120, 120});
    out.add_object("ground", out.add_mesh("ground", ground, out.add_material(clay)), {});

    const vec3 eye(0, 3.4f, 4.0f), aim(0, 0.6f, 0);
    out.add_camera("camera", 0.5, {eye, looking_along(aim - eye)});
    const vec3 fill(3.0f, 3.0f, 1.0f);
    out.add_lamp({"sun", "directional", dvec3(1.0, 0.93, 0.82), lux_for(1.2)},
                 {vec3(0), looking_along(vec3(0.6f, -1.0f, -0.5f))});
    out.add_lamp(
        {"fill", "point", dvec3(0.75, 0.86, 1.0), candela_for(0.25, glm::distance(fill, aim))},
        {fill});
    out.set_ambient(dvec3(0.6, 0.62, 0.66));
}

}  // namespace

const Example tumble{"tumble", "a wooden knot that flies and turns, the camera stands still",
                     build};

}  // namespace estara::examples
