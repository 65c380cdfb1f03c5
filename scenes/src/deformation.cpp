#include "estara/scenes/deformation.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>

#include "estara/scenes/matrix.h"

namespace estara {
namespace {

constexpr std::size_t grain = 1024;  // vertices or triangles that a thread takes at once

bool is_finite(const glm::dvec3& v) noexcept {
    return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}

/// v / |v|, or `otherwise` for a vector without direction.
glm::dvec3 unit_or(const glm::dvec3& v, const glm::dvec3& otherwise) noexcept {
    const double length = glm::length(v);
    return length > 0.0 && std::isfinite(length) ? v / length : otherwise;
}

/// Calls f(i) for all of [0, count), in parallel.
template <class F>
void for_all(std::size_t count, const F& f) {
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, count, grain), [&](const auto& range) {
        for (std::size_t i = range.begin(); i < range.end(); ++i) f(i);
    });
}

class Bending {
public:
    Bending(const Mesh& mesh, const Deformation& how, std::span<const float> weights,
            const glm::dmat4& world_from_rest, std::span<const glm::dmat4> world_from_joints)
        : m_mesh(mesh),
          m_how(how),
          m_weights(weights.first(std::min(weights.size(), how.targets.size()))),
          m_world_from_rest(world_from_rest),
          m_joints(world_from_joints) {}

    Bent run() {
        m_world.resize(m_mesh.P.size());
        m_mirrored.resize(m_mesh.P.size());
        auto bent = std::make_shared<BentMesh>();
        bent->N.resize(m_mesh.N.size());
        for_all(m_mesh.P.size(), [&](std::size_t i) { place(i, *bent); });
        Bent result;
        glm::dvec3 low(m_world.empty() ? glm::dvec3(0.0) : m_world.front()), high(low);
        for (const glm::dvec3& P : m_world) {
            if (!is_finite(P)) return result;
            low = glm::min(low, P);
            high = glm::max(high, P);
        }
        result.anchor = 0.5 * low + 0.5 * high;
        bent->P.resize(m_world.size());
        for_all(m_world.size(),
                [&](std::size_t i) { bent->P[i] = glm::vec3(m_world[i] - result.anchor); });
        if (!is_finite(glm::dvec3(glm::vec3(high - low)))) return result;
        bent->Ng.resize(m_mesh.triangles.size());
        bent->stretch.resize(m_mesh.triangles.size());
        for_all(m_mesh.triangles.size(), [&](std::size_t t) { measure(t, *bent); });
        result.mesh = std::move(bent);
        return result;
    }

private:
    glm::dmat4 matrix_of(std::size_t vertex) const {
        if (m_joints.empty()) return m_world_from_rest;
        const auto count = std::size_t(m_how.influences.count);
        glm::dmat4 sum(0.0);
        for (std::size_t k = vertex * count; k < (vertex + 1) * count; ++k) {
            sum += double(m_how.influences.weight[k]) * m_joints[m_how.influences.joint[k]];
        }
        return sum;
    }

    void place(std::size_t i, BentMesh& bent) {
        glm::dvec3 P(m_mesh.P[i]);
        for (std::size_t t = 0; t < m_weights.size(); ++t) {
            P += double(m_weights[t]) * glm::dvec3(m_how.targets[t].P[i]);
        }
        const glm::dmat4 m = matrix_of(i);
        const glm::dmat3 linear(m);
        m_world[i] = linear * P + glm::dvec3(m[3]);
        m_mirrored[i] = glm::determinant(linear) < 0.0 ? 1 : 0;
        if (m_mesh.N.empty()) return;
        const glm::dvec3 rest(m_mesh.N[i]);
        glm::dvec3 N = rest;
        for (std::size_t t = 0; t < m_weights.size(); ++t) {
            if (m_how.targets[t].N.empty()) continue;
            N += double(m_weights[t]) * glm::dvec3(m_how.targets[t].N[i]);
        }
        const glm::dmat3 turn = normal_matrix(linear);
        bent.N[i] = glm::vec3(
            unit_or(turn * unit_or(N, rest), unit_or(turn * rest, glm::dvec3(0.0, 0.0, 1.0))));
    }

