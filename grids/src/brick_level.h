// One level of a BrickPyramid: its index and its bricks.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "brick_codes.h"
#include "brick_index.h"
#include "estara/scenes/large_pages.h"
#include "estara/shaders/registry.h"

namespace estara {

/// At least -1, which NaN becomes too.
inline double not_below(double index) noexcept { return index > -1.0 ? index : -1.0; }
/// At most 2^30.
inline double not_above(double index) noexcept {
    constexpr double farthest = 1 << 30;
    return index < farthest ? index : farthest;
}
/// An index coordinate that may be anything, between -1 and 2^30, and so outside of every level
/// where it was; its floor fits an int.
inline double within_int(double index) noexcept { return not_above(not_below(index)); }

struct BrickLevel {
    BrickIndex index;
    std::size_t brick_words;  ///< of all parts
    std::uint32_t bricks = 0;
    LargePages<std::uint32_t> words;

    /// A brick for every 4^3 cells of which one has eight active voxels. In parallel.
    /// @param cells  if there, only the bricks that hold one of these are made
    /// @param where  begins the message of an Error
    BrickLevel(const GridLevel& level, std::span<const BrickPart> parts,
               std::optional<std::span<const glm::ivec3>> cells, const std::string& where,
               InstructionSet limit);

    std::uint64_t bytes() const noexcept {
        return index.bytes() + std::uint64_t(bricks) * brick_words * sizeof(std::uint32_t);
    }
};

}  // namespace estara
