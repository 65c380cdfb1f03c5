#include "reprojection.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <atomic>
#include <cmath>

#include "estara/scenes/program.h"
#include "estara/shaders/wide.h"

namespace estara {
namespace {

void keep_smallest(std::uint64_t& at, std::uint64_t value) noexcept {
    const std::atomic_ref<std::uint64_t> kept(at);
    std::uint64_t old = kept.load(std::memory_order_relaxed);
    while (value < old && !kept.compare_exchange_weak(old, value, std::memory_order_relaxed)) {
    }
}

}  // namespace

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
      m_strata(settings.spp, settings.seed),
      m_slots(std::size_t(settings.width) * std::size_t(settings.height) *
              std::size_t(settings.spp)),
      m_claims(new std::uint64_t[m_slots]) {}

void Reprojection::start(ReuseCache& cache, const PinholePose& pose,
                         std::span<const PosedInstance> instances) {
    m_cache = &cache;
    m_seconds = 0.0;
    cache.start_frame();
    in_parallel(m_slots, 1u << 16, [&](std::size_t first, std::size_t last) {
        std::fill(m_claims.get() + first, m_claims.get() + last, ~std::uint64_t{0});
    });
    const auto pages = std::size_t(cache.page_count());
    m_in_view.assign(pages, 0);
    in_parallel(pages, 8, [&](std::size_t first, std::size_t last) {
        for (std::size_t p = first; p < last; ++p) {
            const ReuseCache::Page& page = cache.page(std::uint32_t(p));
            if (page.instance < 0) continue;
            const PosedInstance& instance = instances[std::size_t(page.instance)];
            if (!instance.is_there || !may_be_seen(pose, instance, page)) continue;
            m_in_view[p] = 1;
            claim(pose, instance, int(p));
        }
    });
    count_serving();
    cache.queue_unused(m_in_view);
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

/// How many points of each page have won a sample.
void Reprojection::count_serving() {
    std::vector<int> serving(m_in_view.size(), 0), looked_at(m_in_view.size(), 0);
    in_parallel(m_slots, 1u << 14, [&](std::size_t first, std::size_t last) {
        std::uint32_t current = ~0u;
        int run = 0;  // neighbours are mostly of one page
        const auto add = [&] {
            if (run > 0)
                std::atomic_ref(serving[current]).fetch_add(run, std::memory_order_relaxed);
        };
        for (std::size_t s = first; s < last; ++s) {
            RayId id;
            id.bits = m_claims[s] & ~hidden;
            if (id.bits == none) continue;
            if ((m_claims[s] & hidden) != 0) {  // looked at, but of little hope
                std::atomic_ref(looked_at[id.page()]).store(1, std::memory_order_relaxed);
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
    });
    for (std::size_t p = 0; p < serving.size(); ++p) {
        if (serving[p] + looked_at[p] > 0) m_cache->mark_used(std::uint32_t(p), serving[p]);
    }
}

void Reprojection::claim(const PinholePose& pose, const PosedInstance& instance, int p) noexcept {
    constexpr int most = 1 << RayId::index_bits;
    struct Places {
        std::uint32_t pixel[most];
        int stratum[most];  ///< -1: outside the image
        std::size_t slot[most];
        int index[most];  ///< of the points inside
    };
    thread_local Places places;
    const ReuseCache::Page& page = m_cache->page(std::uint32_t(p));
    wide([=, to = &places, m = instance.world_from_object, size = page.size, Px = page.P(0),
          Py = page.P(1), Pz = page.P(2), width = m_width, height = m_height,
          columns = m_strata.columns(), rows = m_strata.rows(),
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
            const int stratum = SampleStrata::cell(x - float(column), shift.x, columns) +
                                columns * SampleStrata::cell(y - float(row), shift.y, rows);
            to->stratum[i] = seen ? stratum : -1;
            to->pixel[i] = std::uint32_t(row) * std::uint32_t(width) + std::uint32_t(column);
        }
    });
    // Slots are all over memory: they are asked for before any is used.
    const std::size_t pixels = std::size_t(m_width) * std::size_t(m_height);
    int count = 0;
    for (int i = 0; i < page.size; ++i) {
        if (places.stratum[i] < 0) continue;
        const std::size_t slot =
            std::size_t(m_strata.sample(places.stratum[i])) * pixels + places.pixel[i];
        __builtin_prefetch(&m_claims[slot], 1);
        places.slot[count] = slot;
        places.index[count++] = i;
    }
    for (int k = 0; k < count; ++k) {
        const int i = places.index[k];
        const RayId id(page.born, std::uint32_t(p), i);
        keep_smallest(m_claims[places.slot[k]], id.bits | (page.hidden()[i] != 0 ? hidden : 0));
    }
}

}  // namespace estara
