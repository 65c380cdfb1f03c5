#include "estara/bake/surface_band.h"

#include <fmt/format.h>
#include <tbb/blocked_range.h>
#include <tbb/parallel_pipeline.h>
#include <tbb/parallel_reduce.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <cmath>
#include <functional>

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

/// Block b of those that triangles have been sorted into.
BlockInput input(const Mesh& mesh, const Lattice& lattice, const BlockTriangles& sorted,
                 std::size_t b) noexcept {
    return {mesh, lattice, 8 * sorted.blocks[b],
            std::span(sorted.triangles)
                .subspan(sorted.first[b], sorted.first[b + 1] - sorted.first[b])};
}

/// Blocks that are voxelized one after another: half a millisecond of work.
constexpr std::size_t chunk_size = 64;

/// What a chunk of blocks adds to the band.
struct Chunk {
    std::vector<Block> blocks;  ///< rows counted from 0
    std::vector<BlockMask> cells;
    std::vector<float> distance;
    std::vector<std::uint32_t> triangle;

    /// What has been found for a block's voxels, with the sign of the side.
    void add_voxels(const NearestTriangles& nearest, const BlockMask& active, double voxel_size) {
        std::size_t row = distance.size();
        distance.resize(row + std::size_t(active.count()));
        triangle.resize(distance.size());
        for_each_bit(active, [&](int x, int y, int z) {
            const auto bit = std::size_t(BlockMask::bit(x, y, z));
            // No branch: the side is random.
            const double side = 1.0 - 2.0 * double(nearest.height[bit] < 0.0f);
            distance[row] = float(side * double(nearest.distance[bit]) * voxel_size);
            triangle[row++] = nearest.triangle[bit];
        });
    }
};

Chunk voxelize_chunk(const Mesh& mesh, const Lattice& lattice, const BlockTriangles& sorted,
                     std::size_t begin, std::size_t end) {
    thread_local NearestTriangles nearest;  // 6 KiB
    Chunk chunk;
    for (std::size_t b = begin; b < end; ++b) {
        CellRows rows;
        nearest.clear();
        voxelize(input(mesh, lattice, sorted, b), rows, &nearest);
        const BlockMask active = corners_of(rows);
        if (!active.any()) continue;  // the block's bounds met, its cells did not
        chunk.blocks.push_back({8 * sorted.blocks[b], active, chunk.distance.size()});
        chunk.cells.push_back(cells_of(rows));
        chunk.add_voxels(nearest, active, lattice.voxel_size);
    }
    return chunk;
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

SurfaceBand surface_band(const Mesh& mesh, double voxel_size, bool with_triangles) {
    const Lattice lattice = make_lattice(mesh, voxel_size);
    const BlockTriangles sorted = triangles_by_block(mesh, lattice);
    const std::size_t count = sorted.blocks.size();
    SurfaceBand band{voxel_size, lattice.origin, {}, {}, {}, {}};
    std::size_t next = 0;
    const auto begin_chunk = [&](tbb::flow_control& flow) {
        const std::size_t begin = next;
        if (begin >= count) flow.stop();
        next += chunk_size;
        return begin;
    };
    const auto fill_chunk = [&](std::size_t begin) {
        return voxelize_chunk(mesh, lattice, sorted, begin, std::min(begin + chunk_size, count));
    };
    const auto add = [&](const Chunk& chunk) {
        const std::uint64_t rows = band.distance.size();
        for (Block block : chunk.blocks) {
            block.first += rows;
            band.blocks.push_back(block);
        }
        band.cells.insert(band.cells.end(), chunk.cells.begin(), chunk.cells.end());
        band.distance.insert(band.distance.end(), chunk.distance.begin(), chunk.distance.end());
        if (!with_triangles) return;
        band.triangle.insert(band.triangle.end(), chunk.triangle.begin(), chunk.triangle.end());
    };
    // Few, and taken in at once: if all of them were kept until the band's size is known, they
    // would take as much memory as the band, and the heap would not give it back.
    const auto chunks_at_a_time = 2 * std::size_t(tbb::this_task_arena::max_concurrency());
    using tbb::filter_mode, tbb::make_filter;
    tbb::parallel_pipeline(
        chunks_at_a_time,
        make_filter<void, std::size_t>(filter_mode::serial_in_order, begin_chunk) &
            make_filter<std::size_t, Chunk>(filter_mode::parallel, fill_chunk) &
            make_filter<Chunk, void>(filter_mode::serial_in_order, add));
    return band;
}

std::uint64_t count_voxels(const Mesh& mesh, double voxel_size) {
    const Lattice lattice = make_lattice(mesh, voxel_size);
    const BlockTriangles sorted = triangles_by_block(mesh, lattice);
    return tbb::parallel_reduce(
        tbb::blocked_range<std::size_t>(0, sorted.blocks.size()), std::uint64_t{0},
        [&](const tbb::blocked_range<std::size_t>& blocks, std::uint64_t voxels) {
            for (std::size_t b = blocks.begin(); b < blocks.end(); ++b) {
                CellRows rows;
                voxelize(input(mesh, lattice, sorted, b), rows, nullptr);
                voxels += std::uint64_t(corners_of(rows).count());
            }
            return voxels;
        },
        std::plus<>());
}

void nearest_points(const Mesh& mesh, const SurfaceBand& band, std::size_t block,
                    std::vector<MeshPoint>& points) {
    points.clear();
    const Block& of = band.blocks[block];
    const std::uint32_t* const triangles = band.triangle.data() + of.first;
    for_each_bit(of.active, [&](int x, int y, int z) {
        const std::uint32_t triangle = triangles[points.size()];
        const glm::vec2 b12(
            nearest_on_triangle(glm::dvec3(of.origin + glm::ivec3(x, y, z)),
                                triangle_corners(mesh, triangle, band.origin, band.voxel_size)));
        points.push_back(mesh_point(mesh, triangle, b12.x, b12.y));
    });
}

}  // namespace estara
