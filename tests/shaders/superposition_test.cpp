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

}  // namespace
}  // namespace estara
