// Bricks: the lookup structure of rendering. README.md of this folder draws it.
#include "estara/grids/bricks.h"

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

#include "blocks.h"
#include "estara/scenes/error.h"

namespace estara {
namespace {

constexpr int side = 9;  // 8 voxels and the apron
constexpr int voxels = side * side * side;
constexpr int table_size = 16 * 16 * 16;                       // entries of a table
constexpr int brick_bits = 3, table_bits = 7, root_bits = 11;  // 8, 16 * 8, 16 * 16 * 8 voxels
constexpr int max_extent = 1 << 18;

/// Four floats of a voxel, side by side in a register (extensions of g++ and clang).
using Codes8 [[gnu::vector_size(16)]] = std::uint16_t;
using Ints4 [[gnu::vector_size(16)]] = std::int32_t;
using Floats4 [[gnu::vector_size(16)]] = float;

/// Reads eight codes and takes four: each beside a zero is a 32-bit whole number.
Floats4 load4(const std::uint16_t* codes) noexcept {
    Codes8 c;
    std::memcpy(&c, codes, sizeof c);
    const Codes8 wide = __builtin_shufflevector(c, Codes8{}, 0, 8, 1, 9, 2, 10, 3, 11);
    return __builtin_convertvector(std::bit_cast<Ints4>(wide), Floats4);
}

Floats4 load4(const float* values) noexcept {
    Floats4 v;
    std::memcpy(&v, values, sizeof v);
    return v;
}

/// Turns a brick's codes back into values: least + step * code.
struct Range {
    float least, step;
};

/// A brick's values before they become codes.
struct RawBrick {
    float value[BrickPyramid::max_floats][voxels];
    bool active[voxels];
};

std::size_t in_brick(const glm::ivec3& p) noexcept {
    return std::size_t((p.x * side + p.y) * side + p.z);
}

/// Which of a table's entries a voxel belongs to, the entries being 2^bits voxels wide.
std::size_t in_table(const glm::ivec3& p, int bits) noexcept {
    const glm::ivec3 q = (p >> bits) & 15;
    return std::size_t((q.x << 8) | (q.y << 4) | q.z);
}

/// Copies block b and what of its seven neighbours lies in the apron.
void gather(const GridLevel& level, const glm::ivec3& origin, int floats, RawBrick& raw) {
    std::fill(std::begin(raw.active), std::end(raw.active), false);
    for (int n = 0; n < 8; ++n) {
        const glm::ivec3 shift = 8 * glm::ivec3(n >> 2, (n >> 1) & 1, n & 1);
        const std::ptrdiff_t found = find_block(level.blocks, origin + shift);
        if (found < 0) continue;
        const Block& block = level.blocks[std::size_t(found)];
        std::uint64_t row = block.first;
        for_each_bit(block.active, [&](int x, int y, int z) {
            const glm::ivec3 p = shift + glm::ivec3(x, y, z);
            if (glm::all(glm::lessThan(p, glm::ivec3(side)))) {
                const std::size_t i = in_brick(p);
                raw.active[i] = true;
                for (int c = 0; c < floats; ++c) {
                    raw.value[c][i] = level.planes[std::size_t(c)][row];
                }
            }
            ++row;
        });
    }
}

/// Codes of float c. Voxels that are not active get the mean of those that are: no lookup on the
/// surface reads them, and one beside it sees nothing odd.
Range encode(const RawBrick& raw, int c, int floats, std::uint16_t* codes) {
    double low = std::numeric_limits<double>::infinity(), high = -low, sum = 0.0;
    int count = 0;
    for (int i = 0; i < voxels; ++i) {
        if (!raw.active[i]) continue;
        const double v = raw.value[c][i];
        low = std::min(low, v);
        high = std::max(high, v);
        sum += v;
        ++count;
    }
    const double mean = sum / count;
    const Range range{float(low), float((high - low) / 65535.0)};
    const double inverse = range.step > 0.0f ? 1.0 / double(range.step) : 0.0;
    for (int i = 0; i < voxels; ++i) {
        const double v = raw.active[i] ? double(raw.value[c][i]) : mean;
        const double code = std::clamp(std::nearbyint((v - low) * inverse), 0.0, 65535.0);
        codes[i * floats + c] = std::uint16_t(code);
    }
    return range;
}

std::string title(const TextureGrid& grid) {
    return grid.object.empty() ? "texture grid" : fmt::format("object \"{}\"", grid.object);
}

}  // namespace

/// A point located on a level: its cell's first voxel, its brick's range and where in the cell it
/// is.
struct BrickPyramid::Tap {
    const std::uint16_t* voxel = nullptr;  ///< null: no brick there
    const float* range = nullptr;
    glm::vec3 f{0.0f};

