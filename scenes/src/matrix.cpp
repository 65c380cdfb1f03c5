#include "estara/scenes/matrix.h"

#include <algorithm>
#include <cmath>

namespace estara {
namespace {

double largest_entry(const glm::dmat3& m) noexcept {
    double largest = 0.0;
    for (int c = 0; c < 3; ++c) {
        for (int r = 0; r < 3; ++r) largest = std::max(largest, std::abs(m[c][r]));
    }
    return largest;
}

/// Largest eigenvalue of a symmetric matrix.
/// (Smith 1961, "Eigenvalues of a Symmetric 3x3 Matrix", Communications of the ACM 4(4).)
double largest_eigenvalue(const glm::dmat3& a) noexcept {
    const double mean = (a[0][0] + a[1][1] + a[2][2]) / 3.0;
    const glm::dmat3 centred = a - glm::dmat3(mean);
    double squares = 0.0;
    for (int c = 0; c < 3; ++c) squares += glm::dot(centred[c], centred[c]);
    const double spread = std::sqrt(squares / 6.0);
    if (!(spread > 0.0)) return mean;  // a multiple of the identity
    const double cosine = std::clamp(glm::determinant(centred / spread) / 2.0, -1.0, 1.0);
    return mean + 2.0 * spread * std::cos(std::acos(cosine) / 3.0);
}

}  // namespace

// Scaled to entries of at most 1 first, so that nothing over- or underflows.
double largest_singular_value(const glm::dmat3& m) noexcept {
    const double scale = largest_entry(m);
    if (!(scale > 0.0)) return 0.0;
    const glm::dmat3 unit = m / scale;
    return scale * std::sqrt(std::max(0.0, largest_eigenvalue(glm::transpose(unit) * unit)));
}

// The matrix of cofactors is det(m) times the inverse transpose, and exists where det(m) = 0.
glm::dmat3 normal_matrix(const glm::dmat3& m) noexcept {
    const double scale = largest_entry(m);
    if (!(scale > 0.0)) return glm::dmat3(1.0);
    const glm::dmat3 unit = m / scale;
    const glm::dmat3 cofactors(glm::cross(unit[1], unit[2]), glm::cross(unit[2], unit[0]),
                               glm::cross(unit[0], unit[1]));
    const double sign = glm::dot(unit[0], cofactors[0]) < 0.0 ? -1.0 : 1.0;
    const double size = largest_entry(cofactors);
    return size > 0.0 ? cofactors * (sign / size) : glm::dmat3(1.0);
}

}  // namespace estara
