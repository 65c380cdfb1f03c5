#include "estara/render/frame.h"

#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_pipeline.h>
#include <tbb/task_arena.h>

#include <mutex>

#include "estara/render/sampling.h"
#include "estara/scenes/program.h"
#include "reprojection.h"
#include "tile.h"

namespace estara {

FrameStatistics& FrameStatistics::operator+=(const FrameStatistics& other) noexcept {
    seconds += other.seconds;
    evaluation_seconds += other.evaluation_seconds;
    light_seconds += other.light_seconds;
    view_seconds += other.view_seconds;
    ray_seconds += other.ray_seconds;
    primary_rays += other.primary_rays;
    shadow_rays += other.shadow_rays;
    samples += other.samples;
    lookups += other.lookups;
    irradiance_lookups += other.irradiance_lookups;
    misses += other.misses;
    bad_pixels += other.bad_pixels;
    geometry_seconds += other.geometry_seconds;
    refits += other.refits;
    rebuilds += other.rebuilds;
    lit += other.lit;
    shadow_seconds += other.shadow_seconds;
    reuse += other.reuse;
    if (objects.size() < other.objects.size()) objects.resize(other.objects.size());
    for (std::size_t o = 0; o < other.objects.size(); ++o) objects[o] += other.objects[o];
    return *this;
}

ObjectCost& ObjectCost::operator+=(const ObjectCost& other) noexcept {
    evaluation += other.evaluation;
    recall += other.recall;
    keep += other.keep;
    view += other.view;
    evaluated += other.evaluated;
    recalled += other.recalled;
    kept += other.kept;
    return *this;
}

ReuseCounts& ReuseCounts::operator+=(const ReuseCounts& other) noexcept {
    projection_seconds += other.projection_seconds;
    listing_seconds += other.listing_seconds;
    keeping_seconds += other.keeping_seconds;
    insertion_seconds += other.insertion_seconds;
    slots += other.slots;
    rays += other.rays;
    hits += other.hits;
    untested += other.untested;
    misses += other.misses;
    occluded += other.occluded;
    turned += other.turned;
    beside += other.beside;
    refilled += other.refilled;
    kept += other.kept;
    refused += other.refused;
    evicted += other.evicted;
    records += other.records;
    bytes += other.bytes;
    table_bytes += other.table_bytes;
    return *this;
}

struct FrameRenderer::Impl {
    const Scene& scene;
    RayScene& rays;
    FrameSettings settings;
    std::vector<glm::vec2> pattern;
    std::vector<std::vector<glm::vec3>> face_normals;  ///< by object
    std::vector<std::vector<glm::vec3>> tangents;      ///< by object, of those that wear dPdu
    tbb::enumerable_thread_specific<TileRenderer> tiles;
    std::unique_ptr<Reprojection> reprojection;        ///< once a cache is used
    std::vector<std::unique_ptr<NewRecords>> buffers;  ///< what tiles have found, on its way

    /// @param number  of [0, tile_count())
    void render_tile(const FrameContext& frame, int number, Film& film, NewRecords& found) {
        tiles.local().render(frame, number * settings.tile_step, film, found);
    }
    void render_and_keep(const FrameContext& frame, int count, ReuseCache& cache, Film& film,
                         const std::function<void()>& tile_done, ReuseCounts& counts);

