#include "estara/render/camera.h"

#include <cmath>
#include <limits>

#include "estara/shaders/wide.h"

namespace estara {
namespace {

/// Squares of lengths for which float does: neither the square nor its root over- or underflows.
constexpr float least_square = 1e-30f, largest_square = 1e30f;

}  // namespace

Ray Camera::primary_ray(float x, float y) const noexcept {
    return {m_pose.eye, m_pose.direction(x, y, m_width, m_height), 0.0f,
            std::numeric_limits<float>::infinity()};
}

Sight Camera::sight(const glm::vec3& P) const noexcept {
    // A difference of floats is exact to half an ulp, so float does where the square is a float.
    const glm::vec3 near = m_pose.eye - P;
    const float square = glm::dot(near, near);
    if (square > least_square && square < largest_square) {
        const float length = std::sqrt(square);
        return {ViewDirection(near / length), length};
    }
    const glm::dvec3 v = glm::dvec3(m_pose.eye) - glm::dvec3(P);
    const double length = glm::length(v);
    return {ViewDirection(length > 0.0 ? glm::vec3(v / length) : -m_pose.forward), float(length)};
}

void Camera::primary_rays(const float* x, const float* y, int n, RayBatch& rays) const noexcept {
    wide([=, pose = m_pose, width = m_width, height = m_height, to = &rays]() ESTARA_LOOP {
#pragma GCC ivdep
        for (int i = 0; i < n; ++i) {
            const glm::vec3 d = pose.direction(x[i], y[i], width, height);
            to->origin[0][i] = pose.eye.x;
            to->origin[1][i] = pose.eye.y;
            to->origin[2][i] = pose.eye.z;
            to->direction[0][i] = d.x;
            to->direction[1][i] = d.y;
            to->direction[2][i] = d.z;
            to->tmin[i] = 0.0f;
            to->tmax[i] = std::numeric_limits<float>::infinity();
        }
    });
    rays.size = n;
}

void Camera::sights(const float* P, int first, int last, ViewDirections& V,
                    float* distance) const noexcept {
    constexpr int stride = batch_capacity;
    float *const x = V.m_v[0], *const y = V.m_v[1], *const z = V.m_v[2];
    int unusual = 0;  // at the eye, or beyond what float squares: nearly never
    int* const found = &unusual;
    wide([=, eye = m_pose.eye]() ESTARA_LOOP {
        int any = 0;
#pragma GCC ivdep
        for (int i = first; i < last; ++i) {
            const float dx = eye.x - P[i], dy = eye.y - P[stride + i],
                        dz = eye.z - P[2 * stride + i];
            const float square = dx * dx + dy * dy + dz * dz;
            const float length = std::sqrt(square);
            x[i] = dx / length;
            y[i] = dy / length;
            z[i] = dz / length;
            distance[i] = length;
            any |= (square > least_square) & (square < largest_square) ? 0 : 1;
        }
        *found = any;
    });
    if (unusual == 0) return;
    for (int i = first; i < last; ++i) {
        const Sight s = sight({P[i], P[stride + i], P[2 * stride + i]});
        const glm::vec3 v = s.V.vec();
        x[i] = v.x;
        y[i] = v.y;
        z[i] = v.z;
        distance[i] = s.distance;
    }
}

}  // namespace estara
