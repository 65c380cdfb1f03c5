// What a point sends to the eye is a sum over what lights it: the renderer adds light by light.
#include <gtest/gtest.h>

#include <cmath>
#include <tuple>
#include <vector>

#include "library/all.h"
#include "sampling.h"
#include "src/loops.h"
#include "view.h"

namespace estara {
namespace {

template <class S>
void expect_superposition() {
    const S shader;
    test::Random random(1);
    for (int i = 0; i < 1000; ++i) {
        SurfacePoint x{};
        x.P = {random.within(-1.0f, 1.0f), random.within(-1.0f, 1.0f), random.within(-1.0f, 1.0f)};
        x.N = random.direction();
        x.filter_width = 0.01f;
        x.dPdu = random.direction();
        const auto baked = shader.bake(x);
        const glm::vec3 N = random.direction(), E(random.unit(), random.unit(), random.unit());
        const glm::vec3 A(random.unit(), random.unit(), random.unit()), none(0.0f);
        const ViewDirection V = Camera::direction(random.direction());
        std::vector<Light> lights;
        for (int k = 0; k < i % 4; ++k) {
            lights.push_back({random.direction(), glm::vec3(random.unit(), random.unit(), 1.0f)});
        }
        glm::vec3 sum = shader.view(baked, Seen{N, V, E, A, {}});
        for (const Light& light : lights) {
            sum += shader.view(baked, Seen{N, V, none, none, {&light, 1}, 0.0f});
        }
        const glm::vec3 whole = shader.view(baked, Seen{N, V, E, A, lights});
        for (int c = 0; c < 3; ++c) {
            ASSERT_NEAR(sum[c], whole[c], 1e-6f * (1.0f + std::fabs(whole[c]))) << S::name;
        }
    }
}

template <class... S>
void expect_superposition_of(std::type_identity<std::tuple<S...>>) {
    (expect_superposition<S>(), ...);
}

/// What the loops leave out of a light's share is no more than highlight_edge() says.
template <class S>
void expect_all_highlights() {
    const S shader;
    const BoundShaderPtr bound = bind_shader(S::name, {}, true).shader;
    test::Random random(2);
    float largest = 0.0f;
    for (int round = 0; round < 40; ++round) {
        SurfaceBatch batch = test::random_batch(round, 2.0f, 0.01f);
        const std::vector<float> planes = test::bake(*bound, batch);
        SeenBatch seen{};
        std::vector<glm::vec3> expected;
        for (int i = 0; i < batch.size; ++i) {
            SurfacePoint x{};
            x.P = {batch.P[0][i], batch.P[1][i], batch.P[2][i]};
            x.N = {batch.N[0][i], batch.N[1][i], batch.N[2][i]};
            x.uv = {batch.uv[0][i], batch.uv[1][i]};
            x.dPdu = {batch.dPdu[0][i], batch.dPdu[1][i], batch.dPdu[2][i]};
            x.filter_width = batch.filter_width;
            const glm::vec3 N = random.direction(), none(0.0f);
            const ViewDirection V = Camera::direction(random.direction());
            const Light light{random.direction(),
                              glm::vec3(random.unit(), 1.0f, i % 7 ? 0.5f : 0.0f)};
            const Seen one{N, V, none, none, {&light, 1}, 0.0f};
            test::set(seen, i, one);
            glm::vec3 sum(0.0f);
            if constexpr (!HasOctaves<S>) {
                sum = shader.view(shader.bake(x), one);
            } else {  // the record as the loops make it
                typename S::Baked baked;
                detail::load<S>(baked, planes.data(), i);
                sum = shader.view(baked, one);
            }
            expected.push_back(sum);
        }
        std::vector<float> Ci(3 * SeenBatch::capacity, -1.0f);
        bound->view(planes.data(), seen, 0, batch.size, true, Ci.data());
        for (int i = 0; i < batch.size; ++i) {
            for (int c = 0; c < 3; ++c) {
                const float got = Ci[std::size_t(c * SeenBatch::capacity + i)];
                const float error = std::fabs(got - expected[std::size_t(i)][c]);
                ASSERT_LE(error, 1e-6f * std::fabs(got) + 1.01f * negligible_highlight) << S::name;
                largest = std::max(largest, error);
            }
        }
    }
    if constexpr (HasHighlight<S>) {
        EXPECT_GT(largest, 0.0f) << S::name << ": nothing has been left out";
    }
}

template <class... S>
void expect_all_highlights_of(std::type_identity<std::tuple<S...>>) {
    (expect_all_highlights<S>(), ...);
}

TEST(View, LeavesOutHighlightsThatNobodySees) {
    expect_all_highlights_of(std::type_identity<AllShaders>());
}

TEST(HighlightEdge, IsWhereTheHighlightIsNegligible) {
    for (const float roughness : {0.001f, 0.01f, 0.1f, 0.3f, 1.0f}) {
        for (const float weight : {0.1f, 1.0f, 40.0f}) {
            const float edge = highlight_edge(roughness, weight);
            const double there = weight * std::pow(double(edge), 8.0 / double(roughness));
            EXPECT_NEAR(there, 0x1p-20, 0x1p-20 * 0.05) << roughness << ' ' << weight;
        }
    }
    EXPECT_EQ(highlight_edge(0.1f, 0.0f), 2.0f);
}

TEST(View, IsTheSumOfWhatEveryLightMakes) {
    expect_superposition_of(std::type_identity<AllShaders>());
}

/// The last of S's channels.
template <class S>
constexpr auto last_channel() {
    constexpr auto channels = S::channels();
    return std::get<std::tuple_size_v<decltype(channels)> - 1>(channels);
}

template <class S>
void expect_no_look_at_the_normal(int& normals) {
    if constexpr (requires(typename S::Baked b) {
                      b.*last_channel<S>().member = glm::vec3(0.0f);
                  }) {
        if (last_channel<S>().kind != ChannelKind::normal) return;
        ++normals;
        const S shader;
        test::Random random(2);
        for (int i = 0; i < 100; ++i) {
            SurfacePoint x{};
            x.P = random.point(1.0f);
            x.N = random.direction();
            x.dPdu = random.direction();
            x.filter_width = 0.01f;
            const auto baked = shader.bake(x);
            auto other = baked;
            other.*last_channel<S>().member = random.direction();
            const Light light{random.direction(), glm::vec3(1.0f)};
            const Seen seen{random.direction(),
                            Camera::direction(random.direction()),
                            glm::vec3(0.5f),
                            glm::vec3(0.2f),
                            {&light, 1}};
            ASSERT_EQ(shader.view(baked, seen), shader.view(other, seen)) << S::name;
        }
    }
}

// The renderer hands over the normal in Seen, in world space and on the eye's side.
TEST(View, DoesNotLookAtTheNormalOfItsRecord) {
    int normals = 0;
    [&]<class... S>(std::type_identity<std::tuple<S...>>) {
        (expect_no_look_at_the_normal<S>(normals), ...);
    }(std::type_identity<AllShaders>{});
    EXPECT_EQ(normals, 2);
}

}  // namespace
}  // namespace estara
