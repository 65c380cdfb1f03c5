// Writing pictures.
#pragma once

#include <optional>
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

/// Film::settings of an image file; nothing if it cannot be read or is not ours.
std::optional<std::string> image_settings(const std::string& path);
/// A file's picture, linear, alpha associated. Error if it cannot be read.
Film read_image(const std::string& path);

}  // namespace estara
