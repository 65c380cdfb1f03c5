#include "estara/render/reuse_model.h"

#include <limits>

namespace estara {

double time_without_reuse(const SampleTimes& times, double n) noexcept {
    return times.without_reuse() * n;
}

double time_with_reuse(const SampleTimes& times, double n) noexcept {
    return times.first_with_reuse() + times.later_with_reuse() * (n - 1.0);
}

double predicted_speedup(const SampleTimes& times, double n) noexcept {
    const double with = time_with_reuse(times, n);
    return with > 0.0 ? time_without_reuse(times, n) / with : 1.0;
}

double break_even(const SampleTimes& times) noexcept {
    const double gain = times.without_reuse() - times.later_with_reuse();
    if (!(gain > 0.0)) return std::numeric_limits<double>::infinity();
    return (times.first_with_reuse() - times.later_with_reuse()) / gain;
}

double limit_of_speedup(const SampleTimes& times) noexcept {
    const double later = times.later_with_reuse();
    return later > 0.0 ? times.without_reuse() / later : 1.0;
}

}  // namespace estara
