// Grids around a sphere, voxelised by brute force, and points on it.
#pragma once

#include <filesystem>
#include <functional>
#include <random>
#include <string>
#include <vector>

#include "estara/grids/texture_grid.h"

namespace estara {

struct Sphere {
    glm::dvec3 center{0.3, -0.2, 0.1};
    double radius = 1.0;
    bool upper_half = false;  ///< only z >= center.z

    /// Points uniform by area, rounded to float.
    std::vector<glm::vec3> random_points(int count) const;
};

/// A value of a channel's component at a position.
using Field = std::function<float(const glm::dvec3& P, int component)>;

/// Smooth, between 0 and 1, different in every component.
float waves(const glm::dvec3& P, int component);

/// Level 0 with its cells: every cell that comes within slack voxels of the sphere. The box around
/// the sphere begins at index 10.
TextureGrid sphere_grid(const Sphere& sphere, double voxel_size, std::vector<GridChannel> channels,
                        const Field& field = waves, double slack = 1e-3);

/// sphere_grid() of color and specular with all levels, parameters, digests and error figures.
TextureGrid complete_grid(const std::string& object = "", double voxel_size = 0.05);

/// Rows of two levels or grids are the same, bit by bit; distance and cells aside.
void expect_same(const TextureGrid& a, const TextureGrid& b);

/// A fresh folder, removed at the end.
class TemporaryFolder {
public:
    TemporaryFolder();
    ~TemporaryFolder();
    TemporaryFolder(const TemporaryFolder&) = delete;
    TemporaryFolder& operator=(const TemporaryFolder&) = delete;
    std::string file(const std::string& name) const { return (m_path / name).string(); }
    /// Names of what it holds, hidden files too, sorted.
    std::vector<std::string> entries() const;

private:
    std::filesystem::path m_path;
};

std::string read_bytes(const std::string& path);
void write_bytes(const std::string& path, const std::string& bytes);

/// The text of the Error that f throws; fails the test if it throws none.
std::string error_of(const std::function<void()>& f);

}  // namespace estara
