#include "block_loops.h"

#include <algorithm>
#include <bit>

#include "triangle_boxes.h"
#include "triangle_planes.h"

namespace estara {

namespace {

/// Whole numbers from lo to hi; none if lo > hi.
struct Span {
    int lo, hi;
};

/// The cells of a block, counted from `first`, that lie in a range.
ESTARA_KERNEL Span cells_in(const Range& range, double first) noexcept {
    const double lo = std::max(range.lo - first, 0.0);
    const double hi = std::min(range.hi - first, double(CellRows::side - 1));
    if (!(lo <= hi)) return {0, -1};
    return {ceil_to_int(lo), floor_to_int(hi)};
}

/// Adds the cells that one triangle meets.
/// @return  the x of rows that may have changed
ESTARA_KERNEL Span mark_triangle(const std::array<glm::dvec3, 3>& v, double slack,
                                 const glm::ivec3& origin, CellRows& cells) noexcept {
    const TriangleBoxes boxes(v, -slack, 1.0 + 2.0 * slack);
    const glm::dvec3 first = glm::dvec3(origin) - 1.0;
    const Span xs = cells_in(boxes.bounds[0], first.x);
    const Span ys = cells_in(boxes.bounds[1], first.y);
    Range within{first.z, first.z + double(CellRows::side - 1)};
    clip(within, boxes.bounds[2]);
    if (!(within.lo <= within.hi)) return {0, -1};

    std::array<double, CellRows::side> lo, hi;  // of z, by y
    for (int y = ys.lo; y <= ys.hi; ++y) {
        Range z = within;
        clip(z, boxes.z_of_y(first.y + double(y)));
        lo[std::size_t(y)] = z.lo;
        hi[std::size_t(y)] = z.hi;
    }
    for (int x = xs.lo; x <= xs.hi; ++x) {
        const double cell_x = first.x + double(x);
        const Range z_of_x = boxes.z_of_x(cell_x);
        Range y_of_x = boxes.bounds[1];
        clip(y_of_x, boxes.y_of_x(cell_x));
        const Span column = cells_in(y_of_x, first.y);
        auto& row = cells.rows[std::size_t(x)];
        for (int y = column.lo; y <= column.hi; ++y) {
            Range z{lo[std::size_t(y)], hi[std::size_t(y)]};
            clip(z, z_of_x);
            clip(z, boxes.z_of_plane(cell_x, first.y + double(y)));
            // An empty range may be anything: these bounds make it no bits.
            const int from = ceil_to_int(std::min(z.lo - first.z, double(CellRows::side)));
            const int to = 1 + floor_to_int(std::max(z.hi - first.z, -1.0));
            row[std::size_t(y)] |= std::uint16_t(((1 << to) - 1) & ~((1 << from) - 1));
        }
    }
    return xs;
}

ESTARA_KERNEL double larger(double a, double b) noexcept { return a > b ? a : b; }
ESTARA_KERNEL double smaller(double a, double b) noexcept { return a < b ? a : b; }

/// Takes a triangle into account for the voxels (x, y, 0) to (x, y, 7) of which bits are set; they
/// are neighbours.
ESTARA_KERNEL void visit_row(const TrianglePlanes& planes, double triangle, int x, int y,
                             unsigned bits, NearestTriangles& nearest) noexcept {
    std::array<double, 8> at;  // the planes' numbers at (x, y, 0)
    for (std::size_t k = 0; k < 8; ++k) {
        at[k] = planes.w[k] + planes.x[k] * double(x) + planes.y[k] * double(y);
    }
    const auto number = [&](int k, double z) {
        return at[std::size_t(k)] + planes.z[std::size_t(k)] * z;
    };
    const double first = std::countr_zero(bits), last = std::bit_width(bits) - 1;
    constexpr double tie = 1e-9;
    // Not converted from whole numbers: 16 of those fill the vector that holds 8 doubles.
    constexpr std::array<double, 8> lanes{0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0};

    const auto row = std::size_t(x * 64 + y * 8);
    double* const __restrict distances = nearest.distance2.data() + row;
    double* const __restrict heights = nearest.height.data() + row;
    double* const __restrict triangles = nearest.triangle.data() + row;
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
        distances[i] = take ? distance2 : distances[i];
        heights[i] = take ? facing : heights[i];
        triangles[i] = take ? triangle : triangles[i];
    }
}

ESTARA_KERNEL void mark_loop(const BlockInput& in, CellRows& cells) noexcept {
    for (const std::uint32_t t : in.triangles) {
        mark_triangle(in.lattice.corners(in.mesh, t), in.lattice.slack, in.origin, cells);
    }
}

ESTARA_KERNEL void nearest_loop(const BlockInput& in, NearestTriangles& nearest) noexcept {
    CellRows cells;
    for (const std::uint32_t t : in.triangles) {
        std::array<glm::dvec3, 3> v = in.lattice.corners(in.mesh, t);
        const Span xs = mark_triangle(v, in.lattice.slack, in.origin, cells);
        for (glm::dvec3& corner : v) corner -= glm::dvec3(in.origin);
        const TrianglePlanes planes(v);
        for (int x = std::max(xs.lo - 1, 0); x <= std::min(xs.hi, 7); ++x) {
            for (int y = 0; y < 8; ++y) {
                const unsigned bits = cells.corners(std::size_t(x), std::size_t(y));
                if (bits != 0) visit_row(planes, double(t), x, y, bits, nearest);
            }
        }
        for (int x = xs.lo; x <= xs.hi; ++x) cells.rows[std::size_t(x)] = {};
    }
}

// Functions with a target of their own, for the reasons that shaders/src/bake_all.h gives.
using MarkLoop = void (*)(const BlockInput&, CellRows&) noexcept;
using NearestLoop = void (*)(const BlockInput&, NearestTriangles&) noexcept;

[[gnu::flatten]] void mark_baseline(const BlockInput& in, CellRows& cells) noexcept {
    mark_loop(in, cells);
}
[[gnu::flatten]] void nearest_baseline(const BlockInput& in, NearestTriangles& nearest) noexcept {
    nearest_loop(in, nearest);
}

#if defined(__x86_64__) && defined(__OPTIMIZE__) && !defined(__clang__)
#define ESTARA_DISPATCH 1
[[gnu::flatten, gnu::target("arch=x86-64-v3")]] void mark_avx2(const BlockInput& in,
                                                               CellRows& cells) noexcept {
    mark_loop(in, cells);
}
[[gnu::flatten, gnu::target("arch=x86-64-v3")]] void nearest_avx2(
    const BlockInput& in, NearestTriangles& nearest) noexcept {
    nearest_loop(in, nearest);
}
[[gnu::flatten, gnu::target("arch=x86-64-v4,prefer-vector-width=512")]] void nearest_avx512(
    const BlockInput& in, NearestTriangles& nearest) noexcept {
    nearest_loop(in, nearest);
}
#endif

MarkLoop widest_mark_loop() noexcept {
#ifdef ESTARA_DISPATCH
    if (__builtin_cpu_supports("x86-64-v3")) return mark_avx2;
#endif
    return mark_baseline;
}

NearestLoop widest_nearest_loop() noexcept {
#ifdef ESTARA_DISPATCH
    if (__builtin_cpu_supports("x86-64-v4")) return nearest_avx512;
    if (__builtin_cpu_supports("x86-64-v3")) return nearest_avx2;
#endif
    return nearest_baseline;
}

}  // namespace

void mark_cells(const BlockInput& in, CellRows& cells) noexcept {
    static const MarkLoop loop = widest_mark_loop();
    loop(in, cells);
}

void find_nearest(const BlockInput& in, NearestTriangles& nearest) noexcept {
    static const NearestLoop loop = widest_nearest_loop();
    loop(in, nearest);
}

}  // namespace estara
