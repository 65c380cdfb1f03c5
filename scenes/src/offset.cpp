// Where a ray that leaves a surface starts.
#include <algorithm>
#include <cmath>
#include <limits>

#include "estara/scenes/ray_scene.h"

namespace estara {

namespace {

/// Largest relative error of n float operations one after the other.
/// Higham 2002, "Accuracy and Stability of Numerical Algorithms", Eq. 3.1.
constexpr float gamma(int n) noexcept {
    constexpr float half_ulp = 0x1p-24f;
    return float(n) * half_ulp / (1.0f - float(n) * half_ulp);
}

glm::mat3 magnitudes(const glm::mat3& m) noexcept {
    return {glm::abs(m[0]), glm::abs(m[1]), glm::abs(m[2])};
}

/// Bound of the distance, by world axis, between P and the surface as a ray from P meets it.
glm::vec3 error_bound(const glm::vec3& P, const glm::mat4& world_from_object,
                      const glm::vec3& P_object) noexcept {
    const glm::mat3 linear(world_from_object);
    const glm::mat3 there = magnitudes(linear), back = magnitudes(glm::inverse(linear));
    const glm::vec3 reach = there * glm::abs(P_object);
    const glm::vec3 shift = glm::abs(glm::vec3(world_from_object[3]));
    // Seven operations interpolate P_object; nine are left for the triangle test.
    const glm::vec3 on_triangle = gamma(16) * reach;
    const glm::vec3 to_world = gamma(3) * (reach + shift);
    // The tracer takes the ray's origin back with the inverse it has computed itself.
    const glm::vec3 to_object = back * (gamma(4) * glm::abs(P) + gamma(6) * shift);
    // Along an axis in which the object has no extent (a floor in y = 0) nothing of this is left;
    // the triangle test takes its products from the other axes all the same, and its distance of
    // next to 0 is a hit.
    const glm::vec3 size = reach + shift;
    const glm::vec3 least(gamma(8) * std::max({size.x, size.y, size.z}));
    return glm::max(on_triangle + to_world + there * to_object, least);
}

/// The next float in the direction of `way`, x itself where that is 0.
float nudged(float x, float way) noexcept {
    constexpr float infinity = std::numeric_limits<float>::infinity();
    return way == 0.0f ? x : std::nextafter(x, way > 0.0f ? infinity : -infinity);
}

}  // namespace

glm::vec3 offset_from_surface(const glm::vec3& P, const glm::vec3& N,
                              const glm::mat4& world_from_object,
                              const glm::vec3& P_object) noexcept {
    const float distance = glm::dot(glm::abs(N), error_bound(P, world_from_object, P_object));
    if (!std::isfinite(distance)) return P;  // singular: there is no surface to leave
    const glm::vec3 off = P + distance * N;
    return {nudged(off.x, N.x), nudged(off.y, N.y), nudged(off.z, N.z)};
}

}  // namespace estara
