#include "reprojection.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>

#include "estara/scenes/program.h"
#include "estara/shaders/wide.h"

namespace estara {
/// From the top: the pixel's number in the tile (9 bits), the rectangle, whether it was hidden,
/// page and index of the point.
struct Reprojection::Fallen {
    static constexpr int index = 0, page = RayId::index_bits, hidden = page + ReuseCache::page_bits,
                         stratum = hidden + 1, pixel = stratum + 16;
    static_assert(pixel + 9 == 64 && TileGrid::pixels == 1 << 9);

    static std::uint32_t page_of(std::uint64_t bits) noexcept {
        return std::uint32_t(bits >> page) & ((1u << ReuseCache::page_bits) - 1);
    }
    static int stratum_of(std::uint64_t bits) noexcept { return int(bits >> stratum & 0xffff); }
    static int index_of(std::uint64_t bits) noexcept {
        return int(bits & ((1u << RayId::index_bits) - 1));
    }
};

struct Reprojection::Sorting {
    std::vector<std::uint64_t> fallen;  ///< by pixel
    std::vector<LeftOver> left_over;    ///< of a pixel
};

template <class F>
void Reprojection::in_parallel(std::size_t count, std::size_t grain, const F& f) {
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, count, grain), [&](const auto& range) {
        const Stopwatch time;
        f(range.begin(), range.end());
        m_seconds += time.seconds();
    });
}

Reprojection::Reprojection(const FrameSettings& settings)
    : m_width(settings.width),
      m_height(settings.height),
      m_tiles(settings.width, settings.height),
      m_strata(settings.spp, settings.seed),
      m_slot_count(std::size_t(m_tiles.count()) * TileGrid::pixels * 2 * std::size_t(settings.spp)),
      m_slots(new std::uint64_t[m_slot_count]) {}

void Reprojection::start(ReuseCache& cache, const PinholePose& pose,
                         std::span<const PosedInstance> instances) {
    m_cache = &cache;
    m_seconds = 0.0;
    cache.start_frame();
    for (Bins& bins : m_bins) {
        for (auto& bin : bins) bin.clear();
    }
    const auto pages = std::size_t(cache.page_count());
    m_in_view.assign(pages, 0);
    m_serving.assign(pages, 0);
    m_looked_at.assign(pages, 0);
    in_parallel(pages, 8, [&](std::size_t first, std::size_t last) {
        Bins& bins = m_bins.local();
        bins.resize(std::size_t(m_tiles.count()));
        for (std::size_t p = first; p < last; ++p) {
            ReuseCache::Page& page = cache.page(std::uint32_t(p));
            if (page.instance < 0) continue;
            const PosedInstance& instance = instances[std::size_t(page.instance)];
            if (!instance.is_there) continue;
            if (cache.layout(page.instance).bends) {
                bend(instance, page);
            } else if (instance.bent) {
                continue;  // squeezed flat in this frame
            }
            if (!may_be_seen(pose, instance, page)) continue;
            m_in_view[p] = 1;
            project(pose, instance, int(p), bins);
        }
    });
    in_parallel(std::size_t(m_tiles.count()), 1, [&](std::size_t first, std::size_t last) {
        thread_local Sorting sorting;
        for (std::size_t tile = first; tile < last; ++tile) serve_tile(int(tile), sorting);
    });
    for (std::size_t p = 0; p < pages; ++p) {
        if (m_serving[p] + m_looked_at[p] > 0) cache.mark_used(std::uint32_t(p), m_serving[p]);
    }
    cache.queue_unused(m_in_view);
}

std::uint64_t Reprojection::bytes() const noexcept {
    std::uint64_t sum = m_slot_count * sizeof(std::uint64_t) +
                        (m_serving.capacity() + m_looked_at.capacity()) * sizeof(int) +
                        m_in_view.capacity();
    for (const Bins& bins : m_bins) {
        for (const auto& bin : bins) sum += bin.capacity() * sizeof(std::uint64_t);
    }
    return sum;
}

