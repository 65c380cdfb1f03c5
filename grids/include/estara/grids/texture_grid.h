// A shader's view-independent values on the voxels around a surface, and the .vdb file that holds
// them. No OpenVDB type is seen here: only src/vdb_*.cpp pay for its headers.
#pragma once

#include <glm/glm.hpp>

#include <array>
#include <bit>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

namespace estara {

/// 512 bits, one a voxel (or cell) of an 8^3 block. Bit of local (x, y, z): x*64 + y*8 + z, so word
/// x and bit y*8 + z: OpenVDB's own leaf order.
struct BlockMask {
    std::array<std::uint64_t, 8> words{};

    static constexpr int bit(int x, int y, int z) noexcept { return (x << 6) | (y << 3) | z; }
    bool test(int i) const noexcept { return (words[i >> 6] >> (i & 63)) & 1u; }
    void set(int i) noexcept { words[i >> 6] |= std::uint64_t{1} << (i & 63); }
    int count() const noexcept {
        int n = 0;
        for (const std::uint64_t w : words) n += std::popcount(w);
        return n;
    }
    /// How many are set before bit i.
    int before(int i) const noexcept {
        int n = std::popcount(words[i >> 6] & ((std::uint64_t{1} << (i & 63)) - 1));
        for (int w = 0; w < i >> 6; ++w) n += std::popcount(words[w]);
        return n;
    }
    bool any() const noexcept {
        std::uint64_t all = 0;
        for (const std::uint64_t w : words) all |= w;
        return all != 0;
    }
    bool operator==(const BlockMask&) const = default;
};

/// Calls f(x, y, z) for every set bit, in bit order, with local coordinates in [0, 8).
template <class F>
void for_each_bit(const BlockMask& mask, F&& f) {
    for (int x = 0; x < 8; ++x) {
        for (std::uint64_t left = mask.words[std::size_t(x)]; left != 0; left &= left - 1) {
            const int bit = std::countr_zero(left);
            f(x, bit >> 3, bit & 7);
        }
    }
}

/// The active voxels of an 8^3 block, and where their values start.
struct Block {
    glm::ivec3 origin{
        0};  ///< index space, of the voxel with the smallest coordinates; multiples of 8, >= 0
    BlockMask active;         ///< never empty
    std::uint64_t first = 0;  ///< row of its first active voxel; the others follow in bit order
};

/// One level of detail. Voxel centres lie at whole index coordinates; voxel (i, j, k) of level n
/// has the position of voxel (2i, 2j, 2k) of level n - 1.
struct GridLevel {
    std::vector<Block> blocks;  ///< ascending by (x, y, z) of origin
    /// Cells (unit cubes between eight voxels, named by the smallest corner) that the surface
    /// crosses, by block in the same order; a block may have voxels and no cell. Not stored in
    /// files.
    std::vector<BlockMask> cells;
    /// planes[c][row]: float c of the baked record, row as Block::first says.
    std::vector<std::vector<float>> planes;

    std::uint64_t voxels() const noexcept {
        return blocks.empty() ? 0
                              : blocks.back().first + std::uint64_t(blocks.back().active.count());
    }
};

struct GridChannel {
    std::string name;  ///< "color", "specular", ...: the grid's name in the file
    int components;    ///< 1 or 3
};

/// Error of what a lookup returns against the shader itself, over random points of the surface.
struct ErrorFigures {
    double mean = 0.0, rmse = 0.0, p99 = 0.0, p999 = 0.0,
           max = 0.0;           ///< of |difference| of a component
    std::uint64_t samples = 0;  ///< surface points
};

/// An object's baked shader: a pyramid of levels in the object's space. An object may have several,
/// of different shaders, with voxels and levels of their own.
struct TextureGrid {
    std::string object;       ///< the scene's name for it; grids carry it in a file of several
    double voxel_size = 1.0;  ///< edge of a voxel of level 0, object space
    glm::dvec3 origin{0.0};   ///< object position of index (0, 0, 0), on every level
    std::vector<GridChannel> channels;
    std::vector<GridLevel> levels;  ///< finest first, at least one

    /// Signed distance to the nearest triangle at level 0's voxels, object space, by row; negative
    /// behind the surface. Becomes the grid "surface". Empty after reading a file.
    std::vector<float> distance;
    bool closed = false;  ///< the mesh is watertight: the inside of "surface" is filled

    std::string shader;  ///< its name
    std::vector<std::pair<std::string, std::vector<float>>>
        params;  ///< every parameter, 1 or 3 floats
    std::string shader_digest, mesh_digest;
    std::string lights_digest;         ///< of the lights that light was computed from; else empty
    std::vector<ErrorFigures> errors;  ///< by channel; may be empty
    std::string request;  ///< digest of all that the whole file was asked to be; may be empty
    std::string tool_version;

    int floats() const noexcept {
        int n = 0;
        for (const GridChannel& c : channels) n += c.components;
        return n;
    }
};

/// Adds coarser levels until one is at most 16 voxels a side.
///
/// A voxel of level n + 1 is active if a cell around it holds a cell of level n that the surface
/// crosses, so that every trilinear lookup on the surface finds its eight voxels. Its value is the
/// tent-weighted (1 2 1 in each axis) mean of the active voxels of level n around it: a function of
/// the surface's own values, never of empty space. Needs levels[0] with cells; forgets nothing.
void add_levels(TextureGrid& grid);

/// Rounds every value to the nearest half float, as saving with half precision will: done before
/// the error is measured, so that the figure includes it.
void round_to_half(TextureGrid& grid);

enum class Compression { zip, blosc, none };

struct VdbWriteOptions {
    Compression compression = Compression::zip;
    bool half = false;  ///< save values as half floats (call round_to_half() first)
};

/// Writes grids of one or several objects as a .vdb file that any OpenVDB program can read
/// (grids/README.md is the format). A name that a reader would see twice is an Error. Takes at
/// most some 6 bytes of memory a voxel, and 4 MB a thread, beside the grids.
///
/// Written to a temporary file in the same folder, closed, size compared, reopened and compared
/// with what was meant to be written (grid list, digest of every piece), fsync'd and renamed: under
/// `path` there is a whole file or what was there before. Error (failed) if the disk is full.
/// @return size of the file in bytes
std::uint64_t write_vdb(const std::string& path, const std::vector<TextureGrid>& grids,
                        const VdbWriteOptions& options);

/// Reads what write_vdb() wrote, by object and shader in the order of their names. `distance` and
/// `cells` are not read.
/// Error: not a .vdb, truncated, damaged, not made by estara-bake, missing level or channel, a
/// value that is not finite. In parallel.
std::vector<TextureGrid> read_vdb(const std::string& path);

}  // namespace estara
