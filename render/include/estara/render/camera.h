// The eye of one frame: rays into the scene and directions back.
#pragma once

#include <glm/glm.hpp>

#include "estara/scenes/ray_scene.h"
#include "estara/scenes/scene.h"
#include "estara/shaders/seen.h"

namespace estara {

/// A point as the eye sees it.
struct Sight {
    ViewDirection V;
    float distance;  ///< world units
};

/// A pinhole camera at one time, with an image of one size. The only maker of ViewDirection.
class Camera {
public:
    /// @param width, height  image size, pixels, >= 1
    Camera(const PinholePose& pose, int width, int height) noexcept
        : m_pose(pose), m_width(width), m_height(height) {}

    /// The ray through the image at (x, y) in pixels, (0, 0) the upper left corner. Its direction
    /// has 1 along the viewing axis, so t of a hit is not the distance.
    Ray primary_ray(float x, float y) const noexcept;

    /// The way from a point, world space, to the eye. At the eye itself, where there is none, V is
    /// the way back along the viewing axis.
    Sight sight(const glm::vec3& P) const noexcept;

    /// The rays through n points of the image, as primary_ray().
    /// @param n  at most RayBatch::capacity
    void primary_rays(const float* x, const float* y, int n, RayBatch& rays) const noexcept;

    /// sight() of points [first, last), given as three planes of batch_capacity floats.
    void sights(const float* P, int first, int last, ViewDirections& V,
                float* distance) const noexcept;

    const PinholePose& pose() const noexcept { return m_pose; }
    const glm::vec3& eye() const noexcept { return m_pose.eye; }

    /// Angle between neighbouring pixels at the image centre, radians.
    float pixel_angle() const noexcept { return m_pose.pixel_angle(m_height); }

private:
    PinholePose m_pose;
    int m_width, m_height;
};

}  // namespace estara
