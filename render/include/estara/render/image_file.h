// Writing pictures.
#pragma once

#include <string>

#include "estara/render/file_pattern.h"
#include "estara/render/film.h"

namespace estara {

/// Writes a film, whole or not at all (PendingFile).
///
/// EXR: R, G, B, A and the AOVs as albedo.R/G/B, N.X/Y/Z (half), P.X/Y/Z and Z (float); linear,
/// alpha associated, zip. PNG: 8 bits, sRGB, alpha unassociated, no AOVs.
/// Error: the folder cannot be made or written to (bad_input); the disk is full (failed).
void write_image(const std::string& path, ImageFormat format, const Film& film);

/// Width and height of an image file; (0, 0) if it cannot be read.
glm::ivec2 image_size(const std::string& path);

}  // namespace estara
