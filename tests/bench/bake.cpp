// Baking greenmarble: speed by instruction set, by threads and by size, and its peak of memory.
#include "estara/bake/bake.h"

#include <fmt/format.h>
#include <tbb/task_arena.h>

#include <cmath>
#include <optional>

#include "memory.h"
#include "meshes.h"
#include "rounds.h"
#include "rows.h"

namespace estara::bench {
namespace {

constexpr int round_count = 5;

std::uint64_t bytes_of(const TextureGrid& grid) {
    std::uint64_t bytes = grid.distance.size() * sizeof(float);
    for (const GridLevel& level : grid.levels) {
        bytes += level.blocks.size() * sizeof(Block) + level.cells.size() * sizeof(BlockMask);
        for (const auto& plane : level.planes) bytes += plane.size() * sizeof(float);
    }
    return bytes;
}

/// Slope of log(y) over log(x), least squares.
double log_slope(const std::vector<double>& x, const std::vector<double>& y) {
    const double n = double(x.size());
    double sx = 0, sy = 0, sxx = 0, sxy = 0;
    for (std::size_t i = 0; i < x.size(); ++i) {
        const double a = std::log(x[i]), b = std::log(y[i]);
        sx += a, sy += b, sxx += a * a, sxy += a * b;
    }
    return (n * sxy - sx * sy) / (n * sxx - sx * sx);
}

void add_speed(Rows& rows, double voxel_size) {
    const Mesh& mesh = surface();
    const BoundShaderPtr avx2 = bound("greenmarble", InstructionSet::avx2),
                         widest = bound("greenmarble");
    const TextureGrid grid = bake_mesh(mesh, *widest, voxel_size, false);
    if (grid.levels.front().planes !=
        bake_mesh(mesh, *avx2, voxel_size, false).levels.front().planes) {
        rows.disagree("bake: AVX2 and the widest instruction set give different voxels");
    }
    const double rmse = measure_error(mesh, *widest, grid, error_samples, 0).front().rmse;
    const std::string error = fmt::format("rmse {:.2g}", rmse);

    tbb::task_arena one(1), two(2);
    const auto bake_in = [&](tbb::task_arena& arena, const BoundShader& shader) {
        return [&] { arena.execute([&] { bake_mesh(mesh, shader, voxel_size, false); }); };
    };
    const bool has_avx512 = __builtin_cpu_supports("x86-64-v4");
    std::vector<std::function<void()>> contenders{bake_in(two, *avx2), bake_in(one, *avx2)};
    if (has_avx512) contenders.push_back(bake_in(two, *widest));
    const auto costs = rounds(round_count, contenders);

    const double voxels = double(grid.levels.front().voxels());
    const auto speed = [&](const Cost& cost) { return voxels / cost.wall; };
    const std::string what = fmt::format("bake_mesh, {} voxels, ", voxels);
    rows.add({"bake/thread_scaling", ratio(costs[1], costs[0], &Cost::wall), "ratio", "exact",
              what + "AVX2: wall time with one thread over that with two"});
    rows.add({"bake/greenmarble/voxels_per_s", spread_of(costs[0], speed), "voxels/s", error,
              what + "AVX2, two threads"});
    if (has_avx512) {
        rows.add({"bake/greenmarble/voxels_per_s/avx512", spread_of(costs[2], speed), "voxels/s",
                  error, what + "AVX-512, two threads"});
    }
    rows.add({"bake/greenmarble/cpu_ns_per_voxel",
              spread_of(costs[0], [&](const Cost& c) { return 1e9 * c.cpu / voxels; }), "ns", error,
              what + "AVX2, two threads, CPU time of both"});
    rows.add({"bake/rmse", once(rmse), "colour", "", what + "lookup against shader"});
}

void add_scaling(Rows& rows) {
    const Mesh& mesh = surface();
    const BoundShaderPtr shader = bound("greenmarble");
    std::vector<double> voxels;
    std::vector<std::function<void()>> contenders;
    for (const double wanted : {1e5, 4e5, 1.6e6, 6.4e6}) {
        const double size = voxel_size_for(mesh, *shader, wanted);
        contenders.push_back([&mesh, shader, size] { bake_mesh(mesh, *shader, size, false); });
        voxels.push_back(wanted);
    }
    const auto costs = rounds(round_count, contenders);
    std::vector<double> slopes;
    for (std::size_t round = 0; round < std::size_t(round_count); ++round) {
        std::vector<double> seconds;
        for (const auto& cost : costs) seconds.push_back(cost[round].cpu);
        slopes.push_back(log_slope(voxels, seconds));
    }
    rows.add({"bake/scaling_exponent", spread(std::move(slopes)), "exponent", "",
              "slope of log CPU time over log voxels, 0.1 to 6.4 million"});
}

void add_peak(Rows& rows, double voxel_size) {
    const Mesh& mesh = surface();
    const BoundShaderPtr shader = bound("greenmarble");
    std::vector<double> ratios;
    for (int i = 0; i < round_count; ++i) {
        std::optional<TextureGrid> grid;
        const std::uint64_t peak =
            peak_growth([&] { grid = bake_mesh(mesh, *shader, voxel_size, false); });
        ratios.push_back(double(peak) / double(bytes_of(*grid)));
    }
    rows.add({"bake/peak_ratio", spread(std::move(ratios)), "ratio", "",
              "growth of the process during bake_mesh over the bytes of the TextureGrid"});
}

}  // namespace

void bake(Bench& bench) {
    const double voxel_size = voxel_size_for(surface(), *bound("greenmarble"), 2e6);
    add_peak(bench.rows, voxel_size);
    add_speed(bench.rows, voxel_size);
    add_scaling(bench.rows);
}

}  // namespace estara::bench
