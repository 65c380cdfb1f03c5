// Where neighbouring points of a picture lie on different surfaces.
#pragma once

#include <glm/glm.hpp>

#include <array>
#include <cstdint>
#include <vector>

#include "estara/shaders/kernel.h"

namespace estara {

/// Whether two neighbouring points of one instance seem to lie on one surface: their normals are
/// less than 37 degrees apart, and the way from one to the other leaves neither's plane by more
/// than 18 degrees.
/// @param P, Ng  object space; Ng of unit length
ESTARA_KERNEL bool is_one_surface(const glm::vec3& P_a, const glm::vec3& Ng_a, const glm::vec3& P_b,
                                  const glm::vec3& Ng_b) noexcept {
    constexpr float least = 0.8f;  // cosine between normals
    constexpr float steep = 0.1f;  // square of the sine of the way's angle with a plane
    const glm::vec3 way = P_b - P_a;
    const float off_a = glm::dot(Ng_a, way), off_b = glm::dot(Ng_b, way);
    const float most = steep * glm::dot(way, way);
    return (glm::dot(Ng_a, Ng_b) > least) & (off_a * off_a <= most) & (off_b * off_b <= most);
}

/// Finds the outlines in a raster of points, some of them not known, row after row.
///
/// A cell is at an outline if its point and that of one of its four neighbours are of different
/// instances, or not of one surface. Next to a cell without a point all others are at an outline;
/// what is beyond the raster is taken to be alike.
class OutlineFinder {
public:
    static constexpr int none = -1;  ///< instance of a cell without a point

    /// Begins a raster, and its first row: no cell has a point yet.
    void start(int width);
    /// @param P, Ng  object space of the instance; Ng of unit length
    void set(int x, int instance, const glm::vec3& P, const glm::vec3& Ng) noexcept {
        Row& row = m_rows[m_now];
        const auto i = std::size_t(x + 1);
        row.instance[i] = instance;
        for (int c = 0; c < 3; ++c) {
            row.P[std::size_t(c)][i] = P[c];
            row.Ng[std::size_t(c)][i] = Ng[c];
        }
    }
    /// Ends a row and begins the next.
    /// @param above  by cell of the row before, if there is one: 1 at an outline
    void next(std::uint8_t* above);
    /// After next() of the last row: tells of that row.
    void finish(std::uint8_t* last);

private:
    static constexpr int beyond = -2;
    /// With a cell beyond on either side.
    struct Row {
        std::vector<std::int32_t> instance;
        std::array<std::vector<float>, 3> P, Ng;
        std::vector<std::int32_t> right, below;  ///< 1: differs from that neighbour
    };

    void tell(const Row& row, const Row& above, std::uint8_t* outline) const;

    int m_width = 0;
    std::size_t m_now = 0;  ///< of m_rows; the rows before it go around
    bool m_first = true;
    std::array<Row, 3> m_rows;
};

}  // namespace estara
