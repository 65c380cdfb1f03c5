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

ESTARA_KERNEL double larger(double a, double b) noexcept { return a > b ? a : b; }
ESTARA_KERNEL double smaller(double a, double b) noexcept { return a < b ? a : b; }

/// 2^n as a number; n whole, [0, 1000].
ESTARA_KERNEL double power_of_two(double n) noexcept {
    return std::bit_cast<double>(std::bit_cast<std::uint64_t>(n + (0x1p52 + 1023.0)) << 52);
}

/// Adds the cells that one triangle meets.
ESTARA_KERNEL void mark_triangle(const std::array<glm::dvec3, 3>& v, double slack,
                                 const glm::ivec3& origin, CellRows& cells) noexcept {
    const TriangleBoxes boxes(v, -slack, 1.0 + 2.0 * slack);
    const glm::dvec3 first = glm::dvec3(origin) - 1.0;
    const Span xs = count_from(first.x, CellRows::side - 1, boxes.bounds[0]);
    const Span ys = count_from(first.y, CellRows::side - 1, boxes.bounds[1]);
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
            for (std::size_t i = 0; i < 8; ++i) row[i] |= std::uint16_t(int(bits[i]));
        }
    }
}

/// Takes a triangle into account for voxels (x, y, z) of which z lies in [first, last].
ESTARA_KERNEL void visit_row(const TrianglePlanes& planes, double triangle, int x, int y,
                             double first, double last, NearestTriangles& nearest) noexcept {
    std::array<double, 8> at;  // the planes' numbers at (x, y, 0)
    for (std::size_t k = 0; k < 8; ++k) {
        at[k] = planes.w[k] + planes.x[k] * double(x) + planes.y[k] * double(y);
    }
    const auto number = [&](int k, double z) {
        return at[std::size_t(k)] + planes.z[std::size_t(k)] * z;
    };
    constexpr double tie = 1e-9;

    const auto row = std::size_t(x * 64 + y * 8);
    double* const __restrict distances = nearest.distance2.data() + row;
    double* const __restrict heights = nearest.height.data() + row;
    double* const __restrict triangles = nearest.triangle.data() + row;
    // Written after the loop: inside it g++ makes masked stores of them, which are slow.
    std::array<std::array<double, 8>, 3> kept;
    for (std::size_t i = 0; i < 8; ++i) {
        const double z = lanes[i];
        const double height = number(TrianglePlanes::height, z);
        double in_plane = std::numeric_limits<double>::infinity(), outmost = -in_plane;
        for (int e = 0; e < 3; ++e) {
            const double beside = number(TrianglePlanes::beside + e, z);
            const double along = std::abs(number(TrianglePlanes::along + e, z));
            const double past = larger(along - planes.half[std::size_t(e)], 0.0);
            in_plane = smaller(in_plane, beside * beside + past * past);
            outmost = larger(outmost, beside);
        }
        const double distance2 = height * height + (outmost <= planes.inside ? 0.0 : in_plane);
        const double facing = height * planes.faces;
        const bool closer = distance2 < distances[i] - tie;
        const bool tied = distance2 <= distances[i] + tie;
        const bool faces_more = std::abs(facing) > std::abs(heights[i]);
        const bool take = (closer | (tied & faces_more)) & (z >= first) & (z <= last);
        kept[0][i] = take ? distance2 : distances[i];
        kept[1][i] = take ? facing : heights[i];
        kept[2][i] = take ? triangle : triangles[i];
    }
    for (std::size_t i = 0; i < 8; ++i) {
        distances[i] = kept[0][i];
        heights[i] = kept[1][i];
        triangles[i] = kept[2][i];
    }
}

ESTARA_KERNEL void mark_loop(const BlockInput& in, CellRows& cells) noexcept {
    for (const std::uint32_t t : in.triangles) {
        mark_triangle(in.lattice.corners(in.mesh, t), in.lattice.slack, in.origin, cells);
    }
}

ESTARA_KERNEL void nearest_loop(const BlockInput& in, NearestTriangles& nearest) noexcept {
    const glm::dvec3 first(in.origin);
    for (const std::uint32_t t : in.triangles) {
        std::array<glm::dvec3, 3> v = in.lattice.corners(in.mesh, t);
        // The eight cells around a voxel, each as large as it was marked, are a box.
        const double reach = 1.0 + in.lattice.slack;
        const TriangleBoxes boxes(v, -reach, 2.0 * reach);
        const Span xs = count_from(first.x, 7, boxes.bounds[0]);
        const Span ys = count_from(first.y, 7, boxes.bounds[1]);
        if (xs.lo > xs.hi || ys.lo > ys.hi) continue;
        for (glm::dvec3& corner : v) corner -= first;
        const TrianglePlanes planes(v);
        const Ranges rows = boxes.z_of_rows(first.y);
        for (int x = xs.lo; x <= xs.hi; ++x) {
            const Ranges z = boxes.z_of_boxes(first.x + double(x), first.y, rows);
            for (int y = ys.lo; y <= ys.hi; ++y) {
                const double lo = larger(z.lo[std::size_t(y)] - first.z, 0.0);
                const double hi = smaller(z.hi[std::size_t(y)] - first.z, 7.0);
                if (lo <= hi) visit_row(planes, double(t), x, y, lo, hi, nearest);
            }
        }
    }
}

}  // namespace

void mark_cells(const BlockInput& in, CellRows& cells, InstructionSet limit) noexcept {
    // Wider gains nothing (measured): a row has nine cells.
    const InstructionSet widest = limit < InstructionSet::avx2 ? limit : InstructionSet::avx2;
    wide([&in, &cells]() ESTARA_LOOP { mark_loop(in, cells); }, widest);
}

void find_nearest(const BlockInput& in, NearestTriangles& nearest, InstructionSet limit) noexcept {
    wide([&in, &nearest]() ESTARA_LOOP { nearest_loop(in, nearest); }, limit);
}

}  // namespace estara