/// Moves a page's points to where they are on the mesh as it is bent now.
void Reprojection::bend(const PosedInstance& instance, ReuseCache::Page& page) const {
    const RecordLayout layout = m_cache->layout(page.instance);
    const std::vector<glm::vec3>& vertices = instance.bent ? instance.bent->P : instance.mesh->P;
    page.low = glm::vec3(std::numeric_limits<float>::infinity());
    page.high = -page.low;
    for (int i = 0; i < page.size; ++i) {
        const Site site = Site::from(page.record(i), layout);
        const glm::vec3 P = site.of(vertices, instance.mesh->triangles[site.triangle]);
        for (int c = 0; c < 3; ++c) page.P(c)[i] = P[c];
        page.low = glm::min(page.low, P);
        page.high = glm::max(page.high, P);
    }
}

/// Whether the ball around a page's points reaches into the view.
bool Reprojection::may_be_seen(const PinholePose& pose, const PosedInstance& instance,
                               const ReuseCache::Page& page) const noexcept {
    const glm::vec3 middle = 0.5f * (page.low + page.high);
    const glm::vec3 centre(instance.world_from_object * glm::vec4(middle, 1.0f));
    // A little more for the rounding of all this, far from the origin too.
    const float radius =
        0.5f * glm::distance(page.low, page.high) * instance.largest_scale * 1.01f +
        1e-5f * glm::length(centre - pose.eye) + 1e-6f * glm::length(centre);
    const glm::vec3 d = centre - pose.eye;
    const float z = glm::dot(d, pose.forward);
    const float ty = pose.tan_half_yfov, tx = ty * float(m_width) / float(m_height);
    const auto outside = [&](float x, float t) {
        return std::abs(x) - t * z > radius * std::sqrt(1.0f + t * t);
    };
    return !(z < -radius || outside(glm::dot(d, pose.right), tx) ||
             outside(glm::dot(d, pose.up), ty));
}

/// Sorts the points of a page into the tiles that they fall into.
void Reprojection::project(const PinholePose& pose, const PosedInstance& instance, int p,
                           Bins& bins) {
    constexpr int most = 1 << RayId::index_bits;
    struct Places {
        int tile[most];  ///< -1: outside the image
        int pixel[most], stratum[most];
    };
    thread_local Places places;
    const ReuseCache::Page& page = m_cache->page(std::uint32_t(p));
    wide([=, to = &places, m = instance.world_from_object, size = page.size, Px = page.P(0),
          Py = page.P(1), Pz = page.P(2), width = m_width, height = m_height,
          tile_columns = m_tiles.columns, columns = m_strata.columns(), rows = m_strata.rows(),
          shift = m_strata.shift()]() ESTARA_LOOP {
        const glm::vec3 mx(m[0]), my(m[1]), mz(m[2]), mt(m[3]);
#pragma GCC ivdep
        for (int i = 0; i < size; ++i) {
            const glm::vec3 P = mx * Px[i] + my * Py[i] + mz * Pz[i] + mt;
            const glm::vec3 at = pose.project(P, width, height);
            const bool seen = (at.z > 0.0f) & (at.x >= 0.0f) & (at.x < float(width)) &
                              (at.y >= 0.0f) & (at.y < float(height));
            const float x = seen ? at.x : 0.0f, y = seen ? at.y : 0.0f;
            const int column = int(x), row = int(y);
            to->stratum[i] = SampleStrata::cell(x - float(column), shift.x, columns) +
                             columns * SampleStrata::cell(y - float(row), shift.y, rows);
            to->tile[i] = seen ? TileGrid::tile(column, row, tile_columns) : -1;
            to->pixel[i] = TileGrid::number(column, row);
        }
    });
    const std::uint8_t* const was_hidden = page.hidden();
    const std::uint64_t of_page = std::uint64_t(p) << Fallen::page;
    for (int i = 0; i < page.size; ++i) {
        if (places.tile[i] < 0) continue;
        bins[std::size_t(places.tile[i])].push_back(
            std::uint64_t(places.pixel[i]) << Fallen::pixel |
            std::uint64_t(places.stratum[i]) << Fallen::stratum |
            std::uint64_t(was_hidden[i]) << Fallen::hidden | of_page | std::uint64_t(i));
    }
}

