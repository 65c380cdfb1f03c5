#include "estara/render/frame.h"

#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>

#include "estara/render/sampling.h"
#include "estara/scenes/program.h"
#include "tile.h"

namespace estara {

FrameStatistics& FrameStatistics::operator+=(const FrameStatistics& other) noexcept {
    seconds += other.seconds;
    evaluation_seconds += other.evaluation_seconds;
    view_seconds += other.view_seconds;
    ray_seconds += other.ray_seconds;
    primary_rays += other.primary_rays;
    shadow_rays += other.shadow_rays;
    samples += other.samples;
    lookups += other.lookups;
    irradiance_lookups += other.irradiance_lookups;
    misses += other.misses;
    bad_pixels += other.bad_pixels;
    return *this;
}

struct FrameRenderer::Impl {
    const Scene& scene;
    RayScene& rays;
    FrameSettings settings;
    std::vector<glm::vec2> pattern;
    std::vector<std::vector<glm::vec3>> face_normals;  ///< by object
    tbb::enumerable_thread_specific<TileRenderer> tiles;

    int columns() const { return (settings.width - 1) / TileRenderer::width + 1; }
    int rows() const { return (settings.height - 1) / TileRenderer::height + 1; }
};

FrameRenderer::FrameRenderer(const Scene& scene, RayScene& rays, const FrameSettings& settings)
    : m_impl(new Impl{scene, rays, settings, sample_pattern(settings.spp, settings.seed), {}, {}}) {
    m_impl->face_normals.resize(scene.objects.size());
    tbb::parallel_for(std::size_t{0}, scene.objects.size(), [&](std::size_t i) {
        m_impl->face_normals[i] = face_normals(scene.objects[i].mesh);
    });
}

FrameRenderer::~FrameRenderer() = default;

int FrameRenderer::tile_count() const noexcept { return m_impl->columns() * m_impl->rows(); }

FrameStatistics FrameRenderer::render(const std::vector<ObjectShading>& shading, int camera,
                                      double time, Film& film,
                                      const std::function<void()>& tile_done) {
    const Stopwatch whole;
    Impl& my = *m_impl;
    const Pose pose = pose_at(my.scene, time);
    my.rays.set_pose(pose);
    const std::vector<PosedInstance> instances = pose_instances(my.scene, pose);
    const std::vector<PosedLight> lights = posed_lights(my.scene, pose);
    const FrameContext context{
        my.scene,
        my.rays,
        Camera(pinhole_pose(my.scene, my.scene.cameras[std::size_t(camera)], pose),
               my.settings.width, my.settings.height),
        instances,
        lights,
        shading,
        my.face_normals,
        my.pattern,
        my.settings};

    for (TileRenderer& tile : my.tiles) tile.statistics = {};
    tbb::parallel_for(0, tile_count(), [&](int i) {
        const glm::ivec2 corner(i % my.columns() * TileRenderer::width,
                                i / my.columns() * TileRenderer::height);
        my.tiles.local().render(context, corner, film);
        if (tile_done) tile_done();
    });

    FrameStatistics statistics;
    for (const TileRenderer& tile : my.tiles) statistics += tile.statistics;
    statistics.seconds = whole.seconds();
    return statistics;
}

}  // namespace estara
