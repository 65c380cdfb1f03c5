#include "estara/bake/surface_band.h"

#include <fmt/format.h>
#include <tbb/blocked_range.h>
#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_sort.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <tuple>

#include "estara/scenes/error.h"
#include "triangle_box.h"

namespace estara {

namespace {

/// Index of the smallest voxel coordinate that the mesh's bounds have: the object lies in one
/// octant, where an OpenVDB tree is smallest, with room for the cells around it; and a flat side of
/// it lies between two layers of voxels, not in one, where it would touch three.
constexpr double margin = 8.5;

/// Where a mesh lies on its grid of voxels.
struct Lattice {
    double voxel_size;
    glm::dvec3 origin;
    double slack;  ///< how much larger than one voxel a cell is taken, on each side, in voxels

    std::array<glm::dvec3, 3> corners(const Mesh& mesh, std::size_t triangle) const {
        const glm::uvec3& t = mesh.triangles[triangle];
        std::array<glm::dvec3, 3> v;
        for (int i = 0; i < 3; ++i) v[i] = (glm::dvec3(mesh.P[t[i]]) - origin) / voxel_size;
        return v;
    }
};

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

/// A triangle and a block that it may have voxels in.
struct Entry {
    glm::ivec3 block;  ///< voxel origin / 8
    std::uint32_t triangle;
    bool operator<(const Entry& o) const noexcept {
        return std::tie(block.x, block.y, block.z, triangle) <
               std::tie(o.block.x, o.block.y, o.block.z, o.triangle);
    }
};

/// Lists the blocks in [lo, hi] that a triangle's cells may lie in, halving the range until one is
/// left and leaving out what the triangle does not meet: a large triangle costs what its area is
/// worth, not its bounding box.
void list_blocks(const std::array<glm::dvec3, 3>& v, std::uint32_t triangle, double slack,
                 const glm::ivec3& lo, const glm::ivec3& hi, std::vector<Entry>& out) {
    const glm::ivec3 size = hi - lo + 1;
    const int widest = std::max({size.x, size.y, size.z});
    // Cells -1 ... 7 of a block touch its voxels.
    const double edge = 8.0 * widest + 1.0 + 2.0 * slack;
    const glm::dvec3 corner = 8.0 * glm::dvec3(lo) - 1.0 - slack;
    if (!TriangleBox(v, edge).meets(corner)) return;
    if (widest == 1) {
        out.push_back({lo, triangle});
        return;
    }
    const int axis = size.x == widest ? 0 : (size.y == widest ? 1 : 2);
    glm::ivec3 middle_hi = hi, middle_lo = lo;
    middle_hi[axis] = lo[axis] + widest / 2 - 1;
    middle_lo[axis] = lo[axis] + widest / 2;
    list_blocks(v, triangle, slack, lo, middle_hi, out);
    list_blocks(v, triangle, slack, middle_lo, hi, out);
}

std::vector<Entry> list_entries(const Mesh& mesh, const Lattice& lattice) {
    tbb::enumerable_thread_specific<std::vector<Entry>> lists;
    tbb::parallel_for(
        tbb::blocked_range<std::size_t>(0, mesh.triangles.size(), 256), [&](const auto& range) {
            std::vector<Entry>& list = lists.local();
            for (std::size_t t = range.begin(); t < range.end(); ++t) {
                const auto v = lattice.corners(mesh, t);
                const glm::dvec3 lo = glm::min(v[0], glm::min(v[1], v[2])) - lattice.slack - 1.0;
                const glm::dvec3 hi = glm::max(v[0], glm::max(v[1], v[2])) + lattice.slack + 1.0;
                list_blocks(v, std::uint32_t(t), lattice.slack, glm::ivec3(glm::floor(lo / 8.0)),
                            glm::ivec3(glm::floor(hi / 8.0)), list);
            }
        });
    std::vector<Entry> all;
    for (std::vector<Entry>& list : lists) {
        all.insert(all.end(), list.begin(), list.end());
        std::vector<Entry>().swap(list);
    }
    tbb::parallel_sort(all);
    return all;
}

struct Nearest {
    double distance2 = std::numeric_limits<double>::infinity();  ///< voxels squared
    double facing = -1.0;  ///< |cosine| between the triangle's normal and the way to the voxel
    double side = 1.0;
    std::uint32_t triangle = 0;
    glm::vec2 barycentrics{0.0f};
};

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

/// Takes a triangle into account for the voxel at p. Of triangles equally near (they share the
/// nearest edge or vertex) the one that faces the voxel most decides the side: the others may see
/// it from behind although it is in front of the surface.
void keep_nearest(Nearest& nearest, const glm::dvec3& p, const std::array<glm::dvec3, 3>& v,
                  const glm::dvec3& unit_normal, std::uint32_t triangle) {
    const glm::dvec2 b = nearest_on_triangle(p, v);
    const glm::dvec3 way = p - ((1.0 - b.x - b.y) * v[0] + b.x * v[1] + b.y * v[2]);
    const double distance2 = glm::dot(way, way);
    const double tie = 1e-9;
    if (distance2 > nearest.distance2 + tie) return;
    const double height = glm::dot(unit_normal, way);
    const double facing = std::abs(height) / std::sqrt(std::max(distance2, 1e-30));
    if (distance2 < nearest.distance2 - tie || facing > nearest.facing) {
        nearest = {distance2, facing, height < 0.0 ? -1.0 : 1.0, triangle, glm::vec2(b)};
    }
}

/// A block under construction: 9^3 cells around it matter, cell -1 to 7 in each direction.
struct BlockBuilder {
    BlockMask active, cells;
    std::array<Nearest, 512> nearest;

