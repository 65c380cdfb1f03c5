// What else one wants to know of a matrix.
#pragma once

#include <glm/glm.hpp>

namespace estara {

/// Largest singular value: how long a unit vector can become.
double largest_singular_value(const glm::dmat3& m) noexcept;

/// The inverse transpose times some positive number. For a singular matrix still the normals of
/// what it flattens, as far as they exist.
glm::dmat3 normal_matrix(const glm::dmat3& m) noexcept;

}  // namespace estara
