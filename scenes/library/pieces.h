// Things that stand in a scene.
#pragma once

#include <string>

#include "glb.h"
#include "shapes.h"

namespace estara::examples {

/// An object of its own mesh and material.
struct Piece {
    std::string name;
    Material material;
    Mesh mesh;  ///< in scene units
    glm::vec3 position;
    glm::quat rotation{1.0f, 0.0f, 0.0f, 0.0f};
    /// Object space units in a scene unit: how dense the solid patterns get.
    float pattern = 1.0f;
};

/// The piece put on the plane y = position.y.
Piece resting(Piece piece);

void add_piece(GlbBuilder& out, const Piece& piece);

}  // namespace estara::examples
