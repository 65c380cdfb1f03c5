// Coarser levels of a baked grid.
#include <fmt/format.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_sort.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <glm/gtc/packing.hpp>
#include <numeric>
#include <stdexcept>

#include "blocks.h"
#include "estara/scenes/error.h"
#include "estara/shaders/kernel.h"
#include "estara/shaders/wide.h"

namespace estara {
namespace {

constexpr int coarsest_extent = 16;  // voxels a side, at most

// Masks of a block: word x, byte y, bit z.
constexpr std::uint64_t every_byte = 0x0101010101010101u;

void unite(BlockMask& a, const BlockMask& b) noexcept {
    for (std::size_t w = 0; w < a.words.size(); ++w) a.words[w] |= b.words[w];
}

/// The 4^3 cells that a block's cells lie in, at an octant (0 or 4 in each axis) of the coarse
/// block.
BlockMask halved(const BlockMask& fine, const glm::ivec3& octant) noexcept {
    BlockMask coarse;
    for (std::size_t x = 0; x < 4; ++x) {
        std::uint64_t w = fine.words[2 * x] | fine.words[2 * x + 1];
        w |= w >> 8;  // pairs of bytes, then the even bytes side by side
        w &= 0x00ff00ff00ff00ffu;
        w = (w | (w >> 8)) & 0x0000ffff0000ffffu;
        w = (w | (w >> 16)) & 0x00000000ffffffffu;
        w = (w | (w >> 1)) & (0x55 * every_byte);  // and so with the bits of each byte
        w = (w | (w >> 1)) & (0x33 * every_byte);
        w = (w | (w >> 2)) & (0x0f * every_byte);
        coarse.words[x + std::size_t(octant.x)] = w << (8 * octant.y + octant.z);
    }
    return coarse;
}

/// Index of the first block at or after an origin.
std::size_t first_not_before(const std::vector<Block>& blocks, const glm::ivec3& origin) noexcept {
    const auto found = std::lower_bound(
        blocks.begin(), blocks.end(), origin,
        [](const Block& b, const glm::ivec3& o) { return comes_before(b.origin, o); });
    return std::size_t(found - blocks.begin());
}

/// Calls f(index, origin - corner) for the blocks whose origins lie in the box from corner to
/// corner + 8 (count - 1).
template <class F>
void for_each_block_in(const std::vector<Block>& blocks, const glm::ivec3& corner, int count,
                       F&& f) {
    const int reach = 8 * (count - 1);
    for (int x = 0; x <= reach; x += 8) {
        for (int y = 0; y <= reach; y += 8) {
            const glm::ivec3 first = corner + glm::ivec3(x, y, 0);
            const glm::ivec3 last = first + glm::ivec3(0, 0, reach);
            for (std::size_t b = first_not_before(blocks, first);
                 b < blocks.size() && !comes_before(last, blocks[b].origin); ++b) {
                f(b, blocks[b].origin - corner);
            }
        }
    }
}

/// Sorts blocks and leaves one for each origin.
void make_unique(std::vector<Block>& blocks) {
    tbb::parallel_sort(blocks.begin(), blocks.end(), [](const Block& a, const Block& b) {
        return comes_before(a.origin, b.origin);
    });
    const auto same = [](const Block& a, const Block& b) { return a.origin == b.origin; };
    blocks.erase(std::unique(blocks.begin(), blocks.end(), same), blocks.end());
}

/// The coarse blocks with cells, and these.
GridLevel halve_cells(const GridLevel& fine) {
    GridLevel crossed;
    for (std::size_t b = 0; b < fine.blocks.size(); ++b) {
        const glm::ivec3 origin = (fine.blocks[b].origin / 2) & ~7;
        const bool repeated = !crossed.blocks.empty() && crossed.blocks.back().origin == origin;
        if (fine.cells[b].any() && !repeated) crossed.blocks.push_back({origin, {}, 0});
    }
    make_unique(crossed.blocks);
    crossed.cells.resize(crossed.blocks.size());
    tbb::parallel_for(std::size_t{0}, crossed.blocks.size(), [&](std::size_t b) {
        for_each_block_in(fine.blocks, 2 * crossed.blocks[b].origin, 2,
                          [&](std::size_t child, const glm::ivec3& from) {
                              unite(crossed.cells[b], halved(fine.cells[child], from / 2));
                          });
    });
    return crossed;
}

/// Whether a cell has a corner in the block that lies `step` (0 or 1 in each axis) blocks further.
bool reaches(const BlockMask& cells, const glm::ivec3& step) noexcept {
    std::uint64_t layer = ~std::uint64_t{0};
    if (step.y != 0) layer &= std::uint64_t{0xff} << 56;
    if (step.z != 0) layer &= 0x80 * every_byte;
    std::uint64_t any = 0;
    for (std::size_t x = step.x != 0 ? 7 : 0; x < 8; ++x) any |= cells.words[x] & layer;
    return any != 0;
}

/// The voxels of a block that are corners of cells.
/// @param near  cells of the block, near[1][1][1], and of those one step back in x, y, z
BlockMask corners(const std::array<std::array<std::array<BlockMask, 2>, 2>, 2>& near) noexcept {
    // A cell's corners lie at its own z and the next; then likewise in y and x.
    const auto in_yz = [&](std::size_t nx, std::size_t x) {
        std::array<std::uint64_t, 2> in_z{};
        for (std::size_t ny = 0; ny < 2; ++ny) {
            const std::uint64_t w = near[nx][ny][1].words[x], back = near[nx][ny][0].words[x];
            in_z[ny] = w | ((w << 1) & (0xfe * every_byte)) | ((back >> 7) & every_byte);
        }
        return in_z[1] | (in_z[1] << 8) | (in_z[0] >> 56);
    };
    BlockMask voxels;
    std::uint64_t previous = in_yz(0, 7);
    for (std::size_t x = 0; x < 8; ++x) {
        const std::uint64_t own = in_yz(1, x);
        voxels.words[x] = own | previous;
        previous = own;
    }
    return voxels;
}

/// Blocks and cells of the next level; planes stay empty.
GridLevel coarse_topology(const GridLevel& fine) {
    const GridLevel crossed = halve_cells(fine);
    GridLevel coarse;
    for (std::size_t b = 0; b < crossed.blocks.size(); ++b) {
        for (int n = 0; n < 8; ++n) {
            const glm::ivec3 step(n >> 2, (n >> 1) & 1, n & 1);
            if (!reaches(crossed.cells[b], step)) continue;
            coarse.blocks.push_back({crossed.blocks[b].origin + 8 * step, {}, 0});
        }
    }
    make_unique(coarse.blocks);
    coarse.cells.resize(coarse.blocks.size());
    tbb::parallel_for(std::size_t{0}, coarse.blocks.size(), [&](std::size_t b) {
        std::array<std::array<std::array<BlockMask, 2>, 2>, 2> near{};
        for_each_block_in(crossed.blocks, coarse.blocks[b].origin - 8, 2,
                          [&](std::size_t n, const glm::ivec3& from) {
                              const auto at = glm::uvec3(from) / 8u;
                              near[at.x][at.y][at.z] = crossed.cells[n];
                          });
        coarse.cells[b] = near[1][1][1];
        coarse.blocks[b].active = corners(near);
    });
    std::uint64_t rows = 0;
    for (Block& block : coarse.blocks) {
        block.first = rows;
        rows += std::uint64_t(block.active.count());
    }
    return coarse;
}

/// The fine voxels that a coarse block's values are made of: for coarse origin O the cube from
/// 2 O - 1 to 2 O + 15 in each axis. Three floats of each, and 1 where a voxel is active.
class FineCube {
public:
    static constexpr int planes = 3;
    using Record = std::array<float, planes + 1>;

