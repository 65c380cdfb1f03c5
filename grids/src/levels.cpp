// Coarser levels of a baked grid.
#include <fmt/format.h>
#include <tbb/concurrent_vector.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_sort.h>

#include <cmath>
#include <cstdlib>
#include <glm/gtc/packing.hpp>
#include <stdexcept>

#include "blocks.h"
#include "estara/scenes/error.h"

namespace estara {
namespace {

constexpr int coarsest_extent = 16;  // voxels a side, at most

/// Part of a coarse block: what one fine block contributes to it.
struct Part {
    glm::ivec3 origin{0};
    BlockMask voxels, cells;
};

void unite(BlockMask& a, const BlockMask& b) noexcept {
    for (std::size_t w = 0; w < a.words.size(); ++w) a.words[w] |= b.words[w];
}

/// Halves the cells of a fine block and marks the corners of what results. A block's cells shrink
/// into one coarse block; their corners reach into up to seven more on its positive sides.
void add_parts(const Block& fine, const BlockMask& cells, tbb::concurrent_vector<Part>& parts) {
    const glm::ivec3 half = fine.origin / 2;
    const glm::ivec3 octant = half & 7;  // 0 or 4
    std::array<Part, 8> near;
    for_each_bit(cells, [&](int x, int y, int z) {
        const glm::ivec3 c = octant + (glm::ivec3(x, y, z) >> 1);
        near[0].cells.set(BlockMask::bit(c.x, c.y, c.z));
        for (int corner = 0; corner < 8; ++corner) {
            const glm::ivec3 v = c + glm::ivec3(corner >> 2, (corner >> 1) & 1, corner & 1);
            const glm::ivec3 block = v >> 3;
            const glm::ivec3 local = v & 7;
            near[std::size_t(block.x * 4 + block.y * 2 + block.z)].voxels.set(
                BlockMask::bit(local.x, local.y, local.z));
        }
    });
    for (int i = 0; i < 8; ++i) {
        Part& part = near[std::size_t(i)];
        if (!part.voxels.any()) continue;
        part.origin = (half & ~7) + 8 * glm::ivec3(i >> 2, (i >> 1) & 1, i & 1);
        parts.push_back(part);
    }
}

/// Blocks and cells of the next level; planes stay empty. The order in which threads deliver
/// parts does not matter: they are sorted by block and united.
GridLevel coarse_topology(const GridLevel& fine) {
    tbb::concurrent_vector<Part> parts;
    tbb::parallel_for(std::size_t{0}, fine.blocks.size(), [&](std::size_t b) {
        if (fine.cells[b].any()) add_parts(fine.blocks[b], fine.cells[b], parts);
    });
    tbb::parallel_sort(parts.begin(), parts.end(), [](const Part& a, const Part& b) {
        return comes_before(a.origin, b.origin);
    });
    GridLevel coarse;
    for (const Part& part : parts) {
        if (coarse.blocks.empty() || coarse.blocks.back().origin != part.origin) {
            coarse.blocks.push_back({part.origin, {}, 0});
            coarse.cells.emplace_back();
        }
        unite(coarse.blocks.back().active, part.voxels);
        unite(coarse.cells.back(), part.cells);
    }
    std::uint64_t rows = 0;
    for (Block& block : coarse.blocks) {
        block.first = rows;
        rows += std::uint64_t(block.active.count());
    }
    return coarse;
}

/// The fine voxels that a coarse block's values are made of: for coarse origin O the cube from
/// 2 O - 1 to 2 O + 15 in each axis.
struct FineRows {
    static constexpr int side = 17;
    static constexpr std::int64_t none = -1;
    std::vector<std::int64_t> row = std::vector<std::int64_t>(side * side * side, none);

    static std::size_t at(const glm::ivec3& p) noexcept {
        return std::size_t((p.x * side + p.y) * side + p.z);
    }

    void gather(const std::vector<Block>& fine, const glm::ivec3& coarse_origin) {
        std::fill(row.begin(), row.end(), none);
        for (int n = 0; n < 27; ++n) {
            const glm::ivec3 step = glm::ivec3(n / 9, n / 3 % 3, n % 3) - 1;
            const std::ptrdiff_t found = find_block(fine, 2 * coarse_origin + 8 * step);
            if (found >= 0) add(fine[std::size_t(found)], 8 * step + 1);
        }
    }

