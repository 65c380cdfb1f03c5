#include "block_loops.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

#include "estara/shaders/wide.h"
#include "triangle_boxes.h"
#include "triangle_planes.h"

namespace estara {

namespace {

/// Whole numbers from lo to hi; none if lo > hi.
struct Span {
    int lo, hi;
};

/// The numbers from 0 to last that lie in a range when counted from `first` on.
ESTARA_KERNEL Span count_from(double first, int last, const Range& range) noexcept {
    const double lo = std::max(range.lo - first, 0.0);
    const double hi = std::min(range.hi - first, double(last));
    if (!(lo <= hi)) return {0, -1};
    return {ceil_to_int(lo), floor_to_int(hi)};
}

template <class T>
ESTARA_KERNEL T larger(T a, T b) noexcept {
    return a > b ? a : b;
}
template <class T>
ESTARA_KERNEL T smaller(T a, T b) noexcept {
    return a < b ? a : b;
}

/// 2^n as a number; n whole, [0, 1000].
ESTARA_KERNEL double power_of_two(double n) noexcept {
    return std::bit_cast<double>(std::bit_cast<std::uint64_t>(n + (0x1p52 + 1023.0)) << 52);
}

/// The cells that one triangle meets. `cells` is empty before.
/// @return  the x in which there may be some, counted as CellRows does
ESTARA_KERNEL Span mark_triangle(const std::array<glm::dvec3, 3>& v, double slack,
                                 const glm::ivec3& origin, CellRows& cells) noexcept {
    const TriangleBoxes boxes(v, -slack, 1.0 + 2.0 * slack);
    const glm::dvec3 first = glm::dvec3(origin) - 1.0;
    const Span xs = count_from(first.x, CellRows::side - 1, boxes.bounds[0]);
    const Span ys = count_from(first.y, CellRows::side - 1, boxes.bounds[1]);
    if (ys.lo > ys.hi) return ys;
    for (int y = ys.lo; y <= ys.hi; y += 8) {  // twice only for one that crosses the block
        const Ranges rows = boxes.z_of_rows(first.y + double(y));
        for (int x = xs.lo; x <= xs.hi; ++x) {
            const Ranges z = boxes.z_of_boxes(first.x + double(x), first.y + double(y), rows);
            std::array<double, 8> bits;
            for (std::size_t i = 0; i < 8; ++i) {
                const double lo = larger(z.lo[i] - first.z, 0.0);
                const double hi = smaller(z.hi[i] - first.z, double(CellRows::side - 1));
                // From bit ceil(lo) to bit floor(hi), as a number; none if that is below 0.
                const double from = power_of_two(std::ceil(smaller(lo, double(CellRows::side))));
                const double to = power_of_two(std::floor(larger(hi, -1.0)) + 1.0);
                bits[i] = larger(to - from, 0.0);
            }
            std::uint16_t* const row = &cells.rows[std::size_t(x)][std::size_t(y)];
            for (std::size_t i = 0; i < 8; ++i) row[i] = std::uint16_t(int(bits[i]));
        }
    }
    return xs;
}

/// Where the eight voxels of a row lie, from the block's middle, and their bits.
constexpr float middle = 3.5f;
constexpr std::array<float, 8> from_middle{-3.5f, -2.5f, -1.5f, -0.5f, 0.5f, 1.5f, 2.5f, 3.5f};
constexpr std::array<std::uint32_t, 8> bit_of{1, 2, 4, 8, 16, 32, 64, 128};

/// Takes a triangle into account for those voxels of a row whose bits are set.
/// @param planes  from the block's middle
/// @param x, y    [0, 8)
ESTARA_KERNEL void visit_row(const TrianglePlanes& planes, std::uint32_t triangle, int x, int y,
                             std::uint32_t voxels, NearestTriangles& nearest) noexcept {
    std::array<float, 8> at;  // the planes' numbers at (x, y), z in the middle
    for (std::size_t k = 0; k < 8; ++k) {
        at[k] = planes.w[k] + planes.x[k] * (float(x) - middle) + planes.y[k] * (float(y) - middle);
    }
    const auto number = [&](int k, float z) {
        return at[std::size_t(k)] + planes.z[std::size_t(k)] * z;
    };
    constexpr float tie = 1e-5f;

    const auto row = std::size_t(x * 64 + y * 8);
    float* const __restrict distances = nearest.distance.data() + row;
    float* const __restrict heights = nearest.height.data() + row;
    std::uint32_t* const __restrict triangles = nearest.triangle.data() + row;
    // Written after the loop: inside it g++ makes masked stores of them, which are slow.
    std::array<std::array<float, 8>, 2> kept;
    std::array<std::uint32_t, 8> kept_triangle;
    for (std::size_t i = 0; i < 8; ++i) {
        const float z = from_middle[i];
        const float height = number(TrianglePlanes::height, z);
        float in_plane = std::numeric_limits<float>::infinity(), outmost = -in_plane;
        for (int e = 0; e < 3; ++e) {
            const float beside = number(TrianglePlanes::beside + e, z);
            const float along = number(TrianglePlanes::along + e, z);
            const float past = larger(
                larger(planes.start[std::size_t(e)] - along, along - planes.end[std::size_t(e)]),
                0.0f);
            in_plane = smaller(in_plane, beside * beside + past * past);
            outmost = larger(outmost, beside);
        }
        const float distance =
            std::sqrt(height * height + (outmost <= planes.inside ? 0.0f : in_plane));
        const float facing = height * planes.faces;
        const bool closer = distance < distances[i] - tie;
        const bool tied = distance <= distances[i] + tie;
        const bool faces_more = std::fabs(facing) > std::fabs(heights[i]);
        const bool asked = (voxels & bit_of[i]) != 0;
        const bool take = (closer | (tied & faces_more)) & asked;
        // Of two that tie the smaller one, whichever triangle is kept.
        kept[0][i] = asked ? smaller(distance, distances[i]) : distances[i];
        kept[1][i] = take ? facing : heights[i];
        kept_triangle[i] = take ? triangle : triangles[i];
    }
    for (std::size_t i = 0; i < 8; ++i) {
        distances[i] = kept[0][i];
        heights[i] = kept[1][i];
        triangles[i] = kept_triangle[i];
    }
}

ESTARA_KERNEL void voxelize_loop(const BlockInput& in, CellRows& cells,
                                 NearestTriangles* nearest) noexcept {
    const glm::dvec3 center = glm::dvec3(in.origin) + double(middle);
    for (const std::uint32_t t : in.triangles) {
        std::array<glm::dvec3, 3> v = in.lattice.corners(in.mesh, t);
        CellRows met;
        const Span xs = mark_triangle(v, in.lattice.slack, in.origin, met);
        if (xs.lo > xs.hi) continue;
        for (int x = xs.lo; x <= xs.hi; ++x) {
            for (std::size_t y = 0; y < 16; ++y) {
                cells.rows[std::size_t(x)][y] |= met.rows[std::size_t(x)][y];
            }
        }
        if (nearest == nullptr) continue;
        for (glm::dvec3& corner : v) corner -= center;
        const TrianglePlanes planes(v);
        for (int x = std::max(xs.lo - 1, 0); x <= std::min(xs.hi, 7); ++x) {
            std::array<std::uint32_t, 8> voxels;
            for (std::size_t y = 0; y < 8; ++y) voxels[y] = met.corners(std::size_t(x), y);
            for (int y = 0; y < 8; ++y) {
                if (voxels[std::size_t(y)] == 0) continue;
                visit_row(planes, t, x, y, voxels[std::size_t(y)], *nearest);
            }
        }
    }
}

}  // namespace

void voxelize(const BlockInput& in, CellRows& cells, NearestTriangles* nearest,
              InstructionSet limit) noexcept {
    wide([&in, &cells, nearest]() ESTARA_LOOP { voxelize_loop(in, cells, nearest); }, limit);
}

}  // namespace estara
