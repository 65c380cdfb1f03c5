#include "estara/bake/surface_band.h"

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>

#include "block_loops.h"
#include "block_triangles.h"
#include "estara/scenes/error.h"

namespace estara {

namespace {

/// Index of the smallest voxel coordinate that the mesh's bounds have: the object lies in one
/// octant, where an OpenVDB tree is smallest, with room for the cells around it; and a flat side of
/// it lies between two layers of voxels, not in one, where it would touch three.
constexpr double margin = 8.5;

Lattice make_lattice(const Mesh& mesh, double voxel_size) {
    const Box box = bounds(mesh);
    if (!(voxel_size > 0.0) || !std::isfinite(voxel_size)) {
        throw Error(fmt::format("voxel size {} is not a positive number", voxel_size));
    }
    const glm::dvec3 extent = glm::dvec3(box.max) - glm::dvec3(box.min);
    const double widest = std::max({extent.x, extent.y, extent.z}) / voxel_size;
    if (widest > 131072.0) {
        throw Error(
            fmt::format("voxel size {:.6g} divides the object into {:.6g} voxels a side; at most "
                        "131072 are possible, of {:.6g}",
                        voxel_size, widest, voxel_size * widest / 131072.0));
    }
    // A hit point is interpolated in float: three products and two sums, each off by half an ulp of
    // the largest coordinate; four ulps bound it (with what the lookup itself rounds).
    const glm::vec3 largest = glm::max(glm::abs(box.min), glm::abs(box.max));
    const double extreme = std::max({largest.x, largest.y, largest.z});
    const double slack = 1e-4 + 4.0 * extreme * 0x1p-23 / voxel_size;
    if (slack > 0.25) {
        throw Error(
            fmt::format("voxel size {:.6g} is too small for coordinates as large as {:.6g}, which "
                        "floats tell apart by {:.2g}; move the object to its own origin",
                        voxel_size, extreme, extreme * 0x1p-23));
    }
    return {voxel_size, glm::dvec3(box.min) - margin * voxel_size, slack};
}

Lattice lattice_of(const SurfaceBand& band) noexcept {
    return {band.voxel_size, band.origin, band.slack};
}

/// A block's own cells.
BlockMask cells_of(const CellRows& rows) noexcept {
    BlockMask mask;
    for (std::size_t x = 0; x < 8; ++x) {
        for (std::size_t y = 0; y < 8; ++y) {
            const auto row = std::uint64_t((rows.rows[x + 1][y + 1] >> 1) & 0xffu);
            mask.words[x] |= row << (8 * y);
        }
    }
    return mask;
}

/// The voxels of a block that are corners of a cell.
BlockMask corners_of(const CellRows& rows) noexcept {
    BlockMask mask;
    for (std::size_t x = 0; x < 8; ++x) {
        for (std::size_t y = 0; y < 8; ++y) {
            mask.words[x] |= std::uint64_t(rows.corners(x, y)) << (8 * y);
        }
    }
    return mask;
}

BlockInput input(const Mesh& mesh, const SurfaceBand& band, const Lattice& lattice,
                 std::size_t block) noexcept {
    const SurfaceBand::Near& near = band.near[block];
    return {mesh, lattice, band.blocks[block].origin,
            std::span(band.triangles).subspan(near.first, near.count)};
}

/// The nearest triangles of a block. 12 KiB that a thread keeps.
const NearestTriangles& nearest_triangles(const BlockInput& in) noexcept {
    thread_local NearestTriangles nearest;
    nearest.clear();
    find_nearest(in, nearest);
    return nearest;
}

/// What was found for voxel `bit`, with the sign of the side.
float signed_distance(const NearestTriangles& nearest, std::size_t bit,
                      double voxel_size) noexcept {
    const double side = 1.0 - 2.0 * double(nearest.height[bit] < 0.0);  // no branch: it is random
    return float(side * std::sqrt(nearest.distance2[bit]) * voxel_size);
}

double ratio(double a, double b) noexcept { return b > 0.0 ? a / b : 0.0; }

/// Barycentric coordinates (b1, b2) of the triangle's point nearest to p (Ericson 2005, "Real-Time
/// Collision Detection", section 5.1.5; a zero-length edge counts as its start).
glm::dvec2 nearest_on_triangle(const glm::dvec3& p, const std::array<glm::dvec3, 3>& v) {
    const glm::dvec3 ab = v[1] - v[0], ac = v[2] - v[0], ap = p - v[0];
    const double d1 = glm::dot(ab, ap), d2 = glm::dot(ac, ap);
    if (d1 <= 0.0 && d2 <= 0.0) return {0.0, 0.0};
    const glm::dvec3 bp = p - v[1];
    const double d3 = glm::dot(ab, bp), d4 = glm::dot(ac, bp);
    if (d3 >= 0.0 && d4 <= d3) return {1.0, 0.0};
    const double vc = d1 * d4 - d3 * d2;
    if (vc <= 0.0 && d1 >= 0.0 && d3 <= 0.0) return {ratio(d1, d1 - d3), 0.0};
    const glm::dvec3 cp = p - v[2];
    const double d5 = glm::dot(ab, cp), d6 = glm::dot(ac, cp);
    if (d6 >= 0.0 && d5 <= d6) return {0.0, 1.0};
    const double vb = d5 * d2 - d1 * d6;
    if (vb <= 0.0 && d2 >= 0.0 && d6 <= 0.0) return {0.0, ratio(d2, d2 - d6)};
    const double va = d3 * d6 - d5 * d4;
    if (va <= 0.0 && d4 - d3 >= 0.0 && d5 - d6 >= 0.0) {
        const double w = ratio(d4 - d3, (d4 - d3) + (d5 - d6));
        return {1.0 - w, w};
    }
    const double sum = va + vb + vc;
    return {ratio(vb, sum), ratio(vc, sum)};
}

}  // namespace

void check_voxel_size(const Mesh& mesh, double voxel_size) { make_lattice(mesh, voxel_size); }

SurfaceBand surface_band(const Mesh& mesh, double voxel_size) {
    const Lattice lattice = make_lattice(mesh, voxel_size);
    BlockTriangles sorted = triangles_by_block(mesh, lattice);

    const std::size_t count = sorted.blocks.size();
    std::vector<BlockMask> active(count), cells(count);
    tbb::parallel_for(std::size_t{0}, count, [&](std::size_t b) {
        CellRows rows;
        mark_cells({mesh, lattice, 8 * sorted.blocks[b],
                    std::span(sorted.triangles)
                        .subspan(sorted.first[b], sorted.first[b + 1] - sorted.first[b])},
                   rows);
        cells[b] = cells_of(rows);
        active[b] = corners_of(rows);
    });

    SurfaceBand band{voxel_size, lattice.origin, lattice.slack, {}, {}, {}, {}};
    std::uint64_t rows = 0;
    for (std::size_t b = 0; b < count; ++b) {
        if (!active[b].any()) continue;  // the block's bounds met, its cells did not
        band.blocks.push_back({8 * sorted.blocks[b], active[b], rows});
        band.cells.push_back(cells[b]);
        band.near.push_back(
            {sorted.first[b], std::uint32_t(sorted.first[b + 1] - sorted.first[b])});
        rows += std::uint64_t(active[b].count());
    }
    band.triangles = std::move(sorted.triangles);
    return band;
}

void nearest_distances(const Mesh& mesh, const SurfaceBand& band, std::size_t block,
                       float* distances) noexcept {
    const Lattice lattice = lattice_of(band);
    const NearestTriangles& nearest = nearest_triangles(input(mesh, band, lattice, block));
    for_each_bit(band.blocks[block].active, [&](int x, int y, int z) {
        const auto bit = std::size_t(BlockMask::bit(x, y, z));
        *distances++ = signed_distance(nearest, bit, band.voxel_size);
    });
}

void nearest_points(const Mesh& mesh, const SurfaceBand& band, std::size_t block,
                    NearestPoints& points) noexcept {
    const Lattice lattice = lattice_of(band);
    const NearestTriangles& nearest = nearest_triangles(input(mesh, band, lattice, block));
    std::size_t i = 0;
    for_each_bit(band.blocks[block].active, [&](int x, int y, int z) {
        const auto bit = std::size_t(BlockMask::bit(x, y, z));
        const auto triangle = std::uint32_t(nearest.triangle[bit]);
        const glm::dvec3 voxel(band.blocks[block].origin + glm::ivec3(x, y, z));
        points.distance[i] = signed_distance(nearest, bit, band.voxel_size);
        points.triangle[i] = triangle;
        points.barycentrics[i] =
            glm::vec2(nearest_on_triangle(voxel, lattice.corners(mesh, triangle)));
        ++i;
    });
}

}  // namespace estara
