// Turned wood, marble and stone on a round cobbled table; the camera goes once around them.
#include <cmath>
#include <numbers>

#include "all.h"
#include "keys.h"
#include "pieces.h"

namespace estara::examples {

namespace {

using glm::dvec3;
using glm::vec3;

constexpr float degree = std::numbers::pi_v<float> / 180.0f;
const vec3 up(0.0f, 1.0f, 0.0f);

// The materials: change the look here.
const Material walnut{"walnut", "wood", {{"ringscale", {14}}}, dvec3(0.18, 0.07, 0.02)};
const Material cherry{
    "cherry",
    "wood",
    {{"ringscale", {22}}, {"lightwood", {0.45, 0.2, 0.07}}, {"darkwood", {0.16, 0.05, 0.015}}},
    dvec3(0.3, 0.12, 0.04)};
const Material maple{"maple",
                     "wood",
                     {{"ringscale", {26}},
                      {"lightwood", {0.62, 0.4, 0.2}},
                      {"darkwood", {0.3, 0.16, 0.07}},
                      {"roughness", {0.15}}},
                     dvec3(0.45, 0.28, 0.13)};
const Material pink_granite{"pink granite",
                            "stone",
                            {{"Cs", {0.75, 0.5, 0.42}},
                             {"graincolor", {0.12, 0.09, 0.09}},
                             {"exponent", {1.3}},
                             {"Ks", {0.5}}},
                            dvec3(0.45, 0.3, 0.26)};
const Material dark_granite{"dark granite",
                            "stone",
                            {{"scale", {0.012}},
                             {"Cs", {0.4, 0.42, 0.47}},
                             {"graincolor", {0.02, 0.02, 0.03}},
                             {"Ks", {0.6}}},
                            dvec3(0.14, 0.15, 0.17)};
const Material paving{"paving",
                      "cobblestone",
                      {{"variant", {1}},
                       {"txtscale", {6}},
                       {"selfCol", {0.3, 0.28, 0.25}},
                       {"varCol", {0.55, 0.5, 0.44}},
                       {"Ks", {0.12}}},
                      dvec3(0.45, 0.4, 0.35)};
const Material red_cobbles{
    "red cobbles",
    "cobblestone",
    {{"variant", {0}}, {"sscale", {18}}, {"tscale", {9}}, {"varCol", {0.72, 0.42, 0.3}}},
    dvec3(0.65, 0.4, 0.3)};
const Material green_marble{"green marble", "greenmarble", {}, dvec3(0.04, 0.16, 0.02)};
const Material black_marble{"black marble",
                            "greenmarble",
                            {{"darkcolor", {0.01, 0.01, 0.012}},
                             {"lightcolor", {0.05, 0.045, 0.05}},
                             {"veincolor", {0.8, 0.58, 0.22}},
                             {"sharpness", {16}}},
                            dvec3(0.05, 0.04, 0.03)};
const Material red_marble{"red marble",
                          "greenmarble",
                          {{"darkcolor", {0.16, 0.02, 0.015}},
                           {"lightcolor", {0.34, 0.07, 0.045}},
                           {"veincolor", {0.88, 0.78, 0.62}}},
                          dvec3(0.28, 0.06, 0.04)};
const Material plaster{"plaster",
                       "plastic",
                       {{"Ka", {0.2}}, {"Kd", {0.7}}, {"Ks", {0}}, {"Cs", {0.3, 0.24, 0.2}}},
                       dvec3(0.3, 0.24, 0.2)};

Mesh table() {
    const glm::dvec2 rim_to_centre[]{{1.54, -0.14}, {1.59, -0.13}, {1.62, -0.09}, {1.62, -0.04},
                                     {1.59, -0.01}, {1.54, 0},     {1.5, 0},      {1.1, 0},
                                     {0.5, 0},      {0, 0}};
    return lathe(rim_to_centre, {400, 50});
}

/// A cove all around: whichever way the camera looks there is something behind the table.
Mesh backdrop() {
    const glm::dvec2 rim_to_centre[]{{6.5, 2.6},   {6.5, 2.0},   {6.5, 1.2}, {6.4, 0.5}, {5.8, 0},
                                     {4.8, -0.14}, {3.2, -0.14}, {1, -0.14}, {0, -0.14}};
    return lathe(rim_to_centre, {160, 40});
}

Mesh vase() {
    const glm::dvec2 out_and_in[]{
        {0, 0},        {0.2, 0},     {0.23, 0},    {0.23, 0.03}, {0.16, 0.09}, {0.2, 0.2},
        {0.31, 0.45},  {0.33, 0.65}, {0.2, 0.88},  {0.1, 0.98},  {0.1, 1.06},  {0.17, 1.14},
        {0.175, 1.15}, {0.16, 1.15}, {0.08, 1.05}, {0.08, 0.97}, {0.18, 0.87}, {0.3, 0.64},
        {0.28, 0.45},  {0.15, 0.2},  {0.06, 0.12}, {0, 0.12}};
    return lathe(out_and_in, {220, 160});
}

Mesh bowl() {
    const glm::dvec2 out_and_in[]{{0, 0},         {0.16, 0},      {0.19, 0},    {0.19, 0.03},
                                  {0.17, 0.05},   {0.3, 0.1},     {0.42, 0.22}, {0.46, 0.33},
                                  {0.465, 0.345}, {0.445, 0.345}, {0.4, 0.24},  {0.29, 0.13},
                                  {0.12, 0.09},   {0, 0.09}};
    return lathe(out_and_in, {220, 100});
}

Mesh goblet() {
    const glm::dvec2 out_and_in[]{{0, 0},        {0.15, 0},     {0.18, 0},     {0.185, 0.015},
                                  {0.12, 0.04},  {0.04, 0.07},  {0.032, 0.16}, {0.05, 0.21},
                                  {0.032, 0.25}, {0.05, 0.29},  {0.15, 0.36},  {0.19, 0.47},
                                  {0.175, 0.6},  {0.17, 0.615}, {0.16, 0.6},   {0.17, 0.47},
                                  {0.13, 0.37},  {0.05, 0.32},  {0, 0.31}};
    return lathe(out_and_in, {140, 140});
}

/// Three balls in the bowl and a fourth upon them.
void add_balls(std::vector<Piece>& pieces, const vec3& bowl_position) {
    constexpr float radius = 0.145f, height = 0.26f;
    const float circle = radius * 2.0f / std::numbers::sqrt3_v<float>;  // they touch
    const Mesh ball = sphere(radius, {120, 70});
    const struct {
        const char* name;
        Material material;
        float pattern;
    } looks[]{{"green ball", green_marble, 6.0f},
              {"granite ball", dark_granite, 1.0f},
              {"black ball", black_marble, 6.0f},
              {"top ball", pink_granite, 1.5f}};
    for (int i = 0; i < 4; ++i) {
        const float angle = degree * float(120 * i + 20);
        const float upper = std::sqrt(4.0f * radius * radius - circle * circle);
        const vec3 place = i < 3 ? vec3(circle * std::cos(angle), height, circle * std::sin(angle))
                                 : vec3(0.0f, height + upper, 0.0f);
        pieces.push_back({looks[i].name, looks[i].material, ball, bowl_position + place,
                          glm::angleAxis(angle, up), looks[i].pattern});
    }
}

std::vector<Piece> arrangement() {
    const auto turned = [](float degrees) { return glm::angleAxis(degree * degrees, up); };
    const glm::quat on_edge = turned(62) * glm::angleAxis(degree * 76, vec3(1, 0, 0));
    const vec3 bowl_position(0.68f, 0, 0.38f), centre(-0.05f, 0, -0.1f), ring(-0.6f, 0, -0.7f);
    std::vector<Piece> pieces{
        {"table", paving, table(), vec3(0)},
        {"backdrop", plaster, backdrop(), vec3(0)},
        resting(
            {"plinth", walnut, rounded_box({0.34, 0.06, 0.34}, 0.02, 16, 8), centre, turned(25)}),
        {"vase", green_marble, vase(), centre + vec3(0, 0.12f, 0), turned(0), 4.0f},
        {"bowl", cherry, bowl(), bowl_position, turned(-30)},
        {"goblet", maple, goblet(), vec3(-0.1f, 0, 0.82f), turned(40)},
        resting({"knot", pink_granite, torus_knot(2, 3, 0.27, 0.12, 0.075, {500, 56}),
                 vec3(-0.85f, 0, 0.25f), on_edge}),
        resting({"cushion", red_cobbles, superellipsoid({0.27, 0.22, 0.27}, 0.4, 0.4, {140, 90}),
                 vec3(0.6f, 0, -0.62f), turned(15)}),
        resting({"ring", red_marble, torus(0.2, 0.07, {140, 60}), ring, turned(0), 4.0f}),
        {"egg", maple, superellipsoid({0.16, 0.21, 0.16}, 1, 1, {90, 60}), ring + vec3(0, 0.25f, 0),
         turned(70) * glm::angleAxis(degree * 12, vec3(0, 0, 1))},
    };
    add_balls(pieces, bowl_position);
    return pieces;
}

void add_lamps(GlbBuilder& out) {
    const vec3 aim(0, 0.3f, 0), key(-3.0f, 4.2f, 2.6f), fill(3.2f, 2.4f, -2.4f);
    const double key_strength = candela_for(1.4, glm::distance(key, aim));
    const double fill_strength = candela_for(0.3, glm::distance(fill, aim));
    out.add_lamp({"key", "spot", dvec3(1.0, 0.87, 0.7), key_strength, 0.32, 0.55},
                 {key, looking_along(aim - key)});
    out.add_lamp({"fill", "point", dvec3(0.7, 0.83, 1.0), fill_strength}, {fill});
    out.set_ambient(dvec3(0.6, 0.62, 0.66));
}

/// Once around, looking slightly down.
void add_camera(GlbBuilder& out) {
    constexpr float distance = 4.4f, pitch = 20 * degree;
    const int pivot = out.add_node("orbit", {vec3(0, 0.42f, 0)});
    const vec3 eye = distance * vec3(0, std::sin(pitch), std::cos(pitch));
    out.add_camera("camera", 0.46, {eye, looking_along(-eye), 1.0f, pivot});
    const auto angle = [](double part) {
        return glm::angleAxis(float(2.0 * std::numbers::pi * part), up);
    };
    out.animate_rotation(pivot, frame_times(), frame_values<glm::quat>(angle));
}

void build(GlbBuilder& out) {
    for (const Piece& piece : arrangement()) add_piece(out, piece);
    add_lamps(out);
    add_camera(out);
}

}  // namespace

const Example still_life{"still-life", "wood, marble and stone on a table, the camera goes around",
                         build};

}  // namespace estara::examples
