#include "estara/render/flicker.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "estara/render/camera.h"

namespace estara {
namespace {

/// What pixels' centres see.
class SeenCentres {
public:
    SeenCentres(const Scene& scene, RayScene& rays, int camera, double time,
                const glm::dvec3& origin, int width, int height)
        : m_scene(scene),
          m_pose(pose_at(scene, time, origin)),
          m_eye(pinhole_pose(scene, scene.cameras[std::size_t(camera)], m_pose)),
          m_width(width),
          m_height(height),
          m_hits(std::size_t(width) * std::size_t(height)) {
        rays.set_pose(m_pose);
        const Camera view(m_eye, width, height);
        std::vector<Ray> row(static_cast<std::size_t>(width));
        for (int y = 0; y < height; ++y) {
            for (int x = 0; x < width; ++x) {
                row[std::size_t(x)] = view.primary_ray(float(x) + 0.5f, float(y) + 0.5f);
            }
            rays.intersect(row, m_hits.data() + std::size_t(y) * std::size_t(width));
        }
    }

    const Hit& hit(int x, int y) const {
        return m_hits[std::size_t(y) * std::size_t(m_width) + std::size_t(x)];
    }
    /// Where this picture has what a ray has met in this one or another.
    glm::vec3 world(const Hit& hit) const {
        const std::vector<glm::vec3>& P = placed_vertices(m_scene, m_pose, hit.instance);
        const int object = m_scene.instances[hit.instance].object;
        const glm::uvec3 t = m_scene.objects[std::size_t(object)].mesh.triangles[hit.triangle];
        const glm::vec3 placed =
            (1.0f - hit.b1 - hit.b2) * P[t.x] + hit.b1 * P[t.y] + hit.b2 * P[t.z];
        return glm::vec3(m_pose.world_from_instance[hit.instance] * glm::vec4(placed, 1.0f));
    }
    glm::vec3 project(const glm::vec3& P) const { return m_eye.project(P, m_width, m_height); }
    float footprint(const glm::vec3& P) const {
        return m_eye.pixel_angle(m_height) * glm::distance(P, m_eye.eye);
    }

private:
    const Scene& m_scene;
    Pose m_pose;
    PinholePose m_eye;
    int m_width, m_height;
    std::vector<Hit> m_hits;
};

/// Pixels whose centres are around a place, and the shares they have of it.
struct Around {
    int x, y;
    float s, t;
};
Around around(const glm::vec2& place) noexcept {
    const float x = std::floor(place.x - 0.5f), y = std::floor(place.y - 0.5f);
    return {int(x), int(y), place.x - 0.5f - x, place.y - 0.5f - y};
}

glm::vec3 sampled(const Film& film, const glm::vec2& place) {
    const Around a = around(place);
    const auto at = [&](int x, int y) { return glm::vec3(film.color[film.index(x, y)]); };
    return glm::mix(glm::mix(at(a.x, a.y), at(a.x + 1, a.y), a.s),
                    glm::mix(at(a.x, a.y + 1), at(a.x + 1, a.y + 1), a.s), a.t);
}

}  // namespace

std::vector<glm::vec2> motion(const Scene& scene, RayScene& rays, int camera, double before,
                              double now, int width, int height) {
    // One origin for both: what stands still stays where it is.
    const glm::dvec3 origin = place_of(scene, scene.cameras[std::size_t(camera)].node, now);
    const SeenCentres old(scene, rays, camera, before, origin, width, height);
    const SeenCentres fresh(scene, rays, camera, now, origin, width, height);
    const glm::vec2 unknown(std::numeric_limits<float>::quiet_NaN());
    std::vector<glm::vec2> places(std::size_t(width) * std::size_t(height), unknown);
    constexpr float near = 4.0f;  // pixels; a surface aslant spreads over some
    for (int y = 0; y < height; ++y) {
        for (int x = 0; x < width; ++x) {
            const Hit& hit = fresh.hit(x, y);
            if (hit.instance == Hit::none) continue;
            const glm::vec3 P = old.world(hit);
            const glm::vec3 place = old.project(P);
            if (!(place.z > 0.0f && place.x >= 0.5f && place.x < float(width) - 0.5f &&
                  place.y >= 0.5f && place.y < float(height) - 0.5f)) {
                continue;
            }
            const Around a = around(glm::vec2(place));
            if (a.x + 1 >= width || a.y + 1 >= height) continue;
            bool same = true;
            for (int k = 0; k < 4; ++k) {
                const Hit& other = old.hit(a.x + (k & 1), a.y + (k >> 1));
                same = same && other.instance == hit.instance &&
                       glm::distance(old.world(other), P) <= near * old.footprint(P);
                if (!same) break;
            }
            if (same) {
                places[std::size_t(y) * std::size_t(width) + std::size_t(x)] = glm::vec2(place);
            }
        }
    }
    return places;
}

Flicker flicker(const Film& before, const Film& now, const Film& reference_before,
                const Film& reference_now, const std::vector<glm::vec2>& motion) {
    Flicker result;
    std::vector<float> differences;
    double squares = 0.0;
    for (std::size_t i = 0; i < motion.size(); ++i) {
        if (std::isnan(motion[i].x)) continue;
        const glm::vec3 change = glm::vec3(now.color[i]) - sampled(before, motion[i]);
        const glm::vec3 wanted =
            glm::vec3(reference_now.color[i]) - sampled(reference_before, motion[i]);
        for (int c = 0; c < 3; ++c) {
            const float d = change[c] - wanted[c];
            squares += double(d) * double(d);
            differences.push_back(std::abs(d));
        }
        ++result.pixels;
    }
    if (differences.empty()) return result;
    result.rms = std::sqrt(squares / double(differences.size()));
    const auto at = differences.begin() + std::ptrdiff_t(0.99 * double(differences.size() - 1));
    std::nth_element(differences.begin(), at, differences.end());
    result.p99 = double(*at);
    return result;
}

Flicker pooled(const std::vector<Flicker>& flickers) {
    Flicker all;
    double squares = 0.0;
    for (const Flicker& one : flickers) {
        squares += one.rms * one.rms * double(one.pixels);
        all.pixels += one.pixels;
        all.p99 = std::max(all.p99, one.p99);
    }
    if (all.pixels > 0) all.rms = std::sqrt(squares / double(all.pixels));
    return all;
}

}  // namespace estara
