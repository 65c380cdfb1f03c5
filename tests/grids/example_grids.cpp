#include "example_grids.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <iterator>

#include "estara/scenes/error.h"

namespace estara {
namespace {

/// Whether the closed cell [low, low + 1]^3, index space, comes within slack of the sphere.
bool near_sphere(const glm::dvec3& low, const glm::dvec3& center, double radius, double slack) {
    const glm::dvec3 nearest = glm::clamp(center, low, low + 1.0);
    const glm::dvec3 farthest = glm::max(glm::abs(center - low), glm::abs(center - low - 1.0));
    return glm::length(nearest - center) <= radius + slack &&
           glm::length(farthest) >= radius - slack;
}

struct Voxels {
    glm::ivec3 blocks;  // of the whole box
    std::vector<BlockMask> cells, active;

    explicit Voxels(const glm::ivec3& size)
        : blocks(size / 8 + 1), cells(std::size_t(blocks.x * blocks.y * blocks.z)), active(cells) {}

    std::size_t block(const glm::ivec3& p) const {
        return std::size_t(((p.x >> 3) * blocks.y + (p.y >> 3)) * blocks.z + (p.z >> 3));
    }
    static int bit(const glm::ivec3& p) { return BlockMask::bit(p.x & 7, p.y & 7, p.z & 7); }

