// Writes meshes as scanners leave them: make_models FOLDER.
#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <fstream>
#include <numbers>
#include <random>
#include <string>
#include <vector>

namespace {

constexpr double pi = std::numbers::pi;

using Point = std::array<double, 3>;

/// A lump: a sphere with hills of several sizes. @param up, around  radians
Point lump(double up, double around, double size) {
    const double x = std::sin(up) * std::cos(around), y = std::cos(up),
                 z = std::sin(up) * std::sin(around);
    const double r = 1.0 + 0.2 * std::sin(3.0 * x + 1.0) * std::cos(2.0 * y) +
                     0.1 * std::sin(5.0 * z + 2.0 * x) + 0.03 * std::sin(17.0 * y + 11.0 * z) +
                     0.01 * std::sin(41.0 * x) * std::sin(37.0 * z);
    return {size * r * x, size * r * y, size * r * z};
}

/// Open at the bottom, with a scanner's noise along the normal and a few holes.
void write_scan(const std::string& path) {
    constexpr int rows = 120, columns = 300;
    constexpr double size = 0.06, noise = 4e-5;
    std::mt19937 random(3);
    std::ofstream file(path);
    file.precision(7);
    file << "# A generated scan.\n";
    for (int j = 0; j < rows; ++j) {
        for (int i = 0; i < columns; ++i) {
            const double up = 0.01 + (0.85 * pi - 0.01) * j / (rows - 1);
            const Point p = lump(up, 2.0 * pi * i / columns, size);
            const double off = 1.0 + noise / size * (double(random()) / 2147483648.0 - 1.0);
            file << "v " << off * p[0] << ' ' << off * p[1] << ' ' << off * p[2] << '\n';
        }
    }
    const auto index = [](int j, int i) { return 1 + j * columns + i % columns; };
    for (int j = 0; j + 1 < rows; ++j) {
        for (int i = 0; i < columns; ++i) {
            if (j > 60 && j < 64 && i % 100 < 9) continue;  // what the scanner has not seen
            const int a = index(j, i), b = index(j, i + 1), c = index(j + 1, i + 1),
                      d = index(j + 1, i);
            if ((i + j) % 2 == 0) {
                file << "f " << a << ' ' << b << ' ' << c << "\nf " << a << ' ' << c << ' ' << d
                     << '\n';
            } else {
                file << "f " << a << ' ' << b << ' ' << d << "\nf " << b << ' ' << c << ' ' << d
                     << '\n';
            }
        }
    }
}

void put(std::string& bytes, std::uint32_t word) {
    for (int k = 0; k < 4; ++k) bytes += char(word >> (8 * k) & 255);
}

/// Closed; each row of quads is a run of the one strip.
void write_strips(const std::string& path) {
    constexpr int rows = 260, columns = 516;
    std::string vertices, strip;
    std::uint32_t length = 0;
    const auto vertex = [&](double up, double around) {
        for (const double c : lump(up, around, 0.8)) {
            put(vertices, std::bit_cast<std::uint32_t>(float(c)));
        }
    };
    const auto corner = [&](std::uint32_t index) {
        put(strip, index);
        ++length;
    };
    constexpr std::uint32_t restart = ~0u, north = 0, south = 1;
    vertex(0.0, 0.0);
    vertex(pi, 0.0);
    for (int j = 1; j < rows; ++j) {
        for (int i = 0; i < columns; ++i) vertex(pi * j / rows, 2.0 * pi * i / columns);
    }
    const auto index = [](int j, int i) {
        return std::uint32_t(2 + (j - 1) * columns + i % columns);
    };
    for (int j = 0; j < rows; ++j) {
        for (int i = 0; i <= columns; ++i) {
            if (j == 0) {
                corner(index(1, i));
                corner(north);
            } else if (j + 1 == rows) {
                corner(south);
                corner(index(j, i));
            } else {
                corner(index(j + 1, i));
                corner(index(j, i));
            }
        }
        corner(restart);
    }
    std::ofstream file(path, std::ios::binary);
    file << "ply\nformat binary_little_endian 1.0\nelement vertex " << 2 + (rows - 1) * columns
         << "\nproperty float x\nproperty float y\nproperty float z\n"
            "element tristrips 1\nproperty list int int vertex_indices\nend_header\n"
         << vertices;
    std::string size;
    put(size, length);
    file << size << strip;
}

}  // namespace

int main(int argc, char** argv) {
    if (argc != 2) return 2;
    const std::string folder = argv[1];
    write_scan(folder + "/scan.obj");
    write_strips(folder + "/strips.ply");
    return 0;
}
