#include "estara/render/reuse_cache.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>

#include "estara/render/reuse_model.h"
#include "estara/render/sampling.h"
#include "estara/scenes/program.h"
#include "small_scene.h"

namespace estara {
namespace {

using test::error_of;

/// A cache of so many pages for one object with a colour, in one place.
ReuseCache small_cache(int pages) {
    return ReuseCache(std::uint64_t(pages) * ReuseCache::page_bytes, {{3, 2}}, {0});
}

/// A record that knows its number.
std::vector<float> numbered(const ReuseCache& cache, float number) {
    std::vector<float> floats(std::size_t(cache.layout(0).floats()));
    for (std::size_t i = 0; i < floats.size(); ++i) floats[i] = number + float(i);
    return floats;
}

int capacity_of_a_page(ReuseCache& cache) {
    cache.clear();
    cache.start_frame();
    cache.add(0, numbered(cache, 0.0f).data());
    const int capacity = cache.page(0).capacity;
    cache.clear();
    return capacity;
}

TEST(RecordLayout, OfOneColourUnderAFewLightsIsACacheLine) {
    EXPECT_EQ((RecordLayout{3, 31}.floats()), 16);
    EXPECT_EQ((RecordLayout{3, 32}.floats()), 17);  // a second word of bits
    EXPECT_EQ((RecordLayout{3, -1}.floats()), 12);  // without light
}

TEST(RayId, HoldsWhatItIsMadeOfAndGrowsWithTheFrame) {
    const int last_frame = ReuseCache::longest_window;
    for (const int born : {0, 1, 77, last_frame}) {
        for (const std::uint32_t page : {0u, 5u, 0x7fffffffu}) {
            for (const int index : {0, 3, 2047}) {
                const RayId id(born, page, index);
                EXPECT_EQ(id.born(), born);
                EXPECT_EQ(id.page(), page);
                EXPECT_EQ(id.index(), index);
                EXPECT_LT(id.bits, RayId().bits >> 1);  // the uppermost bit is left to others
            }
        }
    }
    EXPECT_LT(RayId(1, 0x7fffffffu, 2047).bits, RayId(2, 0, 0).bits);
}

TEST(ReuseCache, GivesBackWhatItWasGiven) {
    ReuseCache cache = small_cache(3);
    cache.start_frame();
    const int count = 2 * 190;
    for (int i = 0; i < count; ++i) ASSERT_TRUE(cache.add(0, numbered(cache, float(i)).data()));
    EXPECT_EQ(cache.records(), std::uint64_t(count));
    int seen = 0;
    for (int p = 0; p < cache.page_count(); ++p) {
        const ReuseCache::Page& page = cache.page(std::uint32_t(p));
        if (page.instance < 0) continue;
        for (int i = 0; i < page.size; ++i) {
            const float number = float(seen++);
            for (int k = 0; k < page.floats; ++k) {
                ASSERT_EQ(page.record(i)[k], number + float(k));
            }
            for (int c = 0; c < 3; ++c) ASSERT_EQ(page.P(c)[i], number + float(c));
            EXPECT_EQ(page.hidden()[i], 0);
        }
    }
    EXPECT_EQ(seen, count);
}

TEST(ReuseCache, TakesNoMoreMemoryThanItIsGiven) {
    ReuseCache cache = small_cache(4);
    const int capacity = capacity_of_a_page(cache);
    for (int frame = 0; frame < 20; ++frame) {
        cache.start_frame();
        cache.queue_unused();
        for (int i = 0; i < 3 * capacity; ++i) cache.add(0, numbered(cache, 1.0f).data());
        EXPECT_LE(cache.bytes(), 4 * ReuseCache::page_bytes);
        EXPECT_LE(cache.records(), std::uint64_t(4 * capacity));
    }
}

TEST(ReuseCache, GivesAwayThePageThatHasNotBeenUsedForLongest) {
    ReuseCache cache = small_cache(3);
    const int capacity = capacity_of_a_page(cache);
    for (int page = 0; page < 3; ++page) {  // pages 0, 1, 2 are born in frames 0, 1, 2
        cache.start_frame();
        cache.queue_unused();
        for (int i = 0; i < capacity; ++i) cache.add(0, numbered(cache, float(page)).data());
    }
    cache.start_frame();
    cache.mark_used(0, 1);
    cache.queue_unused();
    ASSERT_TRUE(cache.add(0, numbered(cache, 3.0f).data()));
    EXPECT_EQ(cache.page(0).born, 0);
    EXPECT_EQ(cache.page(1).born, 3);  // page 1 is older than page 2, and page 0 is in use
    EXPECT_EQ(cache.page(2).born, 2);
    EXPECT_EQ(cache.evicted(), std::uint64_t(capacity));
}

TEST(ReuseCache, GivesUpWhatIsInViewAndServesNothing) {
    const auto frames_until_gone = [](int serving, bool in_view) {
        ReuseCache cache = small_cache(4);
        cache.start_frame();
        for (int i = 0; i < 100; ++i) cache.add(0, numbered(cache, 1.0f).data());
        int frame = 1;
        for (; frame < 30; ++frame) {
            cache.start_frame();
            if (cache.records() == 0) {
                EXPECT_EQ(cache.evicted(), 100u);
                EXPECT_EQ(cache.bytes(), 0u);
                break;
            }
            if (serving > 0) cache.mark_used(0, serving);
            cache.queue_unused(std::vector<std::uint8_t>(1, in_view ? 1 : 0));
        }
        return frame;
    };
    EXPECT_EQ(frames_until_gone(0, false), 30);  // it may come into view again
    EXPECT_EQ(frames_until_gone(50, true), 30);
    EXPECT_EQ(frames_until_gone(1, true), 9);
}

TEST(ReuseCache, RefusesWhereAllOfItIsInUse) {
    ReuseCache cache = small_cache(1);
    const int capacity = capacity_of_a_page(cache);
    cache.start_frame();
    for (int i = 0; i < capacity; ++i) EXPECT_TRUE(cache.add(0, numbered(cache, 0.0f).data()));
    EXPECT_FALSE(cache.add(0, numbered(cache, 0.0f).data()));
    cache.start_frame();
    cache.mark_used(0, 1);
    cache.queue_unused();
    EXPECT_FALSE(cache.add(0, numbered(cache, 0.0f).data()));
    EXPECT_EQ(cache.records(), std::uint64_t(capacity));
}

TEST(ReuseCache, SaysThatOnePageMustFit) {
    EXPECT_THAT(error_of([] {
                    ReuseCache(1000, {{3, 2}}, {0});
                }),
                testing::HasSubstr("--cache-memory 1000 B: a page of the cache alone takes 16"));
}

TEST(SampleStrata, HoldOneSampleOfThePatternEach) {
    for (int spp = 1; spp <= 64; ++spp) {
        for (const std::uint32_t seed : {0u, 1u, 12u}) {
            const SampleStrata strata(spp, seed);
            ASSERT_EQ(strata.columns() * strata.rows(), spp);
            const std::vector<glm::vec2> pattern = sample_pattern(spp, seed);
            std::vector<int> found(std::size_t(spp), 0);
            for (int i = 0; i < spp; ++i) {
                const glm::vec2 p = pattern[std::size_t(i)];
                const int rectangle =
                    SampleStrata::cell(p.x, strata.shift().x, strata.columns()) +
                    strata.columns() * SampleStrata::cell(p.y, strata.shift().y, strata.rows());
                EXPECT_EQ(strata.sample(rectangle), i) << spp << " samples, seed " << seed;
                ++found[std::size_t(rectangle)];
            }
            for (const int n : found) EXPECT_EQ(n, 1);
        }
    }
}

TEST(SampleStrata, AreAsSquareAsTheNumberAllows) {
    EXPECT_EQ(SampleStrata(16, 0).columns(), 4);
    EXPECT_EQ(SampleStrata(12, 0).columns(), 3);
    EXPECT_EQ(SampleStrata(7, 0).columns(), 7);
}

TEST(SampleStrata, KeepPlacesOnTheBorderInside) {
    for (const float place : {0.0f, 0.99999994f, 0.5f}) {
        for (const float shift : {0.0f, 0.3f, 0.99999994f}) {
            const int cell = SampleStrata::cell(place, shift, 3);
            EXPECT_GE(cell, 0);
            EXPECT_LE(cell, 2);
        }
    }
}

// The paper's section 3.3, with round numbers: T_s^1 = 10, T_s^2 = 12, T_s^3 = 4.
TEST(ReuseModel, IsThePapersEquations) {
    const SampleTimes times{8.0, 2.0, 2.0, 2.0};
    EXPECT_EQ(time_without_reuse(times, 50.0), 500.0);           // Eq. 3
    EXPECT_EQ(time_with_reuse(times, 50.0), 12.0 + 4.0 * 49.0);  // Eq. 4
    EXPECT_EQ(predicted_speedup(times, 50.0), 500.0 / 208.0);
    EXPECT_EQ(limit_of_speedup(times), 2.5);  // Eq. 5
    EXPECT_DOUBLE_EQ(break_even(times), 8.0 / 6.0);
    EXPECT_NEAR(predicted_speedup(times, 1e9), limit_of_speedup(times), 1e-6);
    EXPECT_DOUBLE_EQ(predicted_speedup(times, break_even(times)), 1.0);
}

TEST(ReuseModel, OfAShaderThatCostsNothingNeverPays) {
    const SampleTimes velvet{0.0, 10.0, 2.0, 3.0};
    EXPECT_EQ(break_even(velvet), std::numeric_limits<double>::infinity());
    EXPECT_LT(limit_of_speedup(velvet), 1.0);
}

}  // namespace
}  // namespace estara