    void add_cell(const glm::ivec3& p) {
        cells[block(p)].set(bit(p));
        for (int n = 0; n < 8; ++n) {
            const glm::ivec3 v = p + glm::ivec3(n >> 2, (n >> 1) & 1, n & 1);
            active[block(v)].set(bit(v));
        }
    }
};

}  // namespace

std::vector<glm::vec3> Sphere::random_points(int count) const {
    std::mt19937 random(7);
    std::vector<glm::vec3> points;
    const auto unit = [&] { return double(random()) / 4294967296.0; };
    while (int(points.size()) < count) {
        const glm::dvec3 p = 2.0 * glm::dvec3(unit(), unit(), unit()) - 1.0;
        const double length = glm::length(p);
        if (length > 1.0 || length < 1e-3 || (upper_half && p.z < 0.0)) continue;
        points.emplace_back(center + radius / length * p);
    }
    return points;
}

float waves(const glm::dvec3& P, int component) {
    return float(0.5 + 0.25 * std::sin(3.0 * P.x + component) +
                 0.24 * std::cos(2.0 * P.y - 4.0 * P.z + 0.7 * component));
}

TextureGrid sphere_grid(const Sphere& sphere, double voxel_size, std::vector<GridChannel> channels,
                        const Field& field, double slack) {
    TextureGrid grid;
    grid.voxel_size = voxel_size;
    grid.channels = std::move(channels);
    grid.closed = !sphere.upper_half;
    grid.origin = sphere.center - sphere.radius - 10.0 * voxel_size;
    const glm::dvec3 center = (sphere.center - grid.origin) / voxel_size;
    const double radius = sphere.radius / voxel_size;
    const glm::ivec3 size(int(std::ceil(center.x + radius)) + 2);
    Voxels voxels(size);
    glm::ivec3 p;
    for (p.x = 8; p.x < size.x; ++p.x) {
        for (p.y = 8; p.y < size.y; ++p.y) {
            for (p.z = 8; p.z < size.z; ++p.z) {
                if (sphere.upper_half && p.z + 1.0 < center.z - slack) continue;
                if (near_sphere(glm::dvec3(p), center, radius, slack)) voxels.add_cell(p);
            }
        }
    }
    GridLevel& level = grid.levels.emplace_back();
    level.planes.resize(std::size_t(grid.floats()));
    for (p.x = 0; p.x < 8 * voxels.blocks.x; p.x += 8) {
        for (p.y = 0; p.y < 8 * voxels.blocks.y; p.y += 8) {
            for (p.z = 0; p.z < 8 * voxels.blocks.z; p.z += 8) {
                const BlockMask& active = voxels.active[voxels.block(p)];
                if (!active.any()) continue;
                level.blocks.push_back({p, active, level.planes[0].size()});
                level.cells.push_back(voxels.cells[voxels.block(p)]);
                for (int i = 0; i < 512; ++i) {
                    if (!active.test(i)) continue;
                    const glm::ivec3 v = p + glm::ivec3(i >> 6, (i >> 3) & 7, i & 7);
                    const glm::dvec3 P = grid.origin + voxel_size * glm::dvec3(v);
                    for (int c = 0; c < grid.floats(); ++c) {
                        level.planes[std::size_t(c)].push_back(field(P, c));
                    }
                    grid.distance.push_back(float(glm::length(P - sphere.center) - sphere.radius));
                }
            }
        }
    }
    return grid;
}

TextureGrid complete_grid(const std::string& object, double voxel_size) {
    TextureGrid grid = sphere_grid({}, voxel_size, {{"color", 3}, {"specular", 1}});
    grid.object = object;
    grid.shader = "wood";
    grid.params = {{"ringscale", {10.0f}}, {"lightwood", {0.3f, 0.12f, 0.03f}}, {"Ka", {0.2f}}};
    grid.shader_digest = "0123456789abcdef";
    grid.mesh_digest = "fedcba9876543210";
    grid.errors = {{0.001, 0.002, 0.003, 0.004, 0.005, 1000}, {0.1, 0.2, 0.3, 0.4, 0.5, 1000}};
    grid.tool_version = "0.1.0";
    add_levels(grid);
    return grid;
}

void expect_same(const TextureGrid& a, const TextureGrid& b) {
    EXPECT_EQ(a.object, b.object);
    EXPECT_EQ(a.voxel_size, b.voxel_size);
    EXPECT_EQ(a.origin, b.origin);
    EXPECT_EQ(a.closed, b.closed);
    EXPECT_EQ(a.shader, b.shader);
    EXPECT_EQ(a.params, b.params);
    EXPECT_EQ(a.shader_digest, b.shader_digest);
    EXPECT_EQ(a.mesh_digest, b.mesh_digest);
    EXPECT_EQ(a.lights_digest, b.lights_digest);
    EXPECT_EQ(a.tool_version, b.tool_version);
    ASSERT_EQ(a.channels.size(), b.channels.size());
    for (std::size_t c = 0; c < a.channels.size(); ++c) {
        EXPECT_EQ(a.channels[c].name, b.channels[c].name);
        EXPECT_EQ(a.channels[c].components, b.channels[c].components);
    }
    ASSERT_EQ(a.errors.size(), b.errors.size());
    for (std::size_t c = 0; c < a.errors.size(); ++c) {
        EXPECT_EQ(a.errors[c].mean, b.errors[c].mean);
        EXPECT_EQ(a.errors[c].rmse, b.errors[c].rmse);
        EXPECT_EQ(a.errors[c].p99, b.errors[c].p99);
        EXPECT_EQ(a.errors[c].p999, b.errors[c].p999);
        EXPECT_EQ(a.errors[c].max, b.errors[c].max);
        EXPECT_EQ(a.errors[c].samples, b.errors[c].samples);
    }
    ASSERT_EQ(a.levels.size(), b.levels.size());
    for (std::size_t n = 0; n < a.levels.size(); ++n) {
        ASSERT_EQ(a.levels[n].blocks.size(), b.levels[n].blocks.size());
        for (std::size_t i = 0; i < a.levels[n].blocks.size(); ++i) {
            const Block &p = a.levels[n].blocks[i], &q = b.levels[n].blocks[i];
            ASSERT_TRUE(p.origin == q.origin && p.active == q.active && p.first == q.first);
        }
        EXPECT_EQ(a.levels[n].planes, b.levels[n].planes) << "level " << n;
    }
}

TemporaryFolder::TemporaryFolder() {
    std::string name = (std::filesystem::temp_directory_path() / "estara_test_XXXXXX").string();
    if (!mkdtemp(name.data())) ADD_FAILURE() << "no temporary folder " << name;
    m_path = name;
}

TemporaryFolder::~TemporaryFolder() {
    std::error_code ignored;
    std::filesystem::remove_all(m_path, ignored);
}

std::vector<std::string> TemporaryFolder::entries() const {
    std::vector<std::string> names;
    for (const auto& entry : std::filesystem::directory_iterator(m_path)) {
        names.push_back(entry.path().filename().string());
    }
    std::sort(names.begin(), names.end());
    return names;
}

std::string read_bytes(const std::string& path) {
    std::ifstream in(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(in), {}};
}

void write_bytes(const std::string& path, const std::string& bytes) {
    std::ofstream out(path, std::ios::binary);
    out.write(bytes.data(), std::streamsize(bytes.size()));
    ASSERT_TRUE(out.flush().good()) << path;
}

std::string error_of(const std::function<void()>& f) {
    try {
        f();
    } catch (const Error& e) {
        return e.what();
    }
    ADD_FAILURE() << "no error was thrown";
    return "";
}

}  // namespace estara
