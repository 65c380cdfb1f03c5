// Smooth shapes of any fineness, from formulas: what the example scenes are built of.
//
// Every mesh has unit normals that point outwards, texture coordinates (in [0, 1]^2 unless said
// otherwise), and no triangle
// with two corners in one place. Where a surface closes on itself, the vertices on either side of
// the uv seam have the same position bit for bit, so closed shapes are watertight.
#pragma once

#include <functional>
#include <glm/glm.hpp>
#include <glm/gtc/quaternion.hpp>
#include <span>

#include "estara/scenes/mesh.h"

namespace estara::examples {

/// Rows and columns of quads; both >= 3.
struct Cells {
    int u, v;
};

/// What a parametric surface does at the ends of u and v: meet itself, or stop (at an edge, or by
/// shrinking to a point).
struct Closed {
    bool u, v;
};

/// Tessellates P(u, v). The outside is where dP/dv x dP/du points.
/// @param at  position for u, v in [0, 1]; smooth enough that differences over 1e-5 are its slope
Mesh tessellate(const std::function<glm::dvec3(double u, double v)>& at, Cells cells,
                Closed closed);

/// Turns a profile about the y axis. u runs around it and v along the profile,
/// slower where it bends.
/// @param profile  (radius, y) of control points of a uniform cubic B-spline that starts and ends
///                 at the first and last one; from the bottom outwards and up. Radius 0 at both
///                 ends makes it closed. A point given twice makes a tight bend, thrice an edge.
Mesh lathe(std::span<const glm::dvec2> profile, Cells cells);

Mesh sphere(double radius, Cells cells);

/// A ring around the y axis.
/// @param ring  radius of the circle along which the tube runs
Mesh torus(double ring, double tube, Cells cells);

/// A tube along the curve that winds p times around the y axis and q times through the ring.
/// @param ring, winding  radii of the torus on which the curve lies
Mesh torus_knot(int p, int q, double ring, double winding, double tube, Cells cells);

/// |x/rx|, |y/ry|, |z/rz| to growing powers: an ellipsoid at squareness 1, boxier below.
/// @param squareness  (0, 1]: of the outline seen from the side, and seen from above
Mesh superellipsoid(const glm::dvec3& radii, double side_squareness, double top_squareness,
                    Cells cells);

/// A box with edges rounded to quarter circles; each of the six faces has its own uv square.
/// @param flat, bend  quads along the flat part of an edge, and along each of its half bends
Mesh rounded_box(const glm::dvec3& half_size, double radius, int flat, int bend);

/// A square of gentle hills around the origin, seen from above (y); open.
/// @param height     of the hills, either way from y = 0
/// @param wavelength  distance between them
Mesh rolling_ground(double size, double height, double wavelength, Cells cells);

/// A tube along a curve in the xy plane; open at its ends. u runs around it and v along.
/// @param curve   for s in [0, 1]; never at rest
/// @param radius  of the tube at s
Mesh planar_tube(const std::function<glm::dvec2(double s)>& curve,
                 const std::function<double(double s)>& radius, Cells cells);

/// The mesh made `factor` times larger.
Mesh scaled(Mesh mesh, float factor);

/// The mesh turned, then shifted.
Mesh moved(Mesh mesh, const glm::vec3& by,
           const glm::quat& rotation = glm::quat(1.0f, 0.0f, 0.0f, 0.0f));

/// Several meshes as one.
Mesh joined(std::span<const Mesh> parts);

/// The mesh with texture coordinates in lengths: each triangle is seen from the axis that it faces
/// most, with u to the right and v up (on floors v is -z). For meshes whose faces share no
/// vertices, such as rounded boxes.
Mesh with_metric_uv(Mesh mesh);

}  // namespace estara::examples
