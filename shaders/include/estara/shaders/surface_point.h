// What the view-independent half of a shader may know: where it is on the surface.
#pragma once

#include <glm/glm.hpp>

namespace estara {

/// A point of a surface, in the object's own (rest) space.
///
/// Nothing in here has to do with a camera; that is what makes a value computed from it reusable in
/// every frame. Patterns that only need P are evaluated off the surface too (at voxel centres),
/// where N, uv and dPdu are those of the nearest surface point.
struct SurfacePoint {
    glm::vec3 P;     ///< position, object space, in the scene's unit of length
    glm::vec3 N;     ///< geometric or interpolated normal, object space, unit length
    glm::vec2 uv;    ///< texture coordinates; (0, 0) for a mesh that has none
    glm::vec3 dPdu;  ///< change of P with u, object space; not of unit length

    /// Width below which detail is left out, object space, > 0: the voxel's edge, whether the point
    /// is baked or evaluated directly. Never a pixel's width: that changes from frame to frame.
    float filter_width;

    /// Sum of the shader's octave(x, k) over the octaves that filter_width leaves room for, or of
    /// as many as its octaves(filter_width) says; 0 for a shader without octave(). Summed up before
    /// bake(), because a loop of varying length inside it would keep the loop over points from
    /// being made wide.
    float octave_sum;
    glm::vec4 octave_more{0.0f};  ///< likewise, of OctaveTerm::more
};

/// A term of five sums over octaves at once.
struct OctaveTerm {
    float value;
    glm::vec4 more;
};

}  // namespace estara
