// Key frames on whole frames.
#pragma once

#include <functional>
#include <vector>

namespace estara::examples {

inline constexpr int frames = 48;        ///< of a loop
inline constexpr int path_frames = 100;  ///< of a path, which has two ends
inline constexpr double fps = 24.0;

/// When frames 1 to `count` are shown, seconds.
inline std::vector<float> frame_times(int count = frames) {
    std::vector<float> times;
    for (int f = 1; f <= count; ++f) times.push_back(float(f / fps));
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
