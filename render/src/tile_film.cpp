// A tile's pixels from its samples.
#include <algorithm>
#include <cmath>

#include "estara/shaders/math.h"
#include "tile.h"

namespace estara {
namespace {

/// First float of the channel "color" in a baked record, or -1.
int color_offset(const ShaderInfo& info) noexcept {
    int offset = 0;
    for (const ChannelInfo& channel : info.channels) {
        if (channel.name == "color" && channel.components == 3) return offset;
        offset += channel.components;
    }
    return -1;
}

}  // namespace

void TileRenderer::clear_sums(const FrameContext& frame) {
    std::fill_n(m_sums.color[0], 3 * capacity, 0.0f);
    for (int* counts : {m_sums.hits, m_sums.recalled, m_sums.age, m_sums.occluded}) {
        std::fill_n(counts, capacity, 0);
    }
    if (frame.reuse != nullptr) {
        for (Plane& plane : m_sums.moved) std::fill_n(plane, capacity, 0.0f);
        for (Plane& plane : m_sums.color_x) std::fill_n(plane, capacity, 0.0f);
        for (Plane& plane : m_sums.color_y) std::fill_n(plane, capacity, 0.0f);
        std::fill_n(m_sums.hit_x, capacity, 0.0f);
        std::fill_n(m_sums.hit_y, capacity, 0.0f);
    }
    if (!frame.settings.aovs.any()) return;
    for (Planes* planes : {&m_sums.albedo, &m_sums.N, &m_sums.P}) {
        std::fill_n((*planes)[0], 3 * capacity, 0.0f);
    }
    std::fill_n(m_sums.depth, capacity, 0.0f);
}

void TileRenderer::accumulate(const FrameContext& frame) {
    const Samples& s = m_samples;
    for (int j = 0; j < m_count;) {  // neighbours are mostly of one pixel
        const int pixel = s.pixel[j], first = j;
        glm::vec3 color(0.0f);
        do {
            color += at(s.Ci, j++);
        } while (j < m_count && s.pixel[j] == pixel);
        m_sums.hits[pixel] += j - first;
        for (int c = 0; c < 3; ++c) m_sums.color[c][pixel] += color[c];
    }
    if (frame.reuse != nullptr) accumulate_places(frame);
    if (!frame.settings.aovs.any()) return;
    for (const Group& group : m_groups) {
        const int albedo = color_offset(shading_of(frame, group).shader->info());
        for (int j = group.first; j < group.last; ++j) {
            const int pixel = s.pixel[j];
            m_sums.age[pixel] += s.age[j] >= 0 ? s.age[j] : 0;
            m_sums.depth[pixel] += s.distance[j];
            for (int c = 0; c < 3; ++c) {
                m_sums.N[c][pixel] += s.seen.N[c][j];
                m_sums.P[c][pixel] += s.P[c][j];
                if (albedo < 0) continue;
                m_sums.albedo[c][pixel] += m_planes[std::size_t((albedo + c) * capacity + j)];
            }
        }
    }
}

/// What places_of() and the weights need of where the samples lie.
void TileRenderer::accumulate_places(const FrameContext& frame) {
    const Samples& s = m_samples;
    for (const Group& group : m_groups) {
        for (int j = group.first; j < group.last;) {
            const int pixel = s.pixel[j], first = j;
            glm::vec2 sum(0.0f);
            glm::vec3 color_x(0.0f), color_y(0.0f);
            float moved[5] = {};
            do {
                const glm::vec2 own = frame.pattern[std::size_t(s.number[j])] - 0.5f;
                const glm::vec2 p = group.recalled ? glm::vec2(s.x[j], s.y[j]) : own;
                const glm::vec3 Ci = at(s.Ci, j);
                sum += p;
                color_x += p.x * Ci;
                color_y += p.y * Ci;
                moved[0] += p.x - own.x;
                moved[1] += p.y - own.y;
                moved[2] += p.x * p.x - own.x * own.x;
                moved[3] += p.x * p.y - own.x * own.y;
                moved[4] += p.y * p.y - own.y * own.y;
                ++j;
            } while (j < group.last && s.pixel[j] == pixel);
            m_sums.hit_x[pixel] += sum.x;
            m_sums.hit_y[pixel] += sum.y;
            for (int c = 0; c < 3; ++c) {
                m_sums.color_x[c][pixel] += color_x[c];
                m_sums.color_y[c][pixel] += color_y[c];
            }
            for (int m = 0; m < 5; ++m) m_sums.moved[m][pixel] += moved[m];
            m_sums.recalled[pixel] += group.recalled ? j - first : 0;
        }
    }
}

/// Where a pixel's samples lie.
PlaceMoments TileRenderer::places_of(const FrameContext& frame, int pixel) const {
    const float n = float(frame.pattern.size());
    const PlaceMoments& own = frame.pattern_moments;
    const auto& moved = m_sums.moved;
    return {own.mean + glm::vec2(moved[0][pixel], moved[1][pixel]) / n,
            own.xx + moved[2][pixel] / n, own.xy + moved[3][pixel] / n,
            own.yy + moved[4][pixel] / n};
}

void TileRenderer::resolve(const FrameContext& frame, Film& film) {
    const float samples = float(frame.pattern.size());
    const float scale = std::exp2(frame.settings.exposure) / samples;
    const int size = int(m_pixels.size());
    for (int p = 0; p < size; ++p) m_sums.covered[p] = float(m_sums.hits[p]);
    if (frame.reuse != nullptr) weigh_by_place(frame);
    int bad = 0;
    int* const bad_pixels = &bad;
    wide([=, sums = &m_sums]() ESTARA_LOOP {
        int any = 0;
#pragma GCC ivdep
        for (int p = 0; p < size; ++p) {
            const bool hit = sums->hits[p] > 0;
            const glm::vec3 none(0.0f);
            const glm::vec3 color = select(hit, at(sums->color, p) * scale, none);
            const bool good = is_finite(color.x) & is_finite(color.y) & is_finite(color.z);
            put(sums->color, p, select(good, color, none));
            sums->bad[p] = good ? 0 : 1;
            any += sums->bad[p];
            const float coverage = sums->covered[p] / samples;
            const float positive = coverage > 0.0f ? coverage : 0.0f;
            sums->covered[p] = positive < 1.0f ? positive : 1.0f;
        }
        *bad_pixels = any;
    });
    statistics.bad_pixels += std::uint64_t(bad);
    for (int p = 0; p < size; ++p) {
        const glm::ivec2 pixel = m_pixels[std::size_t(p)];
        film.color[film.index(pixel.x, pixel.y)] =
            glm::vec4(at(m_sums.color, p), m_sums.covered[p]);
    }
    if (frame.settings.aovs.any()) resolve_aovs(frame, film);
}

/// Of pixels with recalled samples: sums as if these lay where the pattern's do.
void TileRenderer::weigh_by_place(const FrameContext& frame) {
    for (int p = 0; p < int(m_pixels.size()); ++p) {
        if (m_sums.recalled[p] == 0) continue;
        const PlaceMoments places = places_of(frame, p);
        const glm::vec2 g = slant(places, frame.pattern_moments.mean);
        const auto weighted = [&](float sum, float x, float y) {
            return sum - g.x * (x - places.mean.x * sum) - g.y * (y - places.mean.y * sum);
        };
        for (int c = 0; c < 3; ++c) {
            float& sum = m_sums.color[c][p];
            sum = weighted(sum, m_sums.color_x[c][p], m_sums.color_y[c][p]);
        }
        m_sums.covered[p] = weighted(m_sums.covered[p], m_sums.hit_x[p], m_sums.hit_y[p]);
    }
}

void TileRenderer::resolve_aovs(const FrameContext& frame, Film& film) {
    const float samples = float(frame.pattern.size());
    const Aovs& aovs = film.aovs;
    for (int p = 0; p < int(m_pixels.size()); ++p) {
        const glm::ivec2 pixel = m_pixels[std::size_t(p)];
        const std::size_t to = film.index(pixel.x, pixel.y);
        const float hits = float(std::max(m_sums.hits[p], 1));  // the sums of none are 0
        if (aovs.albedo) {
            const glm::vec3 albedo = at(m_sums.albedo, p) / hits;
            const bool good = is_finite(albedo.x) & is_finite(albedo.y) & is_finite(albedo.z);
            film.albedo[to] = good ? albedo : glm::vec3(0.0f);
            if (!good && m_sums.bad[p] == 0) ++statistics.bad_pixels;
        }
        if (aovs.normal) film.N[to] = at(m_sums.N, p) / hits;
        if (aovs.position && m_sums.hits[p] > 0) {
            film.P[to] = glm::vec3(glm::dvec3(at(m_sums.P, p) / hits) + frame.origin);
        } else if (aovs.position) {
            film.P[to] = glm::vec3(0.0f);
        }
        if (aovs.depth) film.depth[to] = m_sums.depth[p] / hits;
        if (aovs.hit) film.hit[to] = float(m_sums.recalled[p]) / samples;
        if (aovs.age) film.age[to] = float(m_sums.age[p]) / hits;
        if (aovs.occluded) film.occluded[to] = float(m_sums.occluded[p]) / samples;
    }
}

}  // namespace estara
