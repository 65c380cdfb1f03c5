// What each object is rendered with: its shader, its grid, its filter width.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "estara/render/frame.h"
#include "estara/render/options.h"
#include "estara/render/textures.h"

namespace estara {

/// For the user: how an object was rendered.
struct ObjectRecord {
    std::string object, shader, params;
    Strategy strategy;
    float filter_width;
    std::string grid_file;  ///< "" and 0 without a grid
    double voxel_size = 0.0;
    int levels = 0;
    std::uint64_t grid_bytes = 0;  ///< in memory
};

/// By object.
struct Wardrobe {
    std::vector<ObjectShading> chosen;  ///< as --strategy says
    std::vector<ObjectShading> direct;  ///< the same without grids
    std::vector<ObjectRecord> records;
};

/// Puts --shader on the objects that wear none. Error for an unknown shader or parameter.
void put_on(Scene& scene, const std::string& shader, const std::vector<Setting>& params);

/// Reads the grids, finds their objects and flattens the ones that are used.
///
/// The filter width of an object with a grid is the grid's voxel, also for direct evaluation: both
/// then have the same octaves. Without one it is direct_filter_widths(). `say` is told what stays
/// without a grid, and the warnings of match_grids().
/// @param camera  index into Scene::cameras
Wardrobe dress(Scene& scene, RayScene& rays, const Options& options, int camera, const Say& say);

/// Half the smallest footprint of a pixel on each object, at least 1/16384 of the object's
/// diagonal; 1/512 of the diagonal for an object that is never seen. Object space, by object.
///
/// Looks at the whole animation (at most 64 of its frames, evenly spread), not at the frames to be
/// rendered: each frame of an animation may be a job of its own, and a texture must not change
/// from one to the next.
std::vector<float> direct_filter_widths(const Scene& scene, RayScene& rays, int camera, double fps,
                                        int width, int height);

}  // namespace estara
