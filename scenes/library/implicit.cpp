#include "implicit.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <unordered_map>

// The only file of the examples that includes OpenVDB: that takes half a minute to compile.
#include <openvdb/openvdb.h>
#include <openvdb/tools/SignedFloodFill.h>
#include <openvdb/tools/VolumeToMesh.h>
#include <tbb/parallel_for.h>

namespace estara::examples {

namespace {

/// Slope of a solid: unit normal that points outwards.
glm::dvec3 slope(const Solid& solid, const glm::dvec3& p, double step) {
    // Four points of a tetrahedron: as good as six on the axes.
    const glm::dvec3 corners[]{{1, 1, 1}, {1, -1, -1}, {-1, 1, -1}, {-1, -1, 1}};
    glm::dvec3 sum(0.0);
    for (const glm::dvec3& c : corners) sum += c * solid(p + step * c);
    return glm::normalize(sum);
}

/// Fills the voxels near the surface, a leaf at a time; those that the surface cannot reach are
/// left to the flood fill.
openvdb::FloatGrid::Ptr near_surface(const Solid& solid, const DBox& inside, double edge) {
    constexpr int side = int(openvdb::FloatTree::LeafNodeType::DIM);
    const double band = 3.0 * edge;
    const openvdb::FloatGrid::Ptr grid = openvdb::FloatGrid::create(float(band));
    grid->setGridClass(openvdb::GRID_LEVEL_SET);
    const auto first = glm::ivec3(glm::floor(inside.min / (edge * side))) - 1;
    const auto last = glm::ivec3(glm::floor(inside.max / (edge * side))) + 1;
    std::vector<openvdb::FloatTree::LeafNodeType*> leaves;
    for (int z = first.z; z <= last.z; ++z)
        for (int y = first.y; y <= last.y; ++y)
            for (int x = first.x; x <= last.x; ++x) {
                const glm::dvec3 centre = (glm::dvec3(x, y, z) + 0.5) * (side * edge);
                // Blended distances may be too large by a little: half a leaf more.
                const double reach = 0.5 * side * edge * (std::numbers::sqrt3 + 1.0) + band;
                if (std::abs(solid(centre)) < reach)
                    leaves.push_back(
                        grid->tree().touchLeaf(openvdb::Coord(side * x, side * y, side * z)));
            }
    tbb::parallel_for(std::size_t{0}, leaves.size(), [&](std::size_t i) {
        auto& leaf = *leaves[i];
        for (openvdb::Index n = 0; n < leaf.SIZE; ++n) {
            const openvdb::Vec3d p = leaf.offsetToGlobalCoord(n).asVec3d() * edge;
            const double d = solid({p.x(), p.y(), p.z()});
            if (std::abs(d) < band) {
                leaf.setValueOn(n, float(d));
            } else {
                leaf.setValueOff(n, float(std::copysign(band, d)));
            }
        }
    });
    openvdb::tools::signedFloodFill(grid->tree());
    return grid;
}

}  // namespace

double ellipsoid(const glm::dvec3& p, const glm::dvec3& centre, const glm::dvec3& radii) {
    const glm::dvec3 q = (p - centre) / radii;
    const double k0 = glm::length(q), k1 = glm::length(q / radii);
    if (k1 < 1e-9) return -std::min({radii.x, radii.y, radii.z});
    return k0 * (k0 - 1.0) / k1;
}

double capsule(const glm::dvec3& p, const glm::dvec3& a, double radius_a, const glm::dvec3& b,
               double radius_b) {
    const glm::dvec3 ab = b - a, ap = p - a;
    const double t = std::clamp(glm::dot(ap, ab) / glm::dot(ab, ab), 0.0, 1.0);
    return glm::length(ap - t * ab) - (radius_a + t * (radius_b - radius_a));
}

double blended(double a, double b, double blend) {
    if (blend <= 0.0) return std::min(a, b);
    const double h = std::max(blend - std::abs(a - b), 0.0) / blend;
    return std::min(a, b) - 0.25 * h * h * blend;
}

double carved(double a, double b, double blend) { return -blended(-a, b, blend); }

Mesh surface_of(const Solid& solid, const DBox& inside, double edge) {
    openvdb::initialize();
    const openvdb::FloatGrid::Ptr grid = near_surface(solid, inside, edge);
    std::vector<openvdb::Vec3s> points;
    std::vector<openvdb::Vec4I> quads;
    openvdb::tools::volumeToMesh(*grid, points, quads);

    Mesh mesh;
    mesh.P.resize(points.size());
    mesh.N.resize(points.size());
    tbb::parallel_for(std::size_t{0}, points.size(), [&](std::size_t i) {
        glm::dvec3 p = edge * glm::dvec3(points[i].x(), points[i].y(), points[i].z());
        // The mesher's points are averages: a step along the slope puts them on the surface.
        const double most = 0.25 * edge;
        p -= std::clamp(solid(p), -most, most) * slope(solid, p, 0.2 * edge);
        mesh.P[i] = p;
        mesh.N[i] = slope(solid, p, 0.5 * edge);
    });
    const auto add_triangle = [&](glm::uint a, glm::uint b, glm::uint c) {
        const glm::vec3 &A = mesh.P[a], &B = mesh.P[b], &C = mesh.P[c];
        // Points may meet on their way to the surface; what they close is closed without it.
        if (A != B && B != C && C != A) mesh.triangles.emplace_back(a, b, c);
    };
    for (const openvdb::Vec4I& q : quads) {
        // Cut along the shorter diagonal: bends in a crease stay round.
        const auto length = [&](int a, int b) { return glm::distance(mesh.P[q[a]], mesh.P[q[b]]); };
        if (length(0, 2) < length(1, 3)) {
            add_triangle(q[0], q[2], q[1]);
            add_triangle(q[0], q[3], q[2]);
        } else {
            add_triangle(q[0], q[3], q[1]);
            add_triangle(q[1], q[3], q[2]);
        }
    }
    return mesh;
}

Mesh with_cylindrical_uv(Mesh mesh, const glm::dvec3& axis) {
    const Box box = bounds(mesh);
    mesh.uv.clear();
    for (const glm::vec3& p : mesh.P) {
        const glm::dvec3 q = glm::dvec3(p) - axis;
        mesh.uv.emplace_back(0.5 + std::atan2(q.x, q.z) / (2.0 * std::numbers::pi),
                             (p.y - box.min.y) / (box.max.y - box.min.y));
    }
    std::unordered_map<glm::uint, glm::uint> beyond;  // vertices once more, with u + 1
    for (glm::uvec3& t : mesh.triangles) {
        const float highest = std::max({mesh.uv[t.x].x, mesh.uv[t.y].x, mesh.uv[t.z].x});
        for (int c = 0; c < 3; ++c) {
            if (highest - mesh.uv[t[c]].x < 0.5f) continue;
            const auto [copy, fresh] = beyond.try_emplace(t[c], glm::uint(mesh.P.size()));
            if (fresh) {
                mesh.P.push_back(mesh.P[t[c]]);
                mesh.N.push_back(mesh.N[t[c]]);
                mesh.uv.push_back(mesh.uv[t[c]] + glm::vec2(1.0f, 0.0f));
            }
            t[c] = copy->second;
        }
    }
    return mesh;
}

}  // namespace estara::examples
