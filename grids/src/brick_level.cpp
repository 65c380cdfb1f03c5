// Makes a level's bricks from its blocks.
#include "brick_level.h"

#include <tbb/parallel_for.h>

#include <atomic>
#include <new>
#include <utility>

#include "estara/grids/bricks.h"
#include "estara/shaders/kernel.h"
#include "estara/shaders/wide.h"

namespace estara {
namespace {

using Near = std::array<const Block*, 8>;

/// A block and its neighbours on the positive sides, null where there is none: element n is
/// shifted by the bits of n, 4 along x, 2 along y, 1 along z.
Near neighbours(const std::vector<Block>& blocks, const BrickIndex& index, std::uint32_t b) {
    Near near{&blocks[b]};
    for (int n = 1; n < 8; ++n) {
        const glm::ivec3 shift = 8 * glm::ivec3(n >> 2, (n >> 1) & 1, n & 1);
        const std::uint32_t found = index.block_of(blocks[b].origin + shift);
        near[std::size_t(n)] = found == BrickIndex::none ? nullptr : &blocks[found];
    }
    return near;
}

/// Word x of a block's mask, 0 where there is no block.
std::uint64_t word(const Block* block, std::size_t x) noexcept {
    return block == nullptr ? 0 : block->active.words[x];
}

constexpr std::uint64_t z0 = 0x0101010101010101u;  // bits with z = 0 of a mask's word
constexpr std::uint64_t y0 = 0xffu;                // bits with y = 0

/// Which of a block's eight bricks have a cell whose eight voxels are active: bit x*4 + y*2 + z.
std::uint8_t complete_bricks(const Near& near) noexcept {
    // Squares of four active voxels in the planes x = 0 to 8.
    std::array<std::uint64_t, 9> squares;
    for (std::size_t x = 0; x < squares.size(); ++x) {
        const std::size_t n = x < 8 ? 0 : 4, w = x & 7;
        const auto pairs = [&](const Block* block, const Block* next_z) {
            const std::uint64_t here = word(block, w);
            return here & (((here >> 1) & ~(z0 << 7)) | ((word(next_z, w) & z0) << 7));
        };
        const std::uint64_t here = pairs(near[n], near[n + 1]);
        const std::uint64_t next_y = pairs(near[n + 2], near[n + 3]);
        squares[x] = here & ((here >> 8) | ((next_y & y0) << 56));
    }
    std::uint8_t mask = 0;
    for (std::size_t half = 0; half < 2; ++half) {
        std::uint64_t cells = 0;
        for (std::size_t x = 4 * half; x < 4 * half + 4; ++x) cells |= squares[x] & squares[x + 1];
        constexpr std::uint64_t octant = 0x0f0f0f0fu;
        for (std::uint32_t yz = 0; yz < 4; ++yz) {
            const std::uint64_t bits = octant << (32 * (yz >> 1) + 4 * (yz & 1));
            if (cells & bits) mask = std::uint8_t(mask | (1u << (4 * half + yz)));
        }
    }
    return mask;
}

/// The values of a block and of the voxels next to it on the positive sides: 9^3, NaN where a voxel
/// is not active. (No value is NaN: that is checked before.)
struct RawBlock {
    static constexpr std::size_t side = 9;
    static constexpr std::size_t padded = 736;  // RawBrick copies by eight
    std::array<std::array<float, padded>, BrickPyramid::max_floats> value;
};

ESTARA_KERNEL void gather(const Near& near, const GridLevel& level, RawBlock& raw) noexcept {
    const std::size_t floats = level.planes.size();
    std::array<const float*, BrickPyramid::max_floats> planes;
    for (std::size_t c = 0; c < floats; ++c) {
        planes[c] = level.planes[c].data();
        raw.value[c].fill(std::numeric_limits<float>::quiet_NaN());
    }
    for (std::size_t n = 0; n < 8; ++n) {
        if (near[n] == nullptr) continue;
        const std::size_t shift =
            8 * (((n >> 2) * RawBlock::side + ((n >> 1) & 1)) * RawBlock::side + (n & 1));
        const std::uint64_t wanted =
            (n & 2 ? y0 : ~std::uint64_t{0}) & (n & 1 ? z0 : ~std::uint64_t{0});
        std::uint64_t row = near[n]->first;
        for (std::size_t x = 0; x < (n & 4 ? 1 : 8); ++x) {
            const std::uint64_t active = near[n]->active.words[x];
            for (std::uint64_t left = active & wanted; left != 0; left &= left - 1) {
                const auto bit = std::size_t(std::countr_zero(left));
                const std::size_t to =
                    shift + x * RawBlock::side * RawBlock::side + bit + (bit >> 3);
                const std::uint64_t below = active & ((std::uint64_t{1} << bit) - 1);
                const std::uint64_t from = row + std::uint64_t(std::popcount(below));
                for (std::size_t c = 0; c < floats; ++c) raw.value[c][to] = planes[c][from];
            }
            row += std::uint64_t(std::popcount(active));
        }
    }
}

/// The part of a block's values that a brick holds.
ESTARA_KERNEL void cut(const std::array<float, RawBlock::padded>& block, std::uint32_t octant,
                       RawBrick& brick) noexcept {
    const std::size_t corner =
        4 *
        (((octant >> 2) * RawBlock::side + ((octant >> 1) & 1)) * RawBlock::side + (octant & 1));
    for (std::size_t x = 0; x < brick_side; ++x) {
        for (std::size_t y = 0; y < brick_side; ++y) {
            // Eight floats for five: what is too much is overwritten by the next row.
            const std::size_t row = corner + (x * RawBlock::side + y) * RawBlock::side;
            const std::size_t to = (x * brick_side + y) * brick_side;
            std::memcpy(brick.value.data() + to, block.data() + row, 8 * sizeof(float));
        }
    }
    for (std::size_t i = brick_voxels; i < RawBrick::size; ++i) {
        brick.value[i] = std::numeric_limits<float>::quiet_NaN();
    }
}

/// What fill_table() works on.
struct Filling {
    const GridLevel& level;
    const BrickIndex& index;
    std::span<const BrickPart> parts;
    std::span<const std::uint8_t> masks;
    std::size_t brick_words;
};

/// Asks for what gather() will read. Blocks are taken in the order of the index and their values
/// lie in the order of the level: the processor does not foresee it.
ESTARA_KERNEL void prefetch(const Near& near, const GridLevel& level) noexcept {
    constexpr std::size_t line = 64 / sizeof(float);
    for (std::size_t n = 0; n < 8; ++n) {
        if (near[n] == nullptr) continue;
        const std::size_t count = n < 4 ? std::size_t(near[n]->active.count())
                                        : std::size_t(std::popcount(near[n]->active.words[0]));
        for (const std::vector<float>& plane : level.planes) {
            const float* const values = plane.data() + near[n]->first;
            for (std::size_t i = 0; i < count; i += line) __builtin_prefetch(values + i);
        }
    }
}

/// Makes the bricks of one bottom table, from words on.
ESTARA_KERNEL void fill_table(const Filling& job, std::size_t table,
                              std::uint32_t* words) noexcept {
    std::array<std::uint32_t, BrickIndex::bottom_size> blocks;
    std::size_t size = 0;
    job.index.for_each_block(table, [&](std::uint32_t b) {
        if (job.masks[b] != 0) blocks[size++] = b;
    });
    if (size == 0) return;
    Near next = neighbours(job.level.blocks, job.index, blocks[0]);
    for (std::size_t i = 0; i < size; ++i) {
        const Near near = next;
        if (i + 1 < size) {
            next = neighbours(job.level.blocks, job.index, blocks[i + 1]);
            prefetch(next, job.level);
        }
        RawBlock raw;
        gather(near, job.level, raw);
        for (std::uint32_t left = job.masks[blocks[i]]; left != 0; left &= left - 1) {
            const auto octant = std::uint32_t(std::countr_zero(left));
            for (const BrickPart& part : job.parts) {
                std::array<RawBrick, 4> bricks;
                for (int c = 0; c < part.floats; ++c) {
                    cut(raw.value[std::size_t(part.first + c)], octant, bricks[std::size_t(c)]);
                }
                encode_brick(bricks.data(), part.floats, words + part.offset);
            }
            words += job.brick_words;
        }
    }
}

/// By block, which bricks hold one of the cells.
std::vector<std::uint8_t> bricks_of(std::span<const glm::ivec3> cells,
                                    const std::vector<Block>& blocks, const BrickIndex& index) {
    std::vector<std::uint8_t> masks(blocks.size(), 0);
    tbb::parallel_for(std::size_t{0}, cells.size(), [&](std::size_t i) {
        const glm::uvec3 cell(cells[i]);
        const std::uint32_t b = index.block_of(cell);
        if (b == BrickIndex::none) return;
        const glm::uvec3 octant = (cell >> 2u) & 1u;
        const auto bit = std::uint8_t(1u << (octant.x * 4 + octant.y * 2 + octant.z));
        std::atomic_ref(masks[b]).fetch_or(bit, std::memory_order_relaxed);
    });
    return masks;
}

}  // namespace

BrickLevel::BrickLevel(const GridLevel& level, std::span<const BrickPart> parts,
                       std::optional<std::span<const glm::ivec3>> cells, const std::string& where,
                       InstructionSet limit)
    : index(level.blocks, where), brick_words(0) {
    for (const BrickPart& part : parts) brick_words += BrickPart::words(part.floats);

    std::vector<std::uint8_t> masks = cells ? bricks_of(*cells, level.blocks, index)
                                            : std::vector<std::uint8_t>(level.blocks.size(), 255);
    std::vector<std::uint32_t> first(index.tables(), 0);  // first the number of bricks
    tbb::parallel_for(std::size_t{1}, index.tables(), [&](std::size_t table) {
        index.for_each_block(table, [&](std::uint32_t b) {
            if (masks[b] != 0) masks[b] &= complete_bricks(neighbours(level.blocks, index, b));
            first[table] += std::uint32_t(std::popcount(masks[b]));
        });
    });
    for (std::uint32_t& f : first) f = std::exchange(bricks, bricks + f);

    // A lookup in no order costs a quarter less in large pages.
    words = allocate_large_pages<std::uint32_t>(std::size_t(bricks) * brick_words);
    if (!words) throw std::bad_alloc();
    const Filling job{level, index, parts, masks, brick_words};
    tbb::parallel_for(std::size_t{1}, index.tables(), [&](std::size_t table) {
        std::uint32_t* const to = words.get() + std::size_t(first[table]) * brick_words;
        wide([&job, table, to]() ESTARA_LOOP { fill_table(job, table, to); }, limit);
    });
    index.set_bricks(masks, first);
}

}  // namespace estara
