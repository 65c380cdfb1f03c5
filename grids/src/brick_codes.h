// What a brick is in memory: 5^3 voxels as codes of a few bits, and the range that turns them back
// into values.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <limits>
#include "estara/shaders/kernel.h"

namespace estara {

/// Four and eight numbers that are computed with at once (extensions of g++ and clang).
using Floats4 [[gnu::vector_size(16)]] = float;
using Floats8 [[gnu::vector_size(32)]] = float;
using Ints8 [[gnu::vector_size(32)]] = std::int32_t;
using Words4 [[gnu::vector_size(32)]] = std::uint64_t;

constexpr std::uint32_t brick_side = 5;  // voxels along each axis: four and the apron
constexpr std::uint32_t brick_voxels = brick_side * brick_side * brick_side;

/// Where in a word the code of a float lies.
struct CodeField {
    int bits, shift;

    float largest() const noexcept { return float((1 << bits) - 1); }
    bool has_sign_bit() const noexcept { return bits + shift == 32; }
    std::uint32_t mask() const noexcept { return ((std::uint32_t{1} << bits) - 1) << shift; }
};

/// How up to four floats of a voxel share a 32-bit word. One alone has 23 bits: with half a code
/// added for rounding it is still exact as a float.
constexpr std::array<CodeField, 4> code_fields(int floats) noexcept {
    switch (floats) {
        case 1:
            return {{{23, 0}}};
        case 2:
            return {{{16, 0}, {16, 16}}};
        case 3:
            return {{{11, 0}, {11, 11}, {10, 22}}};
        default:
            return {{{8, 0}, {8, 8}, {8, 16}, {8, 24}}};
    }
}

/// Up to four floats of every voxel of a brick, in 32-bit words: the offset of each float, its
/// scale, and a word a voxel (x slowest). Five to eight floats are two parts, one after the other.
///
/// A code is used where it lies in its word, without a shift: value = offset + scale * (word &
/// mask), the power of two being part of the scale. A field that reaches the sign bit is stored
/// with that bit flipped, so that the signed word is code - half, and half is part of the offset.
struct BrickPart {
    int first, floats;                     ///< floats of the record: [first, first + floats)
    std::size_t offset;                    ///< words before it in its brick
    std::array<std::uint32_t, 8> masks{};  ///< of floats 0 0 1 1 2 2 3 3, 0 for one not there

    static constexpr std::size_t words(int floats) noexcept {
        return 2 * std::size_t(floats) + brick_voxels;
    }

    BrickPart(int first_float, int number_of_floats, std::size_t offset_in_brick) noexcept
        : first(first_float), floats(number_of_floats), offset(offset_in_brick) {
        for (std::size_t c = 0; c < std::size_t(floats); ++c) {
            masks[2 * c] = masks[2 * c + 1] = code_fields(floats)[c].mask();
        }
    }

