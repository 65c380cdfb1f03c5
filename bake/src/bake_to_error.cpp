// The largest voxel that keeps a bound on the error, found by baking.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "estara/bake/bake.h"
#include "estara/scenes/error.h"
#include "estara/scenes/program.h"

namespace estara {
namespace {

/// A voxel size that was tried and the RMSE it gave.
struct Trial {
    double size, error;
};

/// How error grows with the voxel size, as a power, between two trials: 2 where the shader is
/// smooth and resolved, 1/2 at its discontinuities. Without a second trial the cautious end.
double growth(const std::optional<Trial>& coarse, const std::optional<Trial>& fine) {
    if (!coarse || !fine || !(coarse->error > fine->error) || !(fine->error > 0.0)) return 1.0;
    return std::clamp(std::log(coarse->error / fine->error) / std::log(coarse->size / fine->size),
                      0.25, 2.5);
}

/// The next size to try, between the smallest one that failed and the largest one that did not.
double next_size(const std::optional<Trial>& failed, const std::optional<Trial>& previous,
                 const std::optional<Trial>& met, double bound) {
    if (!met) {
        const double slope = growth(previous, failed);
        return failed->size *
               std::clamp(0.97 * std::pow(bound / failed->error, 1.0 / slope), 0.25, 0.9);
    }
    if (!failed) return met->size * 2.0;
    const double slope = growth(failed, met);
    const double wanted = failed->size * 0.99 * std::pow(bound / failed->error, 1.0 / slope);
    const double span =
        failed->size / met->size;  // both ends shrink towards each other in any case
    return std::clamp(wanted, met->size * std::pow(span, 0.2), met->size * std::pow(span, 0.8));
}

double worst_rmse(const TextureGrid& grid) {
    double worst = 0.0;
    for (const ErrorFigures& e : grid.errors) worst = std::max(worst, e.rmse);
    return worst;
}

[[noreturn]] void out_of_reach(double bound, std::uint64_t max_bytes,
                               const std::optional<Trial>& best) {
    const std::string reached =
        best ? fmt::format("the smallest voxel that fits, {:.3g}, reached {:.3g}", best->size,
                           best->error)
             : "no voxel fits";
    throw Error(
        fmt::format("RMSE {:.3g} is out of reach within the {} that --max-memory leaves: {}", bound,
                    format_bytes(max_bytes), reached),
        ExitStatus::failed);
}

/// A voxel size and what a bake with it will take.
struct Attempt {
    double size;
    BakeEstimate estimate;
};

/// The wanted size, or the smallest one that floats and memory allow if that is larger.
Attempt feasible(const Mesh& mesh, const ShaderInfo& shader, double wanted,
                 std::uint64_t max_bytes) {
    if (max_bytes == 0) return {std::numeric_limits<double>::infinity(), {}};
    const double size = std::max(wanted, finest_voxel_size(mesh));
    Attempt attempt{size, estimate_bake(mesh, shader, size)};
    // The estimate goes with 1 / size^2, but not exactly: a few steps settle it.
    for (int step = 0; step < 8 && attempt.estimate.bytes > max_bytes; ++step) {
        attempt.size *= 1.02 * std::sqrt(double(attempt.estimate.bytes) / double(max_bytes));
        attempt.estimate = estimate_bake(mesh, shader, attempt.size);
    }
    return attempt;
}

}  // namespace

BoundedBake bake_to_error(const Mesh& mesh, const BoundShader& shader, double max_error, bool half,
                          std::uint64_t max_bytes, std::uint64_t seed, const AttemptBegins& begin) {
    if (!(max_error > 0.0)) throw Error(fmt::format("--max-error {}: must be above 0", max_error));
    const double diagonal = bounds(mesh).diagonal();
    const double coarsest = std::max(diagonal / 16.0, finest_voxel_size(mesh));
    constexpr double close_enough = 1.1;
    BoundedBake result;
    std::optional<Trial> failed, previous, met;
    double wanted = diagonal / 128.0;
    for (;;) {
        const std::uint64_t left = max_bytes > result.bytes ? max_bytes - result.bytes : 0;
        const auto [size, estimate] = feasible(mesh, shader.info(), wanted, left);
        if (met && size >= (failed ? failed->size : 1.01 * coarsest)) return result;  // no memory
        if (!met && size > coarsest) out_of_reach(max_error, max_bytes, failed);
        if (failed && !met && size >= 0.98 * failed->size) {
            out_of_reach(max_error, max_bytes, failed);
        }
        TextureGrid grid = bake_mesh(mesh, shader, size, half,
                                     begin ? begin(size, estimate.voxels) : VoxelsDone{});
        grid.errors = measure_error(mesh, shader, grid, error_samples, seed);
        ++result.attempts;
        const Trial trial{size, worst_rmse(grid)};
        if (trial.error <= max_error) {
            met = trial;
            result.grid = std::move(grid);
            result.bytes = estimate.bytes;
        } else {
            previous = failed;
            failed = trial;
        }
        if (met &&
            (met->size >= coarsest || (failed && failed->size <= close_enough * met->size))) {
            return result;
        }
        wanted = std::min(next_size(failed, previous, met, max_error), coarsest);
    }
}

}  // namespace estara
