// Light on a tile's samples: baked, recalled or traced, and what it makes of them.
#include <algorithm>
#include <cmath>

#include "estara/grids/irradiance.h"
#include "estara/scenes/program.h"
#include "tile.h"

namespace estara {
namespace {

/// A highlight below this, in the units of the picture (1 is white), is taken as it is, in shadow
/// or not: a light's error is at most this, a quarter of an 8-bit picture's darkest step.
constexpr float negligible_gloss = 0x1p-14f;

/// Of a light among a record's bits: the first tells the side of the point itself.
constexpr int place_of_light(int light) noexcept { return light + 1; }

}  // namespace

/// Starts E: what is baked, or nothing yet. Baked is the front of the surface, outside of shadow
/// edges.
void TileRenderer::look_up_irradiance(const FrameContext& frame, const Group& group) {
    SeenBatch& seen = m_samples.seen;
    for (int c = 0; c < 3; ++c) std::fill(seen.E[c] + group.first, seen.E[c] + group.last, 0.0f);
    std::fill(m_samples.baked_E + group.first, m_samples.baked_E + group.last, 0);
    const ObjectShading& shading = shading_of(frame, group);
    if (!shading.irradiance) return;
    const Stopwatch time;
    m_irradiance.resize(4 * capacity);
    find_footprints(frame, group);
    shading.irradiance->lookup(m_samples.surface.P[0] + group.first, m_footprints,
                               m_irradiance.data(), capacity, m_found.data());
    for (int j = group.first; j < group.last; ++j) {
        const auto i = std::size_t(j - group.first);
        const bool baked = m_found[i] && m_samples.front[j] &&
                           m_irradiance[3 * capacity + i] <= irradiance_mask_limit;
        if (!baked) continue;
        m_samples.baked_E[j] = 1;
        for (std::size_t c = 0; c < 3; ++c) seen.E[c][j] = m_irradiance[c * capacity + i];
    }
    statistics.irradiance_lookups += std::uint64_t(group.last - group.first);
    statistics.evaluation_seconds += time.seconds();
}

/// Adds what one light sends to the eye from every sample.
void TileRenderer::light(const FrameContext& frame, int number) {
    const PosedLight& light = frame.lights[std::size_t(number)];
    const Stopwatch time;
    for (Group& group : m_groups) {
        // Of a point whose light is kept only highlights are asked for, where the light is visible.
        const bool kept =
            group.recalled && frame.reuse->cache().layout(int(group.instance)).is_lit();
        group.dark = kept && !(shading_of(frame, group).shader->glossy() && sees(group, number));
        if (!group.dark) reach_samples(frame, group, light);
    }
    statistics.light_seconds += time.seconds();
    view(frame, true, m_reach.gloss);
    if (light.shadow && frame.settings.shadows) {
        want_shadows(frame);
        trace_shadows(frame, light);
    } else {
        std::fill_n(m_reach.visible, m_count, 1);
    }
    const Stopwatch sum;
    if (frame.reuse != nullptr) recall_visibility(number);
    add_light();
    statistics.light_seconds += sum.seconds();
}

/// Whether a light is visible from any of a group's recalled samples.
bool TileRenderer::sees(const Group& group, int light) const {
    const int place = place_of_light(light);
    const std::uint32_t* const words = m_sides.data() + place / 32 * capacity;
    std::uint32_t any = 0;
    for (int j = group.first; j < group.last; ++j) any |= words[j];
    return (any >> place % 32 & 1u) != 0;
}

/// Recalled samples are told whether the light is visible, the others tell.
void TileRenderer::recall_visibility(int light) {
    const int place = place_of_light(light);
    std::uint32_t* const words = m_sides.data() + place / 32 * capacity;
    wide([=, samples = &m_samples, reach = &m_reach, count = m_count, bit = place % 32]()
             ESTARA_LOOP {
#pragma GCC ivdep
                 for (int j = 0; j < count; ++j) {
                     const int recalled = int(words[j] >> bit & 1u);
                     const int visible = samples->kept[j] != 0 ? recalled : reach->visible[j];
                     reach->visible[j] = visible;
                     words[j] |= std::uint32_t(visible) << bit;
                 }
             });
}

void TileRenderer::reach_samples(const FrameContext& frame, const Group& group,
                                 const PosedLight& light) {
    const bool shadow = light.shadow && frame.settings.shadows;
    const PosedInstance& instance = frame.instances[group.instance];
    wide([samples = &m_samples, reach = &m_reach, group, light, shadow, offset = instance.offset,
          placed = &placed_P(instance)]() ESTARA_LOOP {
#pragma GCC ivdep
        for (int j = group.first; j < group.last; ++j) {
            const FallingLight falling =
                falling_light(light, at(samples->P, j), at(samples->seen.N, j));
            put(samples->seen.L, j, falling.L);
            put(samples->seen.Cl, j, falling.Cl);
            reach->cosine[j] = falling.cosine;
        }
        if (!shadow) return;
#pragma GCC ivdep
        for (int j = group.first; j < group.last; ++j) {
            const glm::vec3 L = at(samples->seen.L, j), Ng = at(samples->Ng, j);
            const float side = glm::dot(Ng, L) < 0.0f ? -1.0f : 1.0f;
            put(reach->origin, j, offset.from(at(samples->P, j), side * Ng, at(*placed, j)));
        }
    });
}

/// Which samples a light reaches if nothing is in its way, and for which that is to be found out.
void TileRenderer::want_shadows(const FrameContext& frame) {
    const float least = negligible_gloss / std::exp2(frame.settings.exposure);
    wide([samples = &m_samples, reach = &m_reach, count = m_count, least]() ESTARA_LOOP {
#pragma GCC ivdep
        for (int j = 0; j < count; ++j) {
            const glm::vec3 gloss = at(reach->gloss, j), Cl = at(samples->seen.Cl, j);
            const bool glossy = !((std::fabs(gloss.x) <= least) & (std::fabs(gloss.y) <= least) &
                                  (std::fabs(gloss.z) <= least));
            const bool reached = (Cl.x > 0.0f) | (Cl.y > 0.0f) | (Cl.z > 0.0f);
            const bool open = (samples->kept[j] == 0) & (glossy | (samples->baked_E[j] == 0));
            reach->wanted[j] = reached & open ? 1 : 0;
            reach->visible[j] = reached ? 1 : 0;
        }
    });
}

void TileRenderer::trace_shadows(const FrameContext& frame, const PosedLight& light) {
    m_rays.size = 0;
    for (int j = 0; j < m_count; ++j) {
        if (!m_reach.wanted[j]) continue;
        m_shadow_sample[m_rays.size] = j;
        m_rays.push(shadow_ray(light, at(m_reach.origin, j), at(m_samples.seen.L, j)));
    }
    const Stopwatch time;
    frame.rays.occluded(m_rays, m_blocked.data());
    statistics.shadow_rays += std::uint64_t(m_rays.size);
    const double seconds = time.seconds();
    statistics.ray_seconds += seconds;
    statistics.shadow_seconds += seconds;
    for (int r = 0; r < m_rays.size; ++r) {
        m_reach.visible[m_shadow_sample[r]] = m_blocked[std::size_t(r)] ? 0 : 1;
    }
}

void TileRenderer::add_light() {
    wide([samples = &m_samples, reach = &m_reach, count = m_count]() ESTARA_LOOP {
#pragma GCC ivdep
        for (int j = 0; j < count; ++j) {
            const bool visible = reach->visible[j] != 0;
            const bool diffuse = visible & (samples->baked_E[j] == 0);
            // Chosen, not multiplied by 0: what has not been asked for may hold anything.
            const glm::vec3 none(0.0f), E = at(samples->seen.Cl, j) * reach->cosine[j];
            put(samples->seen.E, j, at(samples->seen.E, j) + select(diffuse, E, none));
            put(samples->Ci, j, at(samples->Ci, j) + select(visible, at(reach->gloss, j), none));
        }
    });
}

/// What E and the ambient light make, and the sum.
void TileRenderer::close(const FrameContext& frame) {
    m_samples.seen.A = frame.scene.ambient;
    view(frame, false, m_reach.gloss);
    wide([samples = &m_samples, reach = &m_reach, count = m_count]() ESTARA_LOOP {
        for (int c = 0; c < 3; ++c) {
#pragma GCC ivdep
            for (int j = 0; j < count; ++j) samples->Ci[c][j] += reach->gloss[c][j];
        }
    });
}

void TileRenderer::view(const FrameContext& frame, bool lit, Planes& Ci) {
    for (const Group& group : m_groups) {
        const BoundShader& shader = *shading_of(frame, group).shader;
        if (lit && (group.dark || !shader.glossy())) {
            for (Plane& plane : Ci) std::fill(plane + group.first, plane + group.last, 0.0f);
            continue;
        }
        const Stopwatch time;
        shader.view(m_planes.data(), m_samples.seen, group.first, group.last, lit, Ci[0]);
        const double seconds = time.seconds();
        statistics.view_seconds += seconds;
        cost_of(frame, group).view += seconds;
    }
}

}  // namespace estara
