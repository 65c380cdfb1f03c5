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
    int first, floats;   ///< floats of the record: [first, first + floats)
    std::size_t offset;  ///< words before it in its brick

    /// Words before the codes.
    static constexpr std::size_t header(int floats) noexcept { return 2 * std::size_t(floats); }
    static constexpr std::size_t words(int floats) noexcept {
        return header(floats) + brick_voxels;
    }
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
    std::uint32_t* const words = part + BrickPart::header(floats);
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

/// Points that are interpolated at once.
constexpr std::size_t lanes = 4;

/// Trilinear values of four cells, each in a brick of its own.
/// @param part   where the part begins in each brick
/// @param cell   place of each cell's first voxel in its brick
/// @param x,y,z  how far each point is from that voxel to the next one, [0, 1]
/// @param value  one for every float: of the four points
template <int floats>
ESTARA_KERNEL void interpolate_cells(const std::array<const std::uint32_t*, lanes>& part,
                                     const std::array<std::uint32_t, lanes>& cell, const Floats4& x,
                                     const Floats4& y, const Floats4& z, Floats4* value) noexcept {
    constexpr std::array<CodeField, 4> fields = code_fields(floats);
    // Two voxels along z and four points side by side: lanes are the voxels z, z + 1 of the first
    // point, of the second, ... (No function returns such a vector: without AVX the calling
    // convention has none.)
    const auto load = [&](std::uint32_t voxel_x, std::uint32_t voxel_y, Ints8& words) {
        std::array<std::uint64_t, lanes> two;
        for (std::size_t i = 0; i < lanes; ++i) {
            std::memcpy(
                &two[i],
                part[i] + BrickPart::header(floats) + cell[i] + in_brick(voxel_x, voxel_y, 0),
                sizeof two[i]);
        }
        const Words4 side_by_side{two[0], two[1], two[2], two[3]};
        std::memcpy(&words, &side_by_side, sizeof words);
    };
    Ints8 w00, w01, w10, w11;
    load(0, 0, w00);
    load(0, 1, w01);
    load(1, 0, w10);
    load(1, 1, w11);
    const Floats8 far_x = __builtin_shufflevector(x, x, 0, 0, 1, 1, 2, 2, 3, 3),
                  far_y = __builtin_shufflevector(y, y, 0, 0, 1, 1, 2, 2, 3, 3);
    const Floats8 near_x = 1.0f - far_x, near_y = 1.0f - far_y;
    const Floats8 c00 = near_x * near_y, c01 = near_x * far_y, c10 = far_x * near_y,
                  c11 = far_x * far_y;
    const Floats4 near_z = 1.0f - z;
    const Floats8 along_z = __builtin_shufflevector(near_z, z, 0, 4, 1, 5, 2, 6, 3, 7);
    for (std::size_t c = 0; c < std::size_t(floats); ++c) {
        const auto mask = std::int32_t(fields[c].mask());
        const auto codes = [&](const Ints8& words, Floats8& codes_of_c) {
            codes_of_c = __builtin_convertvector(words & mask, Floats8);
        };
        Floats8 v00, v01, v10, v11;
        codes(w00, v00);
        codes(w01, v01);
        codes(w10, v10);
        codes(w11, v11);
        const Floats8 sum = ((c00 * v00 + c01 * v01) + (c10 * v10 + c11 * v11)) * along_z;
        const Floats4 blended = __builtin_shufflevector(sum, sum, 0, 2, 4, 6) +
                                __builtin_shufflevector(sum, sum, 1, 3, 5, 7);
        Floats4 offset, scale;
        for (std::size_t i = 0; i < lanes; ++i) {
            offset[i] = std::bit_cast<float>(part[i][c]);
            scale[i] = std::bit_cast<float>(part[i][std::size_t(floats) + c]);
        }
        value[c] = offset + scale * blended;
    }
}

}  // namespace estara