    /// Asks memory for the four pairs of voxels and the range.
    void prefetch(int floats) const noexcept {
        if (voxel == nullptr) return;
        for (int row = 0; row < 4; ++row) {
            __builtin_prefetch(voxel + ((row >> 1) * side + (row & 1)) * side * floats);
        }
        __builtin_prefetch(range);
    }
};

/// One level: root table over the bounding box -> tables of 16^3 -> tables of 16^3 brick numbers.
/// Table 0 of both kinds is full of zeros and brick 0 means none, so that the way down needs no
/// test but the last.
struct BrickPyramid::Level {
    double per_voxel = 1.0;             // index units per unit of object space
    glm::ivec3 low{0};                  // index of the bounding box's corner, multiple of 8
    glm::dvec3 begin{0.0}, end{0.0};    // the bounding box, index space
    glm::ivec3 roots{1};                // entries of the root table along each axis
    std::vector<std::uint32_t> root;    // number of a middle table; an entry is 2048 voxels wide
    std::vector<std::uint32_t> middle;  // number of a bottom table; 128 voxels
    std::vector<std::uint32_t> bottom;  // number of a brick; 8 voxels
    std::vector<std::uint16_t> codes;   // brick, voxel (x slowest), float
    std::vector<float> ranges;          // brick, least of each float, step of each float

    Level(const GridLevel& level, int floats, double voxel_size, const std::string& where);
    void set_bounds(const GridLevel& level, const std::string& where);
    void build_index(const GridLevel& level);
    void fill_bricks(const GridLevel& level, int floats);
    std::uint64_t bytes() const noexcept;

    /// Number of the brick that holds a voxel, or 0.
    std::uint32_t brick_of(const glm::ivec3& voxel) const noexcept {
        const glm::ivec3 r = voxel >> root_bits;
        const std::uint32_t m =
            root[std::size_t((r.x * roots.y + r.y)) * std::size_t(roots.z) + std::size_t(r.z)];
        const std::uint32_t t = middle[std::size_t(m) * table_size + in_table(voxel, table_bits)];
        return bottom[std::size_t(t) * table_size + in_table(voxel, brick_bits)];
    }

