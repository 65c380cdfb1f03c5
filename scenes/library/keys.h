// Key frames on whole frames.
#pragma once

#include <functional>
#include <vector>

namespace estara::examples {

inline constexpr int frames = 48;
inline constexpr double fps = 24.0;

/// When frames 1 to `frames` are shown, seconds.
inline std::vector<float> frame_times() {
    std::vector<float> times;
    for (int f = 1; f <= frames; ++f) times.push_back(float(f / fps));
    return times;
}

/// A value for each frame. @param at  given how much of the loop has passed, [0, 1): frame 1 is at
///                                    0, and the frame after the last would be at 1
template <class T>
std::vector<T> frame_values(const std::function<T(double)>& at) {
    std::vector<T> values;
    for (int f = 1; f <= frames; ++f) values.push_back(at(double(f - 1) / frames));
    return values;
}

}  // namespace estara::examples
