#include "estara/render/reuse_cache.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstring>
#include <limits>
#include <tuple>

#include "estara/scenes/error.h"
#include "estara/scenes/program.h"

namespace estara {

int normal_plane(const ShaderInfo& info) noexcept {
    const bool last_is_normal =
        !info.channels.empty() && info.channels.back().kind == ChannelKind::normal;
    return last_is_normal ? info.baked_floats - 3 : -1;
}

RecordLayout record_layout(const ShaderInfo& info, int lights, bool bends) noexcept {
    const int normal = normal_plane(info);
    return {normal < 0 ? info.baked_floats : normal, lights, bends};
}

ReuseCache::ReuseCache(std::uint64_t bytes, std::vector<RecordLayout> layouts,
                       std::vector<int> objects)
    : m_layouts(std::move(layouts)), m_objects(std::move(objects)) {
    const std::uint64_t pages =
        std::min<std::uint64_t>(bytes / page_bytes, std::uint64_t{1} << page_bits);
    if (pages == 0) {
        throw Error(fmt::format("--cache-memory {}: a page of the cache alone takes {}",
                                format_bytes(bytes), format_bytes(page_bytes)));
    }
    // The system gives memory of this size when it is first touched. Records of a tile lie in many
    // places: large pages spare the processor the search for them.
    m_memory = allocate_large_pages<float>(pages * page_bytes / sizeof(float));
    if (!m_memory) {
        throw Error(fmt::format("--cache-memory: {} cannot be had", format_bytes(bytes)),
                    ExitStatus::failed);
    }
    m_pages.resize(pages);
    for (const RecordLayout& layout : m_layouts) {
        if (std::size_t(layout.floats()) * sizeof(float) > page_bytes / 2) {
            throw Error(fmt::format("a record of {} lights does not fit a page of the cache",
                                    layout.lights));
        }
    }
    for (std::size_t p = 0; p < pages; ++p) {
        m_pages[p].memory = m_memory.get() + p * (page_bytes / sizeof(float));
    }
    clear();
}

void ReuseCache::clear() {
    for (int p = 0; p < m_touched; ++p) m_pages[std::size_t(p)].instance = -1;
    m_touched = 0;
    m_free.clear();
    m_unused.clear();
    m_open.assign(m_objects.size(), -1);
    m_frame = -1;
    m_records = m_evicted = m_in_use = 0;
}

void ReuseCache::start_frame() {
    ++m_frame;
    m_evicted = 0;
    for (int p = 0; p < m_touched; ++p) {
        Page& page = m_pages[std::size_t(p)];
        page.serving = 0;
        if (page.instance < 0 || page.idle < most_idle) continue;
        m_records -= std::uint64_t(page.size);
        m_evicted += std::uint64_t(page.size);
        --m_in_use;
        page.instance = -1;
        m_free.push_back(p);
    }
    m_open.assign(m_objects.size(), -1);
    m_unused.clear();
}

void ReuseCache::queue_unused(const std::vector<std::uint8_t>& in_view) {
    std::vector<int> unused;
    for (int p = 0; p < page_count(); ++p) {
        Page& one = m_pages[std::size_t(p)];
        if (!in_view.empty() && in_view[std::size_t(p)] != 0) {
            one.idle = one.serving * idle_share < one.size ? one.idle + 1 : 0;
        }
        if (one.instance >= 0 && one.used < m_frame) unused.push_back(p);
    }
    std::sort(unused.begin(), unused.end(), [&](int a, int b) {
        const Page &x = m_pages[std::size_t(a)], &y = m_pages[std::size_t(b)];
        return std::tie(x.used, x.born, a) < std::tie(y.used, y.born, b);
    });
    m_unused.assign(unused.begin(), unused.end());
}

int ReuseCache::take_page() {
    if (!m_free.empty()) {
        const int p = m_free.back();
        m_free.pop_back();
        ++m_in_use;
        return p;
    }
    if (std::size_t(m_touched) < m_pages.size()) {
        ++m_in_use;
        return m_touched++;
    }
    if (m_unused.empty()) return -1;
    const int p = m_unused.front();
    m_unused.pop_front();
    m_records -= std::uint64_t(m_pages[std::size_t(p)].size);
    m_evicted += std::uint64_t(m_pages[std::size_t(p)].size);
    return p;
}

bool ReuseCache::add(int instance, const float* floats) {
    int& open = m_open[std::size_t(instance)];
    if (open < 0 || m_pages[std::size_t(open)].size == m_pages[std::size_t(open)].capacity) {
        open = take_page();
        if (open < 0) return false;
        Page& fresh = m_pages[std::size_t(open)];
        fresh.instance = instance;
        fresh.size = 0;
        fresh.born = fresh.used = m_frame;
        fresh.idle = 0;
        fresh.low = glm::vec3(std::numeric_limits<float>::infinity());
        fresh.high = -fresh.low;
        fresh.floats = layout(instance).floats();
        constexpr std::size_t beside = 3 * sizeof(float) + 1;  // P once more, hidden
        fresh.capacity =
            int(std::min(page_bytes / (std::size_t(fresh.floats) * sizeof(float) + beside),
                         std::size_t{1} << RayId::index_bits));
    }
    Page& p = m_pages[std::size_t(open)];
    const int i = p.size++;
    std::memcpy(p.record(i), floats, std::size_t(p.floats) * sizeof(float));
    for (int c = 0; c < 3; ++c) p.P(c)[i] = floats[RecordLayout::P + c];
    p.hidden()[i] = 0;
    const glm::vec3 P(floats[RecordLayout::P], floats[RecordLayout::P + 1],
                      floats[RecordLayout::P + 2]);
    p.low = glm::min(p.low, P);
    p.high = glm::max(p.high, P);
    ++m_records;
    return true;
}

}  // namespace estara