    /// @param first  plane; where fewer than three follow, the last one is there again
    void gather(const GridLevel& fine, const glm::ivec3& coarse_origin, std::size_t first) {
        clear();
        for_each_block_in(fine.blocks, 2 * coarse_origin - 8, 3,
                          [&](std::size_t b, const glm::ivec3& from) {
                              add(fine, fine.blocks[b], from - 7, first);
                          });
    }

    /// The weighted sums of the records around coarse voxel (x, y, z): weights 1 2 1 in each axis.
    ESTARA_KERNEL std::array<double, planes + 1> tent(int x, int y, int z) const noexcept {
        std::array<double, planes + 1> sum{};
        for (int dx = 0; dx < 3; ++dx) {
            for (int dy = 0; dy < 3; ++dy) {
                const double weight = (dx == 1 ? 2.0 : 1.0) * (dy == 1 ? 2.0 : 1.0);
                const Record* const r = &m_records[at(2 * x + dx, 2 * y + dy, 2 * z)];
                for (std::size_t c = 0; c < sum.size(); ++c) {
                    sum[c] += weight * (double(r[0][c]) + 2.0 * double(r[1][c]) + double(r[2][c]));
                }
            }
        }
        return sum;
    }

private:
    static constexpr int side = 17;

    ESTARA_KERNEL static std::size_t at(int x, int y, int z) noexcept {
        return std::size_t((x * side + y) * side + z);
    }

    void clear() noexcept {
        for (std::size_t i = 0; i < m_count; ++i) m_records[m_filled[i]] = {};
        m_count = 0;
    }

