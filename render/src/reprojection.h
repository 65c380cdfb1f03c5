// Which hit points of earlier frames stand in for the samples of this one.
#pragma once

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
/// Fig. 1b) and gives each to the sample in whose rectangle of the pixel (SampleStrata) it falls.
/// Of several the oldest wins, so that what is seen changes as little as it can; but one that was
/// hidden when it was last looked at loses to any that was not.
///
/// Each sample has so at most one point, whose rectangle has the same area for all: a pixel is the
/// same box filter as it is without reuse, and what was not seen before counts by its area.
class Reprojection {
public:
    explicit Reprojection(const FrameSettings& settings);

    /// Starts a frame of the cache. Parallel; the same result for any number of threads.
    void start(ReuseCache& cache, const PinholePose& pose,
               std::span<const PosedInstance> instances);

    /// A point that may stand in for a sample; whether it can be seen is not known.
    struct Candidate {
        RayId id;
        bool exists, was_hidden;
    };
    /// @param sample  of the pattern
    Candidate candidate(int x, int y, int sample) const noexcept {
        const std::uint64_t claim = m_claims[slot(x, y, sample)];
        Candidate found;
        found.id.bits = claim & ~hidden;
        found.exists = found.id.bits != none;
        found.was_hidden = (claim & hidden) != 0;
        return found;
    }

    ReuseCache& cache() const noexcept { return *m_cache; }
    std::uint64_t bytes() const noexcept { return m_slots * sizeof(std::uint64_t); }
    std::uint64_t slots() const noexcept { return m_slots; }
    /// Of the last start(), summed over threads.
    double seconds() const noexcept { return m_seconds; }

private:
    static constexpr std::uint64_t hidden = std::uint64_t{1} << 63, none = hidden - 1;

    std::size_t slot(int x, int y, int sample) const noexcept {
        return (std::size_t(sample) * std::size_t(m_height) + std::size_t(y)) *
                   std::size_t(m_width) +
               std::size_t(x);
    }
    /// f(first, last) on parts of [0, count), timed.
    template <class F>
    void in_parallel(std::size_t count, std::size_t grain, const F& f);
    bool may_be_seen(const PinholePose& pose, const PosedInstance& instance,
                     const ReuseCache::Page& page) const noexcept;
    void claim(const PinholePose& pose, const PosedInstance& instance, int page) noexcept;
    void count_serving();

    int m_width, m_height;
    SampleStrata m_strata;
    std::size_t m_slots;
    std::unique_ptr<std::uint64_t[]> m_claims;  ///< by slot: the winner's id, above it hidden
    std::atomic<double> m_seconds = 0.0;
    std::vector<std::uint8_t> m_in_view;  ///< by page
    ReuseCache* m_cache = nullptr;
};

}  // namespace estara
