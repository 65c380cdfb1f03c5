// Primary rays in the order in which a renderer traces them: tiles, in them squares of 4 x 4
// pixels, so that the rays of a packet stay close together.
#pragma once

#include <glm/glm.hpp>

#include <vector>

#include "estara/render/camera.h"

namespace estara::bench {

struct Raster {
    static constexpr int tile_width = 32, tile_height = 16;
    int width, height;  ///< pixels, multiples of the tile's

    int tiles() const noexcept { return width / tile_width * (height / tile_height); }

    /// Rays through the centres of a tile's pixels, in squares of 4 x 4.
    void rays(const Camera& camera, int tile, RayBatch& out) const {
        const int columns = width / tile_width;
        const glm::ivec2 corner(tile % columns * tile_width, tile / columns * tile_height);
        float x[tile_width * tile_height], y[tile_width * tile_height];
        for (int i = 0; i < tile_width * tile_height; ++i) {
            const int square = i / 16, inside = i % 16;
            x[i] = float(corner.x + square % (tile_width / 4) * 4 + inside % 4) + 0.5f;
            y[i] = float(corner.y + square / (tile_width / 4) * 4 + inside / 4) + 0.5f;
        }
        camera.primary_rays(x, y, tile_width * tile_height, out);
    }
};

}  // namespace estara::bench
