#include "fixed_points.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>

#include "estara/scenes/error.h"
#include "estara/scenes/matrix.h"
#include "estara/scenes/program.h"
#include "estara/scenes/ray_scene.h"
#include "estara/shaders/wide.h"
#include "raster.h"

namespace estara::bench {
namespace {

constexpr int capacity = batch_capacity;
constexpr Raster raster{1280, 720};
constexpr double fps = 24.0;
using Planes = float[3][capacity];

/// Points in the order in which tiles see them.
struct Points {
    SurfaceBatch surface;  ///< object space
    Planes Ng, P;          ///< object; world
};

ESTARA_KERNEL void put(Planes& planes, int i, const glm::vec3& v) noexcept {
    planes[0][i] = v.x;
    planes[1][i] = v.y;
    planes[2][i] = v.z;
}

/// What a thread shades with.
struct alignas(64) Work {
    SeenBatch seen;
    Planes N, Ci, gloss;
    float distance[capacity], cosine[capacity];
    std::vector<float> planes;
};

}  // namespace

struct FixedPoints::Impl {
    const Scene& scene;
    int instance = 0;
    const Object* object = nullptr;
    glm::mat3 world_from_normal{1.0f};
    glm::mat3 world_from_object{1.0f};
    float filter_width = 1.0f;
    RecordLayout layout;
    std::vector<std::unique_ptr<Points>> batches;
    std::size_t count = 0;
    std::vector<PosedLight> lights;
    std::unique_ptr<ReuseCache> cache;
    std::vector<std::vector<float>> rows;  ///< by batch, on their way into the cache
    std::vector<float> direct, reused;     ///< colours of the last position: batch, plane, point
    Work work;

    explicit Impl(const Scene& s) : scene(s) {}

    const BoundShader& shader() const { return *object->shader; }
    Camera camera(int frame) const {
        const Pose pose = pose_at(scene, frame / fps);
        return Camera(pinhole_pose(scene, scene.cameras.front(), pose), raster.width,
                      raster.height);
    }

    void collect() {
        RayScene rays(scene);
        const Camera eye = camera(1);
        rays.set_pose(pose_at(scene, 1 / fps));
        RayBatch some;
        HitBatch hits;
        for (int tile = 0; tile < raster.tiles(); ++tile) {
            raster.rays(eye, tile, some);
            rays.intersect(some, hits);
            for (int i = 0; i < some.size; ++i) {
                if (hits.instance[i] != std::uint32_t(instance)) continue;
                add(mesh_point(object->mesh, hits.triangle[i], hits.b1[i], hits.b2[i]));
            }
        }
        if (count == 0) throw Error("nothing of object " + object->name + " is seen");
    }

    void add(const MeshPoint& point) {
        if (batches.empty() || batches.back()->surface.size == capacity) {
            batches.push_back(std::make_unique<Points>());
            batches.back()->surface.filter_width = filter_width;
        }
        Points& to = *batches.back();
        const int i = to.surface.size++;
        to.surface.set(i, point.P, point.N, point.uv, tangent(object->mesh, point));
        const Pose pose = pose_at(scene, 0.0);
        const int node = scene.instances[std::size_t(instance)].node;
        const glm::vec3 P(pose.world_from_node[std::size_t(node)] * glm::vec4(point.P, 1.0f));
        for (int c = 0; c < 3; ++c) {
            to.Ng[c][i] = point.Ng[c];
            to.P[c][i] = P[c];
        }
        ++count;
    }

    /// The view-independent part but for light; N is what the light falls on, object space.
    void evaluate(const Points& points, Work& w) const {
        shader().bake(points.surface, w.planes.data());
        const int plane = normal_plane(shader().info());
        const float* const N = plane < 0 ? points.surface.N[0] : w.planes.data() + plane * capacity;
        std::copy_n(N, 3 * capacity, w.N[0]);
    }

    void to_world(int size, Work& w) const {
        wide([to = &w, size, m = world_from_normal]() ESTARA_LOOP {
#pragma GCC ivdep
            for (int i = 0; i < size; ++i) {
                const glm::vec3 N = m * glm::vec3(to->N[0][i], to->N[1][i], to->N[2][i]);
                put(to->seen.N, i, N / std::sqrt(glm::dot(N, N)));
            }
        });
        int plane = 0;
        for (const ChannelInfo& channel : shader().info().channels) {
            float* const x = w.planes.data() + plane * capacity;
            plane += channel.components;
            if (channel.kind != ChannelKind::direction) continue;
            wide([=, m = world_from_object]() ESTARA_LOOP {
#pragma GCC ivdep
                for (int i = 0; i < size; ++i) {
                    const glm::vec3 v = m * glm::vec3(x[i], x[capacity + i], x[2 * capacity + i]);
                    const float scale = 1.0f / std::sqrt(glm::dot(v, v));
                    x[i] = v.x * scale;
                    x[capacity + i] = v.y * scale;
                    x[2 * capacity + i] = v.z * scale;
                }
            });
        }
    }

