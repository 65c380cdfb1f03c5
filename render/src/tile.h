// The innermost loop of rendering: a tile of pixels, from rays to colours.
#pragma once

#include <glm/glm.hpp>

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "estara/render/camera.h"
#include "estara/render/frame.h"
#include "estara/shaders/batch.h"
#include "instances.h"

namespace estara {

/// What all tiles of a frame share.
struct FrameContext {
    const Scene& scene;
    const RayScene& rays;
    Camera camera;
    std::span<const PosedInstance> instances;
    std::span<const PosedLight> lights;
    std::span<const ObjectShading> shading;  ///< by object
    std::span<const glm::vec2> pattern;
    FrameSettings settings;
};

/// Renders tiles one after the other; one per thread. Its memory grows to what a tile needs and is
/// then used again. render/README.md tells the order of what happens to a sample.
class TileRenderer {
public:
    static constexpr int width = 32, height = 16;
    /// A sample in each pixel of a tile fills one batch of a shader.
    static constexpr int capacity = SurfaceBatch::capacity;
    static_assert(width * height == capacity);

    /// Renders the pixels from `corner` on and writes them to the film.
    void render(const FrameContext& frame, const glm::ivec2& corner, Film& film);

    FrameStatistics statistics;  ///< of everything rendered since it was last reset

private:
    /// A hit, in world and object space.
    struct Sample {
        int pixel;        ///< index into m_pixels
        MeshPoint point;  ///< object space
        glm::vec3 P;      ///< world
        glm::vec3 Ng, N;  ///< world, unit, on the side of the eye
        Sight sight;
    };
    /// Samples [first, last) lie on one instance.
    struct Group {
        std::uint32_t instance;
        int first, last;
    };
    /// Sums over a pixel's samples.
    struct PixelSum {
        glm::vec3 color{0.0f}, albedo{0.0f}, N{0.0f}, P{0.0f};
        float depth = 0.0f;
        int hits = 0;
    };
    /// A sample that a light would reach, and with what.
    struct Candidate {
        int sample;
        Light light;
        float cosine;
    };

    void list_pixels(const FrameContext& frame, const glm::ivec2& corner);
    void trace(const FrameContext& frame, const glm::vec2& offset);
    void group_by_instance(const FrameContext& frame);
    void place_on_surface(const FrameContext& frame, const Group& group);
    void light(const FrameContext& frame);
    void find_candidates(const PosedLight& light, const FrameContext& frame);
    void set_point(const FrameContext& frame, const Group& group, int i, int j);
    void evaluate(const FrameContext& frame, const Group& group);
    void look_up(const FrameContext& frame, const Group& group, const ObjectShading& shading);
    void view(const FrameContext& frame, const Group& group);
    void accumulate(const FrameContext& frame, const Group& group);
    void resolve(const FrameContext& frame, Film& film);
    const ObjectShading& shading_of(const FrameContext& frame, const Group& group) const;

    std::vector<glm::ivec2> m_pixels;
    std::vector<PixelSum> m_sums;
    std::vector<Ray> m_rays;
    std::array<Hit, capacity> m_hits;
    std::vector<int> m_group_of_instance;  ///< -1: not hit in this tile
    std::vector<Group> m_groups;
    std::vector<Sample> m_samples;       ///< ordered by group
    std::vector<std::uint32_t> m_order;  ///< hit of each sample
    std::vector<Candidate> m_candidates;
    std::array<std::uint8_t, capacity> m_blocked, m_found;
    std::vector<Light> m_lights;  ///< one row of as many as the scene has lights for each sample
    std::array<int, capacity> m_light_count;
    std::array<glm::vec3, capacity> m_E;
    SurfaceBatch m_batch;
    std::vector<float> m_planes, m_missed_planes;
    std::vector<int> m_missed;
    std::vector<glm::vec3> m_P;
    std::vector<float> m_footprints;
    std::vector<Seen> m_seen;
    std::array<glm::vec3, capacity> m_Ci;
};

}  // namespace estara
