// One object for each of the paper's eleven shaders, all about equally large in the image: its
// simple scene, on which it measures one shader after the other.
#include <cmath>
#include <numbers>

#include "all.h"
#include "camera_path.h"
#include "pieces.h"

namespace estara::examples {

namespace {

using glm::dvec3;
using glm::vec3;

constexpr float degree = std::numbers::pi_v<float> / 180.0f;
const vec3 up(0.0f, 1.0f, 0.0f);

enum class Form { ball, cube, box };

/// An object on the steps, named after its shader.
struct Exhibit {
    Material material;
    Form form;
    float pattern;  ///< object space units in a scene unit
};

const dvec3 plain(0.5);

// From left to right. The numbers are in object space, which `pattern` makes smaller.
const Exhibit front[]{
    {{"skin",
      "RCSkin",
      {{"skincolor", {0.68, 0.47, 0.38}}, {"blemishthresh", {2.6}}, {"poresdepth", {-0.0016}}},
      dvec3(0.68, 0.47, 0.38)},
     Form::ball,
     1.0f},
    {{"wood",
      "wood",
      {{"ringscale", {14}}, {"lightwood", {0.5, 0.24, 0.09}}, {"darkwood", {0.14, 0.045, 0.015}}},
      dvec3(0.32, 0.14, 0.05)},
     Form::cube,
     1.0f},
    {{"enamel",
      "spatter",
      {{"specksize", {0.008}},
       {"sizes", {4}},
       {"basecolor", {0.02, 0.08, 0.34}},
       {"Ka", {0.35}},
       {"Kd", {0.7}},
       {"roughness", {0.05}}},
      dvec3(0.1, 0.15, 0.4)},
     Form::ball,
     1.0f},
    {{"velvet",
      "velvet",
      {{"Cs", {0.36, 0.01, 0.04}},
       {"Ka", {0.3}},
       {"Kd", {0.38}},
       {"backscatter", {0.3}},
       {"sheen", {0.5, 0.22, 0.24}},
       {"edginess", {8}}},
      dvec3(0.45, 0.03, 0.07)},
     Form::cube,
     1.0f},
};
const Exhibit middle[]{
    {{"white marble",
      "cmarble",
      {{"veining", {2.5}}, {"Cs", {0.80, 0.55, 0.45}}},
      dvec3(0.8, 0.75, 0.7)},
     Form::ball,
     1.0f},
    {{"blocks",
      "blocks",
      {{"variant", {0}},
       {"blockwidth", {0.25}},
       {"blockheight", {0.125}},
       {"mortarthickness", {0.012}},
       {"blockcolor", {0.74, 0.52, 0.36}},
       {"mortarcolor", {0.50, 0.46, 0.42}},
       {"blockvary", {0.4}},
       {"Ka", {0.35}},
       {"Kd", {0.8}}},
      dvec3(0.65, 0.62, 0.56)},
     Form::box,
     1.0f},
    {{"green marble",
      "greenmarble",
      {{"Ka", {0.3}}, {"roughness", {0.02}}},
      dvec3(0.04, 0.16, 0.02)},
     Form::ball,
     4.0f},
};
const Exhibit back[]{
    {{"cobbles",
      "cobblestone",
      {{"variant", {0}}, {"sscale", {18}}, {"tscale", {10}}, {"varCol", {0.72, 0.50, 0.38}}},
      dvec3(0.6, 0.45, 0.35)},
     Form::ball,
     1.0f},
    {{"carpet",
      "carpet",
      {{"Cs", {0.60, 0.30, 0.12}}, {"scuff", {3}}, {"nap", {2}}, {"Kd", {0.8}}},
      dvec3(0.55, 0.28, 0.12)},
     Form::cube,
     1.0f},
    {{"colored marble", "colormarble", {{"txtscale", {2.5}}}, dvec3(0.7, 0.55, 0.42)},
     Form::ball,
     1.0f},
    {{"granite",
      "stone",
      {{"scale", {0.025}},
       {"Cs", {0.78, 0.56, 0.48}},
       {"graincolor", {0.1, 0.08, 0.08}},
       {"exponent", {1.3}},
       {"Ks", {0.4}}},
      dvec3(0.45, 0.3, 0.26)},
     Form::cube,
     1.0f},
};

const Material clay{"clay",
                    "plastic",
                    {{"Ka", {0.4}}, {"Kd", {0.7}}, {"Ks", {0}}, {"Cs", {0.30, 0.28, 0.265}}},
                    dvec3(0.34, 0.33, 0.32)};
const Material dusk{"dusk",
                    "plastic",
                    {{"Ka", {0.4}}, {"Kd", {0.7}}, {"Ks", {0}}, {"Cs", {0.20, 0.22, 0.26}}},
                    dvec3(0.20, 0.22, 0.26)};

constexpr float rise = 0.86f, going = 1.5f;  // of a step

Mesh form(Form which, double radius) {
    switch (which) {
        case Form::ball:
            return sphere(radius, {180, 110});
        case Form::cube:
            return superellipsoid(dvec3(0.88 * radius), 0.42, 0.42, {200, 120});
        case Form::box:
            break;
    }
    return with_metric_uv(rounded_box(dvec3(0.80 * radius), 0.22 * radius, 24, 12));
}

/// A row of exhibits on a step, turned so that cubes show two of their sides.
template <std::size_t N>
void add_row(GlbBuilder& out, const Exhibit (&row)[N], int step, double radius, float spacing) {
    for (std::size_t i = 0; i < N; ++i) {
        const float x = spacing * (float(i) - 0.5f * float(N - 1));
        const glm::quat turn = glm::angleAxis(degree * (31.0f + 11.0f * float(i)), up);
        add_piece(out, resting({row[i].material.shader,
                                row[i].material,
                                form(row[i].form, radius),
                                {x, rise * float(step), -going * float(step)},
                                turn,
                                row[i].pattern}));
    }
}

/// Three broad steps whose lowest is the floor itself.
void add_stage(GlbBuilder& out) {
    for (int step = 1; step <= 2; ++step) {
        const float depth = 3.0f;
        const vec3 centre(0, rise * (float(step) - 0.5f),
                          -going * (float(step) - 0.5f) - 0.5f * depth);
        const Mesh block = rounded_box({4.6, 0.5 * rise, 0.5 * depth}, 0.06, 4, 6);
        add_piece(out, {"step " + std::to_string(step), clay, block, centre});
    }
    // A floor that rises to a wall all around.
    const glm::dvec2 rim_to_centre[]{{16, 9},   {16, 7}, {16, 4}, {15.6, 1.5}, {14, 0.2},
                                     {11.5, 0}, {8, 0},  {3, 0},  {0, 0}};
    add_piece(out, {"floor", dusk, lathe(rim_to_centre, {200, 60}), vec3(0)});
}

void build(GlbBuilder& out) {
    add_row(out, front, 0, 0.56, 1.50f);
    add_row(out, middle, 1, 0.60, 1.75f);
    add_row(out, back, 2, 0.64, 1.72f);
    add_stage(out);

    const vec3 aim(0, 1.35f, -1.2f), key(-6.0f, 8.0f, 6.5f), fill(8.0f, 4.0f, 7.0f);
    out.add_lamp(
        {"key", "point", dvec3(1.0, 0.93, 0.84), candela_for(1.25, glm::distance(key, aim))},
        {key});
    out.add_lamp(
        {"fill", "point", dvec3(0.78, 0.88, 1.0), candela_for(0.4, glm::distance(fill, aim))},
        {fill});
    out.set_ambient(dvec3(0.45, 0.47, 0.5));

    std::vector<Shot> shots;
    for (const float angle : {-18.0f, -12.0f, 0.0f, 12.0f, 18.0f}) {
        const float pitch = degree * (17.0f + 0.15f * angle), distance = 15.4f;
        const vec3 away(std::sin(degree * angle) * std::cos(pitch), std::sin(pitch),
                        std::cos(degree * angle) * std::cos(pitch));
        shots.push_back({aim + distance * away, aim});
    }
    add_walking_camera(out, 0.32, shots);
}

}  // namespace

const Example simple{"simple", "each of the paper's eleven shaders on an object of its own", build};

}  // namespace estara::examples
