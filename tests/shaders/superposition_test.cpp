// What a point sends to the eye is a sum over what lights it: the renderer adds light by light.
#include <gtest/gtest.h>

#include <cmath>
#include <tuple>
#include <vector>

#include "library/all.h"
#include "sampling.h"
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
