// Points in structure-of-arrays form.
#pragma once

#include <glm/glm.hpp>

#include "estara/shaders/seen.h"

namespace estara {

/// Up to `capacity` points that share one filter width. Row stride is `capacity`, whatever `size`.
struct alignas(64) SurfaceBatch {
    static constexpr int capacity = batch_capacity;

    float P[3][capacity];
    float N[3][capacity];
    float uv[2][capacity];
    float dPdu[3][capacity];
    int size = 0;               ///< number of points in use, [0, capacity]
    float filter_width = 1.0f;  ///< see SurfacePoint; > 0

    /// Sets point i; i < capacity. Does not touch size.
    void set(int i, const glm::vec3& p, const glm::vec3& n, const glm::vec2& st,
             const glm::vec3& dpdu) noexcept {
        for (int c = 0; c < 3; ++c) {
            P[c][i] = p[c];
            N[c][i] = n[c];
            dPdu[c][i] = dpdu[c];
        }
        uv[0][i] = st.x;
        uv[1][i] = st.y;
    }
};

/// As many points as one camera sees them: Seen for each, with the same light or with none. The
/// light of several is a sum: what a point sends to the eye is linear in (E, A, lights, glow),
/// tested for every shader.
struct alignas(64) SeenBatch {
    static constexpr int capacity = batch_capacity;

    float N[3][capacity];
    ViewDirections V;
    float E[3][capacity];
    float L[3][capacity];   ///< of the light, unit, for every point, also where Cl is 0
    float Cl[3][capacity];  ///< 0 where the light does not reach
    glm::vec3 A{0.0f};
};

}  // namespace estara