    /// Light and the view-dependent part.
    /// @param sum_E  else E is there
    void shade(const Points& points, const Camera& eye, bool sum_E, Work& w, float* out) const {
        const int size = points.surface.size;
        eye.sights(points.P[0], 0, size, w.seen.V, w.distance);
        if (sum_E) std::fill_n(w.seen.E[0], 3 * capacity, 0.0f);
        std::fill_n(w.Ci[0], 3 * capacity, 0.0f);
        for (const PosedLight& light : lights) {
            if (!sum_E && !shader().glossy()) break;
            wide([light, size, sum_E, to = &w, P = points.P[0]]() ESTARA_LOOP {
#pragma GCC ivdep
                for (int i = 0; i < size; ++i) {
                    const FallingLight falling = falling_light(
                        light, glm::vec3(P[i], P[capacity + i], P[2 * capacity + i]),
                        glm::vec3(to->seen.N[0][i], to->seen.N[1][i], to->seen.N[2][i]));
                    put(to->seen.L, i, falling.L);
                    put(to->seen.Cl, i, falling.Cl);
                    to->cosine[i] = falling.cosine;
                }
                if (!sum_E) return;
#pragma GCC ivdep
                for (int i = 0; i < size; ++i) {
                    to->seen.E[0][i] += to->seen.Cl[0][i] * to->cosine[i];
                    to->seen.E[1][i] += to->seen.Cl[1][i] * to->cosine[i];
                    to->seen.E[2][i] += to->seen.Cl[2][i] * to->cosine[i];
                }
            });
            if (!shader().glossy()) continue;
            shader().view(w.planes.data(), w.seen, 0, size, true, w.gloss[0]);
            sum(size, w, w.Ci[0]);
        }
        w.seen.A = scene.ambient;
        shader().view(w.planes.data(), w.seen, 0, size, false, w.gloss[0]);
        sum(size, w, w.Ci[0]);
        std::copy_n(w.Ci[0], 3 * capacity, out);
    }

    static void sum(int size, Work& w, float* to) {
        wide([=, from = w.gloss[0]]() ESTARA_LOOP {
            for (int c = 0; c < 3; ++c) {
#pragma GCC ivdep
                for (int i = 0; i < size; ++i) to[c * capacity + i] += from[c * capacity + i];
            }
        });
    }

    void write_rows(const Points& points, const Work& w, std::vector<float>& to) const {
        const auto stride = std::size_t(layout.floats());
        to.resize(std::size_t(points.surface.size) * stride);
        for (int i = 0; i < points.surface.size; ++i) {
            float* const row = to.data() + std::size_t(i) * stride;
            for (int c = 0; c < 3; ++c) {
                row[RecordLayout::P + c] = points.surface.P[c][i];
                row[RecordLayout::N + c] = w.N[c][i];
                row[RecordLayout::Ng + c] = points.Ng[c][i];
                row[layout.E() + c] = w.seen.E[c][i];
            }
            for (int k = 0; k < layout.baked; ++k) {
                row[RecordLayout::first_baked + k] = w.planes[std::size_t(k * capacity + i)];
            }
            row[layout.sides()] = std::bit_cast<float>(~0u);
        }
    }

    void insert_rows() {
        for (std::vector<float>& batch : rows) {
            for (std::size_t i = 0; i < batch.size(); i += std::size_t(layout.floats())) {
                if (!cache->add(instance, batch.data() + i)) throw Error("the cache is too small");
            }
        }
    }

    void recall(const Points& points, std::size_t first, Work& w) const {
        const auto in_page = std::size_t(cache->page(0).capacity);
        const auto stride = std::size_t(layout.floats());
        for (int i = 0; i < points.surface.size;) {
            const std::size_t at = first + std::size_t(i), index = at % in_page;
            const float* row = cache->page(std::uint32_t(at / in_page)).record(int(index));
            const int end = std::min(points.surface.size, i + int(in_page - index));
            for (; i < end; ++i, row += stride) {
                for (int c = 0; c < 3; ++c) {
                    w.N[c][i] = row[RecordLayout::N + c];
                    w.seen.E[c][i] = row[layout.E() + c];
                }
                for (int k = 0; k < layout.baked; ++k) {
                    w.planes[std::size_t(k * capacity + i)] = row[RecordLayout::first_baked + k];
                }
            }
        }
    }

    Work& local() {
        work.planes.resize(std::size_t(shader().info().baked_floats) * capacity);
        return work;
    }

    static float* colours(std::vector<float>& of, std::size_t batch) {
        return of.data() + batch * 3 * capacity;
    }

