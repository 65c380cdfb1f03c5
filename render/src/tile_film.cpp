// A tile's pixels from its samples.
#include <algorithm>
#include <cmath>

#include "tile.h"

namespace estara {
namespace {

ESTARA_KERNEL bool is_finite(float v) noexcept { return v - v == 0.0f; }

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

/// @param offset  of the pattern's sample in the pixel
void TileRenderer::accumulate(const FrameContext& frame, const glm::vec2& offset) {
    const Samples& s = m_samples;
    for (int j = 0; j < m_count; ++j) {
        const int pixel = s.pixel[j];
        ++m_sums.hits[pixel];
        for (int c = 0; c < 3; ++c) m_sums.color[c][pixel] += s.Ci[c][j];
    }
    if (frame.reuse != nullptr) accumulate_places(offset - 0.5f);
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
/// @param own  place of the pattern's sample, from the pixel's centre
void TileRenderer::accumulate_places(const glm::vec2& own) {
    const Samples& s = m_samples;
    for (const Group& group : m_groups) {
        for (int j = group.first; j < group.last; ++j) {
            const int pixel = s.pixel[j];
            const float x = group.recalled ? s.x[j] : own.x, y = group.recalled ? s.y[j] : own.y;
            m_sums.hit_x[pixel] += x;
            m_sums.hit_y[pixel] += y;
            for (int c = 0; c < 3; ++c) {
                m_sums.color_x[c][pixel] += x * s.Ci[c][j];
                m_sums.color_y[c][pixel] += y * s.Ci[c][j];
            }
            if (!group.recalled) continue;
            ++m_sums.recalled[pixel];
            m_sums.moved[0][pixel] += x - own.x;
            m_sums.moved[1][pixel] += y - own.y;
            m_sums.moved[2][pixel] += x * x - own.x * own.x;
            m_sums.moved[3][pixel] += x * y - own.x * own.y;
            m_sums.moved[4][pixel] += y * y - own.y * own.y;
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
    for (std::size_t i = 0; i < m_pixels.size(); ++i) {
        const auto p = int(i);
        const std::size_t to = film.index(m_pixels[i].x, m_pixels[i].y);
        film.color[to] = glm::vec4(0.0f);
        if (film.aovs.albedo) film.albedo[to] = glm::vec3(0.0f);
        if (film.aovs.normal) film.N[to] = glm::vec3(0.0f);
        if (film.aovs.position) film.P[to] = glm::vec3(0.0f);
        if (film.aovs.depth) film.depth[to] = 0.0f;
        if (film.aovs.hit) film.hit[to] = 0.0f;
        if (film.aovs.age) film.age[to] = 0.0f;
        if (film.aovs.occluded) film.occluded[to] = float(m_sums.occluded[i]) / samples;
        if (m_sums.hits[i] == 0) continue;
        const float hits = float(m_sums.hits[i]);
        glm::vec3 color = at(m_sums.color, p) * scale;
        float coverage = hits / samples;
        if (m_sums.recalled[i] > 0) {
            const PlaceMoments places = places_of(frame, p);
            const glm::vec2 g = slant(places, frame.pattern_moments.mean);
            const auto weighted = [&](float sum, float x, float y) {
                return sum - g.x * (x - places.mean.x * sum) - g.y * (y - places.mean.y * sum);
            };
            for (int c = 0; c < 3; ++c) {
                color[c] = scale *
                           weighted(m_sums.color[c][i], m_sums.color_x[c][i], m_sums.color_y[c][i]);
            }
            coverage = weighted(hits, m_sums.hit_x[i], m_sums.hit_y[i]) / samples;
            coverage = std::clamp(coverage, 0.0f, 1.0f);
        }
        glm::vec3 albedo = film.aovs.albedo ? at(m_sums.albedo, p) / hits : glm::vec3(0.0f);
        const bool good_color = is_finite(color.x) & is_finite(color.y) & is_finite(color.z);
        const bool good_albedo = is_finite(albedo.x) & is_finite(albedo.y) & is_finite(albedo.z);
        if (!good_color || !good_albedo) {
            ++statistics.bad_pixels;
            if (!good_color) color = glm::vec3(0.0f);
            if (!good_albedo) albedo = glm::vec3(0.0f);
        }
        film.color[to] = glm::vec4(color, coverage);
        if (film.aovs.albedo) film.albedo[to] = albedo;
        if (film.aovs.normal) film.N[to] = at(m_sums.N, p) / hits;
        if (film.aovs.position) film.P[to] = at(m_sums.P, p) / hits;
        if (film.aovs.depth) film.depth[to] = m_sums.depth[i] / hits;
        if (film.aovs.hit) film.hit[to] = float(m_sums.recalled[i]) / samples;
        if (film.aovs.age) film.age[to] = float(m_sums.age[i]) / hits;
    }
}

}  // namespace estara
