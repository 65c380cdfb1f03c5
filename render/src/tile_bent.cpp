// Samples on meshes that bend: the shader sees the rest pose, light the bent surface.
#include <algorithm>
#include <cmath>

#include "tile.h"

namespace estara {

/// Where new hits are on the bent mesh, with its normals. After interpolate().
void TileRenderer::bend(const FrameContext& frame, const Group& group) {
    const PosedInstance& instance = frame.instances[group.instance];
    const BentMesh& bent = *instance.bent;
    for (int j = group.first; j < group.last; ++j) {
        Site& site = m_samples.site[j];
        if (!group.recalled) {
            const int i = m_order[j];
            site = {m_hits.triangle[i], m_hits.b1[i], m_hits.b2[i]};
        }
        const glm::uvec3 t = instance.mesh->triangles[site.triangle];
        const glm::vec3 Ng = bent.Ng[site.triangle];
        const glm::vec3 n = bent.N.empty() ? Ng : site.of(bent.N, t);
        const float square = glm::dot(n, n);
        put(m_samples.P_bent, j, site.of(bent.P, t));
        put(m_samples.Ng_object, j, Ng);
        // As interpolate(): opposite normals cancel.
        put(m_samples.N_bent, j, square > 1e-8f ? n / std::sqrt(square) : Ng);
    }
}

/// From rest to bent at a sample. Of a shader's own normal the mesh's own is what is carried along
/// with the surface; N_bent must be that still.
CarriedFrame TileRenderer::carried_frame(const PosedInstance& instance, int j) const {
    const Site& site = m_samples.site[j];
    const BentMesh& bent = *instance.bent;
    const MeshPoint rest = mesh_point(*instance.mesh, site.triangle, site.b1, site.b2);
    const glm::uvec3 t = instance.mesh->triangles[site.triangle];
    const glm::vec3 n = bent.N.empty() ? bent.Ng[site.triangle] : site.of(bent.N, t);
    const float square = glm::dot(n, n);
    return {*instance.mesh, bent, site.triangle, rest.N,
            square > 1e-8f ? n / std::sqrt(square) : bent.Ng[site.triangle]};
}

/// A shader's own normals, given at rest, as they are on the bent surface.
void TileRenderer::carry_normals(const FrameContext& frame, const Group& group) {
    const PosedInstance& instance = frame.instances[group.instance];
    for (int j = group.first; j < group.last; ++j) {
        put(m_samples.N_bent, j, carried_frame(instance, j).normal(at(m_samples.surface.N, j)));
    }
}

/// The same of a baked direction.
/// @param x  its three planes
void TileRenderer::carry_directions(const FrameContext& frame, const Group& group, float* x) {
    const PosedInstance& instance = frame.instances[group.instance];
    for (int j = group.first; j < group.last; ++j) {
        const glm::vec3 rest(x[j], x[capacity + j], x[2 * capacity + j]);
        const glm::vec3 v = carried_frame(instance, j).direction(rest);
        x[j] = v.x;
        x[capacity + j] = v.y;
        x[2 * capacity + j] = v.z;
    }
}

}  // namespace estara
