// Trilinear colours at surface points: BrickPyramid against OpenVDB's and NanoVDB's own samplers.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <random>

#include "estara/bake/bake.h"
#include "meshes.h"
#include "peers.h"
#include "raster.h"
#include "rounds.h"
#include "rows.h"

namespace estara::bench {
namespace {

constexpr std::size_t batch = SurfaceBatch::capacity;
constexpr int round_count = 7;
/// Half a step of a colour kept in 8 bits; what floats lose on the way is far below.
constexpr float allowed_difference = 1.0f / 510.0f;

struct Size {
    const char* name;
    double voxels;
};

Camera camera_along(const Box& box, const glm::vec3& forward, const Raster& raster) {
    const glm::vec3 up(0.0f, 1.0f, 0.0f),
        eye = 0.5f * (box.min + box.max) - 1.6f * box.diagonal() * forward;
    return Camera({eye, glm::cross(forward, up), up, forward, 0.235f}, raster.width, raster.height);
}

/// Where the rays of two pictures, from the front and from behind, hit the surface.
std::vector<glm::vec3> visible_points() {
    constexpr Raster raster{1152, 1152};
    const Scene scene = scene_of(surface(), nullptr);
    const Mesh& mesh = scene.objects.front().mesh;
    const RayScene rays(scene);
    std::vector<glm::vec3> points;
    const auto tile = std::make_unique<RayBatch>();
    const auto hits = std::make_unique<HitBatch>();
    for (const glm::vec3& forward : {glm::vec3(0, 0, -1), glm::vec3(0, 0, 1)}) {
        const Camera camera = camera_along(bounds(mesh), forward, raster);
        for (int t = 0; t < raster.tiles(); ++t) {
            raster.rays(camera, t, *tile);
            rays.intersect(*tile, *hits);
            for (int i = 0; i < tile->size; ++i) {
                if (hits->instance[i] != Hit::none)
                    points.push_back(
                        mesh_point(mesh, hits->triangle[i], hits->b1[i], hits->b2[i]).P);
            }
        }
    }
    if (points.size() < 1000000) throw Error("the surface is hit by less than a million rays");
    return points;
}

/// Colours as BrickPyramid leaves them and points as it takes them: batch by batch, and in each
/// plane by plane, which is how a tile's samples lie.
class OurColors {
public:
    explicit OurColors(std::span<const glm::vec3> P)
        : m_size(P.size()),
          m_points((P.size() + batch - 1) / batch * 3 * batch),
          m_planes(m_points.size()),
          m_found(batch) {
        for (std::size_t i = 0; i < P.size(); ++i) {
            for (std::size_t c = 0; c < 3; ++c) m_points[place(i, c)] = P[i][int(c)];
        }
    }

    void look_up(const BrickPyramid& pyramid) {
        for (std::size_t first = 0; first < m_size; first += batch) {
            pyramid.lookup(m_points.data() + 3 * first,
                           {m_footprints.data(), std::min(batch, m_size - first)},
                           m_planes.data() + 3 * first, batch, m_found.data());
        }
    }

    float largest_difference(std::span<const glm::vec3> colors) const {
        float largest = 0.0f;
        for (std::size_t i = 0; i < colors.size(); ++i) {
            for (std::size_t c = 0; c < 3; ++c) {
                const float ours = m_planes[place(i, c)];
                const float difference = std::fabs(ours - colors[i][int(c)]);
                if (!(difference <= largest)) largest = difference;  // NaN too
            }
        }
        return largest;
    }

private:
    static std::size_t place(std::size_t i, std::size_t c) {
        return (i / batch * 3 + c) * batch + i % batch;
    }

    std::size_t m_size;
    std::vector<float> m_footprints = std::vector<float>(batch, 0.0f);
    std::vector<float> m_points, m_planes;
    std::vector<std::uint8_t> m_found;
};

/// One size: its structures, and what they say at the same points.
class Contest {
public:
    Contest(Bench& bench, const Size& size) : m_rows(bench.rows), m_size(size.name) {
        const BoundShaderPtr stone = bound("stone");
        const double voxel = voxel_size_for(surface(), *stone, size.voxels);
        const TextureGrid grid = bake_mesh(surface(), *stone, voxel, false);
        m_voxels = grid.levels.front().voxels();
        const std::string path = bench.folder / "lookup.vdb";
        write_vdb(path, {grid}, {Compression::none, false});
        m_pyramid = std::make_unique<BrickPyramid>(grid);
        m_peers.push_back({"any x86-64", peers_baseline(path)});
        if (__builtin_cpu_supports("x86-64-v3")) m_peers.push_back({"AVX2", peers_avx2(path)});
    }

