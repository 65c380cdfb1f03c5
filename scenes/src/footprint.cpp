// What the camera path needs of each object's resolution.
#include <tbb/blocked_range.h>
#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "estara/scenes/matrix.h"
#include "estara/scenes/ray_scene.h"

namespace estara {

namespace {

constexpr float infinity = std::numeric_limits<float>::infinity();
constexpr int stride = 4;  // pixels between samples

/// One thread's rays of one row of samples, and the smallest footprints it has met.
struct Worker {
    std::vector<Ray> rays;
    std::vector<Hit> hits;
    std::vector<float> smallest;  ///< by object
};

/// One frame: what turns a hit into a footprint.
struct View {
    PinholePose camera;
    std::vector<float> footprint_per_distance;  ///< by instance, object space over world distance
    const Pose& pose;

    /// Object space: what is stretched shows its pattern the larger for it.
    float footprint(const Hit& hit, float distance) const {
        const float there = distance * footprint_per_distance[hit.instance];
        const BentMesh* const bent = pose.bent[hit.instance].get();
        return bent ? there / bent->stretch[hit.triangle] : there;
    }
};

View view_at(const Scene& scene, const SceneCamera& camera, const Pose& pose, int height) {
    View view{pinhole_pose(scene, camera, pose), {}, pose};
    const double pixel_angle = view.camera.pixel_angle(height);
    for (const glm::mat4& world_from_object : pose.world_from_instance) {
        const double stretch = largest_singular_value(glm::dmat3(glm::mat3(world_from_object)));
        view.footprint_per_distance.push_back(float(pixel_angle / stretch));
    }
    return view;
}

void trace_row(const Scene& scene, const RayScene& rays, const View& view, int y, int width,
               int height, Worker& worker) {
    worker.rays.clear();
    for (int x = 0; x < width; x += stride) {
        const glm::vec3 direction =
            view.camera.direction(float(x) + 0.5f, float(y) + 0.5f, width, height);
        worker.rays.push_back({view.camera.eye, direction, 0.0f, infinity});
    }
    worker.hits.resize(worker.rays.size());
    rays.intersect(worker.rays, worker.hits.data());
    for (std::size_t i = 0; i < worker.hits.size(); ++i) {
        const Hit& hit = worker.hits[i];
        if (hit.instance == Hit::none) continue;
        const float distance = hit.t * glm::length(worker.rays[i].direction);
        float& smallest = worker.smallest[scene.instances[hit.instance].object];
        smallest = std::min(smallest, view.footprint(hit, distance));
    }
}

}  // namespace

std::vector<float> smallest_footprints(const Scene& scene, RayScene& rays, int camera,
                                       const FrameRange& frames, double fps, int width,
                                       int height) {
    const std::vector<float> unseen(scene.objects.size(), infinity);
    tbb::enumerable_thread_specific<Worker> workers(Worker{{}, {}, unseen});
    const int rows = (height + stride - 1) / stride;
    for (int f = 0; f < frames.count(); ++f) {
        const double time = frames.at(f) / fps;
        const SceneCamera& eye = scene.cameras[camera];
        const Pose pose = pose_at(scene, time, place_of(scene, eye.node, time));
        rays.set_pose(pose);
        const View view = view_at(scene, eye, pose, height);
        tbb::parallel_for(tbb::blocked_range<int>(0, rows), [&](const auto& range) {
            Worker& worker = workers.local();
            for (int row = range.begin(); row < range.end(); ++row)
                trace_row(scene, rays, view, row * stride, width, height, worker);
        });
    }
    std::vector<float> smallest = unseen;
    for (const Worker& worker : workers)
        for (std::size_t i = 0; i < smallest.size(); ++i)
            smallest[i] = std::min(smallest[i], worker.smallest[i]);
    return smallest;
}

std::vector<double> automatic_voxel_sizes(const Scene& scene, RayScene& rays, int camera,
                                          const FrameRange& frames, double fps, int width,
                                          int height) {
    // A key at the end of a day would otherwise take a day.
    constexpr int most_frames = 256;
    FrameRange looked_at = frames;
    if (frames.count() > most_frames) {
        const int stride = (frames.count() + most_frames - 1) / most_frames;
        looked_at = {frames.first, frames.last, frames.step * stride};
        for (int i = 0; i < frames.count() && !frames.list.empty(); i += stride) {
            looked_at.list.push_back(frames.at(i));
        }
    }
    const std::vector<float> footprints =
        smallest_footprints(scene, rays, camera, looked_at, fps, width, height);
    std::vector<double> sizes;
    for (std::size_t i = 0; i < footprints.size(); ++i) {
        const Mesh& mesh = scene.objects[i].mesh;
        const double diagonal = bounds(mesh).diagonal();
        const double wanted =
            std::isfinite(footprints[i]) ? 0.5 * double(footprints[i]) : diagonal / 512.0;
        const double finest = std::max(diagonal / 16384.0, finest_voxel_size(mesh));
        const double size = std::clamp(wanted, finest, std::max(finest, diagonal / 32.0));
        sizes.push_back(size > 0.0 ? size : 1.0);
    }
    return sizes;
}

}  // namespace estara
