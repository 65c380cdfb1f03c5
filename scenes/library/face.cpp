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
const dvec3 eye_centre(0.32, 0.0, 0.575);  // of the left one, as all that comes in pairs
constexpr double eyeball = 0.15, lid = 0.174;

struct Arc {
    double half_width, height;
    /// Circle through (+-half_width, 0) and (0, height).
    double radius() const { return (half_width * half_width + height * height) / (2.0 * height); }
};

/// The almond between the lids, seen from the front; relative to the eye's centre.
double almond(const dvec2& p) {
    constexpr Arc upper{0.152, 0.059}, lower{0.152, 0.052};
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

/// d with a groove. @param away  distance to the groove's bottom line, as seen from outside
double grooved(double d, double away, double width, double depth) {
    return d + depth * std::exp(-(away / width) * (away / width));
}

double skull(const dvec3& p, const dvec3& side) {
    double d = ellipsoid(p, {0, 0.32, -0.12}, {0.74, 0.80, 0.92});
    d = blended(d, ellipsoid(p, {0, 0.40, 0.30}, {0.60, 0.54, 0.55}), 0.2);
    d = blended(d, ellipsoid(p, {0, -0.35, 0.22}, {0.53, 0.74, 0.58}), 0.2);
    d = blended(d, capsule(side, {0.49, -0.58, 0.06}, 0.15, {0.13, -0.98, 0.64}, 0.15), 0.2);
    d = blended(d, ellipsoid(side, {0.07, -0.99, 0.68}, {0.19, 0.155, 0.17}), 0.14);
    d = blended(d, ellipsoid(side, {0.45, -0.16, 0.47}, {0.19, 0.14, 0.25}), 0.2);
    d = blended(d, capsule(side, {0.50, -0.12, 0.50}, 0.09, {0.68, -0.04, 0.05}, 0.08), 0.16);
    d = blended(d, ellipsoid(side, {0.33, -0.50, 0.53}, {0.24, 0.30, 0.23}), 0.2);
    d = blended(d, ellipsoid(side, {0.43, -0.38, 0.24}, {0.18, 0.40, 0.27}), 0.2);  // masseter
    d = blended(d, ellipsoid(side, {0.43, -0.25, -0.22}, {0.17, 0.36, 0.27}), 0.2);
    d = blended(d, ellipsoid(p, {0, -0.62, 0.60}, {0.34, 0.30, 0.27}), 0.15);
    d = carved(d, ellipsoid(side, {0.90, 0.25, 0.45}, {0.2, 0.25, 0.3}), 0.2);  // temple
    return d;
}

double with_eyes(double d, const dvec3& p, const dvec3& side) {
    d = carved(d, ellipsoid(side, {0.31, 0.0, 0.87}, {0.20, 0.14, 0.20}), 0.16);  // socket
    const double brow =
        blended(capsule(side, {0.10, 0.19, 0.77}, 0.07, {0.36, 0.24, 0.70}, 0.075),
                capsule(side, {0.36, 0.24, 0.70}, 0.075, {0.50, 0.17, 0.47}, 0.03), 0.05);
    d = blended(d, brow, 0.13);

    const dvec3 q = side - eye_centre;
    const double ball = glm::length(q);
    d = blended(d, ball - lid, 0.07);
    // The fold above the upper lid follows its edge.
    const double fold = std::abs(almond(dvec2(q)) - 0.042);
    d = grooved(d, fold, 0.011,
                0.014 * glm::smoothstep(0.0, 0.05, q.y) * glm::smoothstep(-0.1, 0.05, q.z));
    // Carved to just below the eyeball's surface: what it does not cover shows as the corners.
    const double opening = std::max({almond(dvec2(q)), 0.141 - ball, -q.z});
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
    // The groove from the wing down beside the mouth.
    const dvec3 fold[]{{0.20, -0.37, 0}, {0.235, -0.45, 0}, {0.30, -0.57, 0}, {0.335, -0.68, 0}};
    const double along = glm::smoothstep(-0.74, -0.46, p.y) * glm::smoothstep(0.3, 0.6, p.z);
    return grooved(d, rope({side.x, side.y, 0}, fold, {0, 0, 0, 0}, 0.02), 0.045, 0.016 * along);
}

const dvec3 upper_lip[]{
    {0.0, -0.612, 0.888}, {0.055, -0.605, 0.885}, {0.14, -0.622, 0.845}, {0.215, -0.645, 0.775}};
const dvec3 lower_lip[]{
    {0.0, -0.698, 0.862}, {0.08, -0.693, 0.852}, {0.15, -0.670, 0.82}, {0.21, -0.650, 0.772}};

double with_mouth(double d, const dvec3& p, const dvec3& side) {
    d = grooved(d, std::abs(p.x), 0.035,
                0.020 * glm::smoothstep(-0.61, -0.56, p.y) * glm::smoothstep(-0.44, -0.50, p.y) *
                    glm::smoothstep(0.6, 0.8, p.z));  // philtrum
    d = blended(d, rope(side, upper_lip, {0.040, 0.046, 0.036, 0.014}, 0.03), 0.035);
    d = blended(d, rope(side, lower_lip, {0.062, 0.060, 0.042, 0.014}, 0.03), 0.04);
    const dvec3 line[]{{0.0, -0.652, 0}, {0.06, -0.647, 0}, {0.14, -0.652, 0}, {0.225, -0.655, 0}};
    d = grooved(d, rope({side.x, side.y, 0}, line, {0, 0, 0, 0}, 0.0), 0.015,
                0.034 * glm::smoothstep(0.3, 0.6, p.z));
    d = grooved(d, glm::length(dvec2(side) - dvec2(0.245, -0.657)), 0.035,
                0.018 * glm::smoothstep(0.3, 0.6, p.z));
    d = carved(d, capsule(side, {0.0, -0.80, 0.91}, 0.05, {0.14, -0.79, 0.84}, 0.03), 0.1);
    return d;
}

double with_ear(double d, const dvec3& side) {
    // The ear's own plane: x backwards, y up, z out of the head.
    constexpr double flare = 28 * degree;
    const dvec3 s = side - dvec3(0.71, -0.09, -0.06);
    const dvec3 q(-s.z * std::cos(flare) + s.x * std::sin(flare), s.y,
                  s.x * std::cos(flare) + s.z * std::sin(flare));
    if (glm::length(q) > 0.6) return d;
    double ear = ellipsoid(q, {0.03, 0.03, 0.0}, {0.17, 0.27, 0.035});
    const dvec3 helix[]{{-0.05, -0.03, 0.02}, {-0.10, 0.08, 0.03},  {-0.08, 0.20, 0.035},
                        {0.01, 0.285, 0.045}, {0.12, 0.26, 0.05},   {0.185, 0.14, 0.05},
                        {0.18, 0.0, 0.045},   {0.125, -0.13, 0.03}, {0.05, -0.235, 0.015},
                        {-0.02, -0.27, 0.0}};
    ear = blended(
        ear,
        rope(q, helix, {0.022, 0.026, 0.028, 0.030, 0.032, 0.032, 0.03, 0.026, 0.028, 0.032}, 0.02),
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
    d = blended(d, capsule(p, {0, -0.45, -0.32}, 0.46, {0, -2.3, -0.42}, 0.55), 0.2);
    d = blended(d, capsule(side, {0.54, -0.52, -0.24}, 0.085, {0.10, -2.0, 0.10}, 0.085), 0.12);
    d = blended(d, ellipsoid(p, {0, -1.42, 0.11}, {0.09, 0.15, 0.11}), 0.16);  // larynx
    d = blended(d, capsule(side, {0.25, -1.1, -0.62}, 0.22, {0.62, -2.2, -0.55}, 0.26), 0.3);
    return std::max(d, -2.25 - p.y);
}

/// What comes in pairs sees the left side only, smoothly folded at the middle.
dvec3 left_side(const dvec3& p) { return {std::sqrt(p.x * p.x + 0.0009), p.y, p.z}; }

double head(const dvec3& p) {
    const dvec3 side = left_side(p);
    double d = skull(p, side);
    // What is further from the surface than any blending reaches need not be asked.
    if (p.z > 0.1) {
        d = with_eyes(d, p, side);
        d = with_nose(d, p, side);
        d = with_mouth(d, p, side);
    }
    if (p.y < 0.4) d = with_neck(d, p, side);
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

/// Shoulders and chest in a garment that falls in folds from a rolled collar.
double garment(const dvec3& p) {
    const dvec3 side = left_side(p);
    double d = ellipsoid(p, {0, -2.95, -0.30}, {1.40, 0.90, 0.78});
    d = blended(d, capsule(side, {0.30, -2.22, -0.45}, 0.46, {1.55, -2.55, -0.50}, 0.40), 0.3);
    d = blended(d, capsule(side, {1.55, -2.55, -0.50}, 0.42, {1.75, -3.6, -0.45}, 0.38), 0.2);
    d = blended(d, ellipsoid(p, {0, -2.0, -0.42}, {0.85, 0.30, 0.62}), 0.25);
    const double across = std::sqrt(p.x * p.x + 0.06);
    const double along = p.y + 0.62 * across + 0.12 * std::sin(2.0 * p.x + 0.7);
    const double loose = glm::smoothstep(-1.95, -2.45, p.y);
    d -= loose * (0.040 * std::sin(10.0 * along) + 0.016 * std::sin(23.0 * along + 2.0 * p.x));
    // The collar lies on the neck like a ring that dips in front.
    constexpr double tilt = 20 * degree;
    const dvec3 c = p - dvec3(0, -1.86, -0.33);
    const dvec3 q(c.x, c.y * std::cos(tilt) + c.z * std::sin(tilt),
                  c.z * std::cos(tilt) - c.y * std::sin(tilt));
    const double tube = 0.13 + 0.02 * std::sin(5.0 * std::atan2(q.x, q.z) + 6.0 * q.y);
    d = blended(d, glm::length(dvec2(glm::length(dvec2(q.x, q.z)) - 0.66, q.y)) - tube, 0.10);
    return std::max(d * 0.85, -3.4 - p.y);
}

/// The red of the lips lies on the head like paint.
double lips(const dvec3& p) {
    const dvec3 side = left_side(p);
    const double red = std::min(rope(side, upper_lip, {0.046, 0.055, 0.045, 0.018}, 0.03),
                                rope(side, lower_lip, {0.068, 0.066, 0.046, 0.018}, 0.03));
    return std::max(head(p) - 0.0025, red);
}

/// Eyebrows and the dark line of the lashes.
double brows(const dvec3& p) {
    const dvec3 side = left_side(p);
    const dvec2 flat(side);
    const dvec3 arc[]{{0.10, 0.175, 0}, {0.24, 0.225, 0}, {0.39, 0.225, 0}, {0.53, 0.150, 0}};
    const double brow = rope({flat, 0}, arc, {0.034, 0.040, 0.030, 0.008}, 0.02);
    const double strands =
        std::sin(170.0 * (flat.x - 0.55 * flat.y + 0.02 * std::sin(14.0 * flat.x)));
    const double raised = head(p) - 0.016 - 0.0035 * strands;
    const double hairs = -blended(-raised, -0.5 * brow, 0.03);
    const dvec3 q = side - eye_centre;
    const double rim = std::abs(almond(dvec2(q)) - 0.003) - 0.007;
    const double lashes = std::max({head(p) - 0.005, rim, 0.012 - 0.07 * q.x - q.y});
    return std::max(std::min(hairs, lashes), 0.3 - p.z);
}

Material lip_skin(bool second) {
    const dvec3 red = second ? dvec3(0.33, 0.13, 0.10) : dvec3(0.66, 0.29, 0.26);
    return {"lips", "RCSkin", {{"skincolor", {red.r, red.g, red.b}}, {"oily", {0.7}}}, red};
}

Material skin(bool second) {
    if (!second)
        return {"skin",
                "RCSkin",
                {{"skincolor", {0.74, 0.52, 0.43}}, {"oily", {1.0}}},
                dvec3(0.74, 0.52, 0.43)};
    return {"skin",
            "RCSkin",
            {{"skincolor", {0.40, 0.245, 0.17}},
             {"blemishfreq", {8}},
             {"blemishthresh", {1.8}},
             {"oily", {1.5}},
             {"sheenColor", {1.0, 0.85, 0.72}},
             {"xrough", {0.25}},
             {"yrough", {0.40}},
             {"poresthresh", {2.6}},
             {"poresdepth", {-0.0013}}},
            dvec3(0.40, 0.245, 0.17)};
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
                            {"Ks", {0.2}},
                            {"roughness", {0.12}}},
                           dvec3(0.08, 0.045, 0.02)};
const Material brown{"brown",
                     "plastic",
                     {{"Ka", {0.3}}, {"Kd", {0.7}}, {"Ks", {0.1}}, {"Cs", {0.07, 0.04, 0.025}}},
                     dvec3(0.07, 0.04, 0.025)};
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
        return dvec3(15.0 * std::cos(angle), 20.0 * v - 10.0, 15.0 * std::sin(angle));
    };
    return tessellate(at, {160, 40}, {.u = false, .v = false});
}

