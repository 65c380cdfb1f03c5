// The building blocks and the shaders once more, in double precision and as plainly
// as possible: what the fast float versions are tested against. The two share the integer hash
// alone.
#pragma once

#include <glm/glm.hpp>

#include <cstdint>
#include <optional>
#include <vector>

#include "estara/shaders/registry.h"
#include "estara/shaders/seen.h"
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

/// Sum of |snoise(f q)| / f over f = 1, 2, 4 ... below maxfreq.
double skin_turbulence(const glm::dvec3& q, double maxfreq);

/// Change of a number with the point, by central differences over 2h.
template <class F>
glm::dvec3 change(F f, const glm::dvec3& p, double h) {
    glm::dvec3 slope(0.0);
    for (int c = 0; c < 3; ++c) {
        glm::dvec3 step(0.0);
        step[c] = h;
        slope[c] = (f(p + step) - f(p - step)) / (2 * h);
    }
    return slope;
}

struct Fresnel {
    double Kr;
    glm::dvec3 T;
};
Fresnel fresnel(const glm::dvec3& I, const glm::dvec3& N, double eta);
double henyey_greenstein(double cosine, double g);
double single_scatter(const glm::dvec3& wi, const glm::dvec3& wo, const glm::dvec3& n, double g,
                      double albedo, double thickness);

/// The shader's record at a point, in the order of the floats of Baked, with the shader's own
/// parameters; nothing for a shader that has no reference yet.
std::optional<std::vector<double>> bake(const BoundShader& shader, const SurfacePoint& x);

/// How a point is looked at and lit: ambient light and some others.
struct Sight {
    glm::dvec3 V, A;
    std::vector<Light> lights;
};

/// What the whole shader sends along V, unsplit: bake() above, normal, diffuse light and closing in
/// one go. Object space is world space. Nothing for a shader that has no reference yet.
std::optional<glm::dvec3> render(const BoundShader& shader, const SurfacePoint& x,
                                 const Sight& sight);

}  // namespace estara::reference
