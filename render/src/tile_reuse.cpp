// What a tile does with the points that the cache holds for it, and what it gives to the cache.
#include <algorithm>
#include <bit>
#include <cmath>

#include "estara/scenes/program.h"
#include "tile.h"

namespace estara {
namespace {

/// A record takes two or three lines of the processor's caches: the first two.
void prefetch_record(const float* record) noexcept {
    __builtin_prefetch(record);
    __builtin_prefetch(record + 16);
}

}  // namespace

/// Lists the points that the cache has for a tile's samples, and finds the outlines between them.
void TileRenderer::list_points(const FrameContext& frame, int tile, const glm::ivec2& corner) {
    const Stopwatch time;
    const Reprojection& reuse = *frame.reuse;
    const ReuseCache& cache = reuse.cache();
    const SampleStrata& strata = reuse.strata();
    const glm::ivec2 size =
        glm::min(glm::ivec2(TileGrid::width, TileGrid::height),
                 glm::ivec2(frame.settings.width, frame.settings.height) - corner);
    m_listed.resize(std::size_t(TileGrid::pixels * strata.count()));
    // A row has a cell for each rectangle of its pixels.
    const int across = size.x * strata.columns(), down = size.y * strata.rows();
    thread_local std::vector<Listed*> row, before;
    thread_local std::vector<std::uint8_t> outline;
    row.resize(std::size_t(across));
    outline.resize(std::size_t(across));
    const auto note = [&](const std::vector<Listed*>& of) {
        for (std::size_t x = 0; x < of.size(); ++x) of[x]->at_outline = outline[x] != 0;
    };
    m_outlines.start(across);
    for (int y = 0; y < down; ++y) {
        // Records lie all over memory: those of a row are asked for before any is used.
        const int pixel_y = y / strata.rows();
        const int first_stratum = y % strata.rows() * strata.columns();
        std::size_t cell = 0;
        for (int pixel_x = 0; pixel_x < size.x; ++pixel_x) {
            const int number = TileGrid::number(pixel_x, pixel_y);
            for (int column = 0; column < strata.columns(); ++column) {
                const int rectangle = first_stratum + column, sample = strata.sample(rectangle);
                Listed& one = m_listed[std::size_t(number * strata.count() + sample)];
                row[cell++] = &one;
                one = {};
                const Reprojection::Candidate found = reuse.candidate(tile, number, rectangle);
                if (!found.exists) continue;
                const ReuseCache::Page& page = cache.page(found.id.page());
                one.id = found.id;
                one.record = page.record(found.id.index());
                one.instance = page.instance;
                one.was_hidden = found.was_hidden;
                prefetch_record(one.record);
                if (!found.has_second) continue;
                const ReuseCache::Page& other = cache.page(found.second.page());
                if (other.instance != one.instance) continue;
                one.second = other.record(found.second.index());
            }
        }
        for (int x = 0; x < across; ++x) {
            const Listed& one = *row[std::size_t(x)];
            if (one.record == nullptr) continue;
            constexpr int P = RecordLayout::P, Ng = RecordLayout::Ng;
            const float* const r = one.record;
            m_outlines.set(x, one.instance, {r[P], r[P + 1], r[P + 2]},
                           {r[Ng], r[Ng + 1], r[Ng + 2]});
        }
        m_outlines.next(outline.data());
        if (y > 0) note(before);
        std::swap(row, before);
        row.resize(std::size_t(across));
    }
    m_outlines.finish(outline.data());
    note(before);
    const double seconds = time.seconds();
    statistics.evaluation_seconds += seconds;
    statistics.reuse.listing_seconds += seconds;
}

/// Traces the rays of all samples of a tile that have no point, or one at an outline.
///
/// At an outline the sample's own ray tells which surface it sees: how much of a pixel each surface
/// takes is for the pattern to say, or points of the one that has more of them, or older ones,
/// would win too often. All of a tile's rays together, pixel by pixel: they stay close to each
/// other.
void TileRenderer::trace_own_rays(const FrameContext& frame) {
    const Stopwatch time;
    ReuseCache& cache = frame.reuse->cache();
    Listed* waiting[capacity];
    m_own_hits.clear();
    int count = 0;
    const auto trace_some = [&] {
        frame.camera.primary_rays(m_x, m_y, count, m_rays);
        frame.rays.intersect(m_rays, m_hits);
        statistics.primary_rays += std::uint64_t(count);
        for (int r = 0; r < count; ++r) {
            if (m_hits.instance[r] == Hit::none || waiting[r]->record == nullptr) continue;
            const int object = frame.instances[m_hits.instance[r]].object;
            __builtin_prefetch(&frame.face_normals[std::size_t(object)][m_hits.triangle[r]]);
            prefetch_record(waiting[r]->record);
        }
        for (int r = 0; r < count; ++r) {
            Listed& point = *waiting[r];
            const Hit hit{m_hits.instance[r], m_hits.triangle[r], m_hits.b1[r], m_hits.b2[r],
                          m_hits.t[r]};
            point.own = int(m_own_hits.size());
            m_own_hits.push_back(hit);
            if (point.record == nullptr) {
                ++statistics.reuse.misses;
                continue;
            }
            const glm::vec3 P = at(m_rays.origin, r) + hit.t * at(m_rays.direction, r);
            point.seen = lies_on(frame, point, hit, P);
            if (point.seen) continue;
            ++statistics.reuse.beside;
            if (!point.was_hidden) cache.set_hidden(point.id, true);
        }
        count = 0;
    };
    for (int i = 0; i < int(m_pixels.size()); ++i) {
        for (int sample = 0; sample < int(frame.pattern.size()); ++sample) {
            Listed& point = listed(frame, i, sample);
            if (point.record != nullptr && !point.at_outline) continue;
            place_ray(frame, count, i, sample);
            waiting[count++] = &point;
            if (count == capacity) trace_some();
        }
    }
    if (count > 0) trace_some();
    statistics.ray_seconds += time.seconds();
}

/// A point of the cache on its mesh as that is in this frame.
TileRenderer::PlacedPoint TileRenderer::placed_point(const FrameContext& frame,
                                                     std::uint32_t instance,
                                                     const float* record) const {
    const PosedInstance& posed = frame.instances[instance];
    if (posed.bent) {
        const Site site = Site::from(record, frame.reuse->cache().layout(int(instance)));
        return {site.of(posed.bent->P, posed.mesh->triangles[site.triangle]),
                posed.bent->Ng[site.triangle]};
    }
    constexpr int Ng = RecordLayout::Ng;
    return {{record[0], record[1], record[2]}, {record[Ng], record[Ng + 1], record[Ng + 2]}};
}

/// Whether a point of the cache lies on the surface that a ray has met beside it.
/// @param P  of the hit, world space
bool TileRenderer::lies_on(const FrameContext& frame, const Listed& point, const Hit& hit,
                           const glm::vec3& P) const {
    constexpr float least = 0.8f;  // cosine between normals
    constexpr float most = 0.25f;  // from the point's plane, in widths of a pixel
    if (hit.instance != std::uint32_t(point.instance)) return false;
    const PosedInstance& instance = frame.instances[hit.instance];
    const float* const r = point.record;
    const auto [P_object, n] = placed_point(frame, hit.instance, r);
    const glm::vec3& Ng = instance.bent
                              ? instance.bent->Ng[hit.triangle]
                              : frame.face_normals[std::size_t(instance.object)][hit.triangle];
    const glm::vec3 way = P - glm::vec3(instance.world_from_object * glm::vec4(P_object, 1.0f));
    const glm::vec3 n_world = instance.world_from_normal * n;
    const float width = most * frame.camera.pixel_angle() * hit.t;
    const float off = glm::dot(n_world, way);
    return glm::dot(n, Ng) > least && off * off < width * width * glm::dot(n_world, n_world);
}

/// Tests a share of each pixel's points for occlusion, and marks the pixels where the others are to
/// be tested too: those with a hidden point, and those beside them.
///
/// What hides a point was mostly seen in earlier frames and has points of its own there: then its
/// outline has been found. What comes into view without having been seen is found by these tests,
/// unless it is smaller than a pixel: of m tests none may meet what covers the share c of one pixel
/// and nothing beside it, with a probability of (1 - c)^m at most. So c (1 - c)^m of a pixel may be
/// expected to be missing, .082 at most for 4 tests (c = 1/5). In the next frame other samples are
/// tested: after `period` frames all of them have been.
void TileRenderer::test_some(const FrameContext& frame) {
    const int samples = int(frame.pattern.size());
    const int period = frame.settings.test_all_points ? 1 : std::clamp(samples / 4, 1, 4);
    std::fill_n(m_doubtful, capacity, true);
    if (period == 1) return;
    bool hides[capacity] = {};  // by pixel: something hides one of its points
    m_batch.size = 0;
    const auto test = [&] {
        list_candidates(frame);
        aim_at_candidates(frame);
        test_candidates(frame);
        for (int c = 0; c < m_candidate_count; ++c) {
            const int pixel = m_batch.pixel[m_candidates.lane[c]];
            Listed& one = listed(frame, pixel, m_batch.sample[m_candidates.lane[c]]);
            one.seen = m_candidates.blocked[c] == 0;
            one.blocked = !one.seen;
            hides[pixel] |= one.blocked || m_candidates.usable[c] == 0;
        }
        m_batch.size = 0;
    };
    const Stopwatch time;
    const double rays_before = statistics.ray_seconds;
    for (int i = 0; i < int(m_pixels.size()); ++i) {
        const glm::ivec2 pixel = m_pixels[std::size_t(i)];
        const int phase = (frame.reuse->cache().frame() + pixel.x + 2 * pixel.y) % period;
        for (int sample = 0; sample < samples; ++sample) {
            // Spread over the pixel: the pattern goes along one axis in the samples' order, along
            // the other in that of their bits from the last on.
            if ((sample + 3 * (sample / period) + phase) % period != 0) continue;
            const Listed& one = listed(frame, i, sample);
            if (one.record == nullptr || one.at_outline) continue;
            m_batch.push(i, sample);
            if (m_batch.size == capacity) test();
        }
    }
    if (m_batch.size > 0) test();
    spread_doubt(hides);
    const double seconds = time.seconds() - (statistics.ray_seconds - rays_before);
    statistics.evaluation_seconds += seconds;
    statistics.reuse.listing_seconds += seconds;
}

/// @param hides  by pixel: it is doubtful, and so are those beside it
void TileRenderer::spread_doubt(const bool* hides) {
    constexpr int width = TileGrid::width, height = TileGrid::height;
    bool raster[height + 2][width + 2] = {};
    for (std::size_t i = 0; i < m_pixels.size(); ++i) {
        const glm::ivec2 at = TileGrid::place(m_numbers[i]);
        raster[at.y + 1][at.x + 1] = hides[i];
    }
    for (std::size_t i = 0; i < m_pixels.size(); ++i) {
        const glm::ivec2 at = TileGrid::place(m_numbers[i]);
        m_doubtful[i] = false;
        for (int y = 0; y < 3; ++y) {
            for (int x = 0; x < 3; ++x) m_doubtful[i] |= raster[at.y + y][at.x + x];
        }
    }
}

/// Finds out which samples of a batch are recalled; the others need a ray.
void TileRenderer::recall(const FrameContext& frame) {
    const Stopwatch time;
    std::fill_n(m_needs_ray, m_batch.size, 1);
    list_candidates(frame);
    aim_at_candidates(frame);
    const double listing = time.seconds();
    test_candidates(frame);
    const Stopwatch taking;
    take_visible(frame);
    const double seconds = listing + taking.seconds();
    statistics.evaluation_seconds += seconds;
    statistics.reuse.listing_seconds += seconds;
}

/// Of a batch's samples those with a point that may be seen.
void TileRenderer::list_candidates(const FrameContext& frame) {
    thread_local std::uint32_t instance[capacity];
    thread_local int lanes[capacity], order[capacity];
    const ReuseCache& cache = frame.reuse->cache();
    int count = 0;
    for (int lane = 0; lane < m_batch.size; ++lane) {
        const Listed& one = listed(frame, m_batch.pixel[lane], m_batch.sample[lane]);
        if (one.record == nullptr || (one.at_outline && !one.seen)) continue;
        prefetch_record(one.record);
        if (one.second != nullptr && !one.at_outline) prefetch_record(one.second);
        instance[count] = std::uint32_t(one.instance);
        lanes[count++] = lane;
    }
    m_candidate_groups.clear();
    m_candidate_count = sort_by_instance(frame, instance, count, m_candidate_groups, order);
    for (const Group& group : m_candidate_groups) {
        const RecordLayout layout = cache.layout(int(group.instance));
        for (int c = group.first; c < group.last; ++c) {
            const int lane = lanes[order[c]];
            const int pixel = m_batch.pixel[lane];
            const Listed& one = listed(frame, pixel, m_batch.sample[lane]);
            const float* const record = one.record;
            m_candidates.lane[c] = lane;
            m_candidates.id[c] = one.id;
            m_candidates.record[c] = record;
            m_candidates.second[c] = one.at_outline ? nullptr : one.second;
            m_candidates.was_hidden[c] = one.was_hidden ? 1 : 0;
            m_candidates.was_front[c] =
                layout.is_lit() ? int(std::bit_cast<std::uint32_t>(record[layout.sides()]) & 1u)
                                : -1;
            const bool told = one.seen || one.blocked;
            const bool trusted = !told && !m_doubtful[pixel] && !one.was_hidden;
            m_candidates.known[c] = told || trusted ? 1 : 0;
            statistics.reuse.untested += trusted ? 1 : 0;
            m_candidates.blocked[c] = one.blocked ? 1 : 0;
            const PlacedPoint placed = placed_point(frame, group.instance, record);
            put(m_candidates.P_object, c, placed.P);
            put(m_candidates.Ng_object, c, placed.Ng);
        }
    }
}

/// A ray to the eye from every candidate of which it is not known whether it is hidden. It starts
/// off the surface by the bound of SurfaceOffset, on the side of the eye, so the surface itself is
/// not met and what is near is not skipped.
void TileRenderer::aim_at_candidates(const FrameContext& frame) {
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
    m_rays.size = 0;
    for (int c = 0; c < m_candidate_count; ++c) {
        if (m_candidates.known[c] != 0) continue;
        const int r = m_rays.size++;
        m_candidate_of_ray[r] = c;
        if (r == c) continue;
        put(m_rays.origin, r, at(m_rays.origin, c));
        put(m_rays.direction, r, at(m_rays.direction, c));
    }
}

void TileRenderer::test_candidates(const FrameContext& frame) {
    const Stopwatch rays;
    frame.rays.occluded(m_rays, m_blocked.data());
    statistics.ray_seconds += rays.seconds();
    statistics.reuse.rays += std::uint64_t(m_rays.size);
    for (int r = 0; r < m_rays.size; ++r) {
        m_candidates.blocked[m_candidate_of_ray[r]] = m_blocked[std::size_t(r)];
    }
}

/// Keeps the candidates that nothing hides, in their order.
void TileRenderer::take_visible(const FrameContext& frame) {
    ReuseCache& cache = frame.reuse->cache();
    int taken = 0;
    for (Group& group : m_candidate_groups) {
        const int first = taken;
        for (int c = group.first; c < group.last; ++c) {
            const int lane = m_candidates.lane[c];
            const bool usable = m_candidates.usable[c] != 0, blocked = m_candidates.blocked[c] != 0;
            // From the wrong side it is of as little use: both yield to others next time.
            const bool hidden = blocked || !usable;
            if (hidden != (m_candidates.was_hidden[c] != 0)) {
                cache.set_hidden(m_candidates.id[c], hidden);
            }
            if (usable && !blocked) {
                m_needs_ray[lane] = 0;
                m_candidate_order[taken++] = c;
                continue;
            }
            m_sums.occluded[m_batch.pixel[lane]] += usable ? 1 : 0;
            ++(usable ? statistics.reuse.occluded : statistics.reuse.turned);
        }
        group.first = first;
        group.last = taken;
    }
    statistics.reuse.hits += std::uint64_t(taken);
    statistics.reuse.refilled += std::uint64_t(m_batch.size - taken);
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
        m_samples.pixel[j] = m_batch.pixel[m_candidates.lane[c]];
        m_samples.number[j] = m_batch.sample[m_candidates.lane[c]];
        m_samples.age[j] = cache.frame() - m_candidates.id[c].born();
        m_row[j] = -1;
        put(m_samples.surface.P, j, at(m_candidates.P_object, c));
        put(m_samples.middle, j, at(m_candidates.P_object, c));
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
    if (frame.instances[group.instance].bent) {
        for (int j = group.first; j < group.last; ++j) {
            m_samples.site[j] = Site::from(m_candidates.record[m_order[j]], layout);
        }
        bend(frame, group);
        if (normal_plane(shading_of(frame, group).shader->info()) >= 0) carry_normals(frame, group);
    } else {
        average_seconds(frame, group, layout);
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
    place_in_pixels(frame, group);
    turn_normals(frame.instances[group.instance], group);
    turn_directions(frame, group);
    if (lit == 0) statistics.lit += std::uint64_t(group.last - group.first);
    const double seconds = time.seconds();
    statistics.evaluation_seconds += seconds;
    ObjectCost& cost = cost_of(frame, group);
    cost.recall += seconds;
    cost.recalled += std::uint64_t(group.last - group.first);
}

/// Where a rectangle has a second point, the sample is what both are on average: a pixel's noise
/// falls, and so does what changes when one of them goes. Only values are averaged. P stays that of
/// the first, from where light, eye and its own normal are looked at: the mean of two points lies
/// below a surface that is curved, and a shadow ray from there meets the surface itself.
void TileRenderer::average_seconds(const FrameContext& frame, const Group& group,
                                   const RecordLayout& layout) {
    const auto mean = [](float& a, float b) { a = 0.5f * (a + b); };
    for (int j = group.first; j < group.last; ++j) {
        const float* const second = m_candidates.second[m_order[j]];
        if (second == nullptr) continue;
        constexpr int P = RecordLayout::P, N = RecordLayout::Ng;
        // It may lie behind the first, and nobody has looked whether it is hidden.
        bool alike = is_one_surface(at(m_samples.surface.P, j), at(m_samples.Ng_object, j),
                                    {second[P], second[P + 1], second[P + 2]},
                                    {second[N], second[N + 1], second[N + 2]});
        if (layout.is_lit()) {  // from the same side
            const auto sides = std::bit_cast<std::uint32_t>(second[layout.sides()]);
            alike = alike && ((sides ^ m_sides[std::size_t(j)]) & 1u) == 0;
        }
        if (!alike) continue;
        for (int c = 0; c < 3; ++c) mean(m_samples.middle[c][j], second[P + c]);
        int plane = 0;
        for (const ChannelInfo& channel : shading_of(frame, group).shader->info().channels) {
            const int first = plane;
            plane += channel.components;
            if (channel.kind != ChannelKind::value) continue;
            for (int k = first; k < plane; ++k) {
                mean(m_planes[std::size_t(k * capacity + j)],
                     second[RecordLayout::first_baked + k]);
            }
        }
        if (!layout.is_lit()) continue;
        for (int c = 0; c < 3; ++c) mean(m_samples.seen.E[c][j], second[layout.E() + c]);
    }
}

/// Where in their pixels recalled samples have their values from.
void TileRenderer::place_in_pixels(const FrameContext& frame, const Group& group) {
    wide([samples = &m_samples, group, pose = frame.camera.pose(), width = frame.settings.width,
          height = frame.settings.height, m = frame.instances[group.instance].world_from_object]()
             ESTARA_LOOP {
                 const glm::vec3 x(m[0]), y(m[1]), z(m[2]), shift(m[3]);
#pragma GCC ivdep
                 for (int j = group.first; j < group.last; ++j) {
                     const glm::vec3 middle = at(samples->middle, j);
                     const glm::vec3 P = x * middle.x + y * middle.y + z * middle.z + shift;
                     const glm::vec3 place = pose.project(P, width, height);
                     samples->x[j] = place.x - std::floor(place.x) - 0.5f;
                     samples->y[j] = place.y - std::floor(place.y) - 0.5f;
                 }
             });
}

/// The records of new hits, but for their light.
void TileRenderer::keep(const FrameContext& frame, const Group& group, NewRecords& found) {
    const Stopwatch time;
    const PosedInstance& instance = frame.instances[group.instance];
    const RecordLayout layout = frame.reuse->cache().layout(int(group.instance));
    if (instance.bent && !layout.bends) return;  // squeezed flat in this frame
    const std::vector<glm::vec3>& face_normals = frame.face_normals[std::size_t(instance.object)];
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
            to[RecordLayout::Ng + c] = instance.bent ? face_normals[m_samples.site[j].triangle][c]
                                                     : m_samples.Ng_object[c][j];
        }
        if (layout.bends) {
            const int i = m_order[j];
            Site{m_hits.triangle[i], m_hits.b1[i], m_hits.b2[i]}.put(to, layout);
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
