// What each object is rendered with: its shader, its grid, its filter width.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "estara/render/frame.h"
#include "estara/render/options.h"
#include "estara/render/reuse_model.h"
#include "estara/render/textures.h"

namespace estara {

/// What strategy auto has measured of an object, and chosen (strategy.h).
struct StrategyChoice {
    Strategy chosen = Strategy::direct;
    SampleTimes times;
    double cost = 0.0;          ///< predicted seconds a sample as chosen, rays to the eye left out
    double lookup = 0.0;        ///< seconds a sample from its grid; 0 without one
    double frames = 1.0;        ///< that a point serves
    double speedup = 1.0;       ///< of reuse over them, predicted
    std::uint64_t samples = 0;  ///< that this was measured on; 0: not seen
};

/// For the user: how an object was rendered.
struct ObjectRecord {
    std::string object, shader, params;
    Strategy strategy;
    float filter_width;
    std::string grid_file;  ///< "" and 0 without a grid
    double voxel_size = 0.0;
    int levels = 0;
    std::uint64_t grid_bytes = 0;            ///< in memory
    std::optional<StrategyChoice> choice{};  ///< with --strategy auto
};

/// By object.
struct Wardrobe {
    std::vector<ObjectShading> chosen;  ///< as --strategy says
    std::vector<ObjectShading> direct;  ///< the same without grids and cache
    std::vector<ObjectRecord> records;
};

/// Whether the cache keeps light and shadows: as --cache-light says, or if only cameras move. Error
/// if it is to and they change.
bool keeps_light(const Scene& scene, const Options& options);

/// A cache for the objects of `shading` that are cached; null if none is.
std::unique_ptr<ReuseCache> make_cache(const Scene& scene, const Options& options,
                                       const std::vector<ObjectShading>& shading);

/// Puts --shader on the objects that wear none. Error for an unknown shader or parameter.
void put_on(Scene& scene, const std::string& shader, const std::vector<Setting>& params);

/// Reads the grids, finds their objects and flattens the ones that are used.
///
/// The filter width of an object with a grid is the grid's voxel, also for direct evaluation: both
/// then have the same octaves. Without one it is direct_filter_widths(). `say` is told what stays
/// without a grid, and the warnings of match_grids().
/// @param camera  index into Scene::cameras
/// @param range   all that are asked for: what --resume finds done must not change the choice
Wardrobe dress(Scene& scene, RayScene& rays, const Options& options, int camera,
               const FrameRange& range, const Say& say);

/// Half the smallest footprint of a pixel on each object, at least 1/16384 of the object's
/// diagonal; 1/512 of the diagonal for an object that is never seen. Object space, by object.
///
/// Looks at the whole animation (at most 256 of its frames, evenly spread), not at the frames to be
/// rendered: each frame of an animation may be a job of its own, and a texture must not change
/// from one to the next.
std::vector<float> direct_filter_widths(const Scene& scene, RayScene& rays, int camera, double fps,
                                        int width, int height);

}  // namespace estara
