#include "vdb_tree.h"

#include <array>
#include <tuple>

namespace estara {
namespace {

constexpr int leaf_bits = 3, lower_bits = 7, upper_bits = 12;  // log2 of voxels along an edge
constexpr int max_index = 1 << 30;

/// Reads masks as words of 64 bits.
template <std::size_t bits>
std::array<std::uint64_t, bits / 64> take_mask(ByteCursor& in) {
    return in.number<std::array<std::uint64_t, bits / 64>>();
}

class TopologyReader {
public:
    TopologyReader(ByteCursor in, const ValueFormat& format) : m_in(in), m_format(format) {}

    std::vector<StoredLeaf> leaves() {
        const std::size_t value_size = std::size_t(m_format.components) * sizeof(float);
        m_in.skip(sizeof(std::int32_t) + value_size);
        const auto tiles = m_in.number<std::uint32_t>(), children = m_in.number<std::uint32_t>();
        for (std::uint32_t i = 0; i < tiles; ++i) {
            m_in.skip(sizeof(glm::ivec3) + value_size);
            if (m_in.number<char>() != 0) throw BadTree{"was pruned"};
        }
        for (std::uint32_t i = 0; i < children; ++i) {
            const auto origin = m_in.number<glm::ivec3>();
            for (int axis = 0; axis < 3; ++axis) {
                if (origin[axis] < 0 || origin[axis] >= max_index) {
                    throw BadTree{"has voxels out of range"};
                }
                if (origin[axis] % (1 << upper_bits) != 0) throw BadTree{"is damaged"};
            }
            read_node<upper_bits, lower_bits>(origin);
        }
        return std::move(m_leaves);
    }

private:
    /// Reads a node of 2^bits voxels along an edge, with children of 2^child_bits.
    template <int bits, int child_bits>
    void read_node(const glm::ivec3& origin) {
        constexpr int entry_bits = bits - child_bits;
        constexpr std::size_t entries = std::size_t{1} << (3 * entry_bits);
        const auto child_mask = take_mask<entries>(m_in), value_mask = take_mask<entries>(m_in);
        for (const std::uint64_t word : value_mask) {
            if (word != 0) throw BadTree{"was pruned"};
        }
        take_values(m_in, m_format, entries, 0);
        for (std::size_t w = 0; w < child_mask.size(); ++w) {
            for (std::uint64_t left = child_mask[w]; left != 0; left &= left - 1) {
                const int entry = int(64 * w) + std::countr_zero(left);
                constexpr int low = (1 << entry_bits) - 1;
                const glm::ivec3 place(entry >> (2 * entry_bits), (entry >> entry_bits) & low,
                                       entry & low);
                const glm::ivec3 child = origin + (place << child_bits);
                if constexpr (child_bits == leaf_bits) {
                    m_leaves.push_back({child, {take_mask<512>(m_in)}, {}});
                } else {
                    read_node<child_bits, leaf_bits>(child);
                }
            }
        }
    }

    ByteCursor m_in;
    ValueFormat m_format;
    std::vector<StoredLeaf> m_leaves;
};

}  // namespace

bool comes_before_in_tree(const glm::ivec3& a, const glm::ivec3& b) noexcept {
    const auto key = [](const glm::ivec3& p) {
        return std::tuple{p.x >> upper_bits,
                          p.y >> upper_bits,
                          p.z >> upper_bits,
                          p.x >> lower_bits,
                          p.y >> lower_bits,
                          p.z >> lower_bits,
                          p.x,
                          p.y,
                          p.z};
    };
    return key(a) < key(b);
}

std::vector<StoredLeaf> read_leaves(ByteCursor topology, ByteCursor buffers,
                                    const ValueFormat& format) {
    std::vector<StoredLeaf> leaves = TopologyReader(topology, format).leaves();
    for (StoredLeaf& leaf : leaves) {
        if (take_mask<512>(buffers) != leaf.active.words) throw BadTree{"is damaged"};
        leaf.values = take_values(buffers, format, 512, std::size_t(leaf.active.count()));
    }
    return leaves;
}

}  // namespace estara