/// A lamp that is turned to the head. @param cone  half its opening, radians
Lamp lamp(const std::string& name, const dvec3& color, double cone) {
    return {name, "spot", color, 1.0, 0.5 * cone, cone};
}

void add_lamp_at(GlbBuilder& out, Lamp lamp, const vec3& place, double Cl) {
    const vec3 aim(0, -0.5f, 0);
    lamp.intensity = candela_for(Cl, glm::distance(place, aim));
    out.add_lamp(lamp, {place, looking_along(aim - place)});
}

void build(GlbBuilder& out, bool second) {
    const DBox head_box{{-1.6, -2.5, -1.5}, {1.6, 1.4, 1.4}};
    add_piece(out,
              {"head", skin(second),
               with_cylindrical_uv(surface_of(head, head_box, 0.0125), {0, 0, -0.1}), vec3(0)});
    add_piece(out,
              {"hair", dark_marble,
               with_cylindrical_uv(surface_of(hair, head_box, 0.0125), {0, 0, -0.1}), vec3(0)});
    const DBox mouth_box{{-0.4, -0.9, 0.5}, {0.4, -0.4, 1.1}},
        brow_box{{-0.7, -0.2, 0.3}, {0.7, 0.4, 1.0}};
    add_piece(out,
              {"lips", lip_skin(second),
               with_cylindrical_uv(surface_of(lips, mouth_box, 0.008), {0, 0, -0.1}), vec3(0)});
    add_piece(
        out, {"brows", brown, with_cylindrical_uv(surface_of(brows, brow_box, 0.007), {0, 0, -0.1}),
              vec3(0)});
    const DBox garment_box{{-2.6, -3.7, -1.7}, {2.6, -1.4, 1.2}};
    add_piece(out,
              {"garment", marble,
               with_cylindrical_uv(surface_of(garment, garment_box, 0.03), {0, 0, -0.1}), vec3(0)});
    add_eyes(out);
    add_piece(out, {"wall", wall, backdrop(), vec3(0)});

    add_lamp_at(out, lamp("key", {1.0, 0.88, 0.74}, 0.42), {-5.0f, 4.5f, 6.5f}, 1.7);
    // Skin knows no ambient light: the fill stands for it and casts no shadow.
    Lamp fill = lamp("fill", {0.90, 0.93, 1.0}, 0.9);
    fill.shadow = false;
    add_lamp_at(out, fill, {3.0f, -1.0f, 8.5f}, 0.42);
    add_lamp_at(out, lamp("rim", {0.80, 0.90, 1.0}, 0.5), {4.0f, 4.0f, -5.5f}, 1.2);
    out.set_ambient(dvec3(0.35, 0.36, 0.40));

    std::vector<Shot> shots;
    for (const double angle : {-25.0, -15.0, -5.0, 5.0, 15.0, 25.0}) {
        const double distance = 9.5 - 0.9 * std::cos(2.2 * angle * degree);
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
