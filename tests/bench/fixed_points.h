// Shading alone: the same hit points for a number of camera positions, without rays.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "estara/render/camera.h"
#include "estara/render/reuse_cache.h"
#include "estara/render/reuse_model.h"
#include "estara/scenes/scene.h"

namespace estara::bench {

/// The points of one object that its scene's first camera position sees. Both ways of shading them
/// are the renderer's: the shader's loops, the light loops, records of a ReuseCache.
class FixedPoints {
public:
    /// @param object  by name
    FixedPoints(const Scene& scene, const std::string& object);
    ~FixedPoints();

    std::size_t count() const noexcept;

    /// NOREUSE: everything for every camera position (frames 1 to n).
    void without_reuse(int n);
    /// REUSE: record and light in the first position, recalled in the others.
    void with_reuse(int n);
    /// Of the colours at the last camera position of with_reuse() to those of without_reuse().
    double rmse() const;

    /// Seconds of one point, each part timed on its own over all points, one thread.
    SampleTimes times();

private:
    struct Impl;
    std::unique_ptr<Impl> m_impl;
};

}  // namespace estara::bench