/// Sorts a tile's points by pixel and fills its slots.
void Reprojection::serve_tile(int tile, Sorting& sorting) {
    std::array<std::uint32_t, TileGrid::pixels + 1> first{};
    const auto each = [&](auto&& f) {
        for (const Bins& bins : m_bins) {
            if (bins.empty()) continue;  // a thread that has had no page yet
            for (const std::uint64_t fallen : bins[std::size_t(tile)]) f(fallen);
        }
    };
    each([&](std::uint64_t fallen) { ++first[(fallen >> Fallen::pixel) + 1]; });
    for (std::size_t i = 1; i < first.size(); ++i) first[i] += first[i - 1];
    sorting.fallen.resize(first.back());
    std::array<std::uint32_t, TileGrid::pixels> next;
    std::copy_n(first.begin(), next.size(), next.begin());
    each([&](std::uint64_t fallen) { sorting.fallen[next[fallen >> Fallen::pixel]++] = fallen; });

    const std::size_t slots = 2 * std::size_t(m_strata.count());
    std::fill_n(slots_of(tile, 0), slots * TileGrid::pixels, none);
    for (std::size_t i = 0; i < TileGrid::pixels; ++i) {
        if (first[i] == first[i + 1]) continue;
        serve_pixel({sorting.fallen.data() + first[i], first[i + 1] - first[i]},
                    slots_of(tile, int(i)), sorting.left_over);
    }
    count_serving({slots_of(tile, 0), slots * TileGrid::pixels});
}

/// @param slots  by rectangle, then the seconds; all of them none
void Reprojection::serve_pixel(std::span<const std::uint64_t> fallen, std::uint64_t* slots,
                               std::vector<LeftOver>& left_over) const {
    const auto key = [&](std::uint64_t bits) {
        const std::uint32_t page = Fallen::page_of(bits);
        return key_of(RayId(m_cache->page(page).born, page, Fallen::index_of(bits)));
    };
    const auto is_hidden = [](std::uint64_t bits) { return (bits >> Fallen::hidden & 1) != 0; };
    left_over.clear();
    bool any_hidden = false;
    for (const std::uint64_t bits : fallen) {
        if (is_hidden(bits)) {
            any_hidden = true;
            continue;
        }
        const int stratum = Fallen::stratum_of(bits);
        std::uint64_t& slot = slots[stratum];
        const std::uint64_t one = key(bits);
        if (slot != none) left_over.push_back({std::max(one, slot), stratum});
        slot = std::min(one, slot);
    }
    if (!left_over.empty()) spread(left_over, slots);
    if (!any_hidden) return;
    for (const std::uint64_t bits : fallen) {
        std::uint64_t& slot = slots[Fallen::stratum_of(bits)];
        if (is_hidden(bits) && (slot == none || (slot & hidden) != 0)) {
            slot = std::min(slot, key(bits) | hidden);
        }
    }
}

/// Gives points that their rectangles have not taken to empty ones beside them, the oldest first.
/// Of the rest the oldest of each rectangle is its second.
void Reprojection::spread(std::vector<LeftOver>& points, std::uint64_t* slots) const {
    std::sort(points.begin(), points.end());
    const int columns = m_strata.columns(), count = m_strata.count();
    for (const LeftOver& point : points) {
        const int s = point.stratum, column = s % columns;
        const auto take = [&](bool exists, int beside) {
            if (!exists || slots[beside] != none) return false;
            slots[beside] = point.key;
            return true;
        };
        if (take(column > 0, s - 1) || take(column + 1 < columns, s + 1)) continue;
        if (take(s >= columns, s - columns) || take(s + columns < count, s + columns)) continue;
        std::uint64_t& second = slots[count + s];
        second = std::min(second, point.key);
    }
}

/// How many points of each page serve a tile.
void Reprojection::count_serving(std::span<const std::uint64_t> slots) {
    std::uint32_t current = ~0u;
    int run = 0;  // neighbours are mostly of one page
    const auto add = [&] {
        if (run == 0) return;
        std::atomic_ref(m_serving[current]).fetch_add(run, std::memory_order_relaxed);
    };
    for (const std::uint64_t slot : slots) {
        if (slot == none) continue;
        const RayId id = id_of(slot & ~hidden);
        if ((slot & hidden) != 0) {  // looked at, but of little hope
            std::atomic_ref(m_looked_at[id.page()]).store(1, std::memory_order_relaxed);
            continue;
        }
        if (id.page() != current) {
            add();
            current = id.page();
            run = 0;
        }
        ++run;
    }
    add();
}

}  // namespace estara
