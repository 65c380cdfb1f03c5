// How far a picture is from its reference.
#pragma once

#include <cstdint>
#include <span>

#include "estara/render/film.h"

namespace estara {

/// Differences of R, G and B over all pixels, linear, exposure included.
struct ImageError {
    double rmse = 0.0;
    double p999 = 0.0;  ///< 99.9 % of the |differences| are at most this
    double max = 0.0;
    double psnr = 0.0;  ///< decibels against a peak of 1; infinite for equal pictures
};

/// Films of the same size.
ImageError compare_films(const Film& film, const Film& reference);

/// Of several pictures of one size: rmse and psnr of all pixels together, max of all, p999 of the
/// worst picture. At least one.
ImageError pooled(std::span<const ImageError> errors);

}  // namespace estara