    std::size_t header() const noexcept { return std::size_t(2 * floats); }  ///< words before codes
};

/// Place of a voxel among the codes of a brick.
constexpr std::uint32_t in_brick(std::uint32_t x, std::uint32_t y, std::uint32_t z) noexcept {
    return (x * brick_side + y) * brick_side + z;
}

/// A brick's values of one float before they become codes, NaN where a voxel is not active, and at
/// the end as well.
struct RawBrick {
    static constexpr int size = 128;
    alignas(32) std::array<float, size> value;
};

/// Codes of one part of a brick. Voxels that are not active get the middle of the range: no lookup
/// on the surface reads them, and one beside it sees nothing odd.
/// @param raw   part floats, each with an active voxel
/// @param part  BrickPart::words(floats) words
ESTARA_KERNEL void encode_brick(const RawBrick* raw, int floats, std::uint32_t* part) noexcept {
    const std::array<CodeField, 4> fields = code_fields(floats);
    std::uint32_t* const words = part + 2 * floats;
    for (int c = 0; c < floats; ++c) {
        const float* const value = raw[c].value.data();
        // The order of the comparisons leaves NaN out.
        constexpr float infinity = std::numeric_limits<float>::infinity();
        Floats8 lows = Floats8{} + infinity, highs = Floats8{} - infinity;
        for (int i = 0; i < RawBrick::size; i += 8) {
            Floats8 v;
            std::memcpy(&v, value + i, sizeof v);
            lows = v < lows ? v : lows;
            highs = v > highs ? v : highs;
        }
        float low = lows[0], high = highs[0];
        for (int k = 1; k < 8; ++k) {
            low = std::min(low, lows[k]);
            high = std::max(high, highs[k]);
        }
        const CodeField field = fields[std::size_t(c)];
        const float largest = field.largest();
        const auto step = float((double(high) - double(low)) / double(largest));
        const float per_step = std::min(1.0f / step, std::numeric_limits<float>::max());
        const std::int32_t flip =
            field.has_sign_bit() ? std::numeric_limits<std::int32_t>::min() : 0;
        for (int n = 0; n < RawBrick::size; n += 8) {
            const int i = std::min(n, int(brick_voxels) - 8);  // the last eight again, in part
            Floats8 v;
            std::memcpy(&v, value + i, sizeof v);
            Floats8 code = (v - low) * per_step;
            code = code == code ? code : Floats8{} + 0.5f * largest;
            code = (code < largest ? code : Floats8{} + largest) + 0.5f;
            const Ints8 bits = (__builtin_convertvector(code, Ints8) << field.shift) ^ flip;
            Ints8 word{};
            if (c > 0) std::memcpy(&word, words + i, sizeof word);
            word |= bits;
            std::memcpy(words + i, &word, sizeof word);
        }
        const float half = field.has_sign_bit() ? 0.5f * (largest + 1.0f) : 0.0f;
        const float range[2] = {float(double(low) + double(step) * double(half)),
                                step / float(std::uint32_t{1} << field.shift)};
        std::memcpy(part + c, &range[0], sizeof(float));
        std::memcpy(part + floats + c, &range[1], sizeof(float));
    }
}

/// Trilinear value of a cell: up to four floats, what is beyond them has no meaning.
/// @param part  the words of the part of the brick
/// @param cell  place of the cell's first voxel in the brick
/// @param xy    weights of the voxels (0, 0), (0, 1), (1, 0), (1, 1) along x and y
/// @param z     weights of the voxels 0, 1 along z
ESTARA_KERNEL Floats4 interpolate(const BrickPart& layout, const std::uint32_t* part,
                                  std::size_t cell, const std::array<float, 4>& xy,
                                  const std::array<float, 2>& z) noexcept {
    const std::uint32_t* const voxel = part + layout.header() + cell;
    Ints8 masks;
    std::memcpy(&masks, layout.masks.data(), sizeof masks);
    // Two voxels along z at once: lanes z z+1 z z+1 ..., the mask takes float 0 0 1 1 2 2 3 3.
    // (No function returns such a vector: without AVX the calling convention has none.)
    const auto load = [&](std::uint32_t x, std::uint32_t y, Floats8& codes) {
        std::uint64_t two;
        std::memcpy(&two, voxel + in_brick(x, y, 0), sizeof two);
        const Words4 copies = Words4{} + two;
        Ints8 words;
        std::memcpy(&words, &copies, sizeof words);
        codes = __builtin_convertvector(words & masks, Floats8);
    };
    Floats8 c00, c01, c10, c11;
    load(0, 0, c00);
    load(0, 1, c01);
    load(1, 0, c10);
    load(1, 1, c11);
    const Words4 z_copies = Words4{} + std::bit_cast<std::uint64_t>(z);
    Floats8 z_weights;
    std::memcpy(&z_weights, &z_copies, sizeof z_weights);
    const Floats8 c = ((xy[0] * c00 + xy[1] * c01) + (xy[2] * c10 + xy[3] * c11)) * z_weights;
    Floats4 half[2];
    std::memcpy(half, &c, sizeof half);
    const Floats4 sum = __builtin_shufflevector(half[0], half[1], 0, 2, 4, 6) +
                        __builtin_shufflevector(half[0], half[1], 1, 3, 5, 7);
    Floats4 offset, scale;
    std::memcpy(&offset, part, sizeof offset);
    std::memcpy(&scale, part + layout.floats, sizeof scale);
    return offset + scale * sum;
}

}  // namespace estara
