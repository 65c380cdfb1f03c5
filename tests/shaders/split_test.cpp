// A shader in two halves is the whole shader: what bake() keeps serves every view, and bake() and
// view() together make the picture that the unsplit mathematics makes.
#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <ostream>

#include "reference.h"
#include "sampling.h"
#include "view.h"

namespace estara {
namespace {

constexpr int capacity = SurfaceBatch::capacity;

struct Case {
    std::string name, shader;
    std::vector<Setting> settings;
    bool has_uv = true;
};
std::ostream& operator<<(std::ostream& out, const Case& c) { return out << c.name; }

std::vector<Case> cases() {
    std::vector<Case> all;
    for (const ShaderInfo& info : all_shaders()) {
        all.push_back({std::string(info.name), std::string(info.name), {}, true});
    }
    all.push_back({"blocks_bump", "blocks", {{"bump", {1}}}, true});
    all.push_back({"blocks_bump_solid", "blocks", {{"bump", {2}}}, false});
    all.push_back({"RCSkin_thin",
                   "RCSkin",
                   {{"blemishopac", {0.5f}},
                    {"eta", {1.4f}},
                    {"thickness", {0.3f}},
                    {"angle", {30}},
                    {"xrough", {0.1f}},
                    {"oily", {4}},
                    {"poresdepth", {-0.003f}},
                    {"maxfreq", {20}},
                    {"sheenColor", {1, 0.5f, 0.25f}}},
                   true});
    return all;
}

class Split : public testing::TestWithParam<Case> {
protected:
    static BoundShaderPtr bound() {
        return bind_shader(GetParam().shader, GetParam().settings, GetParam().has_uv).shader;
    }
};
INSTANTIATE_TEST_SUITE_P(Library, Split, testing::ValuesIn(cases()),
                         [](const auto& one) { return one.param.name; });

SurfacePoint point(const SurfaceBatch& batch, int i) {
    return {{batch.P[0][i], batch.P[1][i], batch.P[2][i]},
            {batch.N[0][i], batch.N[1][i], batch.N[2][i]},
            {batch.uv[0][i], batch.uv[1][i]},
            {batch.dPdu[0][i], batch.dPdu[1][i], batch.dPdu[2][i]},
            batch.filter_width,
            0.0f};
}

/// The shading normal of point i: the record's, where there is one, else the mesh's.
glm::vec3 normal(const BoundShader& shader, const SurfaceBatch& batch,
                 const std::vector<float>& planes, int i) {
    if (shader.info().channels.back().kind != ChannelKind::normal) return point(batch, i).N;
    const float* const column =
        planes.data() + (shader.info().baked_floats - 3) * capacity + std::ptrdiff_t(i);
    return {column[0], column[capacity], column[2 * capacity]};
}

/// Some eye and lights for each point of a batch.
std::vector<reference::Sight> random_sights(std::uint32_t seed, int lights) {
    test::Random random(seed);
    std::vector<reference::Sight> sights;
    for (int i = 0; i < capacity; ++i) {
        reference::Sight sight{random.direction(), glm::dvec3(random.unit()), {}};
        for (int k = 0; k < lights; ++k) {
            sight.lights.push_back({random.direction(), {random.unit(), random.unit(), 1.0f}});
        }
        sights.push_back(sight);
    }
    return sights;
}

/// As the renderer does it: what diffuse and ambient light make, and then light by light.
std::vector<glm::vec3> shade(const BoundShader& shader, const SurfaceBatch& batch,
                             const std::vector<float>& planes,
                             const std::vector<reference::Sight>& sights) {
    const auto seen = std::make_unique<SeenBatch>();
    std::vector<glm::vec3> colors(capacity, glm::vec3(0.0f));
    std::vector<float> Ci(3 * capacity);
    const int lights = int(sights.front().lights.size());
    for (int pass = -1; pass < lights; ++pass) {
        for (int i = 0; i < capacity; ++i) {
            const reference::Sight& sight = sights[std::size_t(i)];
            const glm::vec3 V(sight.V);
            glm::vec3 N = normal(shader, batch, planes, i);
            if (glm::dot(N, V) < 0.0f) N = -N;
            Seen one = test::seen(N, V, sight.lights);
            if (pass >= 0) one.lights = one.lights.subspan(std::size_t(pass), 1);
            one.A = glm::vec3(sight.A);
            test::set(*seen, i, one);
        }
        for (int i = 0; i < capacity; ++i) {  // A is one for the whole batch
            seen->A = glm::vec3(sights[std::size_t(i)].A);
            shader.view(planes.data(), *seen, i, i + 1, pass >= 0, Ci.data());
            colors[std::size_t(i)] += glm::vec3(Ci[std::size_t(i)], Ci[std::size_t(capacity + i)],
                                                Ci[std::size_t(2 * capacity + i)]);
        }
    }
    return colors;
}

TEST_P(Split, MakesThePictureOfTheWholeShader) {
    const BoundShaderPtr shader = bound();
    int points = 0, others = 0;
    double worst = 0;
    for (std::uint32_t seed = 0; seed < 8; ++seed) {
        const SurfaceBatch batch = test::random_batch(seed, 2.0f, 0.01f);
        const std::vector<float> planes = test::bake(*shader, batch);
        const std::vector<reference::Sight> sights = random_sights(seed + 100, 1 + int(seed % 3));
        const std::vector<glm::vec3> colors = shade(*shader, batch, planes, sights);
        for (int i = 0; i < capacity; ++i) {
            const reference::Sight& sight = sights[std::size_t(i)];
            const auto whole = reference::render(*shader, point(batch, i), sight);
            ASSERT_TRUE(whole.has_value());
            // A highlight of width .01 amplifies a rounding of its cosine 800 times.
            double off = 0;
            for (int c = 0; c < 3; ++c) {
                const double wanted = (*whole)[c];
                off = std::max(
                    off, std::abs(colors[std::size_t(i)][c] - wanted) / (1 + std::abs(wanted)));
            }
            ++points;
            if (off > 2e-3)
                ++others;
            else
                worst = std::max(worst, off);
        }
    }
    // Points at a step of a pattern, at a crease of a normal, or seen along the surface.
    EXPECT_LE(others, 0.004 * points) << "worst of the rest " << worst;
    RecordProperty("largest_error", std::to_string(worst));
}

TEST_P(Split, KeepsARecordThatNoViewChanges) {
    const BoundShaderPtr shader = bound();
    const SurfaceBatch batch = test::random_batch(3);
    const std::vector<float> first = test::bake(*shader, batch);
    std::vector<glm::vec3> seen_first;
    for (std::uint32_t eye = 0; eye < 8; ++eye) {
        const std::vector<float> again = test::bake(*shader, batch);
        ASSERT_TRUE(test::same_bits(again, first)) << "baked again before view " << eye;
        std::vector<float> kept = first;
        const auto from_kept = shade(*shader, batch, kept, random_sights(eye, 2));
        const auto from_new = shade(*shader, batch, again, random_sights(eye, 2));
        ASSERT_EQ(from_kept, from_new) << "a kept record looks as a new one does, view " << eye;
        ASSERT_TRUE(test::same_bits(kept, first)) << "view() leaves the record alone";
    }
}

}  // namespace
}  // namespace estara