    /// @param from_origin  position relative to index (0, 0, 0), object space
    Tap locate(const glm::dvec3& from_origin, int floats) const noexcept;
};

BrickPyramid::Level::Level(const GridLevel& level, int floats, double voxel_size,
                           const std::string& where)
    : per_voxel(1.0 / voxel_size) {
    set_bounds(level, where);
    build_index(level);
    fill_bricks(level, floats);
}

void BrickPyramid::Level::set_bounds(const GridLevel& level, const std::string& where) {
    glm::ivec3 high(0);
    if (!level.blocks.empty()) low = high = level.blocks.front().origin;
    for (const Block& block : level.blocks) {
        low = glm::min(low, block.origin);
        high = glm::max(high, block.origin + 8);
    }
    begin = glm::dvec3(low);
    end = glm::dvec3(high);
    const glm::ivec3 extent = high - low;
    const int widest = std::max({extent.x, extent.y, extent.z});
    if (widest > max_extent) {
        throw Error(fmt::format("{}: {} voxels wide, more than {}; bake it with larger voxels",
                                where, widest, max_extent));
    }
    roots = glm::max(((extent - 1) >> root_bits) + 1, glm::ivec3(1));
}

void BrickPyramid::Level::build_index(const GridLevel& level) {
    root.assign(std::size_t(roots.x) * std::size_t(roots.y) * std::size_t(roots.z), 0);
    middle.assign(table_size, 0);
    bottom.assign(table_size, 0);
    const auto table = [](std::uint32_t& number, std::vector<std::uint32_t>& tables) {
        if (number == 0) {
            number = std::uint32_t(tables.size() / table_size);
            tables.resize(tables.size() + table_size, 0);
        }
        return std::size_t(number) * table_size;
    };
    for (std::size_t b = 0; b < level.blocks.size(); ++b) {
        const glm::ivec3 voxel = level.blocks[b].origin - low;
        const glm::ivec3 r = voxel >> root_bits;
        std::uint32_t& m =
            root[std::size_t((r.x * roots.y + r.y)) * std::size_t(roots.z) + std::size_t(r.z)];
        std::uint32_t& t = middle[table(m, middle) + in_table(voxel, table_bits)];
        bottom[table(t, bottom) + in_table(voxel, brick_bits)] = std::uint32_t(b + 1);
    }
}

void BrickPyramid::Level::fill_bricks(const GridLevel& level, int floats) {
    const std::size_t brick_codes = std::size_t(voxels) * std::size_t(floats);
    codes.resize(level.blocks.size() * brick_codes + max_floats);  // lookup() reads a little on
    ranges.resize(level.blocks.size() * 2 * std::size_t(floats) + max_floats);
    tbb::parallel_for(std::size_t{0}, level.blocks.size(), [&](std::size_t b) {
        RawBrick raw;
        gather(level, level.blocks[b].origin, floats, raw);
        float* range = ranges.data() + b * 2 * std::size_t(floats);
        for (int c = 0; c < floats; ++c) {
            const Range r = encode(raw, c, floats, codes.data() + b * brick_codes);
            range[c] = r.least;
            range[floats + c] = r.step;
        }
    });
}

std::uint64_t BrickPyramid::Level::bytes() const noexcept {
    return (root.size() + middle.size() + bottom.size()) * sizeof(std::uint32_t) +
           codes.size() * sizeof(std::uint16_t) + ranges.size() * sizeof(float);
}

BrickPyramid::Tap BrickPyramid::Level::locate(const glm::dvec3& from_origin,
                                              int floats) const noexcept {
    const glm::dvec3 index = from_origin * per_voxel;
    // Written so that NaN is outside; within, coordinates fit an int.
    const bool inside = (index.x >= begin.x) & (index.y >= begin.y) & (index.z >= begin.z) &
                        (index.x < end.x) & (index.y < end.y) & (index.z < end.z);
    if (!inside) return {};
    const glm::ivec3 base(index);  // index >= 0, so this rounds down
    const std::uint32_t number = brick_of(base - low);
    if (number == 0) return {};
    const std::size_t voxel = std::size_t(number - 1) * voxels + in_brick((base - low) & 7);
    return {codes.data() + voxel * std::size_t(floats),
            ranges.data() + std::size_t(number - 1) * 2 * std::size_t(floats),
            glm::vec3(index - glm::dvec3(base))};
}

namespace {

/// Trilinear value of a tap, four floats at a time; with 3 floats the fourth lane reads on into the
/// next voxel, and is dropped.
/// @tparam N  number of floats
template <int N>
void interpolate(const std::uint16_t* voxel, const float* range, const glm::vec3& f,
                 float* out) noexcept {
    const glm::vec3 e = 1.0f - f;
    const float xy[4] = {e.x * e.y, e.x * f.y, f.x * e.y, f.x * f.y};
    for (int c = 0; c < N; c += 4) {
        Floats4 sum = {};
        for (int corner = 0; corner < 4; ++corner) {
            const std::uint16_t* near =
                voxel + ((corner >> 1) * side * side + (corner & 1) * side) * N + c;
            sum += xy[corner] * (e.z * load4(near) + f.z * load4(near + N));
        }
        const Floats4 value = load4(range + c) + load4(range + N + c) * sum;
        for (int k = c; k < std::min(c + 4, N); ++k) out[k] = value[k - c];
    }
}

void interpolate(const std::uint16_t* voxel, const float* range, const glm::vec3& f, int floats,
                 float* out) noexcept {
    switch (floats) {
        case 1:
            return interpolate<1>(voxel, range, f, out);
        case 2:
            return interpolate<2>(voxel, range, f, out);
        case 3:
            return interpolate<3>(voxel, range, f, out);
        case 4:
            return interpolate<4>(voxel, range, f, out);
        case 5:
            return interpolate<5>(voxel, range, f, out);
        case 6:
            return interpolate<6>(voxel, range, f, out);
        case 7:
            return interpolate<7>(voxel, range, f, out);
        default:
            return interpolate<8>(voxel, range, f, out);
    }
}

}  // namespace

BrickPyramid::~BrickPyramid() = default;
BrickPyramid::BrickPyramid(BrickPyramid&&) noexcept = default;
BrickPyramid& BrickPyramid::operator=(BrickPyramid&&) noexcept = default;

BrickPyramid::BrickPyramid(const TextureGrid& grid)
    : m_floats(grid.floats()), m_voxel_size(grid.voxel_size), m_origin(grid.origin) {
    if (m_floats < 1 || m_floats > max_floats) {
        throw Error(fmt::format("{}: {} floats a voxel; a lookup takes 1 to {}", title(grid),
                                m_floats, max_floats));
    }
    check_finite(grid, title(grid));
    for (std::size_t n = 0; n < grid.levels.size(); ++n) {
        m_levels.emplace_back(grid.levels[n], m_floats, std::ldexp(m_voxel_size, int(n)),
                              title(grid));
    }
    const std::vector<float> means = plane_means(grid);
    std::copy(means.begin(), means.end(), m_mean.begin());
}

int BrickPyramid::levels() const noexcept { return int(m_levels.size()); }

std::uint64_t BrickPyramid::bytes() const noexcept {
    std::uint64_t sum = 0;
    for (const Level& level : m_levels) sum += level.bytes();
    return sum;
}

/// The value of one tap or of two blended; the mean where there is no brick.
bool BrickPyramid::blend(const Tap& fine, const Tap& coarse, float weight,
                         float* out) const noexcept {
    if (fine.voxel == nullptr) {
        std::copy_n(m_mean.begin(), m_floats, out);
        return false;
    }
    interpolate(fine.voxel, fine.range, fine.f, m_floats, out);
    // Beside the surface the coarser level may have nothing: then the finer one alone.
    if (coarse.voxel == nullptr) return true;
    float value[max_floats];
    interpolate(coarse.voxel, coarse.range, coarse.f, m_floats, value);
    for (int c = 0; c < m_floats; ++c) out[c] += (value[c] - out[c]) * weight;
    return true;
}

bool BrickPyramid::lookup(const glm::vec3& P, int level, float* out) const noexcept {
    const Tap tap = m_levels[std::size_t(level)].locate(glm::dvec3(P) - m_origin, m_floats);
    return blend(tap, {}, 0.0f, out);
}

bool BrickPyramid::lookup(const glm::vec3& P, float footprint, float* out) const noexcept {
    std::uint8_t found = 0;
    lookup({&P, 1}, {&footprint, 1}, out, 1, &found);
    return found != 0;
}

void BrickPyramid::lookup(std::span<const glm::vec3> P, std::span<const float> footprints,
                          float* planes, std::size_t stride, std::uint8_t* found) const noexcept {
    constexpr std::size_t in_flight = 32;  // points whose voxels are on their way at once
    struct Pair {
        Tap fine, coarse;
        float weight;
    };
    std::array<Pair, in_flight> pairs;
    float value[max_floats];
    for (std::size_t first = 0; first < P.size(); first += in_flight) {
        const std::size_t count = std::min(in_flight, P.size() - first);
        for (std::size_t i = 0; i < count; ++i) {
            const glm::dvec3 p = glm::dvec3(P[first + i]) - m_origin;
            const float level = level_for(footprints[first + i]);
            const auto fine = std::size_t(level);
            Pair& pair = pairs[i];
            pair.weight = level - float(fine);
            pair.fine = m_levels[fine].locate(p, m_floats);
            pair.coarse = pair.weight > 0.0f ? m_levels[fine + 1].locate(p, m_floats) : Tap{};
            pair.fine.prefetch(m_floats);
            pair.coarse.prefetch(m_floats);
        }
        for (std::size_t i = 0; i < count; ++i) {
            found[first + i] = blend(pairs[i].fine, pairs[i].coarse, pairs[i].weight, value);
            for (int c = 0; c < m_floats; ++c) {
                planes[std::size_t(c) * stride + first + i] = value[c];
            }
        }
    }
}

float BrickPyramid::level_for(float footprint) const noexcept {
    if (!(footprint > 0.0f)) return 0.0f;
    const float level = std::log2(footprint / float(m_voxel_size)) + level_bias;
    return std::clamp(level, 0.0f, float(levels() - 1));
}

}  // namespace estara
