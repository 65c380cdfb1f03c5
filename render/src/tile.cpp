#include "tile.h"

#include <algorithm>
#include <cmath>

#include "estara/scenes/program.h"

namespace estara {
namespace {

// A shadow ray ends a little before its light: what holds the light is often exactly there.
constexpr float shadow_end = 0.9999f;

/// v / |v|, or `otherwise` for a vector without direction. In float where the square is one.
glm::vec3 unit_or(const glm::vec3& v, const glm::vec3& otherwise) noexcept {
    const float square = glm::dot(v, v);
    if (square > 1e-30f && square < 1e30f) return v / std::sqrt(square);
    const double length = glm::length(glm::dvec3(v));
    return length > 0.0 && std::isfinite(length) ? glm::vec3(glm::dvec3(v) / length) : otherwise;
}

bool is_finite(const glm::vec3& v) noexcept {
    return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}

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

const ObjectShading& TileRenderer::shading_of(const FrameContext& frame, const Group& group) const {
    return frame.shading[std::size_t(frame.instances[group.instance].object)];
}

void TileRenderer::render(const FrameContext& frame, const glm::ivec2& corner, Film& film) {
    list_pixels(frame, corner);
    m_sums.assign(m_pixels.size(), {});
    for (const glm::vec2& offset : frame.pattern) {
        trace(frame, offset);
        group_by_instance(frame);
        for (const Group& group : m_groups) place_on_surface(frame, group);
        light(frame);
        for (const Group& group : m_groups) {
            evaluate(frame, group);
            view(frame, group);
            accumulate(frame, group);
        }
    }
    resolve(frame, film);
}

// In squares of 4 x 4 pixels: the 16 rays of a packet stay close together.
void TileRenderer::list_pixels(const FrameContext& frame, const glm::ivec2& corner) {
    m_pixels.clear();
    for (int i = 0; i < capacity; ++i) {
        const int square = i / 16, inside = i % 16;
        const glm::ivec2 pixel = corner + glm::ivec2(square % (width / 4) * 4 + inside % 4,
                                                     square / (width / 4) * 4 + inside / 4);
        if (pixel.x < frame.settings.width && pixel.y < frame.settings.height) {
            m_pixels.push_back(pixel);
        }
    }
}

void TileRenderer::trace(const FrameContext& frame, const glm::vec2& offset) {
    const Stopwatch time;
    m_rays.clear();
    for (const glm::ivec2& pixel : m_pixels) {
        m_rays.push_back(
            frame.camera.primary_ray(float(pixel.x) + offset.x, float(pixel.y) + offset.y));
    }
    frame.rays.intersect(m_rays, m_hits.data());
    statistics.primary_rays += m_rays.size();
    statistics.ray_seconds += time.seconds();
}

// A counting sort over the instances that this tile hits, in the order of their first hit.
void TileRenderer::group_by_instance(const FrameContext& frame) {
    if (m_group_of_instance.size() != frame.instances.size()) {
        m_group_of_instance.assign(frame.instances.size(), -1);
    }
    m_groups.clear();
    for (std::size_t i = 0; i < m_pixels.size(); ++i) {
        if (m_hits[i].instance == Hit::none) continue;
        int& group = m_group_of_instance[m_hits[i].instance];
        if (group < 0) {
            group = int(m_groups.size());
            m_groups.push_back({m_hits[i].instance, 0, 0});
        }
        ++m_groups[std::size_t(group)].last;
    }
    int first = 0;
    for (Group& group : m_groups) {
        const int size = group.last;
        group.first = group.last = first;
        first += size;
    }
    m_order.resize(std::size_t(first));
    m_samples.clear();
    for (std::size_t i = 0; i < m_pixels.size(); ++i) {
        if (m_hits[i].instance == Hit::none) continue;
        Group& group = m_groups[std::size_t(m_group_of_instance[m_hits[i].instance])];
        m_order[std::size_t(group.last++)] = std::uint32_t(i);
    }
    for (const Group& group : m_groups) m_group_of_instance[group.instance] = -1;
    statistics.samples += m_order.size();
}

void TileRenderer::place_on_surface(const FrameContext& frame, const Group& group) {
    const PosedInstance& instance = frame.instances[group.instance];
    const Mesh& mesh = frame.scene.objects[std::size_t(instance.object)].mesh;
    for (int j = group.first; j < group.last; ++j) {
        const std::uint32_t i = m_order[std::size_t(j)];
        const MeshPoint point = mesh_point(mesh, m_hits[i].triangle, m_hits[i].b1, m_hits[i].b2);
        const glm::vec3 P(instance.world_from_object * glm::vec4(point.P, 1.0f));
        const Sight sight = frame.camera.sight(P);
        const glm::vec3 V = sight.V.vec();
        const glm::vec3 Ng = unit_or(instance.world_from_normal * point.Ng, V);
        const glm::vec3 N = unit_or(instance.world_from_normal * point.N, Ng);
        // N_f: the camera decides on the side and on nothing else.
        const float side = glm::dot(Ng, V) < 0.0f ? -1.0f : 1.0f;
        m_samples.push_back({int(i), point, P, side * Ng, side * N, sight});
    }
}

void TileRenderer::light(const FrameContext& frame) {
    const std::size_t row = frame.lights.size();
    m_lights.resize(m_samples.size() * row);
    std::fill_n(m_light_count.begin(), m_samples.size(), 0);
    std::fill_n(m_E.begin(), m_samples.size(), glm::vec3(0.0f));
    for (const PosedLight& source : frame.lights) {
        find_candidates(source, frame);
        const Stopwatch time;
        frame.rays.occluded(m_rays, m_blocked.data());
        statistics.shadow_rays += m_rays.size();
        statistics.ray_seconds += time.seconds();
        for (std::size_t c = 0; c < m_candidates.size(); ++c) {
            if (m_blocked[c]) continue;  // a light in shadow has Cl = 0 and need not be listed
            const Candidate& found = m_candidates[c];
            const std::size_t j = std::size_t(found.sample);
            m_lights[j * row + std::size_t(m_light_count[j]++)] = found.light;
            m_E[j] += found.light.Cl * found.cosine;
        }
    }
}

/// Samples that face the light, and a shadow ray for each.
void TileRenderer::find_candidates(const PosedLight& source, const FrameContext& frame) {
    m_candidates.clear();
    m_rays.clear();
    for (const Group& group : m_groups) {
        const SurfaceOffset& offset = frame.instances[group.instance].offset;
        for (int j = group.first; j < group.last; ++j) {
            const Sample& s = m_samples[std::size_t(j)];
            const LightSample sample = sample_light(source, s.P);
            const float cosine = glm::dot(s.N, sample.L);
            if (!(cosine > 0.0f) || sample.Cl == glm::vec3(0.0f)) continue;
            const glm::vec3 side = glm::dot(s.Ng, sample.L) < 0.0f ? -s.Ng : s.Ng;
            const glm::vec3 origin = offset.from(s.P, side, s.point.P);
            m_candidates.push_back({j, {sample.L, sample.Cl}, cosine});
            if (std::isfinite(sample.distance)) {
                m_rays.push_back({origin, source.position - origin, 0.0f, shadow_end});
            } else {
                m_rays.push_back({origin, sample.L, 0.0f, sample.distance});
            }
        }
    }
}

/// Makes sample j the batch's point i. The tangent of a mesh is for shaders of its surface only.
void TileRenderer::set_point(const FrameContext& frame, const Group& group, int i, int j) {
    const auto object = std::size_t(frame.instances[group.instance].object);
    const MeshPoint& point = m_samples[std::size_t(j)].point;
    const bool needs_tangent = frame.shading[object].shader->domain() == Domain::surface;
    m_batch.set(i, point.P, point.N, point.uv,
                needs_tangent ? tangent(frame.scene.objects[object].mesh, point)
                              : glm::vec3(1.0f, 0.0f, 0.0f));
}

/// Fills m_planes, rows by the group's samples.
void TileRenderer::evaluate(const FrameContext& frame, const Group& group) {
    const ObjectShading& shading = shading_of(frame, group);
    const std::size_t floats = std::size_t(shading.shader->info().baked_floats) * capacity;
    if (m_planes.size() < floats) m_planes.resize(floats);
    const Stopwatch time;
    if (shading.pyramid) {
        look_up(frame, group, shading);
    } else {
        m_batch.size = group.last - group.first;
        m_batch.filter_width = shading.filter_width;
        for (int i = 0; i < m_batch.size; ++i) set_point(frame, group, i, group.first + i);
        shading.shader->bake(m_batch, m_planes.data());
    }
    statistics.evaluation_seconds += time.seconds();
}

// The footprint is the minor axis of what a sample covers: at grazing angles it is not divided by
// the cosine. The major axis would blur the texture across as well as along.
void TileRenderer::look_up(const FrameContext& frame, const Group& group,
                           const ObjectShading& shading) {
    const int floats = shading.pyramid->floats();
    const float scale = frame.instances[group.instance].largest_scale;
    const float width_at_1 =
        frame.camera.pixel_angle() / std::sqrt(float(frame.pattern.size())) / scale;
    const auto size = std::size_t(group.last - group.first);
    m_P.resize(size);
    m_footprints.resize(size);
    for (std::size_t i = 0; i < size; ++i) {
        const Sample& s = m_samples[std::size_t(group.first) + i];
        m_P[i] = s.point.P;
        m_footprints[i] = s.sight.distance * width_at_1;
    }
    shading.pyramid->lookup(m_P, m_footprints, m_planes.data(), capacity, m_found.data());
    m_missed.clear();
    for (std::size_t i = 0; i < size; ++i) {
        if (!m_found[i]) m_missed.push_back(int(i));
    }
    statistics.lookups += std::uint64_t(group.last - group.first);
    statistics.misses += m_missed.size();
    if (m_missed.empty()) return;

    m_batch.size = int(m_missed.size());
    m_batch.filter_width = shading.filter_width;
    for (int m = 0; m < m_batch.size; ++m) {
        set_point(frame, group, m, group.first + m_missed[std::size_t(m)]);
    }
    m_missed_planes.resize(m_planes.size());
    shading.shader->bake(m_batch, m_missed_planes.data());
    for (int m = 0; m < m_batch.size; ++m) {
        for (int k = 0; k < floats; ++k) {
            m_planes[std::size_t(k * capacity + m_missed[std::size_t(m)])] =
                m_missed_planes[std::size_t(k * capacity + m)];
        }
    }
}

void TileRenderer::view(const FrameContext& frame, const Group& group) {
    const Stopwatch time;
    m_seen.clear();
    for (int j = group.first; j < group.last; ++j) {
        const Sample& s = m_samples[std::size_t(j)];
        const std::size_t row = std::size_t(j) * frame.lights.size();
        m_seen.push_back({s.N,
                          s.sight.V,
                          m_E[std::size_t(j)],
                          frame.scene.ambient,
                          {m_lights.data() + row, std::size_t(m_light_count[std::size_t(j)])}});
    }
    shading_of(frame, group).shader->view(m_planes.data(), m_seen, m_Ci.data());
    statistics.view_seconds += time.seconds();
}

void TileRenderer::accumulate(const FrameContext& frame, const Group& group) {
    const int albedo = color_offset(shading_of(frame, group).shader->info());
    for (int j = group.first; j < group.last; ++j) {
        const Sample& s = m_samples[std::size_t(j)];
        const int i = j - group.first;
        PixelSum& sum = m_sums[std::size_t(s.pixel)];
        sum.color += m_Ci[std::size_t(i)];
        sum.N += s.N;
        sum.P += s.P;
        sum.depth += s.sight.distance;
        ++sum.hits;
        for (int c = 0; albedo >= 0 && c < 3; ++c) {
            sum.albedo[c] += m_planes[std::size_t((albedo + c) * capacity + i)];
        }
    }
}

void TileRenderer::resolve(const FrameContext& frame, Film& film) {
    const float samples = float(frame.pattern.size());
    const float exposure = std::exp2(frame.settings.exposure);
    for (std::size_t i = 0; i < m_pixels.size(); ++i) {
        const PixelSum& sum = m_sums[i];
        if (sum.hits == 0) continue;
        const std::size_t at = film.index(m_pixels[i].x, m_pixels[i].y);
        const float hits = float(sum.hits);
        glm::vec3 color = sum.color * (exposure / samples);
        glm::vec3 albedo = sum.albedo / hits;
        if (!is_finite(color) || !is_finite(albedo)) {
            ++statistics.bad_pixels;
            if (!is_finite(color)) color = glm::vec3(0.0f);
            if (!is_finite(albedo)) albedo = glm::vec3(0.0f);
        }
        film.color[at] = glm::vec4(color, hits / samples);
        if (film.aovs.albedo) film.albedo[at] = albedo;
        if (film.aovs.normal) film.N[at] = sum.N / hits;
        if (film.aovs.position) film.P[at] = sum.P / hits;
        if (film.aovs.depth) film.depth[at] = sum.depth / hits;
    }
}

}  // namespace estara
