// What a tile does with the points that the cache holds for it, and what it gives to the cache.
#include <algorithm>
#include <bit>
#include <cmath>

#include "estara/scenes/program.h"
#include "tile.h"

namespace estara {

/// Finds out which samples of a pass are recalled; the others need a ray.
void TileRenderer::recall(const FrameContext& frame, int sample) {
    const Stopwatch time;
    list_candidates(frame, sample);
    aim_at_candidates(frame);
    double listing = time.seconds();
    const Stopwatch rays;
    frame.rays.occluded(m_rays, m_blocked.data());
    statistics.ray_seconds += rays.seconds();
    statistics.reuse.rays += std::uint64_t(m_candidate_count);
    const Stopwatch taking;
    take_visible(frame);
    listing += taking.seconds();
    statistics.evaluation_seconds += listing;
    statistics.reuse.listing_seconds += listing;
}

void TileRenderer::list_candidates(const FrameContext& frame, int sample) {
    struct Listed {
        Reprojection::Candidate candidate[capacity];
        std::uint32_t instance[capacity];
        int pixel[capacity], order[capacity];
    };
    thread_local Listed listed;
    const ReuseCache& cache = frame.reuse->cache();
    int count = 0;
    for (std::size_t i = 0; i < m_pixels.size(); ++i) {
        const Reprojection::Candidate found =
            frame.reuse->candidate(m_pixels[i].x, m_pixels[i].y, sample);
        m_needs_ray[i] = found.exists ? 0 : 1;
        if (!found.exists) continue;
        __builtin_prefetch(&cache.page(found.id.page()));
        listed.candidate[count] = found;
        listed.pixel[count++] = int(i);
    }
    for (int c = 0; c < count; ++c) {
        const RayId id = listed.candidate[c].id;
        const ReuseCache::Page& page = cache.page(id.page());
        __builtin_prefetch(page.record(id.index()));
        listed.instance[c] = std::uint32_t(page.instance);
    }
    statistics.reuse.misses += m_pixels.size() - std::size_t(count);
    m_candidate_groups.clear();
    m_candidate_count =
        sort_by_instance(frame, listed.instance, count, m_candidate_groups, listed.order);
    for (const Group& group : m_candidate_groups) {
        const RecordLayout layout = cache.layout(int(group.instance));
        for (int c = group.first; c < group.last; ++c) {
            const int from = listed.order[c];
            const RayId id = listed.candidate[from].id;
            const float* const record = cache.page(id.page()).record(id.index());
            m_candidates.pixel[c] = listed.pixel[from];
            m_candidates.id[c] = id;
            m_candidates.record[c] = record;
            m_candidates.was_hidden[c] = listed.candidate[from].was_hidden ? 1 : 0;
            m_candidates.was_front[c] =
                layout.is_lit() ? int(std::bit_cast<std::uint32_t>(record[layout.sides()]) & 1u)
                                : -1;
            put(m_candidates.P_object, c, {record[0], record[1], record[2]});
            constexpr int Ng = RecordLayout::Ng;
            put(m_candidates.Ng_object, c, {record[Ng], record[Ng + 1], record[Ng + 2]});
        }
    }
}

/// A ray from every candidate to the eye. It starts off the surface by the bound of SurfaceOffset,
/// on the side of the eye, so the surface itself is not met and what is near is not skipped.
void TileRenderer::aim_at_candidates(const FrameContext& frame) {
    m_rays.size = m_candidate_count;
    for (const Group& group : m_candidate_groups) {
        const PosedInstance& instance = frame.instances[group.instance];
        wide([=, candidates = &m_candidates, rays = &m_rays, eye = frame.camera.eye(),
              m = instance.world_from_object, n = instance.world_from_normal,
              offset = instance.offset]() ESTARA_LOOP {
            const glm::vec3 x(m[0]), y(m[1]), z(m[2]), shift(m[3]);
#pragma GCC ivdep
            for (int c = group.first; c < group.last; ++c) {
                const glm::vec3 P_object = at(candidates->P_object, c);
                const glm::vec3 P = x * P_object.x + y * P_object.y + z * P_object.z + shift;
                const glm::vec3 Ng = n * at(candidates->Ng_object, c);
                const float square = glm::dot(Ng, Ng);
                const bool usual = (square > least_square) & (square < largest_square);
                const bool front = !(glm::dot(Ng, eye - P) < 0.0f);
                const bool same =
                    (candidates->was_front[c] < 0) | (candidates->was_front[c] == (front ? 1 : 0));
                candidates->usable[c] = usual & same ? 1 : 0;
                const float scale = (front ? 1.0f : -1.0f) / std::sqrt(usual ? square : 1.0f);
                const glm::vec3 origin = offset.from(P, Ng * scale, P_object);
                put(rays->origin, c, origin);
                put(rays->direction, c, eye - origin);
                rays->tmin[c] = 0.0f;
                rays->tmax[c] = 1.0f;
            }
        });
    }
}

/// Keeps the candidates that nothing hides, in their order.
void TileRenderer::take_visible(const FrameContext& frame) {
    ReuseCache& cache = frame.reuse->cache();
    int taken = 0;
    for (Group& group : m_candidate_groups) {
        const int first = taken;
        for (int c = group.first; c < group.last; ++c) {
            const int pixel = m_candidates.pixel[c];
            const bool usable = m_candidates.usable[c] != 0, blocked = m_blocked[std::size_t(c)];
            // From the wrong side it is of as little use: both yield to others next time.
            const bool hidden = blocked || !usable;
            if (hidden != (m_candidates.was_hidden[c] != 0)) {
                cache.set_hidden(m_candidates.id[c], hidden);
            }
            if (usable && !blocked) {
                m_candidate_order[taken++] = c;
                continue;
            }
            m_needs_ray[pixel] = 1;
            m_sums.occluded[pixel] += usable ? 1 : 0;
            ++(usable ? statistics.reuse.occluded : statistics.reuse.turned);
        }
        group.first = first;
        group.last = taken;
    }
    statistics.reuse.hits += std::uint64_t(taken);
    statistics.reuse.refilled += std::uint64_t(m_pixels.size()) - std::uint64_t(taken);
}

/// Behind those of new hits.
void TileRenderer::add_recalled_groups() {
    for (const Group& group : m_candidate_groups) {
        if (group.first == group.last) continue;
        const int first = m_count;
        for (int i = group.first; i < group.last; ++i) m_order[m_count++] = m_candidate_order[i];
        m_groups.push_back({group.instance, first, m_count, true});
    }
}

void TileRenderer::shade_recalled(const FrameContext& frame, const Group& group) {
    const Stopwatch time;
    const ReuseCache& cache = frame.reuse->cache();
    const RecordLayout layout = cache.layout(int(group.instance));
    reserve_planes(shading_of(frame, group).shader->info());
    for (int j = group.first; j < group.last; ++j) {
        const int c = m_order[j];
        const float* const record = m_candidates.record[c];
        m_samples.pixel[j] = m_candidates.pixel[c];
        m_samples.age[j] = cache.frame() - m_candidates.id[c].born();
        m_row[j] = -1;
        put(m_samples.surface.P, j, at(m_candidates.P_object, c));
        put(m_samples.Ng_object, j, at(m_candidates.Ng_object, c));
        constexpr int N = RecordLayout::N;
        put(m_samples.surface.N, j, {record[N], record[N + 1], record[N + 2]});
        const float* const baked = record + RecordLayout::first_baked;
        for (int k = 0; k < layout.baked; ++k) m_planes[std::size_t(k * capacity + j)] = baked[k];
        if (!layout.is_lit()) continue;
        for (int k = 0; k < 3; ++k) m_samples.seen.E[k][j] = record[layout.E() + k];
        for (int w = 0; w < layout.words(); ++w) {
            m_sides[std::size_t(w * capacity + j)] =
                std::bit_cast<std::uint32_t>(record[layout.sides() + w]);
        }
    }
    const int lit = layout.is_lit() ? 1 : 0;
    std::fill(m_samples.baked_E + group.first, m_samples.baked_E + group.last, lit);
    std::fill(m_samples.kept + group.first, m_samples.kept + group.last, lit);
    if (lit == 0) {
        for (int k = 0; k < 3; ++k) {
            std::fill(m_samples.seen.E[k] + group.first, m_samples.seen.E[k] + group.last, 0.0f);
        }
    }
    place_in_world(frame, group);
    turn_normals(frame.instances[group.instance], group);
    turn_directions(frame, group);
    if (lit == 0) statistics.lit += std::uint64_t(group.last - group.first);
    const double seconds = time.seconds();
    statistics.evaluation_seconds += seconds;
    ObjectCost& cost = cost_of(frame, group);
    cost.recall += seconds;
    cost.recalled += std::uint64_t(group.last - group.first);
}

/// The records of new hits, but for their light.
void TileRenderer::keep(const FrameContext& frame, const Group& group, NewRecords& found) {
    const Stopwatch time;
    const RecordLayout layout = frame.reuse->cache().layout(int(group.instance));
    const auto stride = std::size_t(layout.floats());
    const std::size_t first = found.floats.size();
    found.floats.resize(first + std::size_t(group.last - group.first) * stride);
    for (int j = group.first; j < group.last; ++j) {
        const std::size_t row = first + std::size_t(j - group.first) * stride;
        found.instances.push_back(int(group.instance));
        m_sides[std::size_t(j)] |= m_samples.front[j] != 0 ? 1u : 0u;
        m_row[j] = std::ptrdiff_t(row);
        float* const to = found.floats.data() + row;
        for (int c = 0; c < 3; ++c) {
            to[RecordLayout::P + c] = m_samples.surface.P[c][j];
            to[RecordLayout::N + c] = m_samples.surface.N[c][j];
            to[RecordLayout::Ng + c] = m_samples.Ng_object[c][j];
        }
        for (int k = 0; k < layout.baked; ++k) {
            to[RecordLayout::first_baked + k] = m_planes[std::size_t(k * capacity + j)];
        }
    }
    const double seconds = time.seconds();
    statistics.reuse.keeping_seconds += seconds;
    ObjectCost& cost = cost_of(frame, group);
    cost.keep += seconds;
    cost.kept += std::uint64_t(group.last - group.first);
}

/// After all lights: E and visibility of the records that keep() has begun.
void TileRenderer::keep_light(const FrameContext& frame, NewRecords& found) {
    for (const Group& group : m_groups) {
        const RecordLayout layout = frame.reuse->cache().layout(int(group.instance));
        if (group.recalled || !layout.is_lit()) continue;
        for (int j = group.first; j < group.last; ++j) {
            if (m_row[j] < 0) continue;
            float* const to = found.floats.data() + m_row[j];
            for (int c = 0; c < 3; ++c) to[layout.E() + c] = m_samples.seen.E[c][j];
            for (int w = 0; w < layout.words(); ++w) {
                to[layout.sides() + w] =
                    std::bit_cast<float>(m_sides[std::size_t(w * capacity + j)]);
            }
        }
    }
}

}  // namespace estara