    /// f(batch number, work), on this thread alone: shading knows no other threads, and a barrier
    /// after each camera position would cost the faster of two contenders more.
    template <class F>
    void for_batches(const F& f) {
        for (std::size_t b = 0; b < batches.size(); ++b) f(b, local());
    }
};

FixedPoints::FixedPoints(const Scene& scene, const std::string& name)
    : m_impl(std::make_unique<Impl>(scene)) {
    Impl& my = *m_impl;
    for (std::size_t i = 0; i < scene.instances.size(); ++i) {
        const Object& object = scene.objects[std::size_t(scene.instances[i].object)];
        if (object.name != name) continue;
        my.instance = int(i);
        my.object = &object;
    }
    if (my.object == nullptr) throw Error(scene.path + ": no object " + name);
    const Pose pose = pose_at(scene, 0.0);
    const glm::mat4& m =
        pose.world_from_node[std::size_t(scene.instances[std::size_t(my.instance)].node)];
    my.world_from_normal = glm::mat3(normal_matrix(glm::dmat3(glm::mat3(m))));
    my.world_from_object = glm::mat3(m);
    my.lights = posed_lights(scene, pose);
    my.filter_width = float(bounds(my.object->mesh).diagonal() / 512.0);
    my.layout = record_layout(my.shader().info(), int(my.lights.size()));
    my.collect();
    std::vector<RecordLayout> layouts(scene.objects.size(), my.layout);
    std::vector<int> objects;
    for (const Instance& instance : scene.instances) objects.push_back(instance.object);
    my.cache = std::make_unique<ReuseCache>(std::uint64_t{1} << 30, layouts, objects);
    my.rows.resize(my.batches.size());
    my.direct.resize(my.batches.size() * 3 * capacity);
    my.reused.resize(my.direct.size());
}

FixedPoints::~FixedPoints() = default;

std::size_t FixedPoints::count() const noexcept { return m_impl->count; }

void FixedPoints::without_reuse(int n) {
    Impl& my = *m_impl;
    for (int position = 0; position < n; ++position) {
        const Camera eye = my.camera(position + 1);
        my.for_batches([&](std::size_t b, Work& w) {
            const Points& points = *my.batches[b];
            my.evaluate(points, w);
            my.to_world(points.surface.size, w);
            my.shade(points, eye, true, w, Impl::colours(my.direct, b));
        });
    }
}

void FixedPoints::with_reuse(int n) {
    Impl& my = *m_impl;
    my.cache->clear();
    my.cache->start_frame();
    for (int position = 0; position < n; ++position) {
        const Camera eye = my.camera(position + 1);
        my.for_batches([&](std::size_t b, Work& w) {
            const Points& points = *my.batches[b];
            float* const out = Impl::colours(my.reused, b);
            if (position > 0) {
                my.recall(points, b * capacity, w);
                my.to_world(points.surface.size, w);
                return my.shade(points, eye, false, w, out);
            }
            my.evaluate(points, w);
            const std::vector<float> object_space = w.planes;
            my.to_world(points.surface.size, w);
            my.shade(points, eye, true, w, out);
            w.planes = object_space;
            my.write_rows(points, w, my.rows[b]);
        });
        if (position == 0) my.insert_rows();
    }
}

double FixedPoints::rmse() const {
    const Impl& my = *m_impl;
    double squares = 0.0;
    for (std::size_t b = 0; b < my.batches.size(); ++b) {
        for (std::size_t k = 0; k < 3 * capacity; ++k) {
            if (int(k % capacity) >= my.batches[b]->surface.size) continue;
            const std::size_t at = b * 3 * capacity + k;
            const double d = double(my.direct[at]) - double(my.reused[at]);
            squares += d * d;
        }
    }
    return std::sqrt(squares / (3.0 * double(my.count)));
}

SampleTimes FixedPoints::times() {
    Impl& my = *m_impl;
    const Camera eye = my.camera(1);
    Work& w = my.local();
    std::vector<float> out(3 * capacity);
    const auto seconds = [&](const auto& work) {
        std::vector<double> runs;
        for (int run = 0; run < 5; ++run) {
            const Stopwatch watch;
            for (std::size_t b = 0; b < my.batches.size(); ++b) work(b);
            runs.push_back(watch.seconds() / double(my.count));
        }
        std::sort(runs.begin(), runs.end());
        return runs[2];
    };
    const double all = seconds([&](std::size_t b) {
        my.evaluate(*my.batches[b], w);
        my.to_world(my.batches[b]->surface.size, w);
        my.shade(*my.batches[b], eye, true, w, out.data());
    });
    const double later = seconds([&](std::size_t b) {
        my.to_world(my.batches[b]->surface.size, w);
        my.shade(*my.batches[b], eye, false, w, out.data());
    });
    const double rows =
        seconds([&](std::size_t b) { my.write_rows(*my.batches[b], w, my.rows[b]); });
    my.cache->clear();
    my.cache->start_frame();
    const Stopwatch inserting;
    my.insert_rows();
    const double save = rows + inserting.seconds() / double(my.count);
    const double extract =
        seconds([&](std::size_t b) { my.recall(*my.batches[b], b * capacity, w); });
    return {all - later, later, save, extract};
}

}  // namespace estara::bench
