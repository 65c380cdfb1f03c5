// What is told of many errors.
#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include "estara/grids/texture_grid.h"

namespace estara {

/// @param errors   at least one; reordered
/// @param samples  surface points that they are of
inline ErrorFigures error_figures(std::vector<float>& errors, std::uint64_t samples) {
    ErrorFigures f;
    double sum = 0.0, squares = 0.0;
    for (const float e : errors) {
        sum += e;
        squares += double(e) * e;
    }
    f.mean = sum / double(errors.size());
    f.rmse = std::sqrt(squares / double(errors.size()));
    // The values below which a fraction lies; each search leaves the larger ones behind it.
    const auto quantile = [&](double fraction) {
        return errors.begin() + std::ptrdiff_t(fraction * double(errors.size() - 1));
    };
    const auto p99 = quantile(0.99), p999 = quantile(0.999);
    std::nth_element(errors.begin(), p99, errors.end());
    f.p99 = *p99;
    std::nth_element(p99, p999, errors.end());
    f.p999 = *p999;
    f.max = *std::max_element(p999, errors.end());
    f.samples = samples;
    return f;
}

}  // namespace estara