    void run(const std::string& order, std::span<const glm::vec3> P) {
        OurColors ours(P);
        std::vector<glm::vec3> theirs(P.size());
        std::vector<std::function<void()>> contenders{[&] { ours.look_up(*m_pyramid); }};
        for (const Variant& peer : m_peers) {
            contenders.push_back([&] { peer.peers->openvdb(P, theirs.data()); });
            contenders.push_back([&] { peer.peers->nanovdb(P, theirs.data()); });
        }
        for (const auto& contender : contenders) {
            contender();
            if (&contender == contenders.data()) continue;
            const float difference = ours.largest_difference(theirs);
            if (!(difference <= m_difference)) m_difference = difference;
        }
        const std::string name = "lookup/" + order + "/" + m_size;
        if (!(m_difference <= allowed_difference)) {
            m_rows.disagree(fmt::format("{}: colours differ by {}", name, m_difference));
        }
        const auto costs = rounds(round_count, contenders);
        add_ns(name + "/estara", costs[0], P.size(),
               fmt::format("BrickPyramid, batches of {}", batch_capacity));
        add_peer(name, "openvdb", 1, costs, P.size());
        add_peer(name, "nanovdb", 2, costs, P.size());
    }

    void add_figures() {
        const std::string name = "lookup/" + m_size;
        m_rows.add({name + "/max_difference", once(m_difference), "colour", "",
                    "largest difference of a component, ours from any of theirs"});
        const auto per_voxel = [&](std::uint64_t bytes) {
            return once(double(bytes) / double(m_voxels));
        };
        const auto voxels = fmt::format("over {} active voxels of level 0", m_voxels);
        m_rows.add({"lookup/bytes_per_voxel", per_voxel(m_pyramid->bytes()), "bytes", error(),
                    "BrickPyramid, all levels, " + voxels});
        m_rows.add({"lookup/bytes_per_voxel/openvdb",
                    per_voxel(m_peers.front().peers->openvdb_bytes()), "bytes", "",
                    "level 0 only, " + voxels});
        m_rows.add({"lookup/bytes_per_voxel/nanovdb",
                    per_voxel(m_peers.front().peers->nanovdb_bytes()), "bytes", "",
                    "level 0 only, " + voxels});
    }

private:
    struct Variant {
        const char* compiled_for;
        std::unique_ptr<Peers> peers;
    };

    std::string error() const { return fmt::format("max {:.2g}", m_difference); }

    void add_ns(const std::string& name, const std::vector<Cost>& costs, std::size_t points,
                const std::string& what) {
        const auto ns = [&](const Cost& cost) { return 1e9 * cost.cpu / double(points); };
        m_rows.add({name, spread_of(costs, ns), "ns", error(),
                    fmt::format("{}; {} points, {} voxels, one thread", what, points, m_voxels)});
    }

    /// @param first  contender of the first variant; those of the others follow two by two
    void add_peer(const std::string& name, const std::string& peer, std::size_t first,
                  const std::vector<std::vector<Cost>>& costs, std::size_t points) {
        const auto median = [&](std::size_t i) {
            return spread_of(costs[i], [](const Cost& cost) { return cost.cpu; }).median;
        };
        std::size_t fastest = first;
        for (std::size_t i = first; i < costs.size(); i += 2) {
            if (median(i) < median(fastest)) fastest = i;
        }
        const std::string what =
            fmt::format("{} compiled for {}", peer, m_peers[(fastest - 1) / 2].compiled_for);
        m_rows.add({name + "/" + peer + "_ratio", ratio(costs[0], costs[fastest], &Cost::cpu),
                    "ratio", error(), "BrickPyramid over " + what + ", one thread"});
        add_ns(name + "/" + peer, costs[fastest], points, what);
    }

    Rows& m_rows;
    std::string m_size;
    std::uint64_t m_voxels;
    float m_difference = 0.0f;
    std::unique_ptr<BrickPyramid> m_pyramid;
    std::vector<Variant> m_peers;
};

}  // namespace

void lookup(Bench& bench) {
    const std::vector<glm::vec3> coherent = visible_points();
    std::vector<glm::vec3> random = coherent;
    std::shuffle(random.begin(), random.end(), std::mt19937(1));
    for (const Size& size : {Size{"500k", 5e5}, Size{"2M", 2e6}, Size{"8M", 8e6}}) {
        Contest contest(bench, size);
        contest.run("coherent", coherent);
        contest.run("random", random);
        if (std::string(size.name) == "2M") contest.add_figures();
    }
}

}  // namespace estara::bench
