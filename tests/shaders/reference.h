// The building blocks and the shaders once more, in double precision and as plainly
// as possible: what the fast float versions are tested against. The two share the integer hash
// alone.
#pragma once

#include <glm/glm.hpp>

#include <cstdint>
#include <optional>
#include <vector>

#include "estara/shaders/registry.h"
#include "estara/shaders/surface_point.h"

namespace estara::reference {

double mod(double x, double b);
double step(double edge, double x);
double smoothstep(double a, double b, double x);

/// dimensions: 1 to 3; the components of p beyond them are not used.
double snoise(const glm::dvec3& p, int dimensions, std::uint32_t seed = 0);
double noise(const glm::dvec3& p, int dimensions, std::uint32_t seed = 0);
glm::dvec3 vnoise(const glm::dvec3& p);
double cellnoise(const glm::dvec3& p, int dimensions, std::uint32_t seed = 0);

struct Voronoi {
    double f1, f2;
    glm::dvec3 cell;  ///< lower corner of the cell whose feature point is the nearest
};
Voronoi voronoi(const glm::dvec3& p, int dimensions, double jitter);

/// Number of noises and the sum of clamped turbulence, phi = |noise - 1/2| or noise.
int turbulence_noises(double w);
double turbulence(const glm::dvec3& q, double w, bool deviation);

double spline(double x, const std::vector<double>& knots);

/// Parts of greenmarble's pattern.
struct Marble {
    double substrate, veins, mask;
};
Marble marble(const glm::dvec3& P, double w, double veinfreq, double sharpness);

/// The shader's record at a point, in the order of the floats of Baked, with the shader's own
/// parameters; nothing for a shader that has no reference yet.
std::optional<std::vector<double>> bake(const BoundShader& shader, const SurfacePoint& x);

}  // namespace estara::reference