    /// @param shift  position of the block's corner in the cube
    void add(const Block& block, const glm::ivec3& shift) {
        auto next = std::int64_t(block.first);
        for_each_bit(block.active, [&](int x, int y, int z) {
            const glm::ivec3 p = shift + glm::ivec3(x, y, z);
            const bool inside = glm::all(glm::greaterThanEqual(p, glm::ivec3(0))) &&
                                glm::all(glm::lessThan(p, glm::ivec3(side)));
            if (inside) row[at(p)] = next;
            ++next;
        });
    }
};

/// Fills the planes of a coarse block.
///
/// The weights of a voxel never sum to zero. An active voxel I is a corner of a coarse cell C, so
/// I - C is 0 or 1 in each axis, and C holds a fine cell c, which is 2C or 2C + 1 in each axis,
/// whose corners c and c + 1 are all active. In each axis one of them is at most 1 away from 2I:
/// if I = C it is c (2I or 2I + 1), if I = C + 1 it is c + 1 (2I - 1 or 2I).
///
/// Sums are in double, where 27 floats times whole numbers up to 8 are exact if the floats are
/// alike: a constant stays the same constant.
void average(const GridLevel& fine, const Block& block, GridLevel& coarse) {
    FineRows near;
    near.gather(fine.blocks, block.origin);
    std::uint64_t out = block.first;
    for_each_bit(block.active, [&](int x, int y, int z) {
        std::array<std::pair<std::size_t, int>, 27> taps;
        std::size_t count = 0;
        int total = 0;
        for (int n = 0; n < 27; ++n) {
            const glm::ivec3 step = glm::ivec3(n / 9, n / 3 % 3, n % 3) - 1;
            const std::int64_t row = near.row[FineRows::at(2 * glm::ivec3(x, y, z) + 1 + step)];
            if (row == FineRows::none) continue;
            const int weight =
                (2 - std::abs(step.x)) * (2 - std::abs(step.y)) * (2 - std::abs(step.z));
            taps[count++] = {std::size_t(row), weight};
            total += weight;
        }
        for (std::size_t c = 0; c < fine.planes.size(); ++c) {
            double sum = 0.0;
            for (std::size_t t = 0; t < count; ++t) {
                sum += double(fine.planes[c][taps[t].first]) * taps[t].second;
            }
            coarse.planes[c][out] = float(sum / total);
        }
        ++out;
    });
}

GridLevel coarser(const GridLevel& fine) {
    GridLevel coarse = coarse_topology(fine);
    coarse.planes.assign(fine.planes.size(), std::vector<float>(coarse.voxels()));
    tbb::parallel_for(std::size_t{0}, coarse.blocks.size(),
                      [&](std::size_t b) { average(fine, coarse.blocks[b], coarse); });
    return coarse;
}

/// Whether the active voxels span at most coarsest_extent in each axis.
bool is_coarsest(const GridLevel& level) {
    glm::ivec3 low = level.blocks.front().origin;
    glm::ivec3 high = low;
    for (const Block& block : level.blocks) {
        low = glm::min(low, block.origin);
        high = glm::max(high, block.origin);
    }
    if (glm::any(glm::greaterThan(high - low, glm::ivec3(coarsest_extent)))) return false;
    glm::ivec3 first = high + 7;
    glm::ivec3 last = low;
    for (const Block& block : level.blocks) {  // few by now
        for_each_bit(block.active, [&](int x, int y, int z) {
            first = glm::min(first, block.origin + glm::ivec3(x, y, z));
            last = glm::max(last, block.origin + glm::ivec3(x, y, z));
        });
    }
    return glm::all(glm::lessThan(last - first, glm::ivec3(coarsest_extent)));
}

/// Name of the channel that float c of the record belongs to.
std::string channel_of(const TextureGrid& grid, int c) {
    for (const GridChannel& channel : grid.channels) {
        if (c < channel.components) return channel.name;
        c -= channel.components;
    }
    return "?";
}

}  // namespace

void add_levels(TextureGrid& grid) {
    if (grid.levels.empty() || grid.levels.back().blocks.empty()) {
        throw std::invalid_argument("add_levels: a grid without voxels");
    }
    if (grid.levels.back().cells.size() != grid.levels.back().blocks.size()) {
        throw std::invalid_argument("add_levels: a level without cells");
    }
    while (!is_coarsest(grid.levels.back())) {
        GridLevel next = coarser(grid.levels.back());
        if (next.blocks.empty()) throw std::invalid_argument("add_levels: no cell is crossed");
        grid.levels.push_back(std::move(next));
    }
}

float nearest_half(float value) noexcept {
    constexpr float largest = 65504.0f;
    return glm::unpackHalf1x16(glm::packHalf1x16(std::clamp(value, -largest, largest)));
}

void round_to_half(TextureGrid& grid) {
    for (GridLevel& level : grid.levels) {
        tbb::parallel_for(std::size_t{0}, level.planes.size(), [&](std::size_t c) {
            for (float& value : level.planes[c]) value = nearest_half(value);
        });
    }
}

std::vector<float> plane_means(const TextureGrid& grid) {
    std::vector<float> means(std::size_t(grid.floats()), 0.0f);
    if (grid.levels.empty()) return means;
    tbb::parallel_for(std::size_t{0}, means.size(), [&](std::size_t c) {
        const std::vector<float>& plane = grid.levels.front().planes[c];
        double sum = 0.0;
        for (const float value : plane) sum += value;
        if (!plane.empty()) means[c] = float(sum / double(plane.size()));
    });
    return means;
}

void check_finite(const TextureGrid& grid, const std::string& where) {
    for (std::size_t n = 0; n < grid.levels.size(); ++n) {
        const GridLevel& level = grid.levels[n];
        std::vector<char> bad(level.planes.size(), 0);
        tbb::parallel_for(std::size_t{0}, level.planes.size(), [&](std::size_t c) {
            bad[c] = !std::all_of(level.planes[c].begin(), level.planes[c].end(),
                                  [](float v) { return std::isfinite(v); });
        });
        const auto first = std::find(bad.begin(), bad.end(), 1);
        if (first == bad.end()) continue;
        throw Error(fmt::format("{}: channel \"{}\" has a value on level {} that is not finite",
                                where, channel_of(grid, int(first - bad.begin())), n));
    }
}

}  // namespace estara
