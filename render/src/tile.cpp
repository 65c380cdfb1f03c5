#include "tile.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "estara/scenes/program.h"

namespace estara {
namespace {

/// Triangles: with vertices and normals they no longer fit a core's caches (512 KiB).
constexpr std::size_t large_mesh = 8192;

/// v / |v|, or `otherwise` for a vector without direction.
glm::vec3 unit_or(const glm::vec3& v, const glm::vec3& otherwise) noexcept {
    const double length = glm::length(glm::dvec3(v));
    return length > 0.0 && std::isfinite(length) ? glm::vec3(glm::dvec3(v) / length) : otherwise;
}

}  // namespace

const ObjectShading& TileRenderer::shading_of(const FrameContext& frame, const Group& group) const {
    return frame.shading[std::size_t(frame.instances[group.instance].object)];
}

ObjectCost& TileRenderer::cost_of(const FrameContext& frame, const Group& group) {
    if (statistics.objects.empty()) statistics.objects.resize(frame.shading.size());
    return statistics.objects[std::size_t(frame.instances[group.instance].object)];
}

void TileRenderer::render(const FrameContext& frame, int tile, Film& film, NewRecords& found) {
    const TileGrid tiles(frame.settings.width, frame.settings.height);
    list_pixels(frame, tiles.corner(tile));
    clear_sums(frame);
    if (frame.reuse != nullptr) {
        list_points(frame, tile, tiles.corner(tile));
        trace_own_rays(frame);
        test_some(frame);
    }
    // Pixel by pixel: the rays of a packet stay close together, and so do the instances and, if
    // there is a cache, the records of a batch.
    const int samples = int(frame.pattern.size()), pixels = std::max(1, capacity / samples);
    for (int pixel = 0; pixel < int(m_pixels.size()); pixel += pixels) {
        const int last_pixel = std::min(pixel + pixels, int(m_pixels.size()));
        for (int sample = 0; sample < samples; sample += capacity) {
            list_batch({pixel, last_pixel}, {sample, std::min(sample + capacity, samples)});
            if (frame.reuse != nullptr) {
                recall(frame);
            } else {
                std::fill_n(m_needs_ray, m_batch.size, 1);
            }
            trace(frame);
            group_by_instance(frame);
            if (frame.reuse != nullptr) add_recalled_groups();
            m_samples.surface.size = m_count;
            statistics.samples += std::uint64_t(m_count);
            if (m_count > 0) shade(frame, found);
        }
    }
    resolve(frame, film);
}

void TileRenderer::shade(const FrameContext& frame, NewRecords& found) {
    if (frame.reuse != nullptr) m_sides.assign((frame.lights.size() / 32 + 1) * capacity, 0);
    for (const Group& group : m_groups) {
        if (group.recalled) {
            shade_recalled(frame, group);
        } else {
            shade_new(frame, group, found);
        }
    }
    std::fill_n(m_samples.Ci[0], 3 * capacity, 0.0f);
    for (std::size_t l = 0; l < frame.lights.size(); ++l) light(frame, int(l));
    close(frame);
    if (frame.reuse != nullptr) keep_light(frame, found);
    accumulate(frame);
}

void TileRenderer::list_pixels(const FrameContext& frame, const glm::ivec2& corner) {
    m_pixels.resize(TileGrid::pixels);
    m_numbers.resize(TileGrid::pixels);
    for (int i = 0; i < TileGrid::pixels; ++i) {
        m_pixels[std::size_t(i)] = corner + TileGrid::place(i);
        m_numbers[std::size_t(i)] = i;
    }
    const glm::ivec2 size(frame.settings.width, frame.settings.height);
    if (corner.x + TileGrid::width <= size.x && corner.y + TileGrid::height <= size.y) return;
    std::size_t count = 0;
    for (std::size_t i = 0; i < TileGrid::pixels; ++i) {
        const glm::ivec2 pixel = m_pixels[i];
        if (pixel.x >= size.x || pixel.y >= size.y) continue;
        m_pixels[count] = pixel;
        m_numbers[count++] = int(i);
    }
    m_pixels.resize(count);
    m_numbers.resize(count);
}

/// @param pixels, samples  from the first to the one before the last; together no more than a batch
void TileRenderer::list_batch(const glm::ivec2& pixels, const glm::ivec2& samples) {
    m_batch.size = 0;
    for (int pixel = pixels[0]; pixel < pixels[1]; ++pixel) {
        for (int sample = samples[0]; sample < samples[1]; ++sample) m_batch.push(pixel, sample);
    }
}

/// Finds what the samples of a batch see that are not recalled.
void TileRenderer::trace(const FrameContext& frame) {
    const Stopwatch time;
    m_ray_count = 0;
    for (int lane = 0; lane < m_batch.size; ++lane) {
        if (m_needs_ray[lane] == 0 || own_hit(frame, lane) != nullptr) continue;
        place_ray(frame, m_ray_count, m_batch.pixel[lane], m_batch.sample[lane]);
        m_ray_lane[m_ray_count++] = lane;
    }
    frame.camera.primary_rays(m_x, m_y, m_ray_count, m_rays);
    frame.rays.intersect(m_rays, m_hits);
    statistics.primary_rays += std::uint64_t(m_ray_count);
    if (frame.reuse != nullptr) {
        for (int lane = 0; lane < m_batch.size; ++lane) {
            const Hit* const hit = m_needs_ray[lane] != 0 ? own_hit(frame, lane) : nullptr;
            if (hit == nullptr) continue;
            m_hits.instance[m_ray_count] = hit->instance;
            m_hits.triangle[m_ray_count] = hit->triangle;
            m_hits.b1[m_ray_count] = hit->b1;
            m_hits.b2[m_ray_count] = hit->b2;
            m_ray_lane[m_ray_count++] = lane;
        }
    }
    statistics.ray_seconds += time.seconds();
}

void TileRenderer::group_by_instance(const FrameContext& frame) {
    m_groups.clear();
    m_count = sort_by_instance(frame, m_hits.instance, m_ray_count, m_groups, m_order);
}

// A counting sort, in the order in which instances come first.
int TileRenderer::sort_by_instance(const FrameContext& frame, const std::uint32_t* instances,
                                   int count, std::vector<Group>& groups, int* order) {
    if (m_group_of_instance.size() != frame.instances.size()) {
        m_group_of_instance.assign(frame.instances.size(), -1);
    }
    // Neighbours mostly lie on the same instance: calls f(instance, first, last) for those that do.
    const auto for_each_run = [&](const auto& f) {
        for (int first = 0, last = 0; first < count; first = last) {
            while (last < count && instances[last] == instances[first]) ++last;
            if (instances[first] != Hit::none) f(instances[first], first, last);
        }
    };
    for_each_run([&](std::uint32_t instance, int first, int last) {
        int& group = m_group_of_instance[instance];
        if (group < 0) {
            group = int(groups.size());
            groups.push_back({instance, 0, 0, false});
        }
        groups[std::size_t(group)].last += last - first;
    });
    int sorted = 0;
    for (Group& group : groups) {
        const int size = group.last;
        group.first = group.last = sorted;
        sorted += size;
    }
    for_each_run([&](std::uint32_t instance, int first, int last) {
        int& to = groups[std::size_t(m_group_of_instance[instance])].last;
        std::iota(order + to, order + to + (last - first), first);
        to += last - first;
    });
    for (const Group& group : groups) m_group_of_instance[group.instance] = -1;
    return sorted;
}

void TileRenderer::shade_new(const FrameContext& frame, const Group& group, NewRecords& found) {
    interpolate(frame, group);
    if (frame.instances[group.instance].bent) bend(frame, group);
    place_in_world(frame, group);
    evaluate(frame, group);
    take_normals(frame, group);
    turn_normals(frame.instances[group.instance], group);
    look_up_irradiance(frame, group);
    std::fill(m_samples.kept + group.first, m_samples.kept + group.last, 0);
    std::fill(m_samples.age + group.first, m_samples.age + group.last, -1);
    std::fill(m_row + group.first, m_row + group.last, -1);
    statistics.lit += std::uint64_t(group.last - group.first);
    if (frame.reuse != nullptr && shading_of(frame, group).cached) keep(frame, group, found);
    turn_directions(frame, group);
}

/// World space: P, V and the distance to the eye.
void TileRenderer::place_in_world(const FrameContext& frame, const Group& group) {
    const PosedInstance& instance = frame.instances[group.instance];
    wide([samples = &m_samples, placed = &placed_P(instance), group,
          m = instance.world_from_object]() ESTARA_LOOP {
        const glm::vec3 x(m[0]), y(m[1]), z(m[2]), shift(m[3]);
#pragma GCC ivdep
        for (int j = group.first; j < group.last; ++j) {
            const glm::vec3 P = at(*placed, j);
            put(samples->P, j, x * P.x + y * P.y + z * P.z + shift);
        }
    });
    frame.camera.sights(m_samples.P[0], group.first, group.last, m_samples.seen.V,
                        m_samples.distance);
}

/// Object space: mesh_point() for every sample, with the normals left for a wide loop.
void TileRenderer::interpolate(const FrameContext& frame, const Group& group) {
    const auto object = std::size_t(frame.instances[group.instance].object);
    const Mesh& mesh = frame.scene.objects[object].mesh;
    const glm::vec3* const Ng = frame.face_normals[object].data();
    const glm::vec3* const N = mesh.N.empty() ? nullptr : mesh.N.data();
    // A Domain::point shader reads no texture coordinates, and what a lookup misses of another's is
    // given them later.
    const ObjectShading& shading = shading_of(frame, group);
    const bool on_surface = shading.shader->domain() == Domain::surface && !shading.pyramid;
    const glm::vec2* const uv = on_surface && mesh.has_uv() ? mesh.uv.data() : nullptr;
    SurfaceBatch& surface = m_samples.surface;
    // Of a large mesh the vertices are anywhere in memory: those of some samples are asked for
    // before any is used.
    const bool is_large = mesh.triangles.size() > large_mesh;
    constexpr int ahead = 32;
    for (int first = group.first; first < group.last; first += ahead) {
        const int last = std::min(first + ahead, group.last);
        for (int j = first; is_large && j < last; ++j) {
            const std::uint32_t triangle = m_hits.triangle[m_order[j]];
            __builtin_prefetch(&mesh.triangles[triangle]);
            __builtin_prefetch(&Ng[triangle]);
        }
        for (int j = first; is_large && j < last; ++j) {
            const glm::uvec3& t = mesh.triangles[m_hits.triangle[m_order[j]]];
            for (int k = 0; k < 3; ++k) {
                __builtin_prefetch(&mesh.P[t[k]]);
                if (N) __builtin_prefetch(&N[t[k]]);
                if (uv) __builtin_prefetch(&uv[t[k]]);
            }
        }
        for (int j = first; j < last; ++j) {
            const int i = m_order[j];
            const std::uint32_t triangle = m_hits.triangle[i];
            const glm::uvec3 t = mesh.triangles[triangle];
            const float b1 = m_hits.b1[i], b2 = m_hits.b2[i], b0 = 1.0f - b1 - b2;
            const glm::vec3 g = Ng[triangle];
            m_samples.pixel[j] = m_batch.pixel[m_ray_lane[i]];
            m_samples.number[j] = m_batch.sample[m_ray_lane[i]];
            put(surface.P, j, b0 * mesh.P[t.x] + b1 * mesh.P[t.y] + b2 * mesh.P[t.z]);
            put(m_samples.Ng_object, j, g);
            put(surface.N, j, N ? b0 * N[t.x] + b1 * N[t.y] + b2 * N[t.z] : g);
            const glm::vec2 st = uv ? b0 * uv[t.x] + b1 * uv[t.y] + b2 * uv[t.z] : glm::vec2(0.0f);
            surface.uv[0][j] = st.x;
            surface.uv[1][j] = st.y;
        }
    }
    wide([samples = &m_samples, group]() ESTARA_LOOP {
#pragma GCC ivdep
        for (int j = group.first; j < group.last; ++j) {
            const glm::vec3 n = at(samples->surface.N, j), g = at(samples->Ng_object, j);
            const float square = glm::dot(n, n);
            // Opposite normals cancel; what is left of them then is rounding error.
            const bool cancelled = !(square > 1e-8f);
            const float length = std::sqrt(cancelled ? 1.0f : square);
            put(samples->surface.N, j,
                {cancelled ? g.x : n.x / length, cancelled ? g.y : n.y / length,
                 cancelled ? g.z : n.z / length});
        }
    });
    if (!on_surface) return;
    const glm::vec3* const tangents = frame.tangents[object].data();
    for (int j = group.first; j < group.last; ++j) {
        const glm::vec3 dPdu = tangents[m_hits.triangle[m_order[j]]];
        put(surface.dPdu, j, dPdu == glm::vec3(0.0f) ? tangent_without_uv(at(surface.N, j)) : dPdu);
    }
}

/// A sample as a point of its mesh.
MeshPoint TileRenderer::mesh_point_of(const FrameContext& frame, const Group& group, int j) const {
    const auto object = std::size_t(frame.instances[group.instance].object);
    const int i = m_order[j];
    return mesh_point(frame.scene.objects[object].mesh, m_hits.triangle[i], m_hits.b1[i],
                      m_hits.b2[i]);
}

/// World space, and on the side of the eye.
void TileRenderer::turn_normals(const PosedInstance& instance, const Group& group) {
    const auto turn = [](Samples& to, int j, const glm::vec3& Ng, const glm::vec3& N) ESTARA_LOOP {
        const glm::vec3 V = to.seen.V[j].vec();
        // N_f: the camera decides on the side and on nothing else.
        const bool front = !(glm::dot(Ng, V) < 0.0f);
        const float side = front ? 1.0f : -1.0f;
        put(to.Ng, j, side * Ng);
        put(to.seen.N, j, side * N);
        to.front[j] = front ? 1 : 0;
    };
    int unusual = 0;  // a square beyond float, or a matrix that is singular: nearly never
    int* const found = &unusual;
    const Planes* const normals = instance.bent ? &m_samples.N_bent : &m_samples.surface.N;
    wide([=, samples = &m_samples, m = instance.world_from_normal]() ESTARA_LOOP {
        int any = 0;
#pragma GCC ivdep
        for (int j = group.first; j < group.last; ++j) {
            const glm::vec3 Ng = m * at(samples->Ng_object, j);
            const glm::vec3 N = m * at(*normals, j);
            const float g = glm::dot(Ng, Ng), n = glm::dot(N, N);
            const bool usual = (g > least_square) & (g < largest_square) & (n > least_square) &
                               (n < largest_square);
            any |= usual ? 0 : 1;
            turn(*samples, j, Ng / std::sqrt(g), N / std::sqrt(n));
        }
        *found = any;
    });
    if (unusual == 0) return;
    for (int j = group.first; j < group.last; ++j) {
        const glm::vec3 Ng = unit_or(instance.world_from_normal * at(m_samples.Ng_object, j),
                                     m_samples.seen.V[j].vec());
        const glm::vec3 N = unit_or(instance.world_from_normal * at(*normals, j), Ng);
        turn(m_samples, j, Ng, N);
    }
}

void TileRenderer::reserve_planes(const ShaderInfo& info) {
    const std::size_t floats = std::size_t(info.baked_floats) * capacity;
    if (m_planes.size() < floats) m_planes.resize(floats);
}

/// A shader's own normal takes the place of the mesh's.
void TileRenderer::take_normals(const FrameContext& frame, const Group& group) {
    const int plane = normal_plane(shading_of(frame, group).shader->info());
    if (plane < 0) return;
    for (int c = 0; c < 3; ++c) {
        const float* const from = m_planes.data() + (plane + c) * capacity;
        std::copy(from + group.first, from + group.last, m_samples.surface.N[c] + group.first);
    }
    if (frame.instances[group.instance].bent) carry_normals(frame, group);
}

/// Of the planes, the directions to world space.
void TileRenderer::turn_directions(const FrameContext& frame, const Group& group) {
    int plane = 0;
    for (const ChannelInfo& channel : shading_of(frame, group).shader->info().channels) {
        const int first = plane;
        plane += channel.components;
        if (channel.kind != ChannelKind::direction) continue;
        float* const x = m_planes.data() + first * capacity;
        if (frame.instances[group.instance].bent) carry_directions(frame, group, x);
        wide([=, m = glm::mat3(frame.instances[group.instance].world_from_object)]() ESTARA_LOOP {
#pragma GCC ivdep
            for (int j = group.first; j < group.last; ++j) {
                const glm::vec3 v = m * glm::vec3(x[j], x[capacity + j], x[2 * capacity + j]);
                const float square = glm::dot(v, v);
                const bool usual = (square > least_square) & (square < largest_square);
                const float scale = 1.0f / std::sqrt(usual ? square : 1.0f);
                x[j] = v.x * scale;
                x[capacity + j] = v.y * scale;
                x[2 * capacity + j] = v.z * scale;
            }
        });
    }
}

/// Fills m_planes, rows by sample.
void TileRenderer::evaluate(const FrameContext& frame, const Group& group) {
    const ObjectShading& shading = shading_of(frame, group);
    reserve_planes(shading.shader->info());
    const Stopwatch time;
    if (shading.pyramid) {
        look_up(frame, group, shading);
    } else {
        m_samples.surface.filter_width = shading.filter_width;
        shading.shader->bake(m_samples.surface, group.first, group.last, m_planes.data());
    }
    const double seconds = time.seconds();
    statistics.evaluation_seconds += seconds;
    ObjectCost& cost = cost_of(frame, group);
    cost.evaluation += seconds;
    cost.evaluated += std::uint64_t(group.last - group.first);
}

// The footprint is the minor axis of what a sample covers: at grazing angles it is not divided by
// the cosine. The major axis would blur the texture across as well as along.
void TileRenderer::find_footprints(const FrameContext& frame, const Group& group) {
    const float scale = frame.instances[group.instance].largest_scale;
    const float width_at_1 =
        frame.camera.pixel_angle() / std::sqrt(float(frame.pattern.size())) / scale;
    m_footprints.resize(std::size_t(group.last - group.first));
    for (std::size_t i = 0; i < m_footprints.size(); ++i) {
        m_footprints[i] = m_samples.distance[std::size_t(group.first) + i] * width_at_1;
    }
    const BentMesh* const bent = frame.instances[group.instance].bent;
    if (!bent) return;
    for (std::size_t i = 0; i < m_footprints.size(); ++i) {
        m_footprints[i] /= bent->stretch[m_samples.site[std::size_t(group.first) + i].triangle];
    }
}

void TileRenderer::look_up(const FrameContext& frame, const Group& group,
                           const ObjectShading& shading) {
    find_footprints(frame, group);
    shading.pyramid->lookup(m_samples.surface.P[0] + group.first, m_footprints,
                            m_planes.data() + group.first, capacity, m_found.data());
    const int size = group.last - group.first;
    m_missed.clear();
    for (int i = 0; i < size; ++i) {
        if (!m_found[std::size_t(i)]) m_missed.push_back(group.first + i);
    }
    statistics.lookups += std::uint64_t(size);
    statistics.misses += m_missed.size();
    if (m_missed.empty()) return;

    const auto object = std::size_t(frame.instances[group.instance].object);
    const Mesh& mesh = frame.scene.objects[object].mesh;
    m_missed_batch.size = 0;
    m_missed_batch.filter_width = shading.filter_width;
    for (const int j : m_missed) {
        const MeshPoint point = mesh_point_of(frame, group, j);
        m_missed_batch.set(m_missed_batch.size++, point.P, point.N, point.uv, tangent(mesh, point));
    }
    m_missed_planes.resize(m_planes.size());
    shading.shader->bake(m_missed_batch, m_missed_planes.data());
    for (std::size_t m = 0; m < m_missed.size(); ++m) {
        for (int k = 0; k < shading.pyramid->floats(); ++k) {
            m_planes[std::size_t(k * capacity + m_missed[m])] =
                m_missed_planes[std::size_t(k * capacity) + m];
        }
    }
}

}  // namespace estara
