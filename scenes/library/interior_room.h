// What the scene `interior` is made of: the room's measures, its materials, and what puts things
// into it. Lengths are metres.
#pragma once

#include <map>
#include <numbers>
#include <string>
#include <vector>

#include "glb.h"
#include "shapes.h"

namespace estara::examples::interior_room {

using glm::dvec2;
using glm::dvec3;
using glm::quat;
using glm::vec3;

inline constexpr float degree = std::numbers::pi_v<float> / 180.0f;
inline constexpr double pi = std::numbers::pi;
inline const vec3 x_axis(1, 0, 0), up(0, 1, 0), z_axis(0, 0, 1);
inline const quat as_is(1, 0, 0, 0);

inline quat turned(float degrees, const vec3& about = up) {
    return glm::angleAxis(degree * degrees, about);
}
/// Stands what lies along x on its end: wood grows along the object's x axis.
inline const quat upright = turned(90, z_axis);

// The room: floor at y = 0.
inline constexpr float half_width = 3.0f, back = -3.5f, front = 3.2f, height = 2.8f;
inline constexpr float window_near = -0.2f, window_far = -2.2f, window_low = 0.85f,
                       window_high = 2.35f;
inline constexpr float fire_x = -1.3f, breast_front = back + 0.45f;

inline Material plastic_in(const char* name, const dvec3& Cs, double Ka = 0.35, double Ks = 0.0,
                           double roughness = 0.1) {
    return {name,
            "plastic",
            {{"Ka", {Ka}},
             {"Kd", {0.75}},
             {"Ks", {Ks}},
             {"roughness", {roughness}},
             {"Cs", {Cs.r, Cs.g, Cs.b}}},
            Cs};
}
/// What gives light of its own: so many times the ambient light. No lamp shines upon it, or what is
/// a hand's breadth from a bulb would be a thousand times white.
inline Material glowing(const char* name, const dvec3& color, double times) {
    return {name,
            "plastic",
            {{"Ka", {times}}, {"Kd", {0.0}}, {"Ks", {0.0}}, {"Cs", {color.r, color.g, color.b}}},
            color};
}
inline Material wood_in(const char* name, const dvec3& light, const dvec3& dark, double ringscale,
                        double Ks = 0.25) {
    return {name,
            "wood",
            {{"ringscale", {ringscale}},
             {"lightwood", {light.r, light.g, light.b}},
             {"darkwood", {dark.r, dark.g, dark.b}},
             {"Ka", {0.35}},
             {"Kd", {0.75}},
             {"Ks", {Ks}},
             {"roughness", {0.12}}},
            0.5 * (light + dark)};
}
inline Material velvet_in(const char* name, const dvec3& Cs) {
    return {name,
            "velvet",
            {{"Cs", {Cs.r, Cs.g, Cs.b}},
             {"Ka", {0.35}},
             {"Kd", {0.7}},
             {"sheen", {0.35, 0.35, 0.35}},
             {"edginess", {6}}},
            Cs};
}
inline Material carpet_in(const char* name, const dvec3& Cs, double scuff, double nap) {
    return {name,
            "carpet",
            {{"Cs", {Cs.r, Cs.g, Cs.b}},
             {"Ka", {0.35}},
             {"Kd", {0.9}},
             {"scuff", {scuff}},
             {"nap", {nap}}},
            0.8 * Cs};
}
inline Material enamel_in(const char* name, const dvec3& base, const dvec3& specks) {
    return {name,
            "spatter",
            {{"basecolor", {base.r, base.g, base.b}},
             {"spattercolor", {specks.r, specks.g, specks.b}},
             {"Ka", {0.4}},
             {"Kd", {0.7}},
             {"Ks", {0.6}},
             {"roughness", {0.05}},
             {"specksize", {0.0035}},
             {"sizes", {3}}},
            base};
}

inline const Material oak = wood_in("oak", {0.42, 0.24, 0.11}, {0.24, 0.12, 0.05}, 110);
inline const Material oak_dark =
    wood_in("smoked oak", {0.34, 0.18, 0.08}, {0.18, 0.085, 0.035}, 120);
inline const Material oak_pale = wood_in("pale oak", {0.50, 0.30, 0.15}, {0.30, 0.16, 0.07}, 95);
inline const Material walnut =
    wood_in("walnut", {0.22, 0.105, 0.045}, {0.085, 0.035, 0.014}, 120, 0.4);
inline const Material beam_oak =
    wood_in("beam oak", {0.20, 0.11, 0.055}, {0.10, 0.05, 0.022}, 90, 0.08);
inline const Material plaster = plastic_in("plaster", {0.66, 0.60, 0.50});
inline const Material ceiling_white = plastic_in("ceiling white", {0.72, 0.69, 0.63});
inline const Material brass = plastic_in("brass", {0.42, 0.28, 0.09}, 0.35, 0.9, 0.06);
inline const Material iron = plastic_in("iron", {0.03, 0.03, 0.032}, 0.35, 0.35, 0.15);
inline const Material sandstone{"sandstone",
                                "blocks",
                                {{"variant", {0}},
                                 {"blockwidth", {0.46}},
                                 {"blockheight", {0.23}},
                                 {"mortarthickness", {0.012}},
                                 {"blockcolor", {0.68, 0.60, 0.46}},
                                 {"mortarcolor", {0.50, 0.45, 0.36}},
                                 {"blockvary", {0.22}},
                                 {"Ka", {0.35}},
                                 {"Kd", {0.75}}},
                                dvec3(0.60, 0.55, 0.45)};
inline Material outdoors(Material material) {
    material.name += " outdoors";
    for (auto& [name, value] : material.params)
        if (name == "Ka") value = {0.9};
    return material;
}
inline const Material court_sandstone = outdoors(sandstone);

inline const Material brick{"brick",
                            "blocks",
                            {{"variant", {0}},
                             {"blockwidth", {0.22}},
                             {"blockheight", {0.075}},
                             {"mortarthickness", {0.010}},
                             {"blockcolor", {0.46, 0.21, 0.13}},
                             {"mortarcolor", {0.42, 0.38, 0.33}},
                             {"blockvary", {0.45}},
                             {"bump", {1}},
                             {"Ka", {0.35}},
                             {"Kd", {0.75}}},
                            dvec3(0.42, 0.20, 0.13)};
inline const Material white_marble{"white marble",
                                   "cmarble",
                                   {{"veining", {1.6}},
                                    {"Cs", {0.75, 0.62, 0.55}},
                                    {"Ka", {0.35}},
                                    {"Kd", {0.75}},
                                    {"roughness", {0.05}}},
                                   dvec3(0.80, 0.77, 0.72)};
inline const Material warm_marble{
    "warm marble",
    "colormarble",
    {{"txtscale", {1.5}}, {"Ka", {0.35}}, {"Kd", {0.75}}, {"roughness", {0.05}}},
    dvec3(0.62, 0.46, 0.34)};
inline const Material green_marble{"green marble",
                                   "greenmarble",
                                   {{"Ka", {0.35}}, {"Kd", {0.75}}, {"roughness", {0.02}}},
                                   dvec3(0.04, 0.16, 0.02)};
inline const Material granite{"granite",
                              "stone",
                              {{"scale", {0.008}},
                               {"Cs", {0.66, 0.62, 0.58}},
                               {"graincolor", {0.14, 0.13, 0.13}},
                               {"exponent", {1.0}},
                               {"Ka", {0.35}},
                               {"Ks", {0.25}}},
                              dvec3(0.4, 0.38, 0.36)};
inline const Material hearth_stone{"hearth cobbles",
                                   "cobblestone",
                                   {{"variant", {0}},
                                    {"sscale", {9}},
                                    {"tscale", {9}},
                                    {"selfCol", {0.22, 0.20, 0.18}},
                                    {"varCol", {0.42, 0.37, 0.33}},
                                    {"Ka", {0.35}}},
                                   dvec3(0.38, 0.34, 0.30)};
inline const Material court_stone{"courtyard cobbles",
                                  "cobblestone",
                                  {{"variant", {0}},
                                   {"sscale", {4}},
                                   {"tscale", {4}},
                                   {"selfCol", {0.45, 0.42, 0.38}},
                                   {"varCol", {0.66, 0.60, 0.52}},
                                   {"Ka", {0.6}},
                                   {"Ks", {0.05}}},
                                  dvec3(0.6, 0.55, 0.48)};
inline const Material red_velvet = velvet_in("red velvet", {0.32, 0.022, 0.03});
inline const Material blue_velvet = velvet_in("blue velvet", {0.035, 0.09, 0.23});
inline const Material gold_velvet = velvet_in("gold velvet", {0.48, 0.28, 0.06});
inline const Material wine_velvet = velvet_in("wine velvet", {0.26, 0.02, 0.05});
inline const Material rug_field = carpet_in("rug field", {0.50, 0.10, 0.07}, 1.3, 0.8);
inline const Material rug_border = carpet_in("rug border", {0.72, 0.60, 0.40}, 1.3, 0.8);
inline const Material foliage = outdoors(carpet_in("foliage", {0.10, 0.24, 0.05}, 6.0, 12.0));
inline const Material blue_enamel = enamel_in("blue enamel", {0.03, 0.09, 0.30}, {0.85, 0.87, 0.9});
inline const Material cream_enamel =
    enamel_in("cream enamel", {0.80, 0.74, 0.60}, {0.10, 0.16, 0.34});

/// Puts things into the room. Materials and meshes that come again are written once.
class Room {
public:
    explicit Room(GlbBuilder& out) : m_out(out) {}

