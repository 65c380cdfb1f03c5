// A head of skin in a bust of marble: the scene Face of the paper, in two settings of RCSkin.
//
// The head is one solid, blended from some eighty balls and capsules. Lengths are decimetres, so
// that RCSkin's defaults fit: pores 1.7 mm and blemishes 8 mm apart. The face looks along +z, the
// eyes lie at y = 0.
#include <algorithm>
#include <cmath>
#include <numbers>

#include "all.h"
#include "camera_path.h"
#include "implicit.h"
#include "pieces.h"

namespace estara::examples {

namespace {

using glm::dvec2;
using glm::dvec3;
using glm::vec3;

constexpr double degree = std::numbers::pi / 180.0;

// The eyes. The lids are a ball a little larger than the eyeball, opened by an almond.
const dvec3 eye_centre(0.32, 0.0, 0.585);  // of the left one, as all that comes in pairs
constexpr double eyeball = 0.14, lid = 0.163;

struct Arc {
    double half_width, height;
    /// Circle through (+-half_width, 0) and (0, height).
    double radius() const { return (half_width * half_width + height * height) / (2.0 * height); }
};

/// The almond between the lids, seen from the front; relative to the eye's centre.
double almond(const dvec2& p) {
    constexpr Arc upper{0.14, 0.058}, lower{0.14, 0.05};
    constexpr double slant = 4 * degree;  // the outer corner is higher
    const dvec2 q(p.x * std::cos(slant) + p.y * std::sin(slant),
                  p.y * std::cos(slant) - p.x * std::sin(slant));
    const double above =
        glm::length(q - dvec2(-0.01, upper.height - upper.radius())) - upper.radius();
    const double below =
        glm::length(q - dvec2(0.01, lower.radius() - lower.height)) - lower.radius();
    return std::max(above, below);
}

/// Follows points as a rope of tapering capsules.
template <std::size_t N>
double rope(const dvec3& p, const dvec3 (&points)[N], const double (&radii)[N], double blend) {
    double d = capsule(p, points[0], radii[0], points[1], radii[1]);
    for (std::size_t i = 1; i + 1 < N; ++i)
        d = blended(d, capsule(p, points[i], radii[i], points[i + 1], radii[i + 1]), blend);
    return d;
}

double skull(const dvec3& p, const dvec3& side) {
    double d = ellipsoid(p, {0, 0.32, -0.12}, {0.74, 0.80, 0.92});
    d = blended(d, ellipsoid(p, {0, 0.40, 0.30}, {0.60, 0.54, 0.55}), 0.2);
    d = blended(d, ellipsoid(p, {0, -0.35, 0.22}, {0.53, 0.74, 0.58}), 0.2);
    d = blended(d, capsule(side, {0.49, -0.60, 0.04}, 0.15, {0.12, -0.97, 0.63}, 0.15), 0.2);
    d = blended(d, ellipsoid(side, {0.07, -0.99, 0.68}, {0.19, 0.155, 0.17}), 0.14);
    d = blended(d, ellipsoid(side, {0.45, -0.16, 0.47}, {0.19, 0.14, 0.25}), 0.2);
    d = blended(d, capsule(side, {0.50, -0.12, 0.50}, 0.09, {0.68, -0.04, 0.05}, 0.08), 0.16);
    d = blended(d, ellipsoid(side, {0.34, -0.47, 0.54}, {0.23, 0.27, 0.23}), 0.2);
    d = blended(d, ellipsoid(p, {0, -0.62, 0.60}, {0.34, 0.30, 0.27}), 0.15);
    d = carved(d, ellipsoid(side, {0.86, 0.25, 0.45}, {0.2, 0.25, 0.3}), 0.2);  // temple
    return d;
}

double with_eyes(double d, const dvec3& p, const dvec3& side) {
    d = carved(d, ellipsoid(side, {0.31, 0.0, 0.87}, {0.20, 0.14, 0.20}), 0.16);  // socket
    const double brow =
        blended(capsule(side, {0.10, 0.19, 0.77}, 0.07, {0.36, 0.24, 0.70}, 0.075),
                capsule(side, {0.36, 0.24, 0.70}, 0.075, {0.55, 0.15, 0.50}, 0.06), 0.05);
    d = blended(d, brow, 0.13);

    const dvec3 q = side - eye_centre;
    const double ball = glm::length(q);
    d = blended(d, ball - lid, 0.07);
    // The fold above the upper lid, and a shallow one under the eye.
    const dvec3 fold[]{
        {-0.135, 0.035, 0.10}, {-0.06, 0.093, 0.135}, {0.03, 0.102, 0.13}, {0.15, 0.045, 0.06}};
    d = carved(d, rope(q, fold, {0.004, 0.010, 0.010, 0.004}, 0.01), 0.035);
    const dvec3 bag[]{{-0.12, -0.09, 0.12}, {0.0, -0.135, 0.13}, {0.13, -0.10, 0.07}};
    d = carved(d, rope(q, bag, {0.005, 0.012, 0.005}, 0.02), 0.06);
    // Carved to just below the eyeball's surface: what it does not cover shows as the corners.
    const double opening = std::max({almond(dvec2(q)), 0.131 - ball, -q.z});
    d = carved(d, opening, 0.014);
    (void)p;
    return d;
}

double with_nose(double d, const dvec3& p, const dvec3& side) {
    d = blended(d, capsule(p, {0, 0.10, 0.72}, 0.085, {0, -0.10, 0.83}, 0.075), 0.12);
    d = blended(d, capsule(p, {0, -0.10, 0.83}, 0.075, {0, -0.33, 0.97}, 0.085), 0.10);
    d = blended(d, ellipsoid(p, {0, -0.355, 0.98}, {0.115, 0.10, 0.11}), 0.07);
    d = blended(d, ellipsoid(side, {0.125, -0.395, 0.86}, {0.075, 0.075, 0.115}), 0.06);
    d = blended(d, capsule(p, {0, -0.42, 0.97}, 0.045, {0, -0.46, 0.82}, 0.05), 0.05);
    d = carved(d, ellipsoid(side, {0.07, -0.475, 0.90}, {0.036, 0.05, 0.065}), 0.03);  // nostril
    // The groove around the wing, down to the corner of the mouth.
    const dvec3 fold[]{
        {0.185, -0.34, 0.84}, {0.225, -0.42, 0.845}, {0.30, -0.56, 0.80}, {0.34, -0.68, 0.74}};
    d = carved(d, rope(side, fold, {0.012, 0.016, 0.012, 0.004}, 0.02), 0.08);
    return d;
}

double with_mouth(double d, const dvec3& p, const dvec3& side) {
    d = carved(d, capsule(p, {0, -0.46, 0.925}, 0.018, {0, -0.55, 0.93}, 0.026), 0.05);  // philtrum
    const dvec3 upper[]{
        {0.0, -0.600, 0.885}, {0.055, -0.592, 0.882}, {0.15, -0.615, 0.84}, {0.235, -0.640, 0.765}};
    d = blended(d, rope(side, upper, {0.046, 0.052, 0.042, 0.018}, 0.03), 0.035);
    const dvec3 lower[]{
        {0.0, -0.700, 0.865}, {0.08, -0.695, 0.855}, {0.16, -0.670, 0.82}, {0.225, -0.648, 0.765}};
    d = blended(d, rope(side, lower, {0.066, 0.064, 0.046, 0.018}, 0.03), 0.04);
    const dvec3 line[]{
        {0.0, -0.645, 0.945}, {0.06, -0.638, 0.935}, {0.14, -0.645, 0.89}, {0.265, -0.648, 0.78}};
    d = carved(d, rope(side, line, {0.010, 0.010, 0.010, 0.012}, 0.01), 0.03);
    d = carved(d, glm::length(side - dvec3(0.275, -0.652, 0.765)) - 0.02, 0.06);  // corner
    d = carved(d, capsule(side, {0.0, -0.80, 0.91}, 0.05, {0.14, -0.79, 0.84}, 0.03), 0.1);
    return d;
}

double with_ear(double d, const dvec3& side) {
    // The ear's own plane: x backwards, y up, z out of the head.
    constexpr double flare = 28 * degree;
    const dvec3 s = side - dvec3(0.735, -0.09, -0.06);
    const dvec3 q(-s.z * std::cos(flare) + s.x * std::sin(flare), s.y,
                  s.x * std::cos(flare) + s.z * std::sin(flare));
    if (glm::length(q) > 0.6) return d;
    double ear = ellipsoid(q, {0.03, 0.03, 0.0}, {0.17, 0.27, 0.035});
    const dvec3 helix[]{{-0.05, -0.03, 0.02}, {-0.10, 0.08, 0.03},  {-0.08, 0.20, 0.035},
                        {0.01, 0.285, 0.045}, {0.12, 0.26, 0.05},   {0.185, 0.14, 0.05},
                        {0.18, 0.0, 0.045},   {0.125, -0.13, 0.03}, {0.05, -0.235, 0.015},
                        {-0.03, -0.30, 0.0}};
    ear = blended(
        ear,
        rope(q, helix, {0.022, 0.026, 0.028, 0.030, 0.032, 0.032, 0.03, 0.028, 0.035, 0.045}, 0.02),
        0.025);
    const dvec3 antihelix[]{{0.03, 0.18, 0.03},
                            {0.09, 0.10, 0.045},
                            {0.105, 0.0, 0.05},
                            {0.06, -0.12, 0.04},
                            {-0.03, -0.17, 0.03}};
    ear = blended(ear, rope(q, antihelix, {0.02, 0.026, 0.028, 0.028, 0.026}, 0.02), 0.03);
    ear = blended(ear, ellipsoid(q, {-0.085, -0.06, 0.045}, {0.035, 0.045, 0.03}), 0.03);  // tragus
    ear = carved(ear, ellipsoid(q, {0.0, -0.05, 0.06}, {0.07, 0.085, 0.075}), 0.03);       // concha
    return blended(d, ear, 0.045);
}

double with_neck(double d, const dvec3& p, const dvec3& side) {
    d = blended(d, capsule(p, {0, -0.45, -0.30}, 0.50, {0, -2.3, -0.42}, 0.60), 0.2);
    d = blended(d, capsule(side, {0.56, -0.50, -0.22}, 0.09, {0.10, -2.0, 0.13}, 0.09), 0.12);
    d = blended(d, ellipsoid(p, {0, -1.42, 0.15}, {0.10, 0.16, 0.12}), 0.16);  // larynx
    d = blended(d, capsule(side, {0.28, -1.1, -0.62}, 0.26, {1.0, -2.2, -0.55}, 0.26), 0.3);
    return std::max(d, -2.25 - p.y);
}

/// What comes in pairs sees the left side only, smoothly folded at the middle.
dvec3 left_side(const dvec3& p) { return {std::sqrt(p.x * p.x + 0.0009), p.y, p.z}; }

double head(const dvec3& p) {
    const dvec3 side = left_side(p);
    double d = skull(p, side);
    d = with_eyes(d, p, side);
    d = with_nose(d, p, side);
    d = with_mouth(d, p, side);
    d = with_neck(d, p, side);
    return with_ear(d, side);
}

/// Where hair grows: above this height at this depth.
double hairline(double z) {
    const dvec2 points[]{{-1.1, -0.72}, {-0.8, -0.68}, {-0.45, -0.50}, {-0.22, -0.05},
                         {-0.05, 0.22}, {0.12, 0.10},  {0.20, 0.18},   {0.34, 0.52},
                         {0.52, 0.62},  {0.78, 0.74},  {1.2, 0.80}};
    if (z <= points[0].x) return points[0].y;
    for (std::size_t i = 1; i < std::size(points); ++i)
        if (z < points[i].x) {
            const double t = (z - points[i - 1].x) / (points[i].x - points[i - 1].x);
            return glm::mix(points[i - 1].y, points[i].y, t * t * (3.0 - 2.0 * t));
        }
    return points[std::size(points) - 1].y;
}

/// Short curls, as sculptors of antiquity cut them.
double hair(const dvec3& p) {
    const double cap = blended(ellipsoid(p, {0, 0.32, -0.12}, {0.74, 0.80, 0.92}),
                               ellipsoid(p, {0, 0.40, 0.30}, {0.60, 0.54, 0.55}), 0.2);
    const double neck =
        blended(cap, capsule(p, {0, -0.45, -0.30}, 0.50, {0, -2.3, -0.42}, 0.60), 0.2);
    const dvec3 q = p * 15.0;
    const dvec3 bend(q.x + 1.3 * std::sin(0.43 * q.y + 1.0), q.y + 1.3 * std::sin(0.37 * q.z),
                     q.z + 1.3 * std::sin(0.41 * q.x + 2.0));
    const double gyroid = std::sin(bend.x) * std::cos(bend.y) +
                          std::sin(bend.y) * std::cos(bend.z) + std::sin(bend.z) * std::cos(bend.x);
    const double strands = std::sin(5.0 * gyroid + 0.6 * bend.y);
    const double d = neck - 0.085 - 0.028 * gyroid - 0.008 * strands;
    return -blended(-d, -(0.8 * (hairline(p.z) - p.y)), 0.12);
}

/// Shoulders and chest in a garment with folds and a collar.
double garment(const dvec3& p) {
    const dvec3 side = left_side(p);
    double d = ellipsoid(p, {0, -3.0, -0.35}, {1.45, 0.95, 0.80});
    d = blended(d, capsule(side, {0.45, -2.15, -0.48}, 0.42, {1.55, -2.55, -0.50}, 0.42), 0.3);
    d = blended(d, capsule(side, {1.55, -2.55, -0.50}, 0.45, {1.75, -3.6, -0.45}, 0.40), 0.2);
    const double along = 0.9 * p.x + 0.55 * std::sin(1.3 * p.x) - 1.6 * p.y - 0.6 * p.z;
    d -= 0.03 * std::sin(7.0 * along) + 0.015 * std::sin(13.0 * along + 4.0 * p.x + 1.0);
    const double lower = p.z * 0.55;  // the collar dips in front
    const double neck = capsule(p, {0, -1.0, -0.34}, 0.66, {0, -2.6, -0.40}, 0.80);
    const double roll = std::abs(neck) - 0.085;
    const double ring = std::max(roll, std::abs(p.y + 1.98 + lower) - 0.16);
    d = blended(d, ring - 0.04, 0.12);
    d = carved(d, std::max(neck + 0.06, -2.5 - p.y), 0.05);
    return std::max(d * 0.8, -3.4 - p.y);
}

Material skin(bool second) {
    if (!second) return {"skin", "RCSkin", {}, dvec3(0.7, 0.56, 0.52)};
    return {"skin",
            "RCSkin",
            {{"skincolor", {0.50, 0.33, 0.25}},
             {"blemishthresh", {2.4}},
             {"oily", {3.5}},
             {"xrough", {0.22}},
             {"yrough", {0.34}},
             {"poresthresh", {2.2}},
             {"poresdepth", {-0.002}}},
            dvec3(0.50, 0.33, 0.25)};
}

const Material marble{"marble",
                      "greenmarble",
                      {{"Ka", {0.3}}, {"Kd", {0.8}}, {"roughness", {0.03}}},
                      dvec3(0.04, 0.16, 0.02)};
const Material dark_marble{"dark marble",
                           "greenmarble",
                           {{"darkcolor", {0.035, 0.018, 0.010}},
                            {"lightcolor", {0.10, 0.055, 0.03}},
                            {"veincolor", {0.45, 0.28, 0.12}},
                            {"Ka", {0.3}},
                            {"Ks", {0.25}},
                            {"roughness", {0.08}}},
                           dvec3(0.08, 0.045, 0.02)};
const Material iris{"iris",
                    "greenmarble",
                    {{"darkcolor", {0.01, 0.05, 0.035}},
                     {"lightcolor", {0.07, 0.16, 0.10}},
                     {"veincolor", {0.30, 0.30, 0.10}},
                     {"Ks", {0.8}}},
                    dvec3(0.05, 0.12, 0.08)};
const Material white{"white of the eye",
                     "plastic",
                     {{"Ka", {0.3}},
                      {"Kd", {0.75}},
                      {"Ks", {1.0}},
                      {"roughness", {0.02}},
                      {"Cs", {0.82, 0.78, 0.74}}},
                     dvec3(0.82, 0.78, 0.74)};
const Material pupil{
    "pupil",
    "plastic",
    {{"Ka", {0}}, {"Kd", {0.1}}, {"Ks", {1.0}}, {"roughness", {0.02}}, {"Cs", {0.01, 0.01, 0.01}}},
    dvec3(0.01)};
const Material wall{"wall",
                    "plastic",
                    {{"Ka", {0.3}}, {"Kd", {0.8}}, {"Ks", {0}}, {"Cs", {0.20, 0.17, 0.16}}},
                    dvec3(0.20, 0.17, 0.16)};

/// The part of a ball around +z. @param angle  of its rim from the axis
Mesh cap(double radius, double angle, Cells cells) {
    const auto at = [&](double u, double v) {
        const double around = 2.0 * std::numbers::pi * u, out = angle * (1.0 - v);
        return radius * dvec3(std::sin(out) * std::cos(around), -std::sin(out) * std::sin(around),
                              std::cos(out));
    };
    return tessellate(at, cells, {.u = true, .v = false});
}

/// An eye that looks at the middle of the camera's path.
void add_eyes(GlbBuilder& out) {
    const int ball = out.add_mesh("eyeball", sphere(eyeball, {96, 64}), out.add_material(white));
    // Caps that stand on the ball by a hair: 0.2 mm and 0.3 mm.
    constexpr float pattern = 14.0f;
    const int ring = out.add_mesh("iris", scaled(cap(eyeball + 0.002, 0.46, {96, 24}), pattern),
                                  out.add_material(iris));
    const int hole =
        out.add_mesh("pupil", cap(eyeball + 0.003, 0.19, {64, 12}), out.add_material(pupil));
    for (const float sign : {1.0f, -1.0f}) {
        const std::string which = sign > 0 ? "left " : "right ";
        const vec3 centre(sign * float(eye_centre.x), eye_centre.y, eye_centre.z);
        const glm::quat gaze = glm::angleAxis(float(-sign * 1.5 * degree), vec3(0, 1, 0));
        out.add_object(which + "eyeball", ball, {centre, gaze});
        out.add_object(which + "iris", ring, {centre, gaze, 1.0f / pattern});
        out.add_object(which + "pupil", hole, {centre, gaze});
    }
}

/// A wall that curves round behind the bust.
Mesh backdrop() {
    const auto at = [](double u, double v) {
        const double angle = (270.0 + 85.0 * (1.0 - 2.0 * u)) * degree;
        return dvec3(9.0 * std::cos(angle), 12.0 * v - 6.0, 9.0 * std::sin(angle));
    };
    return tessellate(at, {160, 40}, {.u = false, .v = false});
}

void add_lamp_at(GlbBuilder& out, const std::string& name, const vec3& place, const dvec3& color,
                 double Cl) {
    out.add_lamp({name, "point", color, candela_for(Cl, glm::length(place))}, {place});
}

void build(GlbBuilder& out, bool second) {
    const DBox head_box{{-1.6, -2.5, -1.5}, {1.6, 1.4, 1.4}};
    add_piece(out,
              {"head", skin(second),
               with_cylindrical_uv(surface_of(head, head_box, 0.0115), {0, 0, -0.1}), vec3(0)});
    add_piece(out,
              {"hair", dark_marble,
               with_cylindrical_uv(surface_of(hair, head_box, 0.0125), {0, 0, -0.1}), vec3(0)});
    const DBox garment_box{{-2.6, -3.7, -1.7}, {2.6, -1.4, 1.2}};
    add_piece(out,
              {"garment", marble,
               with_cylindrical_uv(surface_of(garment, garment_box, 0.03), {0, 0, -0.1}), vec3(0)});
    add_eyes(out);
    add_piece(out, {"wall", wall, backdrop(), vec3(0)});

    add_lamp_at(out, "key", {-5.0f, 4.5f, 6.5f}, {1.0, 0.92, 0.82}, 1.5);
    add_lamp_at(out, "fill", {6.5f, 0.5f, 5.0f}, {0.75, 0.86, 1.0}, 0.45);
    add_lamp_at(out, "rim", {4.0f, 4.0f, -5.5f}, {0.85, 0.92, 1.0}, 1.3);
    out.set_ambient(dvec3(0.35, 0.36, 0.40));

    std::vector<Shot> shots;
    for (const double angle : {-34.0, -25.0, -8.0, 12.0, 26.0, 34.0}) {
        const double distance = 10.2 - 0.9 * std::cos(2.2 * angle * degree);
        const dvec3 eye(distance * std::sin(angle * degree), 0.35 + 0.006 * angle,
                        distance * std::cos(angle * degree));
        shots.push_back({eye, vec3(0, -0.42, 0.1)});
    }
    add_walking_camera(out, 0.42, shots);
}

void build_first(GlbBuilder& out) { build(out, false); }
void build_second(GlbBuilder& out) { build(out, true); }

}  // namespace

const Example face{"face", "a head of skin in a bust of green marble, the camera passes by",
                   build_first};
const Example face_b{"face-b", "the same head, its skin darker, oilier and more blemished",
                     build_second};

}  // namespace estara::examples