    /// @param shift  position of the block's corner in the cube; -7 if only its last layer is in
    void add(const GridLevel& fine, const Block& block, const glm::ivec3& shift,
             std::size_t first) {
        std::array<const float*, planes> values;  // the last one again where there are too few
        for (std::size_t c = 0; c < planes; ++c) {
            values[c] = fine.planes[std::min(first + c, fine.planes.size() - 1)].data();
        }
        std::uint64_t layer = ~std::uint64_t{0};
        if (shift.y < 0) layer &= std::uint64_t{0xff} << 56;
        if (shift.z < 0) layer &= 0x80 * every_byte;
        std::uint64_t row = block.first;
        for (int x = 0; x < 8; ++x) {
            std::uint64_t left = block.active.words[std::size_t(x)];
            if (x + shift.x < 0 || (left & layer) == 0) {
                row += std::uint64_t(std::popcount(left));
                continue;
            }
            for (; left != 0; left &= left - 1, ++row) {
                const int bit = std::countr_zero(left);
                if (((layer >> bit) & 1) == 0) continue;
                const std::size_t i = at(x + shift.x, (bit >> 3) + shift.y, (bit & 7) + shift.z);
                m_records[i] = {values[0][row], values[1][row], values[2][row], 1.0f};
                m_filled[m_count++] = std::uint16_t(i);
            }
        }
    }

    std::vector<Record> m_records = std::vector<Record>(side * side * side);
    std::vector<std::uint16_t> m_filled = std::vector<std::uint16_t>(side * side * side);
    std::size_t m_count = 0;
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
    thread_local FineCube cube;  // 80 KB that every block needs
    FineCube& near = cube;       // looked up once
    for (std::size_t first = 0; first < fine.planes.size(); first += FineCube::planes) {
        const std::size_t end = std::min(first + FineCube::planes, fine.planes.size());
        near.gather(fine, block.origin, first);
        std::array<float*, FineCube::planes> to{};
        for (std::size_t c = first; c < end; ++c) to[c - first] = coarse.planes[c].data();
        wide([&near, &block, to, count = end - first]() ESTARA_LOOP {
            std::uint64_t out = block.first;
            for_each_bit(block.active, [&](int x, int y, int z) {
                const auto sum = near.tent(x, y, z);
                for (std::size_t c = 0; c < count; ++c) {
                    to[c][out] = float(sum[c] / sum[FineCube::planes]);
                }
                ++out;
            });
        });
    }
}

GridLevel coarser(const GridLevel& fine) {
    GridLevel coarse = coarse_topology(fine);
    const std::size_t voxels = coarse.voxels();
    coarse.planes.resize(fine.planes.size());
    tbb::parallel_for(std::size_t{0}, coarse.planes.size(),
                      [&](std::size_t c) { coarse.planes[c].resize(voxels); });
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

/// Sum of every plane, formed by pieces that depend on nothing but the number of rows: the same for
/// any thread count.
std::vector<double> plane_sums(const GridLevel& level) {
    constexpr std::size_t piece_rows = 1 << 14, lanes = 8;
    const std::size_t planes = level.planes.size(), rows = std::size_t(level.voxels()),
                      pieces = (rows + piece_rows - 1) / piece_rows;
    std::vector<double> parts(planes * pieces);
    tbb::parallel_for(std::size_t{0}, parts.size(), [&](std::size_t i) {
        const std::size_t begin = i % pieces * piece_rows, end = std::min(begin + piece_rows, rows);
        const float* const plane = level.planes[i / pieces].data();
        std::array<double, lanes> sums{};
        std::size_t row = begin;
        for (; row + lanes <= end; row += lanes) {
            for (std::size_t k = 0; k < lanes; ++k) sums[k] += double(plane[row + k]);
        }
        for (; row < end; ++row) sums[0] += double(plane[row]);
        parts[i] = std::accumulate(sums.begin(), sums.end(), 0.0);
    });
    std::vector<double> sums(planes);
    for (std::size_t c = 0; c < planes; ++c) {
        const auto first = parts.begin() + std::ptrdiff_t(c * pieces);
        sums[c] = std::accumulate(first, first + std::ptrdiff_t(pieces), 0.0);
    }
    return sums;
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

std::vector<float> finite_means(const TextureGrid& grid, const std::string& where) {
    std::vector<float> means(std::size_t(grid.floats()), 0.0f);
    for (std::size_t n = 0; n < grid.levels.size(); ++n) {
        const std::vector<double> sums = plane_sums(grid.levels[n]);
        // Floats are too small for a sum of theirs to leave the doubles.
        const auto bad =
            std::find_if(sums.begin(), sums.end(), [](double sum) { return !std::isfinite(sum); });
        if (bad != sums.end()) {
            throw Error(fmt::format("{}: channel \"{}\" has a value on level {} that is not finite",
                                    where, channel_of(grid, int(bad - sums.begin())), n));
        }
        const std::uint64_t voxels = grid.levels[n].voxels();
        if (n > 0 || voxels == 0) continue;
        for (std::size_t c = 0; c < means.size(); ++c) means[c] = float(sums[c] / double(voxels));
    }
    return means;
}

}  // namespace estara
