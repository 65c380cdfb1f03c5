// What reuse gains, as the paper predicts it from the times of one sample.
#pragma once

namespace estara {

/// Times of one sample, seconds (Kondratieva, Havran & Seidel 2004, section 3.3). Combining the two
/// parts is one sum, and is in vd.
struct SampleTimes {
    double vi = 0.0;       ///< view-independent part: bake(), and light where it is kept
    double vd = 0.0;       ///< view-dependent part
    double save = 0.0;     ///< into the cache
    double extract = 0.0;  ///< from the cache, reprojection included

    double without_reuse() const noexcept { return vi + vd; }            ///< T_s^1
    double first_with_reuse() const noexcept { return vi + vd + save; }  ///< T_s^2
    double later_with_reuse() const noexcept { return vd + extract; }    ///< T_s^3
};

/// Reuse must promise this speedup to be chosen: what gains less is within the error of measuring.
inline constexpr double least_gain = 1.0 + 1.0 / 30.0;

/// T^1, Eq. 3: a sample in n camera positions, evaluated in each.
double time_without_reuse(const SampleTimes& times, double n) noexcept;

/// T^2, Eq. 4: evaluated in the first of n, recalled in the others.
double time_with_reuse(const SampleTimes& times, double n) noexcept;

/// T^1 / T^2. 1 where both are 0.
double predicted_speedup(const SampleTimes& times, double n) noexcept;

/// The number of camera positions from which on reuse pays (between Eq. 4 and 5); infinity if it
/// never does.
double break_even(const SampleTimes& times) noexcept;

/// Eq. 5: what the speedup tends to for many camera positions, T_s^1 / T_s^3.
double limit_of_speedup(const SampleTimes& times) noexcept;

}  // namespace estara