    TileGrid grid() const { return {settings.width, settings.height}; }
};

FrameRenderer::FrameRenderer(const Scene& scene, RayScene& rays, const FrameSettings& settings)
    : m_impl(new Impl{
          scene, rays, settings, sample_pattern(settings.spp, settings.seed), {}, {}, {}, {}, {}}) {
    m_impl->face_normals.resize(scene.objects.size());
    m_impl->tangents.resize(scene.objects.size());
    tbb::parallel_for(std::size_t{0}, scene.objects.size(), [&](std::size_t i) {
        const Object& object = scene.objects[i];
        m_impl->face_normals[i] = face_normals(object.mesh);
        if (object.shader->domain() != Domain::surface) return;
        m_impl->tangents[i].resize(object.mesh.triangles.size());
        for (std::uint32_t t = 0; t < object.mesh.triangles.size(); ++t) {
            m_impl->tangents[i][t] = face_tangent(object.mesh, t);
        }
    });
}

FrameRenderer::~FrameRenderer() = default;

int FrameRenderer::tile_count() const noexcept {
    return (m_impl->grid().count() - 1) / m_impl->settings.tile_step + 1;
}

/// Tiles in parallel; what they find goes into the cache in the order of the tiles, so that its
/// contents do not depend on the threads. A few tiles at a time wait for their turn.
void FrameRenderer::Impl::render_and_keep(const FrameContext& frame, int count, ReuseCache& cache,
                                          Film& film, const std::function<void()>& tile_done,
                                          ReuseCounts& counts) {
    const auto most = std::size_t(2 * tbb::this_task_arena::max_concurrency());
    while (buffers.size() < most) buffers.push_back(std::make_unique<NewRecords>());
    int next = 0;
    std::vector<NewRecords*> free;
    for (const auto& buffer : buffers) free.push_back(buffer.get());
    std::mutex free_mutex;
    struct Tile {
        int number;
        NewRecords* found;
    };
    const auto begin = [&](tbb::flow_control& control) -> Tile {
        if (next == count) {
            control.stop();
            return {};
        }
        const std::lock_guard lock(free_mutex);
        NewRecords* const found = free.back();
        free.pop_back();
        found->clear();
        return {next++, found};
    };
    const auto render = [&](Tile tile) {
        render_tile(frame, tile.number, film, *tile.found);
        if (tile_done) tile_done();
        return tile;
    };
    const auto keep = [&](Tile tile) {
        const Stopwatch time;
        const float* floats = tile.found->floats.data();
        for (const int instance : tile.found->instances) {
            ++(cache.add(instance, floats) ? counts.kept : counts.refused);
            floats += cache.layout(instance).floats();
        }
        counts.insertion_seconds += time.seconds();
        const std::lock_guard lock(free_mutex);
        free.push_back(tile.found);
    };
    using tbb::filter_mode;
    tbb::parallel_pipeline(most,
                           tbb::make_filter<void, Tile>(filter_mode::serial_in_order, begin) &
                               tbb::make_filter<Tile, Tile>(filter_mode::parallel, render) &
                               tbb::make_filter<Tile, void>(filter_mode::serial_in_order, keep));
}

FrameStatistics FrameRenderer::render(const std::vector<ObjectShading>& shading, int camera,
                                      double time, Film& film,
                                      const std::function<void()>& tile_done, ReuseCache* cache) {
    const Stopwatch whole;
    Impl& my = *m_impl;
    const SceneCamera& scene_camera = my.scene.cameras[std::size_t(camera)];
    const glm::dvec3 origin = place_of(my.scene, scene_camera.node, time);
    const Pose pose = pose_at(my.scene, time, origin);
    my.rays.set_pose(pose);
    const std::vector<PosedInstance> instances = pose_instances(my.scene, pose);
    const std::vector<PosedLight> lights = posed_lights(my.scene, pose);
    const PinholePose eye = pinhole_pose(my.scene, scene_camera, pose);
    FrameStatistics statistics;
    statistics.geometry_seconds = my.rays.last_update().seconds;
    statistics.refits = std::uint64_t(my.rays.last_update().refits);
    statistics.rebuilds = std::uint64_t(my.rays.last_update().rebuilds);
    if (cache != nullptr) {
        if (!my.reprojection) my.reprojection = std::make_unique<Reprojection>(my.settings);
        my.reprojection->start(*cache, eye, instances);
        statistics.reuse.projection_seconds = my.reprojection->seconds();
        statistics.reuse.slots = my.reprojection->slots();
    }
    const FrameContext context{my.scene,
                               my.rays,
                               Camera(eye, my.settings.width, my.settings.height),
                               origin,
                               instances,
                               lights,
                               shading,
                               my.face_normals,
                               my.tangents,
                               my.pattern,
                               moments_of(my.pattern),
                               my.settings,
                               cache != nullptr ? my.reprojection.get() : nullptr};

    for (TileRenderer& tile : my.tiles) tile.statistics = {};
    if (cache != nullptr) {
        my.render_and_keep(context, tile_count(), *cache, film, tile_done, statistics.reuse);
    } else {
        NewRecords none;
        tbb::parallel_for(0, tile_count(), [&](int i) {
            my.render_tile(context, i, film, none);
            if (tile_done) tile_done();
        });
    }

    for (const TileRenderer& tile : my.tiles) statistics += tile.statistics;
    if (cache != nullptr) {
        statistics.reuse.evicted = cache->evicted();
        statistics.reuse.records = cache->records();
        statistics.reuse.bytes = cache->bytes();
        statistics.reuse.table_bytes = my.reprojection->bytes() + cache->table_bytes();
        for (const auto& buffer : my.buffers) statistics.reuse.table_bytes += buffer->bytes();
    }
    statistics.seconds = whole.seconds();
    return statistics;
}

}  // namespace estara
