// From a scene to pictures: which scenes, and what is baked for them.
#pragma once

#include <ostream>
#include <string>
#include <vector>

namespace estara::test {

/// A scene and the bakes that it takes.
struct Journey {
    std::string name;
    std::string scene;               ///< an example's name, a file of tests/models, or a path
    std::vector<std::string> bakes;  ///< shader and its parameters
    std::string frames;
    bool fills_the_frame = false;

    friend void PrintTo(const Journey& j, std::ostream* out) { *out << j.name; }
};

/// Those of a program of tests.
std::vector<Journey> journeys();

}  // namespace estara::test
