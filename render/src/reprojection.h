// Which hit points of earlier frames stand in for the samples of this one.
#pragma once

#include <tbb/enumerable_thread_specific.h>

#include <atomic>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "estara/render/camera.h"
#include "estara/render/frame.h"
#include "estara/render/reuse_cache.h"
#include "estara/render/sampling.h"
#include "instances.h"
#include "tile_grid.h"

namespace estara {

/// Hit points that a tile has found, on their way into the cache.
struct NewRecords {
    std::vector<int> instances;
    std::vector<float> floats;  ///< of one point after the other, as its RecordLayout says

    std::size_t bytes() const noexcept {
        return instances.capacity() * sizeof(int) + floats.capacity() * sizeof(float);
    }
    void clear() noexcept {
        instances.clear();
        floats.clear();
    }
};

/// Projects all hit points of a ReuseCache onto the image of a frame (the paper's section 3.2,
/// Fig. 1b) and gives each pixel as many of those that fall into it as it has samples.
///
/// A pixel is divided into a rectangle for each of its samples (SampleStrata). The oldest point in
/// a rectangle serves its sample; then the oldest of those that are left over serve samples of
/// empty rectangles beside theirs, so that a point goes on to serve while it crosses its pixel.
/// (Points move all alike where they move at all, and a pattern that has been moved is as evenly
/// spread as it was, but no longer has one point in each rectangle.) A point that was hidden when
/// it was last looked at serves only in its own rectangle, and only if no other does.
///
/// Each sample has so at most one point that stands for it: a pixel is the same box filter as it is
/// without reuse. If the rectangle has a second point, which serves nowhere else, it is named too.
class Reprojection {
public:
    explicit Reprojection(const FrameSettings& settings);

    /// Starts a frame of the cache. Parallel; the same result for any number of threads.
    void start(ReuseCache& cache, const PinholePose& pose,
               std::span<const PosedInstance> instances);

    /// A point that may stand in for a sample; whether it can be seen is not known.
    struct Candidate {
        RayId id;
        RayId second;  ///< of the same rectangle
        bool exists, was_hidden, has_second;
    };
    /// @param pixel      its number in the tile
    /// @param rectangle  of the pixel, in [0, strata().count())
    Candidate candidate(int tile, int pixel, int rectangle) const noexcept {
        const std::uint64_t* const slots = slots_of(tile, pixel);
        const std::uint64_t slot = slots[rectangle], second = slots[m_strata.count() + rectangle];
        Candidate found;
        found.id = id_of(slot & ~hidden);
        found.second = id_of(second);
        found.exists = slot != none;
        found.has_second = second != none;
        found.was_hidden = (slot & hidden) != 0;
        return found;
    }

    const SampleStrata& strata() const noexcept { return m_strata; }
    ReuseCache& cache() const noexcept { return *m_cache; }
    /// What all this takes beside the cache.
    std::uint64_t bytes() const noexcept;
    std::uint64_t slots() const noexcept {
        return std::uint64_t(m_width) * std::uint64_t(m_height) * std::uint64_t(m_strata.count());
    }
    /// Of the last start(), summed over threads.
    double seconds() const noexcept { return m_seconds; }

private:
    static constexpr std::uint64_t hidden = std::uint64_t{1} << 63, none = ~std::uint64_t{0};

    /// What points are compared by: the oldest first, and those of one frame in no order. (In that
    /// of their records those on one side would always win over those on the other.) A number and
    /// its inverse, modulo 2^64, scatter them and bring them back.
    static constexpr std::uint64_t scatter = 0x9e3779b97f4a7c15, gather = 0xf1de83e19937733d;
    static_assert(scatter * gather == 1);
    static constexpr std::uint64_t of_one_frame =
        (std::uint64_t{1} << (RayId::index_bits + RayId::page_bits)) - 1;
    static std::uint64_t key_of(RayId id) noexcept {
        return (id.bits & ~of_one_frame) | ((id.bits * scatter) & of_one_frame);
    }
    static RayId id_of(std::uint64_t key) noexcept {
        RayId id;
        id.bits = (key & ~of_one_frame) | ((key * gather) & of_one_frame);
        return id;
    }
    std::uint64_t* slots_of(int tile, int pixel) const noexcept {
        return m_slots.get() + (std::size_t(tile) * TileGrid::pixels + std::size_t(pixel)) * 2 *
                                   std::size_t(m_strata.count());
    }

    /// A point that has fallen into a tile, packed: tiles hold many.
    struct Fallen;
    /// Points of one thread by the tile that they have fallen into.
    using Bins = std::vector<std::vector<std::uint64_t>>;
    /// A point whose rectangle an older one has taken.
    struct LeftOver {
        std::uint64_t key;
        int stratum;
        bool operator<(const LeftOver& other) const noexcept { return key < other.key; }
    };
    /// What a tile's points are sorted in.
    struct Sorting;

    /// f(first, last) on parts of [0, count), timed.
    template <class F>
    void in_parallel(std::size_t count, std::size_t grain, const F& f);
    bool may_be_seen(const PinholePose& pose, const PosedInstance& instance,
                     const ReuseCache::Page& page) const noexcept;
    void bend(const PosedInstance& instance, ReuseCache::Page& page) const;
    void project(const PinholePose& pose, const PosedInstance& instance, int page, Bins& bins);
    void serve_tile(int tile, Sorting& sorting);
    void serve_pixel(std::span<const std::uint64_t> fallen, std::uint64_t* slots,
                     std::vector<LeftOver>& left_over) const;
    void spread(std::vector<LeftOver>& points, std::uint64_t* slots) const;
    void count_serving(std::span<const std::uint64_t> slots);

    int m_width, m_height;
    TileGrid m_tiles;
    SampleStrata m_strata;
    std::size_t m_slot_count;
    /// By tile and pixel: for each rectangle a key, hidden or not, then for each its second.
    std::unique_ptr<std::uint64_t[]> m_slots;
    tbb::enumerable_thread_specific<Bins> m_bins;
    std::atomic<double> m_seconds = 0.0;
    std::vector<std::uint8_t> m_in_view;      ///< by page
    std::vector<int> m_serving, m_looked_at;  ///< by page
    ReuseCache* m_cache = nullptr;
};

}  // namespace estara
