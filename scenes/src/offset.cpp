// The rounding errors between a point of a mesh and a ray that starts there.
#include "estara/scenes/offset.h"

namespace estara {

namespace {

/// Largest relative error of n float operations one after the other.
/// Higham 2002, "Accuracy and Stability of Numerical Algorithms", Eq. 3.1.
constexpr float gamma(int n) noexcept {
    constexpr float half_ulp = 0x1p-24f;
    return float(n) * half_ulp / (1.0f - float(n) * half_ulp);
}

// Seven operations interpolate P_object; nine are left for the triangle test.
constexpr float on_triangle = gamma(16);
// P_object to P.
constexpr float to_world = gamma(3);
// The tracer takes the ray's origin back with the inverse it has computed itself.
constexpr float origin_to_object = gamma(4), shift_to_object = gamma(6);
// P moved: a product and a sum.
constexpr float moved = gamma(2);

glm::mat3 magnitudes(const glm::mat3& m) noexcept {
    return {glm::abs(m[0]), glm::abs(m[1]), glm::abs(m[2])};
}

}  // namespace

SurfaceOffset::SurfaceOffset(const glm::mat4& world_from_object) noexcept
    : m_there(magnitudes(glm::mat3(world_from_object))),
      m_shift(glm::abs(glm::vec3(world_from_object[3]))),
      m_of_reach(on_triangle + to_world),
      m_least(gamma(8)) {
    const glm::mat3 there_and_back =
        m_there * magnitudes(glm::inverse(glm::mat3(world_from_object)));
    m_of_P = origin_to_object * there_and_back + glm::mat3(moved);
    m_fixed = to_world * m_shift + there_and_back * (shift_to_object * m_shift);
}

}  // namespace estara