    /// A mesh to be placed by stand(). @param pattern  object space units in a metre
    /// @param cut  where in its block of material it was cut, metres
    struct Model {
        int mesh;
        float pattern;
        vec3 cut;
    };
    Model model(const std::string& name, const Material& material, const Mesh& mesh,
                float pattern = 1.0f, const vec3& cut = vec3(0)) {
        const auto [known, fresh] = m_materials.try_emplace(material.name, 0);
        if (fresh) known->second = m_out.add_material(material);
        return {m_out.add_mesh(name, scaled(moved(mesh, cut), pattern), known->second), pattern,
                cut};
    }
    void stand(const std::string& name, const Model& model, const vec3& place,
               const quat& turn = as_is) {
        m_out.add_object(name, model.mesh, {place - turn * model.cut, turn, 1.0f / model.pattern});
    }
    void put(const std::string& name, const Material& material, const Mesh& mesh, const vec3& place,
             const quat& turn = as_is, float pattern = 1.0f, const vec3& cut = vec3(0)) {
        stand(name, model(name, material, mesh, pattern, cut), place, turn);
    }
    /// Several from one block, joined; each at its own place already.
    void put(const std::string& name, const Material& material, const std::vector<Mesh>& parts,
             const vec3& place, const quat& turn = as_is, float pattern = 1.0f) {
        put(name, material, joined(parts), place, turn, pattern);
    }

private:
    GlbBuilder& m_out;
    std::map<std::string, int> m_materials;
};

/// A box whose edges are only just broken. Sizes are whole, not half.
inline Mesh slab(const dvec3& size, double radius = 0.004) {
    return rounded_box(0.5 * size, radius, 1, 2);
}

/// A box between two corners.
inline Mesh between(const vec3& low, const vec3& high, double radius = 0.003) {
    return moved(slab(dvec3(high - low), radius), 0.5f * (low + high));
}

/// The mesh that stands along y laid along x, to be put upright: so its wood grows upwards.
inline Mesh laid(const Mesh& mesh) { return moved(mesh, vec3(0), glm::inverse(upright)); }

/// An even number in [0, 1), always the same for i.
inline float scatter(unsigned i) {
    i = (i ^ 61u) ^ (i >> 16);
    i *= 9u;
    i ^= i >> 4;
    i *= 0x27d4eb2du;
    i ^= i >> 15;
    return float(i >> 8) / 16777216.0f;
}

// The room itself: interior_walls.cpp.
void add_floor(Room& room);
void add_walls(Room& room);
void add_window(Room& room);
void add_courtyard(Room& room);
void add_fireplace(Room& room);
void add_door(Room& room, float middle);

// What stands in it: interior_furniture.cpp.
void add_armchair(Room& room, const std::string& name, const Material& cloth,
                  const Material& pillow, const vec3& place, float facing);
void add_coffee_table(Room& room, const vec3& place);
/// A chair with turned legs and a back of slats, facing +z.
void add_chair(Room& room, const std::string& name, const vec3& place, float facing);
void add_lamps(Room& room, const vec3& floor_lamp, const vec3& table_lamp);
/// A dish above a bulb; @param bulb  its centre. The lamp itself is just below it.
void add_pendant(Room& room, const vec3& bulb);
void add_side_table(Room& room, const vec3& place);
void add_bookcase(Room& room, float left, float right);
void add_statue(Room& room, const vec3& place);
void add_floor_vase(Room& room, const vec3& place);
void add_rug(Room& room, const vec3& place);

}  // namespace estara::examples::interior_room
