// What bends: a wooden post that three joints bow, and a face that shape keys change. Their
// patterns stay in the rest pose and stick to them.
#include <algorithm>
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
    {{"ringscale", {9}}, {"lightwood", {0.5, 0.24, 0.09}}, {"darkwood", {0.14, 0.045, 0.015}}},
    dvec3(0.32, 0.14, 0.05)};
const Material skin{
    "skin", "RCSkin", {{"poresfreq", {20}}, {"blemishfreq", {5}}}, dvec3(0.7, 0.56, 0.5)};
const Material clay{"clay",
                    "plastic",
                    {{"Ka", {0.2}}, {"Kd", {0.7}}, {"Ks", {0}}, {"Cs", {0.42, 0.4, 0.38}}},
                    dvec3(0.42, 0.4, 0.38)};

constexpr double length = 1.8, radius = 0.34;  // of the post
constexpr int joint_count = 3;
double joint_height(int j) { return length * j / joint_count; }

double smooth(double a, double b, double x) {
    const double t = std::clamp((x - a) / (b - a), 0.0, 1.0);
    return t * t * (3.0 - 2.0 * t);
}

/// Each vertex follows the joint below it, and around a joint the one before as well.
Deformation follow_joints(const Mesh& post) {
    Deformation bends;
    bends.influences.count = 4;
    for (const vec3& P : post.P) {
        double left = 1.0, weights[4] = {};
        for (int j = joint_count - 1; j > 0; --j) {
            weights[j] = left * smooth(joint_height(j) - 0.25, joint_height(j) + 0.25, P.y);
            left -= weights[j];
        }
        weights[0] = left;
        for (int j = 0; j < 4; ++j) {
            bends.influences.joint.push_back(std::uint16_t(j < joint_count ? j : 0));
            bends.influences.weight.push_back(float(weights[j]));
        }
    }
    return bends;
}

void add_post(GlbBuilder& out) {
    const glm::dvec2 profile[] = {{0, 0},           {radius, 0},      {radius, 0}, {radius, 0.4},
                                  {radius, length}, {radius, length}, {0, length}};
    const Mesh post = lathe(profile, {120, 160});
    const int mesh = out.add_mesh("post", post, out.add_material(wood), follow_joints(post));
    // As the standard says, a skinned mesh's own place does not count.
    const int object = out.add_object("post", mesh, {{0, 9, 0}});
    std::vector<int> joints;
    std::vector<glm::mat4> rest;
    for (int j = 0; j < joint_count; ++j) {
        const vec3 up(0, float(j == 0 ? 0.0 : length / joint_count), 0);
        joints.push_back(out.add_node("joint " + std::to_string(j + 1),
                                      {j == 0 ? vec3(-0.8f, 0, 0) : up, glm::quat(1, 0, 0, 0), 1.0f,
                                       j == 0 ? -1 : joints.back()}));
        glm::mat4 there(1.0f);
        there[3].y = float(joint_height(j));
        rest.push_back(there);
        if (j == 0) continue;
        out.animate_rotation(joints.back(), frame_times(), frame_values<glm::quat>([](double part) {
                                 const double wave = std::sin(2.0 * std::numbers::pi * part);
                                 return glm::angleAxis(float(0.6 * wave), vec3(0, 0, 1)) *
                                        glm::angleAxis(float(0.3 * wave), vec3(0, 1, 0));
                             }));
    }
    out.add_skin(object, joints, rest);
}

/// How far a point of the unit ball is moved by a key, outwards: a hill around a direction.
MorphTarget hill(const Mesh& ball, const Mesh& face, const vec3& towards, double width,
                 const vec3& by) {
    MorphTarget target;
    Mesh moved = face;
    for (std::size_t i = 0; i < ball.P.size(); ++i) {
        const double away = glm::distance(glm::normalize(ball.P[i]), glm::normalize(towards));
        target.P.push_back(by * float(std::exp(-(away / width) * (away / width))));
        moved.P[i] += target.P.back();
    }
    // The normals' changes, from differences along the surface.
    std::vector<dvec3> sums(moved.P.size(), dvec3(0.0)), before(sums);
    for (const glm::uvec3& t : moved.triangles) {
        const auto add = [&](const std::vector<vec3>& P, std::vector<dvec3>& to) {
            const dvec3 n = glm::cross(dvec3(P[t.y] - P[t.x]), dvec3(P[t.z] - P[t.x]));
            for (int k = 0; k < 3; ++k) to[t[k]] += n;
        };
        add(moved.P, sums);
        add(face.P, before);
    }
    for (std::size_t i = 0; i < sums.size(); ++i) {
        const bool flat = !(glm::length(sums[i]) > 0.0 && glm::length(before[i]) > 0.0);
        target.N.push_back(flat ? vec3(0.0f)
                                : vec3(glm::normalize(sums[i]) - glm::normalize(before[i])));
    }
    return target;
}

void add_face(GlbBuilder& out) {
    const Mesh face = superellipsoid({0.5, 0.62, 0.52}, 0.95, 1.0, {160, 120});
    Deformation bends;
    bends.targets.push_back(hill(face, face, {0, 0.1f, 1}, 0.25, {0, 0, 0.35f}));        // a nose
    bends.targets.push_back(hill(face, face, {0, -0.8f, 0.6f}, 0.4, {0, -0.3f, 0.1f}));  // a chin
    const int mesh = out.add_mesh("face", face, out.add_material(skin), bends);
    const int object = out.add_object("face", mesh, {{0.75f, 0.62f, 0}});
    std::vector<float> weights;
    for (const double part : frame_values<double>([](double p) { return p; })) {
        weights.push_back(float(0.5 - 0.5 * std::cos(2.0 * std::numbers::pi * part)));
        weights.push_back(float(0.5 - 0.5 * std::cos(4.0 * std::numbers::pi * part)));
    }
    out.animate_weights(object, frame_times(), weights);
}

void build(GlbBuilder& out) {
    add_post(out);
    add_face(out);
    const Mesh ground = rolling_ground(14.0, 0.0, 2.5, {2, 2});
    out.add_object("ground", out.add_mesh("ground", ground, out.add_material(clay)), {});
    const vec3 eye(0, 1.7f, 5.4f), aim(0, 0.85f, 0);
    out.add_camera("camera", 0.5, {eye, looking_along(aim - eye)});
    out.add_lamp({"sun", "directional", dvec3(1.0, 0.93, 0.82), lux_for(1.2)},
                 {vec3(0), looking_along(vec3(0.6f, -1.0f, -0.7f))});
    const vec3 fill(3.0f, 3.0f, 2.0f);
    out.add_lamp(
        {"fill", "point", dvec3(0.75, 0.86, 1.0), candela_for(0.25, glm::distance(fill, aim))},
        {fill});
    out.set_ambient(dvec3(0.5, 0.52, 0.56));
}

}  // namespace

const Example bend{"bend", "a wooden post that joints bow, a face that shape keys change", build};

}  // namespace estara::examples
