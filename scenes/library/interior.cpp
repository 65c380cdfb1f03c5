// A furnished room that wears all of the paper's shaders but RCSkin: its scene Interior. Lengths
// are metres; the camera walks in from the front and turns from the window to the fire.
#include <array>
#include <cmath>
#include <map>
#include <numbers>
#include <string>
#include <vector>

#include "all.h"
#include "camera_path.h"
#include "pieces.h"

namespace estara::examples {

namespace {

using glm::dvec2;
using glm::dvec3;
using glm::quat;
using glm::vec3;

constexpr float degree = std::numbers::pi_v<float> / 180.0f;
constexpr double pi = std::numbers::pi;
const vec3 x_axis(1, 0, 0), up(0, 1, 0), z_axis(0, 0, 1);
const quat as_is(1, 0, 0, 0);

quat turned(float degrees, const vec3& about = up) {
    return glm::angleAxis(degree * degrees, about);
}
/// Stands what lies along x on its end: wood grows along the object's x axis.
const quat upright = turned(90, z_axis);

// The room: floor at y = 0.
constexpr float half_width = 3.0f, back = -3.5f, front = 3.2f, height = 2.8f;
constexpr float window_near = -0.2f, window_far = -2.2f, window_low = 0.85f, window_high = 2.35f;
constexpr float fire_x = -1.3f, breast_front = back + 0.45f;

using Params = std::vector<std::pair<std::string, std::vector<double>>>;

Material plastic_in(const char* name, const dvec3& Cs, double Ka = 0.35, double Ks = 0.0,
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
Material glowing(const char* name, const dvec3& color, double times) {
    return {name,
            "plastic",
            {{"Ka", {times}}, {"Kd", {0.0}}, {"Ks", {0.0}}, {"Cs", {color.r, color.g, color.b}}},
            color};
}
Material wood_in(const char* name, const dvec3& light, const dvec3& dark, double ringscale,
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
Material velvet_in(const char* name, const dvec3& Cs) {
    return {name,
            "velvet",
            {{"Cs", {Cs.r, Cs.g, Cs.b}},
             {"Ka", {0.35}},
             {"Kd", {0.7}},
             {"sheen", {0.35, 0.35, 0.35}},
             {"edginess", {6}}},
            Cs};
}
Material carpet_in(const char* name, const dvec3& Cs, double scuff, double nap) {
    return {name,
            "carpet",
            {{"Cs", {Cs.r, Cs.g, Cs.b}},
             {"Ka", {0.35}},
             {"Kd", {0.9}},
             {"scuff", {scuff}},
             {"nap", {nap}}},
            0.8 * Cs};
}
Material enamel_in(const char* name, const dvec3& base, const dvec3& specks) {
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

const Material oak = wood_in("oak", {0.42, 0.24, 0.11}, {0.24, 0.12, 0.05}, 110);
const Material oak_dark = wood_in("smoked oak", {0.34, 0.18, 0.08}, {0.18, 0.085, 0.035}, 120);
const Material oak_pale = wood_in("pale oak", {0.50, 0.30, 0.15}, {0.30, 0.16, 0.07}, 95);
const Material walnut = wood_in("walnut", {0.22, 0.105, 0.045}, {0.085, 0.035, 0.014}, 120, 0.4);
const Material beam_oak = wood_in("beam oak", {0.20, 0.11, 0.055}, {0.10, 0.05, 0.022}, 90, 0.08);
const Material plaster = plastic_in("plaster", {0.66, 0.60, 0.50});
const Material ceiling_white = plastic_in("ceiling white", {0.72, 0.69, 0.63});
const Material brass = plastic_in("brass", {0.42, 0.28, 0.09}, 0.35, 0.9, 0.06);
const Material iron = plastic_in("iron", {0.03, 0.03, 0.032}, 0.35, 0.35, 0.15);
const Material sandstone{"sandstone",
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
Material outdoors(Material material) {
    material.name += " outdoors";
    for (auto& [name, value] : material.params)
        if (name == "Ka") value = {0.9};
    return material;
}
const Material court_sandstone = outdoors(sandstone);

const Material brick{"brick",
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
const Material white_marble{"white marble",
                            "cmarble",
                            {{"veining", {1.6}},
                             {"Cs", {0.75, 0.62, 0.55}},
                             {"Ka", {0.35}},
                             {"Kd", {0.75}},
                             {"roughness", {0.05}}},
                            dvec3(0.80, 0.77, 0.72)};
const Material warm_marble{
    "warm marble",
    "colormarble",
    {{"txtscale", {1.5}}, {"Ka", {0.35}}, {"Kd", {0.75}}, {"roughness", {0.05}}},
    dvec3(0.62, 0.46, 0.34)};
const Material green_marble{"green marble",
                            "greenmarble",
                            {{"Ka", {0.35}}, {"Kd", {0.75}}, {"roughness", {0.02}}},
                            dvec3(0.04, 0.16, 0.02)};
const Material granite{"granite",
                       "stone",
                       {{"scale", {0.008}},
                        {"Cs", {0.66, 0.62, 0.58}},
                        {"graincolor", {0.14, 0.13, 0.13}},
                        {"exponent", {1.0}},
                        {"Ka", {0.35}},
                        {"Ks", {0.25}}},
                       dvec3(0.4, 0.38, 0.36)};
const Material hearth_stone{"hearth cobbles",
                            "cobblestone",
                            {{"variant", {0}},
                             {"sscale", {9}},
                             {"tscale", {9}},
                             {"selfCol", {0.22, 0.20, 0.18}},
                             {"varCol", {0.42, 0.37, 0.33}},
                             {"Ka", {0.35}}},
                            dvec3(0.38, 0.34, 0.30)};
const Material court_stone{"courtyard cobbles",
                           "cobblestone",
                           {{"variant", {0}},
                            {"sscale", {4}},
                            {"tscale", {4}},
                            {"selfCol", {0.45, 0.42, 0.38}},
                            {"varCol", {0.66, 0.60, 0.52}},
                            {"Ka", {0.6}},
                            {"Ks", {0.05}}},
                           dvec3(0.6, 0.55, 0.48)};
const Material red_velvet = velvet_in("red velvet", {0.32, 0.022, 0.03});
const Material blue_velvet = velvet_in("blue velvet", {0.035, 0.09, 0.23});
const Material gold_velvet = velvet_in("gold velvet", {0.48, 0.28, 0.06});
const Material wine_velvet = velvet_in("wine velvet", {0.26, 0.02, 0.05});
const Material rug_field = carpet_in("rug field", {0.50, 0.10, 0.07}, 1.3, 0.8);
const Material rug_border = carpet_in("rug border", {0.72, 0.60, 0.40}, 1.3, 0.8);
const Material foliage = outdoors(carpet_in("foliage", {0.10, 0.24, 0.05}, 6.0, 12.0));
const Material blue_enamel = enamel_in("blue enamel", {0.03, 0.09, 0.30}, {0.85, 0.87, 0.9});
const Material cream_enamel = enamel_in("cream enamel", {0.80, 0.74, 0.60}, {0.10, 0.16, 0.34});

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
Mesh slab(const dvec3& size, double radius = 0.004) {
    return rounded_box(0.5 * size, radius, 1, 2);
}

/// A box between two corners.
Mesh between(const vec3& low, const vec3& high, double radius = 0.003) {
    return moved(slab(dvec3(high - low), radius), 0.5f * (low + high));
}

/// The mesh that stands along y laid along x, to be put upright: so its wood grows upwards.
Mesh laid(const Mesh& mesh) { return moved(mesh, vec3(0), glm::inverse(upright)); }

/// An even number in [0, 1), always the same for i.
float scatter(unsigned i) {
    i = (i ^ 61u) ^ (i >> 16);
    i *= 9u;
    i ^= i >> 4;
    i *= 0x27d4eb2du;
    i ^= i >> 15;
    return float(i >> 8) / 16777216.0f;
}

void add_floor(Room& room) {
    room.put("subfloor", iron,
             between({-half_width - 0.1f, -0.2f, back - 0.1f},
                     {half_width + 0.1f, -0.022f, front + 0.1f}),
             vec3(0));
    constexpr float width = 0.15f, gap = 0.0025f, length = 1.9f;
    // Boards cut from a few logs, each somewhere else.
    std::vector<Room::Model> boards;
    const Material* kinds[]{&oak,      &oak_dark, &oak,      &oak_pale, &oak,
                            &oak_dark, &oak,      &oak_pale, &oak,      &oak_dark};
    for (unsigned i = 0; i < std::size(kinds); ++i)
        boards.push_back(room.model(
            "board " + std::to_string(i), *kinds[i],
            rounded_box({0.5 * (length - gap), 0.011, 0.5 * (width - gap)}, 0.002, 1, 1), 0.5f,
            {3.0f * float(i), 0.22f + 0.2f * scatter(i), 0.5f * scatter(i + 50) - 0.25f}));
    unsigned n = 0;
    for (int row = 0; row < 46; ++row) {
        const float z = back + width * (float(row) + 0.5f);
        if (z > front) break;
        const float shift = length * scatter(unsigned(row) + 200);
        for (float x = -half_width - shift; x < half_width; x += length, ++n) {
            const auto kind = unsigned(scatter(n + 900) * float(boards.size()));
            room.stand("board", boards[kind], {x + 0.5f * length, -0.011f, z},
                       turned(scatter(n + 400) < 0.5f ? 0.0f : 180.0f));
        }
    }
}

void add_walls(Room& room) {
    const float w = half_width, t = 0.25f;
    room.put("left wall", plaster, between({-w - t, -0.1f, back}, {-w, height, front}), vec3(0));
    room.put("back wall", plaster, between({-w - t, -0.1f, back - t}, {w + t, height, back}),
             vec3(0));
    room.put("front wall", plaster, between({-w - t, -0.1f, front}, {w + t, height, front + t}),
             vec3(0));
    room.put("ceiling", ceiling_white,
             between({-w - t, height, back - t}, {w + t, height + t, front + t}), vec3(0));
    // Around the window.
    const std::vector<Mesh> parts{
        between({w, -0.1f, back}, {w + t, height, window_far}, 0.001),
        between({w, -0.1f, window_near}, {w + t, height, front}, 0.001),
        between({w, -0.1f, window_far}, {w + t, window_low, window_near}, 0.001),
        between({w, window_high, window_far}, {w + t, height, window_near}, 0.001)};
    room.put("window wall", sandstone, with_metric_uv(joined(parts)), vec3(0));
    // Skirting boards.
    const Mesh back_board = slab({2.0 * w, 0.11, 0.02});
    const Mesh side_board = slab({double(front - back), 0.11, 0.02});
    room.put("skirting back", walnut, back_board, {0, 0.055f, back + 0.01f}, as_is, 0.8f,
             {0, 0.1f, 0.3f});
    room.put("skirting left", walnut, side_board, {-w + 0.01f, 0.055f, 0.5f * (front + back)},
             turned(90), 0.8f, {9, 0.1f, 0.3f});
    room.put("skirting right", walnut, side_board, {w - 0.01f, 0.055f, 0.5f * (front + back)},
             turned(-90), 0.8f, {5, 0.1f, 0.3f});
    // Beams under the ceiling.
    const Mesh beam = rounded_box({w, 0.11, 0.09}, 0.015, 1, 3);
    for (int i = 0; i < 5; ++i)
        room.put("beam " + std::to_string(i), beam_oak, beam,
                 {0, height - 0.09f, back + 0.7f + 1.35f * float(i)}, as_is, 0.8f,
                 {7.0f * float(i), 0.05f, 0.03f});
}

void add_window(Room& room) {
    const float x = half_width + 0.13f, middle = 0.5f * (window_near + window_far);
    const float wide = window_near - window_far, tall = window_high - window_low;
    const float centre_y = 0.5f * (window_low + window_high);
    const auto bar = [&](const std::string& name, float length, float thick, const vec3& place,
                         const quat& turn) {
        room.put(name, walnut, rounded_box({0.5 * length, 0.5 * thick, 0.5 * thick}, 0.008, 1, 3),
                 place, turn, 0.8f, place + vec3(0, 0.2f, 0));
    };
    for (const float side : {-1.0f, 1.0f}) {
        bar("window post", tall, 0.075f, {x, centre_y, middle + side * (0.5f * wide - 0.035f)},
            upright);
        bar("window rail", wide, 0.07f, {x, centre_y + side * (0.5f * tall - 0.034f), middle},
            turned(90));
    }
    bar("window mullion", tall - 0.02f, 0.055f, {x, centre_y, middle}, upright);
    bar("window transom", wide - 0.02f, 0.05f, {x, centre_y + 0.28f, middle}, turned(90));
    for (const float side : {-1.0f, 1.0f})
        bar("window bar", wide - 0.02f, 0.026f,
            {x, centre_y + 0.28f * (side > 0 ? -0.9f : -2.0f) + 0.28f * 0.4f, middle}, turned(90));
    room.put("sill", granite, rounded_box({0.19, 0.028, 0.5 * wide + 0.06}, 0.012, 1, 4),
             {half_width + 0.03f, window_low + 0.02f, middle}, as_is);

    // Curtains in folds, held back by a band.
    const auto curtain = [](double u, double v) {
        const double s = 0.5 - 0.5 * std::cos(2 * pi * u), off = -0.010 * std::sin(2 * pi * u);
        const double held = std::exp(-std::pow((v - 0.40) / 0.17, 2.0));
        const double width = 0.62 * (1.0 - 0.45 * held);
        const double phase =
            2 * pi * 6.0 * s + 0.9 * std::sin(2 * pi * s) + 0.5 * std::sin(3.0 * v);
        const double deep = (0.050 + 0.02 * std::sin(5.0 * s + 2.0 * v)) * (1.0 - 0.25 * held);
        return dvec3(width * (s - 0.5), 2.42 * v,
                     deep * std::sin(phase) + off * (1.0 + 0.5 * held));
    };
    const Room::Model cloth = room.model("curtain", wine_velvet,
                                         tessellate(curtain, {560, 110}, {.u = true, .v = false}));
    for (const float z : {window_near + 0.16f, window_far - 0.16f})
        room.stand("curtain", cloth, {half_width - 0.17f, 0.03f, z},
                   turned(z > middle ? -90.0f : 90.0f));
    room.put("curtain rod", brass,
             laid(lathe(std::array{dvec2{0, -1.55}, dvec2{0.035, -1.55}, dvec2{0.03, -1.47},
                                   dvec2{0.014, -1.46}, dvec2{0.014, -1.4}, dvec2{0.014, 0},
                                   dvec2{0.014, 1.4}, dvec2{0.014, 1.46}, dvec2{0.03, 1.47},
                                   dvec2{0.035, 1.55}, dvec2{0, 1.55}},
                        {24, 60})),
             {half_width - 0.17f, 2.49f, middle}, turned(90));
}

void add_courtyard(Room& room) {
    room.put("court", court_stone,
             with_metric_uv(between({half_width + 0.26f, -0.6f, -16}, {16, -0.3f, 12})), vec3(0));
    room.put("court wall", court_sandstone,
             with_metric_uv(between({10.0f, -0.35f, -16}, {10.4f, 1.55f, 12})), vec3(0));
    room.put("court coping", granite, rounded_box({0.28, 0.05, 13.9}, 0.02, 1, 3),
             {10.2f, 1.6f, -2});
    const Mesh ball = sphere(0.62, {90, 60}),
               cone = superellipsoid({0.55, 1.5, 0.55}, 1.3, 1.0, {90, 80});
    const dvec2 pot[]{{0, 0},       {0.24, 0},    {0.27, 0.02}, {0.33, 0.3}, {0.40, 0.5},
                      {0.40, 0.56}, {0.36, 0.56}, {0.34, 0.5},  {0, 0.48}};
    const Room::Model pots = room.model("tree pot", warm_marble, lathe(pot, {60, 40}), 1.0f);
    for (int i = 0; i < 5; ++i) {
        const vec3 place(7.4f + 0.4f * float(i % 2), -0.3f, -6.8f + 2.1f * float(i));
        room.stand("tree pot", pots, place);
        room.put("tree " + std::to_string(i), foliage, i % 2 ? cone : ball,
                 place + vec3(0, i % 2 ? 1.9f : 1.05f, 0));
    }
    const auto sky = [](double u, double v) {
        const double angle = (80 - 160 * u) * double(degree);
        return dvec3(3.0 + 22.0 * std::cos(angle), -1.0 + 9.5 * v, -2.0 + 22.0 * std::sin(angle));
    };
    room.put("sky", glowing("sky", {0.50, 0.70, 0.98}, 2.2),
             tessellate(sky, {60, 8}, {.u = false, .v = false}), vec3(0));
}

void add_fireplace(Room& room) {
    const float left = fire_x - 1.0f, right = fire_x + 1.0f, z = breast_front;
    constexpr float half_opening = 0.46f, opening_high = 0.80f;
    const std::vector<Mesh> breast{
        between({left, 0, back - 0.01f}, {fire_x - half_opening, height, z}, 0.001),
        between({fire_x + half_opening, 0, back - 0.01f}, {right, height, z}, 0.001),
        between({fire_x - half_opening, opening_high, back - 0.01f},
                {fire_x + half_opening, height, z}, 0.001)};
    room.put("chimney", brick, with_metric_uv(joined(breast)), vec3(0));
    room.put("fireback", iron, rounded_box({half_opening + 0.02, 0.4, 0.01}, 0.005, 1, 2),
             {fire_x, 0.40f, back + 0.02f});
    room.put("hearth", hearth_stone,
             with_metric_uv(between({left - 0.1f, -0.01f, back + 0.03f},
                                    {right + 0.1f, 0.055f, z + 0.55f}, 0.012)),
             vec3(0));

    // The mantelpiece: two columns on plinths, a frieze and a shelf.
    const float y0 = 0.055f, zc = z + 0.12f;
    const dvec2 shaft[]{{0, 0},         {0.095, 0},    {0.10, 0.0},    {0.10, 0.03}, {0.075, 0.045},
                        {0.085, 0.065}, {0.07, 0.085}, {0.066, 0.1},   {0.069, 0.3}, {0.066, 0.55},
                        {0.058, 0.72},  {0.058, 0.74}, {0.072, 0.755}, {0.06, 0.77}, {0.065, 0.79},
                        {0.095, 0.82},  {0.10, 0.83},  {0.10, 0.85},   {0, 0.85}};
    const Room::Model column =
        room.model("mantel column", white_marble, lathe(shaft, {96, 130}), 3.0f, {0, 4, 0});
    const Room::Model plinth =
        room.model("mantel plinth", white_marble, rounded_box({0.125, 0.06, 0.115}, 0.008, 1, 3),
                   3.0f, {2, 0, 0});
    for (const float side : {-1.0f, 1.0f}) {
        const float x = fire_x + side * 0.64f;
        room.stand("mantel plinth", plinth, {x, y0 + 0.06f, zc});
        room.stand("mantel column", column, {x, y0 + 0.12f, zc});
    }
    room.put("mantel frieze", white_marble, rounded_box({0.80, 0.085, 0.115}, 0.008, 4, 3),
             {fire_x, y0 + 1.055f, zc}, as_is, 3.0f);
    room.put("mantel shelf", white_marble, rounded_box({0.92, 0.03, 0.17}, 0.02, 4, 6),
             {fire_x, y0 + 1.17f, zc + 0.03f}, as_is, 3.0f, {0, 1, 0});
    const std::vector<Mesh> jambs{
        between({-half_opening - 0.10f, 0, -0.02f}, {-half_opening + 0.005f, 0.93f, 0.02f}),
        between({half_opening - 0.005f, 0, -0.02f}, {half_opening + 0.10f, 0.93f, 0.02f}),
        between({-half_opening - 0.09f, opening_high - 0.005f, -0.018f},
                {half_opening + 0.09f, 0.94f, 0.018f})};
    room.put("fire surround", green_marble, jambs, {fire_x, y0, z + 0.022f}, as_is, 6.0f);

    // The fire: logs on irons, flames that give their own light.
    const Mesh log = laid(lathe(std::array{dvec2{0, -0.27}, dvec2{0.05, -0.27}, dvec2{0.055, -0.27},
                                           dvec2{0.055, -0.24}, dvec2{0.05, 0}, dvec2{0.056, 0.24},
                                           dvec2{0.055, 0.27}, dvec2{0.05, 0.27}, dvec2{0, 0.27}},
                                {48, 40}));
    room.put("log left", beam_oak, log, {fire_x - 0.05f, 0.125f, back + 0.22f}, turned(8), 3.0f);
    room.put("log right", beam_oak, log, {fire_x + 0.03f, 0.12f, back + 0.35f}, turned(-7), 3.0f);
    room.put("log top", beam_oak, log, {fire_x, 0.215f, back + 0.28f}, turned(24), 3.0f);
    const dvec2 flame[]{{0, 0},        {0.05, 0.0},  {0.075, 0.06}, {0.06, 0.15},
                        {0.025, 0.25}, {0.01, 0.32}, {0, 0.36}};
    const Mesh tongue = lathe(flame, {40, 50});
    const Material flames[]{glowing("flame", {1.0, 0.42, 0.05}, 2.6),
                            glowing("outer flame", {1.0, 0.2, 0.015}, 2.6)};
    for (int i = 0; i < 5; ++i) {
        const float size = 0.6f + 0.5f * scatter(unsigned(i) + 7);
        room.put(
            "flame " + std::to_string(i), flames[i % 2], scaled(tongue, size),
            {fire_x - 0.22f + 0.11f * float(i), 0.20f, back + 0.24f + 0.05f * scatter(unsigned(i))},
            turned(10.0f * (scatter(unsigned(i) + 3) - 0.5f), z_axis));
    }
    const Room::Model iron_bar =
        room.model("fire iron", iron, rounded_box({0.012, 0.012, 0.16}, 0.006, 1, 2));
    for (const float side : {-1.0f, 1.0f})
        room.stand("fire iron", iron_bar, {fire_x + side * 0.16f, 0.066f, back + 0.28f});

    // On the shelf, and the picture above it.
    const float shelf = y0 + 1.2f;
    const dvec2 urn[]{{0, 0},        {0.05, 0},     {0.055, 0},    {0.055, 0.012}, {0.022, 0.03},
                      {0.03, 0.06},  {0.085, 0.12}, {0.095, 0.19}, {0.06, 0.25},   {0.035, 0.28},
                      {0.06, 0.315}, {0.058, 0.32}, {0.03, 0.285}, {0, 0.27}};
    const Room::Model urns = room.model("urn", warm_marble, lathe(urn, {90, 110}), 4.0f);
    for (const float side : {-1.0f, 1.0f})
        room.stand("urn", urns, {fire_x + side * 0.72f, shelf, zc + 0.02f});
    const dvec2 stick[]{{0, 0},        {0.05, 0},      {0.053, 0.003}, {0.045, 0.015},
                        {0.012, 0.03}, {0.014, 0.08},  {0.009, 0.13},  {0.02, 0.17},
                        {0.022, 0.18}, {0.012, 0.182}, {0.011, 0.18},  {0, 0.18}};
    const dvec2 candle[]{{0, 0.17},    {0.011, 0.17}, {0.011, 0.18},
                         {0.011, 0.3}, {0.010, 0.36}, {0, 0.36}};
    const Room::Model sticks = room.model("candlestick", brass, lathe(stick, {48, 80}));
    const Room::Model candles = room.model(
        "candle", plastic_in("wax", {0.86, 0.80, 0.66}, 0.6, 0.2), lathe(candle, {32, 24}));
    for (const float x : {-0.44f, -0.30f, 0.36f}) {
        room.stand("candlestick", sticks, {fire_x + x, shelf, zc + 0.03f});
        room.stand("candle", candles, {fire_x + x, shelf, zc + 0.03f});
    }
    const auto frame_bar = [&](const std::string& name, float length, float thick,
                               const vec3& place, const quat& turn) {
        room.put(name, walnut, rounded_box({0.5 * length, 0.5 * thick, 0.02}, 0.012, 1, 4), place,
                 turn, 2.0f, place);
    };
    const vec3 picture(fire_x, 1.93f, z + 0.022f);
    frame_bar("picture frame top", 1.02f, 0.06f, picture + vec3(0, 0.35f, 0), as_is);
    frame_bar("picture frame bottom", 1.02f, 0.06f, picture - vec3(0, 0.35f, 0), as_is);
    frame_bar("picture frame left", 0.76f, 0.064f, picture - vec3(0.48f, 0, -0.001f), upright);
    frame_bar("picture frame right", 0.76f, 0.064f, picture + vec3(0.48f, 0, 0.001f), upright);
    room.put("picture", warm_marble, slab({0.94, 0.68, 0.012}), picture - vec3(0, 0, 0.008f), as_is,
             2.5f, {0, 3, 0});
}

/// A turned leg from the floor up to `tall`, laid along x.
Mesh leg(double tall, double thick) {
    const dvec2 profile[]{{0, 0},
                          {0.55 * thick, 0},
                          {0.62 * thick, 0.01},
                          {0.5 * thick, 0.12 * tall},
                          {0.75 * thick, 0.22 * tall},
                          {0.6 * thick, 0.3 * tall},
                          {0.95 * thick, 0.6 * tall},
                          {0.6 * thick, 0.72 * tall},
                          {1.1 * thick, 0.76 * tall},
                          {0.7 * thick, 0.8 * tall},
                          {thick, 0.85 * tall},
                          {thick, tall},
                          {thick, tall},
                          {0, tall}};
    return laid(lathe(profile, {48, 90}));
}

void add_armchair(Room& room, const std::string& name, const Material& cloth,
                  const Material& pillow, const vec3& place, float facing) {
    const quat turn = turned(facing);
    const auto at = [&](const vec3& p) { return place + turn * p; };
    const std::vector<Mesh> body{
        moved(rounded_box({0.36, 0.12, 0.37}, 0.05, 6, 6), {0, 0.27f, 0.0f}),
        moved(superellipsoid({0.315, 0.105, 0.37}, 0.3, 0.35, {120, 60}), {0, 0.425f, 0.05f}),
        moved(rounded_box({0.36, 0.40, 0.10}, 0.095, 8, 12), {0, 0.60f, -0.33f},
              turned(-11, x_axis)),
        moved(rounded_box({0.095, 0.20, 0.40}, 0.09, 8, 12), {-0.395f, 0.385f, 0.0f}),
        moved(rounded_box({0.095, 0.20, 0.40}, 0.09, 8, 12), {0.395f, 0.385f, 0.0f}),
    };
    room.put(name, cloth, body, place, turn);
    room.put(name + " cushion", pillow, superellipsoid({0.22, 0.075, 0.22}, 0.75, 0.45, {100, 50}),
             at({0.03f, 0.70f, -0.155f}), turn * turned(12, z_axis) * turned(69, x_axis));
    const Room::Model foot =
        room.model(name + " foot", walnut, leg(0.17, 0.028), 3.0f, {0, 0.1f, 0});
    for (const float x : {-0.36f, 0.36f})
        for (const float z : {-0.30f, 0.32f})
            room.stand(name + " foot", foot, at({x, 0, z}), upright);
}

void add_coffee_table(Room& room, const vec3& place) {
    const dvec2 top[]{{0, 0},         {0.45, 0},    {0.5, 0},      {0.515, 0.012},
                      {0.515, 0.022}, {0.5, 0.034}, {0.45, 0.034}, {0, 0.034}};
    constexpr float high = 0.40f, surface = high + 0.034f;
    room.put("coffee table top", green_marble, lathe(top, {160, 50}), place + vec3(0, high, 0),
             as_is, 5.0f);
    const dvec2 apron[]{{0.34, 0},    {0.35, 0},    {0.36, 0},    {0.36, 0.01},
                        {0.36, 0.06}, {0.36, 0.07}, {0.35, 0.07}, {0.34, 0.07},
                        {0.34, 0.06}, {0.34, 0.01}, {0.34, 0}};
    room.put("coffee table apron", walnut, lathe(apron, {96, 24}),
             place + vec3(0, high - 0.069f, 0), as_is, 2.0f, {0, 0.3f, 0});
    const Room::Model legs =
        room.model("coffee table leg", walnut, leg(high + 0.001, 0.03), 3.0f, {0, 0.08f, 0});
    for (int i = 0; i < 4; ++i)
        room.stand("coffee table leg", legs,
                   place + turned(45.0f + 90.0f * float(i)) * vec3(0.34f, 0, 0), upright);

    // The tea things.
    const dvec2 body[]{{0, 0},         {0.09, 0},      {0.10, 0.0},    {0.115, 0.02},
                       {0.118, 0.07},  {0.095, 0.125}, {0.062, 0.15},  {0.06, 0.153},
                       {0.064, 0.157}, {0.06, 0.162},  {0.03, 0.175},  {0.012, 0.18},
                       {0.010, 0.188}, {0.018, 0.197}, {0.016, 0.206}, {0, 0.209}};
    const auto spout = [](double s) {
        return dvec2(0.085 + 0.10 * s + 0.012 * std::sin(2 * pi * s),
                     0.055 + 0.105 * s * s + 0.01 * s);
    };
    const auto bail = [](double s) {
        return dvec2(0.085 * std::cos(pi * (1.0 - s)), 0.125 + 0.14 * std::sin(pi * s));
    };
    const std::vector<Mesh> kettle{
        lathe(body, {120, 130}),
        planar_tube(spout, [](double s) { return 0.026 - 0.014 * s; }, {40, 40}),
        planar_tube(bail, [](double) { return 0.007; }, {24, 80})};
    room.put("kettle", blue_enamel, kettle, place + vec3(-0.02f, surface, -0.02f), turned(-35));
    const dvec2 cup[]{{0, 0},        {0.024, 0},    {0.027, 0.0},  {0.027, 0.005},
                      {0.036, 0.02}, {0.041, 0.05}, {0.043, 0.07}, {0.042, 0.072},
                      {0.040, 0.07}, {0.037, 0.05}, {0.03, 0.018}, {0, 0.012}};
    const auto ear = [](double s) {
        return dvec2(0.036 + 0.024 * std::sin(pi * s), 0.018 + 0.038 * s);
    };
    const std::vector<Mesh> cups{lathe(cup, {72, 70}),
                                 planar_tube(ear, [](double) { return 0.0035; }, {16, 40})};
    const dvec2 saucer[]{{0, 0},         {0.03, 0},      {0.035, 0.002},
                         {0.068, 0.012}, {0.07, 0.014},  {0.068, 0.016},
                         {0.034, 0.006}, {0.03, 0.0045}, {0, 0.0045}};
    const Room::Model cup_model = room.model("cup", cream_enamel, joined(cups));
    const Room::Model saucer_model = room.model("saucer", cream_enamel, lathe(saucer, {72, 40}));
    const vec3 places[]{{0.26f, 0, 0.12f}, {-0.16f, 0, 0.26f}, {-0.27f, 0, -0.12f}};
    for (int i = 0; i < 3; ++i) {
        room.stand("saucer", saucer_model, place + vec3(0, surface, 0) + places[i]);
        room.stand("cup", cup_model, place + vec3(0, surface + 0.0052f, 0) + places[i],
                   turned(70.0f + 100.0f * float(i)));
    }
    const dvec2 bowl[]{{0, 0},        {0.04, 0},     {0.045, 0},    {0.045, 0.008},
                       {0.05, 0.015}, {0.1, 0.045},  {0.12, 0.075}, {0.118, 0.078},
                       {0.11, 0.072}, {0.09, 0.048}, {0.04, 0.022}, {0, 0.02}};
    room.put("bowl", warm_marble, lathe(bowl, {96, 80}), place + vec3(0.14f, surface, -0.26f),
             as_is, 5.0f);
}

/// A chair with turned legs and a back of slats, facing +z.
void add_chair(Room& room, const std::string& name, const vec3& place, float facing) {
    const quat turn = turned(facing);
    const auto at = [&](const vec3& p) { return place + turn * p; };
    const Room::Model front_leg =
        room.model(name + " leg", oak_dark, leg(0.45, 0.021), 2.5f, {0, 0.09f, 0.02f});
    for (const float x : {-0.18f, 0.18f})
        room.stand(name + " leg", front_leg, at({x, 0, 0.18f}), turn * upright);
    const Mesh post = laid(rounded_box({0.018, 0.50, 0.018}, 0.01, 4, 4));
    for (const float x : {-0.18f, 0.18f})
        room.put(name + " post", oak_dark, post, at({x, 0.495f, -0.21f}),
                 turn * turned(-6, x_axis) * upright, 2.5f, {x * 9.0f, 0.08f, 0});
    room.put(name + " seat", oak_dark, superellipsoid({0.225, 0.022, 0.225}, 0.35, 0.3, {120, 40}),
             at({0, 0.462f, 0}), turn, 2.0f, {0, 0.15f, 0});
    for (int i = 0; i < 3; ++i) {
        const float y = 0.62f + 0.14f * float(i);
        const double bow = 0.035;
        const auto slat = [&](double u, double v) {  // a bent board
            const double around = 2 * pi * u, s = 2 * v - 1;
            return dvec3(0.178 * s, 0.034 * std::sin(around),
                         -bow * (1 - s * s) + 0.009 * std::cos(around));
        };
        room.put(name + " slat " + std::to_string(i), oak_dark,
                 tessellate(slat, {40, 40}, {.u = true, .v = false}),
                 at({0, y, -0.21f - 0.105f * (y - 0.495f)}), turn, 2.5f, {float(i), 0.12f, 0});
    }
    const Mesh rung = laid(
        lathe(std::array{dvec2{0, -0.17}, dvec2{0.008, -0.17}, dvec2{0.01, -0.1}, dvec2{0.014, 0},
                         dvec2{0.01, 0.1}, dvec2{0.008, 0.17}, dvec2{0, 0.17}},
              {24, 30}));
    room.put(name + " rung", oak_dark, rung, at({0, 0.17f, 0.18f}), turn, 2.5f);
}

/// A shade around a bulb, open above and below.
Mesh lamp_shade(double below, double above, double tall) {
    const dvec2 profile[]{{below - 0.002, 0},     {below, 0},
                          {below, 0.004},         {above, tall - 0.004},
                          {above, tall},          {above - 0.002, tall},
                          {above - 0.004, tall},  {above - 0.004, tall - 0.004},
                          {below - 0.004, 0.004}, {below - 0.004, 0},
                          {below - 0.002, 0}};
    return lathe(profile, {96, 40});
}

const Material linen = plastic_in("linen", {0.72, 0.62, 0.46});
const Material lit_shade = glowing("lit shade", {0.95, 0.68, 0.36}, 2.0);

void add_lamps(Room& room, const vec3& floor_lamp, const vec3& table_lamp) {
    const dvec2 stand[]{{0, 0},        {0.14, 0},    {0.15, 0.004}, {0.13, 0.02}, {0.03, 0.035},
                        {0.014, 0.06}, {0.012, 0.2}, {0.012, 0.7},  {0.02, 0.72}, {0.012, 0.74},
                        {0.011, 0.9},  {0.010, 1.4}, {0.010, 1.46}, {0, 1.46}};
    room.put("floor lamp", brass, lathe(stand, {64, 120}), floor_lamp);
    room.put("floor lamp shade", lit_shade, lamp_shade(0.22, 0.13, 0.26),
             floor_lamp + vec3(0, 1.42f, 0));
    const dvec2 foot[]{{0, 0},         {0.07, 0},     {0.075, 0.004}, {0.06, 0.014},
                       {0.03, 0.03},   {0.05, 0.08},  {0.07, 0.14},   {0.045, 0.2},
                       {0.014, 0.235}, {0.012, 0.26}, {0.010, 0.3},   {0, 0.3}};
    room.put("table lamp", cream_enamel, lathe(foot, {80, 100}), table_lamp);
    room.put("table lamp shade", linen, lamp_shade(0.16, 0.09, 0.19),
             table_lamp + vec3(0, 0.28f, 0));
}

/// A dish above a bulb; @param bulb  its centre. The lamp itself is just below it.
void add_pendant(Room& room, const vec3& bulb) {
    const dvec2 dish[]{{0.010, 0.108}, {0.03, 0.105},   {0.05, 0.092},   {0.14, 0.058},
                       {0.22, 0.005},  {0.234, -0.004}, {0.238, -0.003}, {0.235, 0.0},
                       {0.22, 0.01},   {0.14, 0.065},   {0.05, 0.10},    {0.03, 0.118},
                       {0.010, 0.12}};
    room.put("pendant dish", glowing("lit brass", {0.85, 0.55, 0.22}, 1.3), lathe(dish, {120, 70}),
             bulb);
    const dvec2 rod[]{{0, 0.02},    {0.016, 0.02}, {0.018, 0.03}, {0.018, 0.12}, {0.006, 0.15},
                      {0.005, 0.2}, {0.005, 0.6},  {0.03, 0.74},  {0.05, 0.775}, {0, 0.779}};
    room.put("pendant rod", brass, lathe(rod, {40, 60}), bulb);
    room.put("pendant globe", lit_shade, sphere(0.032, {48, 32}), bulb);
}

void add_side_table(Room& room, const vec3& place) {
    const dvec2 column[]{{0, 0},       {0.18, 0},    {0.19, 0.006}, {0.17, 0.03},  {0.05, 0.05},
                         {0.025, 0.1}, {0.045, 0.2}, {0.028, 0.3},  {0.024, 0.45}, {0.04, 0.55},
                         {0.09, 0.57}, {0.1, 0.59},  {0, 0.59}};
    room.put("side table column", walnut, laid(lathe(column, {72, 110})), place, upright, 2.0f,
             {0, 0.06f, 0.02f});
    const dvec2 top[]{{0, 0},        {0.26, 0},    {0.30, 0},    {0.31, 0.008}, {0.305, 0.016},
                      {0.31, 0.024}, {0.30, 0.03}, {0.26, 0.03}, {0, 0.03}};
    room.put("side table top", walnut, lathe(top, {120, 44}), place + vec3(0, 0.588f, 0),
             turned(20), 1.6f, {0, 0.05f, 0.12f});
}

void add_bookcase(Room& room, float left, float right) {
    constexpr float tall = 2.05f, deep = 0.30f, board = 0.026f;
    const float z = back + 0.5f * deep + 0.004f, middle = 0.5f * (left + right),
                wide = right - left;
    const Mesh side = rounded_box({0.5 * tall, 0.5 * board, 0.5 * deep}, 0.004, 1, 2);
    for (const float x : {left, right})
        room.put("bookcase side", walnut, side, {x, 0.5f * tall, z}, upright, 1.2f,
                 {x, 0.2f, 0.1f});
    const Mesh shelf =
        rounded_box({0.5 * wide - 0.01, 0.5 * board, 0.5 * deep - 0.004}, 0.004, 1, 2);
    const float shelves[]{0.09f, 0.47f, 0.85f, 1.22f, 1.58f, tall - 0.02f};
    for (const float y : shelves)
        room.put("bookcase shelf", walnut, shelf, {middle, y, z}, as_is, 1.2f,
                 {3 * y, 0.25f, 0.1f});
    room.put("bookcase back", walnut, slab({double(wide), double(tall) - 0.03, 0.012}),
             {middle, 0.5f * tall, back + 0.008f}, as_is, 1.2f, {0, 0, 0.5f});
    room.put("bookcase cornice", walnut,
             rounded_box({0.5 * wide + 0.05, 0.03, 0.5 * deep + 0.03}, 0.02, 1, 5),
             {middle, tall + 0.02f, z + 0.014f}, as_is, 1.2f, {5, 0.2f, 0.1f});

    // Books of few formats in many places.
    const Material covers[]{plastic_in("leather brown", {0.20, 0.09, 0.045}, 0.35, 0.15, 0.2),
                            plastic_in("leather red", {0.30, 0.035, 0.03}, 0.35, 0.15, 0.2),
                            plastic_in("leather green", {0.04, 0.13, 0.065}, 0.35, 0.15, 0.2),
                            plastic_in("leather blue", {0.04, 0.07, 0.18}, 0.35, 0.15, 0.2),
                            plastic_in("vellum", {0.62, 0.54, 0.38}, 0.35, 0.1, 0.2),
                            plastic_in("leather black", {0.035, 0.03, 0.028}, 0.35, 0.2, 0.2)};
    std::vector<Room::Model> books;
    std::vector<dvec3> sizes;
    for (unsigned i = 0; i < 12; ++i) {
        sizes.emplace_back(0.022 + 0.028 * scatter(i + 31), 0.20 + 0.095 * scatter(i + 67),
                           0.15 + 0.05 * scatter(i + 91));
        books.push_back(room.model("book " + std::to_string(i), covers[i % std::size(covers)],
                                   rounded_box(0.5 * sizes.back(), 0.005, 1, 2)));
    }
    unsigned n = 0;
    for (std::size_t s = 0; s + 1 < std::size(shelves); ++s) {
        float x = left + 0.03f;
        while (true) {
            const auto kind = std::size_t(scatter(n * 7 + 1000) * float(books.size()));
            const dvec3 size = sizes[kind];
            const bool gap = scatter(n + 3000) < 0.06f;
            if (x + float(size.x) + (gap ? 0.12f : 0.0f) > right - 0.03f) break;
            if (gap) x += 0.12f;
            room.stand("book", books[kind],
                       {x + 0.5f * float(size.x), shelves[s] + 0.5f * board + 0.5f * float(size.y),
                        back + 0.04f + 0.5f * float(size.z) + 0.02f * scatter(n + 5000)});
            x += float(size.x) + 0.0015f;
            ++n;
        }
    }
}

void add_door(Room& room, float middle) {
    constexpr float wide = 0.88f, tall = 2.04f, post = 0.10f;
    const float z = back + 0.02f;
    const Mesh leaf = rounded_box({0.5 * tall, 0.5 * wide, 0.02}, 0.004, 1, 2);
    room.put("door leaf", oak, leaf, {middle, 0.5f * tall + 0.008f, z}, upright, 1.0f,
             {0, 0.1f, 0.35f});
    const Mesh panel = rounded_box({0.34, 0.155, 0.016}, 0.012, 1, 4);
    for (const float x : {-0.2f, 0.2f})
        for (const float y : {0.52f, 1.45f})
            room.put("door panel", oak, panel, {middle + x, y, z + 0.018f}, upright, 1.0f,
                     {4.0f * x + y, 0.1f, 0.35f});
    const Mesh jamb = rounded_box({0.5 * (tall + 0.07), 0.5 * post, 0.035}, 0.012, 1, 4);
    for (const float side : {-1.0f, 1.0f})
        room.put("door jamb", walnut, jamb,
                 {middle + side * (0.5f * wide + 0.45f * post), 0.5f * (tall + 0.07f), z + 0.006f},
                 upright, 1.0f, {2.0f * side, 0.2f, 0.1f});
    room.put("door lintel", walnut,
             rounded_box({0.5 * wide + post + 0.04, 0.06, 0.045}, 0.014, 1, 4),
             {middle, tall + 0.105f, z + 0.008f}, as_is, 1.0f, {4, 0.2f, 0.1f});
    room.put("door knob", brass, sphere(0.028, {48, 32}), {middle - 0.38f, 1.02f, z + 0.065f});
    const dvec2 rose[]{{0, 0},         {0.03, 0},     {0.032, 0.004}, {0.012, 0.008},
                       {0.009, 0.015}, {0.009, 0.05}, {0, 0.05}};
    room.put("door rose", brass, lathe(rose, {40, 40}), {middle - 0.38f, 1.02f, z + 0.018f},
             turned(90, x_axis));
}

void add_statue(Room& room, const vec3& place) {
    const std::vector<Mesh> pedestal{
        moved(rounded_box({0.20, 0.05, 0.20}, 0.012, 4, 4), {0, 0.05f, 0}),
        moved(rounded_box({0.155, 0.42, 0.155}, 0.01, 4, 4), {0, 0.50f, 0}),
        moved(rounded_box({0.19, 0.035, 0.19}, 0.014, 4, 4), {0, 0.945f, 0})};
    room.put("pedestal", granite, pedestal, place);
    room.put("knot", white_marble, torus_knot(2, 3, 0.16, 0.07, 0.045, {360, 44}),
             place + vec3(0, 1.255f, 0), turned(35) * turned(78, x_axis), 4.0f);
}

void add_floor_vase(Room& room, const vec3& place) {
    const dvec2 vase[]{{0, 0},        {0.10, 0},     {0.115, 0},     {0.115, 0.015}, {0.09, 0.04},
                       {0.12, 0.15},  {0.18, 0.33},  {0.185, 0.48},  {0.11, 0.64},   {0.065, 0.72},
                       {0.07, 0.77},  {0.105, 0.82}, {0.107, 0.828}, {0.098, 0.825}, {0.06, 0.77},
                       {0.055, 0.72}, {0.09, 0.64},  {0, 0.60}};
    room.put("floor vase", warm_marble, lathe(vase, {120, 150}), place, as_is, 2.0f, {0, 2, 0});
}

void add_rug(Room& room, const vec3& place) {
    room.put("rug border", rug_border, rounded_box({1.55, 0.008, 1.10}, 0.006, 12, 2),
             place + vec3(0, 0.008f, 0));
    room.put("rug field", rug_field, rounded_box({1.36, 0.010, 0.91}, 0.006, 12, 2),
             place + vec3(0, 0.011f, 0));
}

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
