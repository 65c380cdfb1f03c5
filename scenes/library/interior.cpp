// A furnished room that wears all of the paper's shaders but RCSkin: its scene Interior. Lengths
// are metres; the camera walks in from the front and turns from the window to the fire.
#include "all.h"
#include "camera_path.h"
#include "interior_room.h"

namespace estara::examples {

namespace {

using namespace interior_room;

void add_lights(GlbBuilder& out, const vec3& floor_lamp, const vec3& pendant) {
    const dvec3 bulb(1.0, 0.70, 0.40);
    out.add_lamp({"sun", "directional", dvec3(1.0, 0.90, 0.74), lux_for(3.2)},
                 {vec3(0), looking_along({-0.80f, -0.56f, -0.22f})});
    out.add_lamp({"floor bulb", "point", bulb, candela_for(1.0, 2.0)},
                 {floor_lamp + vec3(0, 1.56f, 0)});
    out.add_lamp({"pendant bulb", "point", dvec3(1.0, 0.80, 0.58), candela_for(0.55, 2.5)},
                 {pendant - vec3(0, 0.035f, 0)});
    out.add_lamp({"fire light", "point", dvec3(1.0, 0.45, 0.14), candela_for(0.40, 1.5)},
                 {vec3(fire_x, 0.50f, breast_front + 0.30f)});
    out.set_ambient(dvec3(0.58, 0.60, 0.65));
}

void build(GlbBuilder& out) {
    Room room(out);
    const vec3 floor_lamp(-2.5f, 0, -1.75f), side_table(2.35f, 0, -2.75f),
        table_lamp = side_table + vec3(0.02f, 0.617f, -0.02f);
    const vec3 pendant(-0.35f, 2.02f, -1.45f);
    add_floor(room);
    add_walls(room);
    add_window(room);
    add_courtyard(room);
    add_fireplace(room);
    add_rug(room, {-0.45f, 0, -1.35f});
    const float on_rug = 0.021f;
    add_coffee_table(room, {-0.35f, on_rug, -1.45f});
    add_armchair(room, "red armchair", red_velvet, gold_velvet, {-1.55f, on_rug, -1.05f}, 100);
    add_armchair(room, "blue armchair", blue_velvet, gold_velvet, {0.72f, on_rug, -1.95f}, -58);
    add_side_table(room, side_table);
    add_lamps(room, floor_lamp, table_lamp);
    add_chair(room, "chair", {1.55f, 0, -0.55f}, -140);
    add_bookcase(room, 0.05f, 1.25f);
    add_door(room, 2.05f);
    add_statue(room, {-2.62f, 0, -2.75f});
    add_floor_vase(room, {1.45f, 0, -3.2f});
    add_lights(out, floor_lamp, pendant);
    add_pendant(room, pendant);

    const Shot shots[]{{{-1.75f, 1.62f, 2.60f}, {0.85f, 1.15f, -1.9f}},
                       {{-1.3f, 1.60f, 2.40f}, {0.70f, 1.10f, -2.0f}},
                       {{-0.6f, 1.56f, 2.15f}, {0.40f, 1.05f, -2.2f}},
                       {{0.1f, 1.52f, 1.95f}, {0.05f, 1.0f, -2.4f}},
                       {{0.55f, 1.50f, 1.8f}, {-0.15f, 0.97f, -2.5f}}};
    add_walking_camera(out, 0.82, shots);
}

}  // namespace

const Example interior{"interior", "a furnished room in ten shaders, the camera walks in and turns",
                       build};

}  // namespace estara::examples
