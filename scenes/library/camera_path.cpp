#include "camera_path.h"

#include <algorithm>
#include <vector>

#include "keys.h"

namespace estara::examples {

Shot shot_at(std::span<const Shot> shots, double part) {
    const int last = int(shots.size()) - 1;
    const auto control = [&](int i) { return shots[std::size_t(std::clamp(i - 2, 0, last))]; };
    const int spans = last + 2;
    const int i = std::clamp(int(part * spans), 0, spans - 1);
    const double t = part * spans - i, s = 1.0 - t;
    const double a = s * s * s / 6.0, d = t * t * t / 6.0;
    const double b = (3.0 * t * t * t - 6.0 * t * t + 4.0) / 6.0;
    const double weights[]{a, b, 1.0 - a - b - d, d};
    glm::dvec3 eye(0.0), aim(0.0);
    for (int k = 0; k < 4; ++k) {
        eye += weights[k] * glm::dvec3(control(i + k).eye);
        aim += weights[k] * glm::dvec3(control(i + k).aim);
    }
    return {eye, aim};
}

void add_walking_camera(GlbBuilder& out, double yfov, std::span<const Shot> shots) {
    std::vector<glm::vec3> eyes;
    std::vector<glm::quat> turns;
    for (int f = 0; f < path_frames; ++f) {
        const Shot shot = shot_at(shots, double(f) / (path_frames - 1));
        eyes.push_back(shot.eye);
        turns.push_back(looking_along(shot.aim - shot.eye));
    }
    const int node = out.add_camera("camera", yfov, {eyes.front(), turns.front()});
    const std::vector<float> times = frame_times(path_frames);
    out.animate_translation(node, times, eyes);
    out.animate_rotation(node, times, turns);
}

}  // namespace estara::examples
