#include "pieces.h"

#include <algorithm>
#include <limits>

namespace estara::examples {

Piece resting(Piece piece) {
    float lowest = std::numeric_limits<float>::infinity();
    for (const glm::vec3& p : piece.mesh.P) lowest = std::min(lowest, (piece.rotation * p).y);
    piece.position.y -= lowest;
    return piece;
}

void add_piece(GlbBuilder& out, const Piece& piece) {
    const int mesh = out.add_mesh(piece.name, scaled(piece.mesh, piece.pattern),
                                  out.add_material(piece.material));
    out.add_object(piece.name, mesh, {piece.position, piece.rotation, 1.0f / piece.pattern});
}

}  // namespace estara::examples
