// How an image is divided into tiles, and the order of a tile's pixels.
#pragma once

#include <glm/glm.hpp>

#include "estara/shaders/batch.h"

namespace estara {

/// Tiles of 32 x 16 pixels, row by row; those at the right and lower border reach beyond the image.
/// A sample in each pixel of a tile fits into one batch of a shader.
struct TileGrid {
    static constexpr int width = 32, height = 16;  ///< of a tile, pixels
    static constexpr int pixels = width * height;
    static_assert(pixels <= batch_capacity);

    int columns, rows;  ///< tiles across and down

    /// @param image_width, image_height  pixels, >= 1
    TileGrid(int image_width, int image_height) noexcept
        : columns((image_width - 1) / width + 1), rows((image_height - 1) / height + 1) {}

    int count() const noexcept { return columns * rows; }
    /// The upper left pixel of a tile.
    glm::ivec2 corner(int tile) const noexcept {
        return {tile % columns * width, tile / columns * height};
    }
    /// The tile of a pixel.
    ESTARA_KERNEL static int tile(int x, int y, int columns) noexcept {
        return y / height * columns + x / width;
    }

    // A tile's pixels are numbered in squares of 4 x 4: rays that are traced together stay close
    // together.
    static glm::ivec2 place(int number) noexcept {
        const int square = number / 16, inside = number % 16;
        return {square % (width / 4) * 4 + inside % 4, square / (width / 4) * 4 + inside / 4};
    }
    /// The inverse of place(), of any pixel of the image.
    ESTARA_KERNEL static int number(int x, int y) noexcept {
        const int u = x & (width - 1), v = y & (height - 1);
        return ((v / 4 * (width / 4) + u / 4) * 16) + (v & 3) * 4 + (u & 3);
    }
};

}  // namespace estara