    static glm::dvec3 cross_of(const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c) {
        return glm::cross(b - a, c - a);
    }

    void measure(std::size_t number, BentMesh& bent) const {
        const glm::uvec3 t = m_mesh.triangles[number];
        const glm::dvec3 rest = cross_of(m_mesh.P[t.x], m_mesh.P[t.y], m_mesh.P[t.z]);
        glm::dvec3 now = cross_of(m_world[t.x], m_world[t.y], m_world[t.z]);
        // What is mirrored has its corners the other way round. Where all of it is flat only the
        // normals tell the side.
        if (!m_mesh.N.empty()) {
            const glm::dvec3 N_rest =
                glm::dvec3(m_mesh.N[t.x]) + glm::dvec3(m_mesh.N[t.y]) + glm::dvec3(m_mesh.N[t.z]);
            const glm::dvec3 N_now =
                glm::dvec3(bent.N[t.x]) + glm::dvec3(bent.N[t.y]) + glm::dvec3(bent.N[t.z]);
            if (glm::dot(rest, N_rest) * glm::dot(now, N_now) < 0.0) now = -now;
        } else if (m_mirrored[t.x] != 0) {
            now = -now;
        }
        const double area = glm::length(now), area_rest = glm::length(rest);
        bent.Ng[number] = glm::vec3(unit_or(now, glm::dvec3(0.0, 0.0, 1.0)));
        const double ratio = area_rest > 0.0 ? std::sqrt(area / area_rest) : 1.0;
        bent.stretch[number] = std::clamp(float(ratio), 1e-6f, 1e6f);
    }

    const Mesh& m_mesh;
    const Deformation& m_how;
    std::span<const float> m_weights;
    glm::dmat4 m_world_from_rest;
    std::span<const glm::dmat4> m_joints;
    std::vector<glm::dvec3> m_world;
    std::vector<std::uint8_t> m_mirrored;  ///< by vertex; bytes, for threads write them
};

/// Edges from a triangle's first corner, made perpendicular to N, and N.
glm::dmat3 frame_of(const std::vector<glm::vec3>& P, const glm::uvec3& t, const glm::vec3& N) {
    const glm::dvec3 n(N), p(P[t.x]);
    const auto in_plane = [&](const glm::dvec3& edge) { return edge - glm::dot(edge, n) * n; };
    return {in_plane(glm::dvec3(P[t.y]) - p), in_plane(glm::dvec3(P[t.z]) - p), n};
}

}  // namespace

Bent bend(const Mesh& mesh, const Deformation& how, std::span<const float> weights,
          const glm::dmat4& world_from_rest, std::span<const glm::dmat4> world_from_joints) {
    return Bending(mesh, how, weights, world_from_rest, world_from_joints).run();
}

CarriedFrame::CarriedFrame(const Mesh& mesh, const BentMesh& bent, std::uint32_t triangle,
                           const glm::vec3& N_rest, const glm::vec3& N_bent) noexcept
    : m_rest(frame_of(mesh.P, mesh.triangles[triangle], N_rest)),
      m_bent(frame_of(bent.P, mesh.triangles[triangle], N_bent)),
      m_N_bent(N_bent) {}

glm::vec3 CarriedFrame::direction(const glm::vec3& rest) const noexcept {
    const double volume = glm::determinant(m_rest);
    if (volume == 0.0) return rest;
    const glm::dvec3 carried = m_bent * (glm::inverse(m_rest) * glm::dvec3(rest));
    return is_finite(carried) ? glm::vec3(carried) : rest;
}

glm::vec3 CarriedFrame::normal(const glm::vec3& rest) const noexcept {
    // The cofactors are det times the inverse transpose, and exist where the triangle has
    // collapsed.
    const glm::dmat3 cofactors(glm::cross(m_bent[1], m_bent[2]), glm::cross(m_bent[2], m_bent[0]),
                               glm::cross(m_bent[0], m_bent[1]));
    const double sign = glm::dot(m_bent[0], cofactors[0]) < 0.0 ? -1.0 : 1.0;
    return glm::vec3(unit_or(sign * (cofactors * (glm::transpose(m_rest) * glm::dvec3(rest))),
                             glm::dvec3(m_N_bent)));
}

}  // namespace estara
