#include "estara/render/compare.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "estara/render/statistics.h"

namespace estara {
namespace {

Film grey(float value) {
    Film film(100, 20, {});
    film.color.assign(film.color.size(), glm::vec4(value, value, value, 1.0f));
    return film;
}

TEST(Compare, EqualFilmsHaveNoError) {
    const ImageError error = compare_films(grey(0.3f), grey(0.3f));
    EXPECT_EQ(error.rmse, 0.0);
    EXPECT_EQ(error.p999, 0.0);
    EXPECT_EQ(error.max, 0.0);
    EXPECT_TRUE(std::isinf(error.psnr));
}

TEST(Compare, ConstantDifferenceIsEveryFigure) {
    const ImageError error = compare_films(grey(0.5f), grey(0.25f));
    EXPECT_NEAR(error.rmse, 0.25, 1e-7);
    EXPECT_EQ(error.p999, 0.25);
    EXPECT_EQ(error.max, 0.25);
    EXPECT_NEAR(error.psnr, -20.0 * std::log10(0.25), 1e-6);
}

TEST(Compare, OneBadPixelShowsInMaxAndNotInP999) {
    Film film = grey(0.5f);
    film.color[77].g = 3.5f;  // one of 6000 values
    const ImageError error = compare_films(film, grey(0.5f));
    EXPECT_EQ(error.max, 3.0);
    EXPECT_EQ(error.p999, 0.0);
    EXPECT_NEAR(error.rmse, 3.0 / std::sqrt(6000.0), 1e-7);
}

TEST(Compare, AlphaIsNotCompared) {
    Film film = grey(0.5f);
    for (glm::vec4& pixel : film.color) pixel.a = 0.0f;
    EXPECT_EQ(compare_films(film, grey(0.5f)).max, 0.0);
}

TEST(Compare, PooledRmseIsThatOfAllPixels) {
    const std::array errors{ImageError{0.3, 0.5, 0.9, 0.0}, ImageError{0.4, 0.6, 0.8, 0.0}};
    const ImageError all = pooled(errors);
    EXPECT_NEAR(all.rmse, std::sqrt((0.09 + 0.16) / 2.0), 1e-12);
    EXPECT_EQ(all.p999, 0.6);
    EXPECT_EQ(all.max, 0.9);
    EXPECT_NEAR(all.psnr, -20.0 * std::log10(all.rmse), 1e-12);
}

TEST(Spread, MedianOfAnEvenNumberIsTheMeanOfTheMiddleTwo) {
    EXPECT_EQ(spread({4.0, 1.0, 2.0, 9.0}).median, 3.0);
    EXPECT_EQ(spread({4.0, 1.0, 9.0}).median, 4.0);
    EXPECT_EQ(spread({4.0, 1.0, 9.0}).min, 1.0);
    EXPECT_EQ(spread({4.0, 1.0, 9.0}).max, 9.0);
}

}  // namespace
}  // namespace estara