    void add(const std::array<glm::dvec3, 3>& v, std::uint32_t triangle, const glm::ivec3& origin,
             double slack) {
        BlockMask touched;
        const TriangleBox test(v, 1.0 + 2.0 * slack);
        const glm::dvec3 base(origin);
        const glm::ivec3 lo =
            glm::max(glm::ivec3(glm::floor(test.min() - slack - base)), glm::ivec3(-1));
        const glm::ivec3 hi =
            glm::min(glm::ivec3(glm::floor(test.max() + slack - base)), glm::ivec3(7));
        for (int x = lo.x; x <= hi.x; ++x) {
            for (int y = lo.y; y <= hi.y; ++y) {
                for (int z = lo.z; z <= hi.z; ++z) {
                    if (!test.meets(base + glm::dvec3(x, y, z) - slack)) continue;
                    if (x >= 0 && y >= 0 && z >= 0) cells.set(BlockMask::bit(x, y, z));
                    touch_corners(x, y, z, touched);
                }
            }
        }
        const glm::dvec3 normal = glm::cross(v[1] - v[0], v[2] - v[0]);
        const double length = glm::length(normal);
        const glm::dvec3 unit = length > 0.0 ? normal / length : glm::dvec3(0.0);
        for_each_bit(touched, [&](int x, int y, int z) {
            const int bit = BlockMask::bit(x, y, z);
            const glm::dvec3 p = base + glm::dvec3(x, y, z);
            keep_nearest(nearest[bit], p, v, unit, triangle);
            active.set(bit);
        });
    }

