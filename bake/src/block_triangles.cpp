#include "block_triangles.h"

#include <tbb/parallel_for.h>
#include <tbb/parallel_sort.h>

#include <bit>

#include "triangle_boxes.h"

namespace estara {

namespace {

/// Triangles that are listed together. A fixed number, so that threads change nothing.
constexpr std::size_t chunk_size = 8192;

/// A block's coordinates as one number that sorts by (x, y, z).
constexpr int key_bits = 21;
std::uint64_t key_of(int x, int y, int z) noexcept {
    return (std::uint64_t(x) << (2 * key_bits)) | (std::uint64_t(y) << key_bits) | std::uint64_t(z);
}
glm::ivec3 block_of(std::uint64_t key) noexcept {
    constexpr std::uint64_t mask = (std::uint64_t{1} << key_bits) - 1;
    return {int(key >> (2 * key_bits)), int((key >> key_bits) & mask), int(key & mask)};
}

/// Numbers keys in the order in which they are first seen: a hash table with linear probing.
class Numbering {
public:
    std::uint32_t number(std::uint64_t key) {
        if (2 * keys.size() >= m_slots.size()) grow();
        const std::size_t at = find(key);
        if (m_slots[at] == 0) {
            keys.push_back(key);
            m_slots[at] = std::uint32_t(keys.size());
        }
        return m_slots[at] - 1;
    }

    std::vector<std::uint64_t> keys;  ///< by number

private:
    std::size_t find(std::uint64_t key) const noexcept {
        std::size_t at = std::size_t((key * 0x9e3779b97f4a7c15u) >> 32) & (m_slots.size() - 1);
        while (m_slots[at] != 0 && keys[m_slots[at] - 1] != key) {
            at = (at + 1) & (m_slots.size() - 1);
        }
        return at;
    }
    void grow() {
        m_slots.assign(std::max<std::size_t>(64, 4 * m_slots.size()), 0);
        for (std::size_t i = 0; i < keys.size(); ++i) {
            m_slots[find(keys[i])] = std::uint32_t(i + 1);
        }
    }

    std::vector<std::uint32_t> m_slots;  ///< number + 1, or 0
};

/// What a chunk of triangles has to say.
struct Chunk {
    struct Entry {
        std::uint32_t block;  ///< its number in this chunk
        std::uint32_t triangle;
    };
    std::vector<Entry> entries;
    std::vector<std::uint64_t> keys;   ///< of its blocks
    std::vector<std::uint32_t> count;  ///< of entries, by block
    std::vector<std::uint32_t> block;  ///< among all blocks
    std::vector<std::uint64_t> next;   ///< where its next triangle goes
};

/// Calls f(x, y, z) for every block with a voxel whose cells (-1 to 7 of it) a triangle meets.
template <class F>
void for_each_block(const std::array<glm::dvec3, 3>& v, double slack, F&& f) {
    glm::ivec3 lo, hi;
    for (int c = 0; c < 3; ++c) {
        lo[c] = ceil_to_int(std::min({v[0][c], v[1][c], v[2][c]}) - (1.0 + slack)) >> 3;
        hi[c] = (floor_to_int(std::max({v[0][c], v[1][c], v[2][c]}) + slack) + 1) >> 3;
    }
    if (lo == hi) return f(lo.x, lo.y, lo.z);

    // Twice the slack: what rounding does to the cells' test must not reach this one.
    const TriangleBoxes boxes({v[0] / 8.0, v[1] / 8.0, v[2] / 8.0}, -(1.0 + 2.0 * slack) / 8.0,
                              (9.0 + 4.0 * slack) / 8.0);
    for (int x = lo.x; x <= hi.x; ++x) {
        Range ys{double(lo.y), double(hi.y)}, zs{double(lo.z), double(hi.z)};
        clip(ys, boxes.y_of_x(x));
        clip(zs, boxes.z_of_x(x));
        if (!(ys.lo <= ys.hi && zs.lo <= zs.hi)) continue;
        for (int y = ceil_to_int(ys.lo); y <= floor_to_int(ys.hi); ++y) {
            Range row = zs;
            clip(row, boxes.z_of_y(y));
            clip(row, boxes.z_of_plane(x, y));
            if (!(row.lo <= row.hi)) continue;
            for (int z = ceil_to_int(row.lo); z <= floor_to_int(row.hi); ++z) f(x, y, z);
        }
    }
}

Chunk list_chunk(const Mesh& mesh, const Lattice& lattice, std::size_t begin, std::size_t end) {
    Chunk chunk;
    Numbering blocks;
    std::uint64_t last_key = ~std::uint64_t{0};  // neighbours in the list are so in space, mostly
    std::uint32_t last = 0;
    for (std::size_t t = begin; t < end; ++t) {
        for_each_block(lattice.corners(mesh, t), lattice.slack, [&](int x, int y, int z) {
            const std::uint64_t key = key_of(x, y, z);
            if (key != last_key) {
                last_key = key;
                last = blocks.number(key);
                chunk.count.resize(blocks.keys.size());
            }
            chunk.entries.push_back({last, std::uint32_t(t)});
            ++chunk.count[last];
        });
    }
    chunk.keys = std::move(blocks.keys);
    return chunk;
}

}  // namespace

BlockTriangles triangles_by_block(const Mesh& mesh, const Lattice& lattice) {
    std::vector<Chunk> chunks((mesh.triangles.size() + chunk_size - 1) / chunk_size);
    tbb::parallel_for(std::size_t{0}, chunks.size(), [&](std::size_t c) {
        chunks[c] = list_chunk(mesh, lattice, c * chunk_size,
                               std::min((c + 1) * chunk_size, mesh.triangles.size()));
    });

    std::vector<std::uint64_t> keys;
    for (const Chunk& chunk : chunks) keys.insert(keys.end(), chunk.keys.begin(), chunk.keys.end());
    tbb::parallel_sort(keys);
    keys.erase(std::unique(keys.begin(), keys.end()), keys.end());

    tbb::parallel_for(std::size_t{0}, chunks.size(), [&](std::size_t c) {
        for (const std::uint64_t key : chunks[c].keys) {
            const auto found = std::lower_bound(keys.begin(), keys.end(), key);
            chunks[c].block.push_back(std::uint32_t(found - keys.begin()));
        }
    });

    // A counting sort. Chunks write behind one another, in order.
    BlockTriangles result;
    result.first.assign(keys.size() + 1, 0);
    for (const Chunk& chunk : chunks) {
        for (std::size_t i = 0; i < chunk.block.size(); ++i) {
            result.first[chunk.block[i] + 1] += chunk.count[i];
        }
    }
    for (std::size_t b = 0; b < keys.size(); ++b) result.first[b + 1] += result.first[b];
    std::vector<std::uint64_t> next(result.first.begin(), result.first.end() - 1);
    for (Chunk& chunk : chunks) {
        chunk.next.resize(chunk.block.size());
        for (std::size_t i = 0; i < chunk.block.size(); ++i) {
            chunk.next[i] = next[chunk.block[i]];
            next[chunk.block[i]] += chunk.count[i];
        }
    }
    result.triangles.resize(result.first.back());
    tbb::parallel_for(std::size_t{0}, chunks.size(), [&](std::size_t c) {
        for (const Chunk::Entry& e : chunks[c].entries) {
            result.triangles[chunks[c].next[e.block]++] = e.triangle;
        }
        chunks[c] = Chunk();
    });

    result.blocks.reserve(keys.size());
    for (const std::uint64_t key : keys) result.blocks.push_back(block_of(key));
    return result;
}

}  // namespace estara
