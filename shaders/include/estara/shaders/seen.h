// What the view-dependent half of a shader may know: how the point is looked at and lit.
#pragma once

#include <glm/glm.hpp>
#include <span>

namespace estara {

class Camera;

/// Unit vector from the surface to the eye, world space. Only a Camera can make one, so code that
/// is handed no ViewDirection cannot depend on the view.
class ViewDirection {
public:
    const glm::vec3& vec() const noexcept { return m_v; }

private:
    friend class Camera;
    friend class ViewDirections;
    explicit ViewDirection(const glm::vec3& v) noexcept : m_v(v) {}
    glm::vec3 m_v;
};

/// Points in a batch, at most, and floats from a plane of them to the next. Two lines of a cache
/// more than 512: planes that lie a power of two apart would all fall into two of a cache's sets,
/// and a loop over twenty of them would find none of them there a second time.
inline constexpr int batch_capacity = 544;

/// A ViewDirection for each point of a batch, which only a Camera can make either.
class ViewDirections {
public:
    ViewDirection operator[](int i) const noexcept {
        return ViewDirection({m_v[0][i], m_v[1][i], m_v[2][i]});
    }

private:
    friend class Camera;
    float m_v[3][batch_capacity];
};

/// One light as a surface point receives it.
struct Light {
    glm::vec3 L;   ///< unit vector from the surface towards the light, world space
    glm::vec3 Cl;  ///< irradiance at normal incidence / pi, linear Rec. 709; 0 in shadow
};

/// A surface point as one camera sees it. It has no position: whatever depends on where the point
/// is has been computed by bake() and is in Baked.
struct Seen {
    glm::vec3 N;      ///< shading normal turned to the side of the eye (N_f), world, unit
    ViewDirection V;  ///< towards the eye
    glm::vec3 E;      ///< diffuse light on N: sum of Cl <N.L>+, shadows included
    glm::vec3 A;      ///< sum of the ambient lights
    std::span<const Light> lights;
    /// Weight of what the surface sends without any light: 1, or 0 where the share of one light
    /// alone is asked for.
    float glow = 1.0f;
};

}  // namespace estara
