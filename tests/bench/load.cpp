// Writing and reading the .vdb file of a bake.
#include <fmt/format.h>

#include <filesystem>

#include "estara/bake/bake.h"
#include "meshes.h"
#include "rounds.h"
#include "rows.h"

namespace estara::bench {
namespace {

bool same_voxels(const TextureGrid& a, const TextureGrid& b) {
    if (a.levels.size() != b.levels.size()) return false;
    for (std::size_t i = 0; i < a.levels.size(); ++i) {
        if (a.levels[i].planes != b.levels[i].planes) return false;
    }
    return true;
}

}  // namespace

void load(Bench& bench) {
    const BoundShaderPtr shader = bound("greenmarble");
    const std::vector<TextureGrid> grids{
        bake_mesh(surface(), *shader, voxel_size_for(surface(), *shader, 8e6), false)};
    const std::string path = bench.folder / "load.vdb";
    std::uint64_t bytes = 0;
    const std::vector<Cost> writing =
        rounds(3, {[&] { bytes = write_vdb(path, grids, {}); }}).front();
    if (!same_voxels(read_vdb(path).front(), grids.front())) {
        bench.rows.disagree("load: the file has not the voxels that were written");
    }
    const std::vector<Cost> reading =
        rounds(5, {[&] { BrickPyramid(read_vdb(path).front()); }}).front();

    const double voxels = double(grids.front().levels.front().voxels());
    const auto speed = [&](const Cost& cost) { return voxels / cost.wall; };
    const auto cpu = [&](const Cost& cost) { return 1e9 * cost.cpu / voxels; };
    const std::string what = fmt::format("{} voxels of level 0, zip, all threads", voxels);
    Rows& rows = bench.rows;
    rows.add({"load/voxels_per_s", spread_of(reading, speed), "voxels/s", "exact",
              "read_vdb and BrickPyramid, page cache warm, " + what});
    rows.add({"load/cpu_ns_per_voxel", spread_of(reading, cpu), "ns", "exact", "the same"});
    rows.add({"write/voxels_per_s", spread_of(writing, speed), "voxels/s", "exact",
              "write_vdb with its verification, " + what});
    rows.add({"write/cpu_ns_per_voxel", spread_of(writing, cpu), "ns", "exact", "the same"});
    rows.add({"file/bytes_per_voxel", once(double(bytes) / voxels), "bytes", "exact",
              "the whole file over the voxels of level 0"});
}

}  // namespace estara::bench
