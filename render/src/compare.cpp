#include "estara/render/compare.h"

#include <OpenImageIO/imagebuf.h>
#include <OpenImageIO/imagebufalgo.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

namespace estara {
namespace {

/// A view of the film's colours; OpenImageIO does not write to what it only compares.
OIIO::ImageBuf wrapped(const Film& film) {
    return {OIIO::ImageSpec(film.width, film.height, 4, OIIO::TypeFloat),
            const_cast<glm::vec4*>(film.color.data())};
}

double p999_of_difference(const Film& a, const Film& b) {
    std::vector<float> differences;
    differences.reserve(a.color.size() * 3);
    for (std::size_t i = 0; i < a.color.size(); ++i) {
        for (int c = 0; c < 3; ++c) differences.push_back(std::abs(a.color[i][c] - b.color[i][c]));
    }
    const std::size_t rank = std::size_t(std::ceil(0.999 * double(differences.size()))) - 1;
    std::nth_element(differences.begin(), differences.begin() + std::ptrdiff_t(rank),
                     differences.end());
    return differences[rank];
}

double psnr_of(double rmse) {
    return rmse > 0.0 ? -20.0 * std::log10(rmse) : std::numeric_limits<double>::infinity();
}

}  // namespace

ImageError compare_films(const Film& film, const Film& reference) {
    const OIIO::ROI rgb(0, film.width, 0, film.height, 0, 1, 0, 3);
    const OIIO::ImageBufAlgo::CompareResults found =
        OIIO::ImageBufAlgo::compare(wrapped(film), wrapped(reference), 0.0f, 0.0f, rgb);
    return {found.rms_error, p999_of_difference(film, reference), found.maxerror,
            psnr_of(found.rms_error)};
}

ImageError pooled(std::span<const ImageError> errors) {
    ImageError all;
    double squares = 0.0;
    for (const ImageError& e : errors) {
        squares += e.rmse * e.rmse;
        all.p999 = std::max(all.p999, e.p999);
        all.max = std::max(all.max, e.max);
    }
    all.rmse = std::sqrt(squares / double(errors.size()));
    all.psnr = psnr_of(all.rmse);
    return all;
}

}  // namespace estara
