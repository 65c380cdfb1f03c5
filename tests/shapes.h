// Small meshes for the tests that run the programs.
#pragma once

#include <cmath>
#include <fstream>
#include <numbers>
#include <string>

namespace estara::test {

/// Writes a closed unit sphere around (2, 1, -3) as OBJ, without texture coordinates.
/// @param rings  from pole to pole; twice as many meridians
inline void write_sphere(const std::string& path, int rings = 40) {
    std::ofstream out(path);
    const int meridians = 2 * rings;
    for (int i = 0; i <= rings; ++i) {
        for (int j = 0; j < meridians; ++j) {
            const double t = std::numbers::pi * i / rings, p = std::numbers::pi * j / rings;
            out << "v " << 2.0 + std::sin(t) * std::cos(p) << ' ' << 1.0 + std::cos(t) << ' '
                << -3.0 - std::sin(t) * std::sin(p) << '\n';
        }
    }
    for (int i = 0; i < rings; ++i) {
        for (int j = 0; j < meridians; ++j) {
            const int a = 1 + i * meridians + j, b = 1 + i * meridians + (j + 1) % meridians;
            out << "f " << a << ' ' << a + meridians << ' ' << b + meridians << ' ' << b << '\n';
        }
    }
}

}  // namespace estara::test
