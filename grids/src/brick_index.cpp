#include "brick_index.h"

#include <fmt/format.h>

#include <algorithm>

#include "estara/scenes/error.h"

namespace estara {
namespace {

constexpr std::size_t small_root = 16 * 16 * 16;  // entries, 16 KiB
constexpr std::uint32_t most_middle_bits = 5;     // 256 KiB a middle table

}  // namespace

BrickIndex::BrickIndex(const std::vector<Block>& blocks, const std::string& where) {
    glm::ivec3 low(0), high(0);
    if (!blocks.empty()) low = high = blocks.front().origin;
    for (const Block& block : blocks) {
        low = glm::min(low, block.origin);
        high = glm::max(high, block.origin + 8);
    }
    m_box.low = glm::uvec3(low);
    m_box.extent = glm::uvec3(high - low);
    const std::uint32_t widest = std::max({m_box.extent.x, m_box.extent.y, m_box.extent.z});
    if (widest > max_extent) {
        throw Error(fmt::format("{}: {} voxels wide, more than {}; bake it with larger voxels",
                                where, widest, max_extent));
    }
    const auto root_size = [&] {
        const std::uint32_t bits = bottom_width_bits + m_box.middle_bits;
        m_box.roots = glm::max((m_box.extent + ((1u << bits) - 1)) >> bits, glm::uvec3(1));
        return std::size_t(m_box.roots.x) * m_box.roots.y * m_box.roots.z;
    };
    while (root_size() > small_root && m_box.middle_bits < most_middle_bits) ++m_box.middle_bits;

    const std::size_t middle_size = std::size_t{1} << (3 * m_box.middle_bits);
    m_root.assign(root_size(), 0);
    m_middle.resize(middle_size);
    m_bottom.resize(bottom_size);
    for (std::size_t b = 0; b < blocks.size(); ++b) {
        const glm::uvec3 v(blocks[b].origin);
        const Way way = m_box.way(v.x, v.y, v.z);
        std::uint32_t& middle = m_root[way.root];
        if (middle == 0) {
            middle = std::uint32_t(m_middle.size());
            m_middle.resize(m_middle.size() + middle_size);
        }
        std::uint32_t& table = m_middle[middle + way.middle].table;
        if (table == 0) {
            table = std::uint32_t(m_bottom.size());
            m_bottom.resize(m_bottom.size() + bottom_size);
        }
        m_bottom[table + way.bottom] = std::uint32_t(b + 1);
    }
    m_middle.shrink_to_fit();
    m_bottom.shrink_to_fit();
}

void BrickIndex::set_bricks(const std::vector<std::uint8_t>& masks,
                            const std::vector<std::uint32_t>& first) {
    for (Middle& middle : m_middle) middle.first_brick = first[middle.table / bottom_size];
    for (std::size_t table = 1; table < tables(); ++table) {
        std::uint32_t before = 0;
        for (std::size_t i = table * bottom_size; i < (table + 1) * bottom_size; ++i) {
            if (m_bottom[i] == 0) continue;
            const std::uint32_t mask = masks[m_bottom[i] - 1];
            m_bottom[i] = (before << 8) | mask;
            before += std::uint32_t(std::popcount(mask));
        }
    }
}

}  // namespace estara