    /// The corners of a cell that are voxels of this block.
    static void touch_corners(int x, int y, int z, BlockMask& touched) {
        for (int i = std::max(x, 0); i <= std::min(x + 1, 7); ++i) {
            for (int j = std::max(y, 0); j <= std::min(y + 1, 7); ++j) {
                for (int k = std::max(z, 0); k <= std::min(z + 1, 7); ++k) {
                    touched.set(BlockMask::bit(i, j, k));
                }
            }
        }
    }
};

/// What BlockBuilder leaves: the masks and the voxels' data in bit order.
struct FinishedBlock {
    BlockMask active, cells;
    std::vector<Nearest> voxels;
};

FinishedBlock build_block(const Mesh& mesh, const Lattice& lattice, const Entry* first,
                          const Entry* last) {
    thread_local BlockBuilder builder;  // 24 KiB that every block needs anew
    builder = BlockBuilder{};
    for (const Entry* e = first; e != last; ++e) {
        builder.add(lattice.corners(mesh, e->triangle), e->triangle, 8 * e->block, lattice.slack);
    }
    FinishedBlock block{builder.active, builder.cells, {}};
    block.voxels.reserve(std::size_t(builder.active.count()));
    for_each_bit(builder.active, [&](int x, int y, int z) {
        block.voxels.push_back(builder.nearest[BlockMask::bit(x, y, z)]);
    });
    return block;
}

}  // namespace

void check_voxel_size(const Mesh& mesh, double voxel_size) { make_lattice(mesh, voxel_size); }

SurfaceBand surface_band(const Mesh& mesh, double voxel_size) {
    const Lattice lattice = make_lattice(mesh, voxel_size);
    const std::vector<Entry> entries = list_entries(mesh, lattice);

    std::vector<std::size_t> starts;  // of each block's entries
    for (std::size_t i = 0; i < entries.size(); ++i) {
        if (i == 0 || entries[i].block != entries[i - 1].block) starts.push_back(i);
    }
    const std::size_t count = starts.size();
    starts.push_back(entries.size());

    std::vector<FinishedBlock> finished(count);
    tbb::parallel_for(std::size_t{0}, count, [&](std::size_t i) {
        finished[i] =
            build_block(mesh, lattice, &entries[starts[i]], entries.data() + starts[i + 1]);
    });

    SurfaceBand band{voxel_size, lattice.origin, {}, {}, {}, {}, {}};
    std::uint64_t rows = 0;
    std::vector<std::size_t> kept;
    for (std::size_t i = 0; i < count; ++i) {
        if (finished[i].voxels.empty()) continue;  // the bounds met, the cells did not
        kept.push_back(i);
        band.blocks.push_back({8 * entries[starts[i]].block, finished[i].active, rows});
        band.cells.push_back(finished[i].cells);
        rows += finished[i].voxels.size();
    }
    band.triangle.resize(rows);
    band.barycentrics.resize(rows);
    band.distance.resize(rows);
    tbb::parallel_for(std::size_t{0}, kept.size(), [&](std::size_t b) {
        std::uint64_t row = band.blocks[b].first;
        for (const Nearest& n : finished[kept[b]].voxels) {
            band.triangle[row] = n.triangle;
            band.barycentrics[row] = n.barycentrics;
            band.distance[row] = float(n.side * std::sqrt(n.distance2) * voxel_size);
            ++row;
        }
        std::vector<Nearest>().swap(finished[kept[b]].voxels);
    });
    return band;
}

bool is_closed(const Mesh& mesh) {
    // Vertices at the same position get the same number.
    std::vector<std::uint32_t> order(mesh.P.size()), number(mesh.P.size());
    for (std::uint32_t i = 0; i < order.size(); ++i) order[i] = i;
    const auto key = [&](std::uint32_t i) {
        return std::tie(mesh.P[i].x, mesh.P[i].y, mesh.P[i].z);
    };
    tbb::parallel_sort(order.begin(), order.end(), [&](auto a, auto b) { return key(a) < key(b); });
    for (std::size_t i = 0; i < order.size(); ++i) {
        number[order[i]] =
            i > 0 && key(order[i]) == key(order[i - 1]) ? number[order[i - 1]] : std::uint32_t(i);
    }

    struct Edge {
        std::uint32_t low, high;
        bool ascending;
        bool operator<(const Edge& o) const noexcept {
            return std::tie(low, high, ascending) < std::tie(o.low, o.high, o.ascending);
        }
    };
    std::vector<Edge> edges;
    edges.reserve(3 * mesh.triangles.size());
    for (const glm::uvec3& t : mesh.triangles) {
        const std::array<std::uint32_t, 3> c{number[t.x], number[t.y], number[t.z]};
        if (c[0] == c[1] || c[1] == c[2] || c[2] == c[0]) continue;
        for (int e = 0; e < 3; ++e) {
            const std::uint32_t a = c[e], b = c[(e + 1) % 3];
            edges.push_back({std::min(a, b), std::max(a, b), a < b});
        }
    }
    tbb::parallel_sort(edges.begin(), edges.end());
    if (edges.empty() || edges.size() % 2 != 0) return false;
    for (std::size_t i = 0; i < edges.size(); i += 2) {
        const Edge &a = edges[i], &b = edges[i + 1];
        const bool pair = a.low == b.low && a.high == b.high && a.ascending != b.ascending;
        const bool third =
            i + 2 < edges.size() && edges[i + 2].low == a.low && edges[i + 2].high == a.high;
        if (!pair || third) return false;
    }
    return true;
}

}  // namespace estara
