// Smooth solids from distances: spheres, capsules and ellipsoids that flow into each other.
#pragma once

#include <glm/glm.hpp>

#include <functional>

#include "estara/scenes/mesh.h"

namespace estara::examples {

/// A solid as a function of the point: negative inside, zero on the surface, and outside no more
/// than the distance to it.
using Solid = std::function<double(const glm::dvec3&)>;

struct DBox {
    glm::dvec3 min, max;
};

/// Distance to a ball stretched along the axes; exact at the surface, too small far away.
double ellipsoid(const glm::dvec3& p, const glm::dvec3& centre, const glm::dvec3& radii);

/// Distance to the hull of two balls: a capsule that may taper.
double capsule(const glm::dvec3& p, const glm::dvec3& a, double radius_a, const glm::dvec3& b,
               double radius_b);

/// Union that flows together where both surfaces are closer than `blend`. 0: a sharp one.
double blended(double a, double b, double blend);
/// a without b; the edge is rounded over `blend`.
double carved(double a, double b, double blend);

/// The surface of a solid as a closed mesh without texture coordinates. Normals are the solid's own
/// slope.
/// @param inside  a box that holds the whole solid
/// @param edge    length of a triangle's edge; features must be several times as large
Mesh surface_of(const Solid& solid, const DBox& inside, double edge);

/// Gives a mesh texture coordinates around the y axis: u once around, 0 at -z, so that dP/du runs
/// horizontally to the right of who sees it from outside; v from the lowest point to the highest.
/// Vertices on the seam are doubled.
/// @param axis  point through which the y axis goes
Mesh with_cylindrical_uv(Mesh mesh, const glm::dvec3& axis);

}  // namespace estara::examples
