// How much pictures of an animation change that should not.
#pragma once

#include <glm/glm.hpp>

#include <cstdint>
#include <vector>

#include "estara/render/film.h"
#include "estara/scenes/ray_scene.h"
#include "estara/scenes/scene.h"

namespace estara {

/// For each pixel, row by row, where the surface that its centre sees was in an earlier frame:
/// pixels, as Camera::primary_ray() takes them; NaN where it was not seen, or where the four pixels
/// around that place do not all see the same instance nearby.
/// @param rays  is moved
/// @param camera  index into Scene::cameras
/// @param before, now  seconds
std::vector<glm::vec2> motion(const Scene& scene, RayScene& rays, int camera, double before,
                              double now, int width, int height);

/// Of D = (I_t - warp I_{t-1}) - (R_t - warp R_{t-1}), R the reference: what of a picture's change
/// along the motion is not the reference's. Over R, G, B of the pixels whose motion is known;
/// linear, exposure included.
struct Flicker {
    double rms = 0.0;
    double p99 = 0.0;          ///< 99 % of |D| are at most this
    std::uint64_t pixels = 0;  ///< with known motion
};

/// Films of one size; warps are bilinear. Blur lowers flicker too: to be told beside an RMSE.
Flicker flicker(const Film& before, const Film& now, const Film& reference_before,
                const Film& reference_now, const std::vector<glm::vec2>& motion);

/// RMS of several pairs of frames together, p99 of the worst. At least one.
Flicker pooled(const std::vector<Flicker>& flickers);

}  // namespace estara
