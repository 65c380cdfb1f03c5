// One picture of a scene.
#pragma once

#include <glm/glm.hpp>

#include <cstdint>
#include <functional>
#include <memory>
#include <vector>

#include "estara/grids/bricks.h"
#include "estara/render/film.h"
#include "estara/render/reuse_cache.h"
#include "estara/scenes/ray_scene.h"
#include "estara/scenes/scene.h"

namespace estara {

/// What one object is rendered with.
struct ObjectShading {
    BoundShaderPtr shader;
    std::shared_ptr<const BrickPyramid> pyramid;  ///< its baked values; null: evaluated directly
    float filter_width = 1.0f;                    ///< of direct evaluation, object space, > 0
    /// Baked diffuse light, shadows included (grids/README.md, "Irradiance"); null: from the
    /// lights.
    std::shared_ptr<const BrickPyramid> irradiance{};
    bool cached = false;  ///< its hit points are kept from frame to frame
};

struct FrameSettings {
    int width = 640, height = 360;  ///< pixels
    int spp = 4;                    ///< samples a pixel, >= 1
    std::uint32_t seed = 0;         ///< shifts the sample pattern
    float exposure = 0.0f;          ///< EV: colours times 2^exposure
    bool shadows = true;            ///< false: nothing casts a shadow, whatever the lights say
    bool test_all_points = false;   ///< every point of the cache for occlusion, not some of a pixel
    int tile_step = 1;              ///< only every so-many-th tile is rendered, for measuring
    Aovs aovs;
};

/// What a frame has done with the cache. Each sample of a frame is a hit, or a ray is traced for
/// it.
struct ReuseCounts {
    double projection_seconds = 0.0;  ///< of all points, summed over threads
    double listing_seconds = 0.0;     ///< finding and testing candidates, without rays, likewise
    double keeping_seconds = 0.0;     ///< making records, likewise
    double insertion_seconds = 0.0;   ///< taking them into the cache, one thread
    std::uint64_t slots = 0;          ///< samples of the whole image
    std::uint64_t rays = 0;           ///< from candidates to the eye
    std::uint64_t hits = 0;           ///< samples that a kept point stands in for
    std::uint64_t untested = 0;       ///< of the candidates, taken to be seen without a ray
    std::uint64_t misses = 0;         ///< samples without a point
    std::uint64_t occluded = 0;       ///< with one that something hides
    std::uint64_t turned = 0;         ///< with one that is seen from its other side
    std::uint64_t beside = 0;         ///< with one at an outline, of a surface that it does not see
    std::uint64_t refilled = 0;       ///< the last four: what the sample's own ray meets is shaded
    std::uint64_t kept = 0;           ///< points taken into the cache
    std::uint64_t refused = 0;        ///< points for which all of it was in use
    std::uint64_t evicted = 0;        ///< points that made room, the least recently used
    std::uint64_t records = 0;        ///< in the cache after the frame
    std::uint64_t bytes = 0;          ///< of its pages in use, after the frame
    std::uint64_t table_bytes = 0;    ///< beside them: which point is for which sample, new records

    /// Without finding candidates, which is part of the evaluation.
    double seconds() const noexcept {
        return projection_seconds + keeping_seconds + insertion_seconds;
    }

    ReuseCounts& operator+=(const ReuseCounts& other) noexcept;
};

/// What the view-independent part of one object has cost in a frame. Seconds, summed over threads.
struct ObjectCost {
    double evaluation = 0.0, recall = 0.0, keep = 0.0, view = 0.0;
    std::uint64_t evaluated = 0;  ///< samples that were baked or looked up
    std::uint64_t recalled = 0;   ///< and those from the cache
    std::uint64_t kept = 0;

    ObjectCost& operator+=(const ObjectCost& other) noexcept;
};

/// What a frame has cost. Times in seconds; those of stages are summed over threads.
struct FrameStatistics {
    double seconds = 0.0;             ///< wall time of the whole frame
    double evaluation_seconds = 0.0;  ///< the view-independent part: bake(), lookups, recalling
    double light_seconds = 0.0;       ///< light on the samples, without its rays
    double view_seconds = 0.0;        ///< the view-dependent part: view()
    double ray_seconds = 0.0;         ///< primary and shadow rays
    std::uint64_t primary_rays = 0, shadow_rays = 0;
    std::uint64_t samples = 0;             ///< shaded surface points
    std::uint64_t lookups = 0;             ///< of them, those looked up in a grid
    std::uint64_t irradiance_lookups = 0;  ///< samples whose light was looked up, or masked
    std::uint64_t misses = 0;      ///< lookups that found no brick and were evaluated directly
    std::uint64_t bad_pixels = 0;  ///< NaN or infinite, written as 0

    double geometry_seconds = 0.0;           ///< moving and bending what rays meet, wall time
    std::uint64_t refits = 0, rebuilds = 0;  ///< ray structures of bent meshes
    std::uint64_t lit = 0;        ///< samples whose light was computed, shadow rays included
    double shadow_seconds = 0.0;  ///< of ray_seconds, those of shadow rays
    ReuseCounts reuse;
    std::vector<ObjectCost> objects;

    FrameStatistics& operator+=(const FrameStatistics& other) noexcept;
};

/// Renders frames of one scene, keeping its threads' working memory from frame to frame.
class FrameRenderer {
public:
    /// Both must outlive this; `rays` is moved by every render().
    FrameRenderer(const Scene& scene, RayScene& rays, const FrameSettings& settings);
    ~FrameRenderer();
    FrameRenderer(const FrameRenderer&) = delete;
    FrameRenderer& operator=(const FrameRenderer&) = delete;

    /// Tiles of a frame, for progress.
    int tile_count() const noexcept;

    /// Renders one frame, tiles in parallel. The same bits for any number of threads. One caller at
    /// a time.
    /// @param shading    by object
    /// @param camera     index into Scene::cameras
    /// @param time       seconds
    /// @param film       of the settings' size and AOVs
    /// @param tile_done  called by any thread after each tile; may be empty
    /// @param cache      points of cached objects are recalled from it and kept in it; null: none
    FrameStatistics render(const std::vector<ObjectShading>& shading, int camera, double time,
                           Film& film, const std::function<void()>& tile_done,
                           ReuseCache* cache = nullptr);

private:
    struct Impl;
    std::unique_ptr<Impl> m_impl;
};

}  // namespace estara
