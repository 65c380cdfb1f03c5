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
#include "outlines.h"
#include "reprojection.h"

namespace estara {

/// Squares of lengths for which float does.
constexpr float least_square = 1e-30f, largest_square = 1e30f;

/// Point i of three planes.
template <class T>
ESTARA_KERNEL glm::vec3 at(const T& planes, int i) noexcept {
    return {planes[0][i], planes[1][i], planes[2][i]};
}

template <class T>
ESTARA_KERNEL void put(T& planes, int i, const glm::vec3& v) noexcept {
    planes[0][i] = v.x;
    planes[1][i] = v.y;
    planes[2][i] = v.z;
}

/// What all tiles of a frame share.
struct FrameContext {
    const Scene& scene;
    const RayScene& rays;
    Camera camera;
    glm::dvec3 origin;  ///< of world space in this frame
    std::span<const PosedInstance> instances;
    std::span<const PosedLight> lights;
    std::span<const ObjectShading> shading;                ///< by object
    std::span<const std::vector<glm::vec3>> face_normals;  ///< by object
    std::span<const std::vector<glm::vec3>> tangents;  ///< by object: face_tangent()s, if needed
    std::span<const glm::vec2> pattern;
    PlaceMoments pattern_moments;
    FrameSettings settings;
    const Reprojection* reuse;  ///< null: every sample is a new ray
};

/// Renders tiles one after the other; one per thread. Its memory grows to what a tile needs and is
/// then used again. Everything about samples is structure of arrays, and every loop over them that
/// does arithmetic is wide. render/README.md tells the order of what happens to a sample.
class TileRenderer {
public:
    static constexpr int capacity = batch_capacity;

    /// Renders a tile and writes its pixels to the film.
    /// @param tile   of TileGrid
    /// @param found  what the cache is to be given of this tile; not touched without reuse
    void render(const FrameContext& frame, int tile, Film& film, NewRecords& found);

    FrameStatistics statistics;  ///< of everything rendered since it was last reset

private:
    using Plane = float[capacity];
    using Planes = float[3][capacity];

    /// Samples [first, last) lie on one instance; they are new hits, or come from the cache.
    struct Group {
        std::uint32_t instance;
        int first, last;
        bool recalled;
        bool dark = false;  ///< the light that is being added makes nothing on it
    };
    /// Samples that are worked on together.
    struct Batch {
        int size = 0;
        int pixel[capacity];   ///< index into m_pixels
        int sample[capacity];  ///< of the pattern

        void push(int of_pixel, int of_pattern) noexcept {
            pixel[size] = of_pixel;
            sample[size++] = of_pattern;
        }
    };
    /// What the cache has for a sample of a tile.
    struct Listed {
        RayId id;
        const float* record = nullptr;  ///< null: nothing
        const float* second = nullptr;  ///< of another point in the same rectangle, or null
        int instance = 0;
        bool was_hidden = false, at_outline = false;
        bool seen = false;     ///< a ray has told that nothing hides it
        bool blocked = false;  ///< a ray has told that something does
        int own = -1;          ///< of m_own_hits: what that ray meets; -1: it has not been traced
    };
    /// Points of the cache that may stand in for samples of a batch, ordered by instance.
    struct alignas(64) Candidates {
        int lane[capacity];  ///< of the batch
        RayId id[capacity];
        const float* record[capacity];
        const float* second[capacity];  ///< null: none
        int was_hidden[capacity];
        int was_front[capacity];  ///< -1: seen from any side
        Planes P_object, Ng_object;
        int usable[capacity];   ///< 1: seen from the side from which it was shaded
        int known[capacity];    ///< 1: whether something hides it is known without a ray
        int blocked[capacity];  ///< 1: something hides it
    };
    /// The samples of a batch that see something, ordered by group.
    struct alignas(64) Samples {
        int pixel[capacity];    ///< index into m_pixels
        int number[capacity];   ///< in the pattern
        SurfaceBatch surface;   ///< object space, at rest
        Planes Ng_object;       ///< geometric normal, unit, object space; bent where the mesh is
        Site site[capacity];    ///< of bent meshes alone, as are the next two
        Planes P_bent, N_bent;  ///< of the bent mesh: P, and the normal to shade with
        Planes P;               ///< world
        Planes Ng;              ///< world, unit, on the side of the eye
        Plane distance;         ///< to the eye, world units
        int front[capacity];    ///< 1: seen from the side that Ng points to on the mesh
        SeenBatch seen;         ///< E is added up light by light
        int baked_E[capacity];  ///< 1: E was looked up or recalled, shadows and all
        int kept[capacity];     ///< 1: so is which lights are visible
        int age[capacity];      ///< frames since the point was found; -1: a new ray
        Planes middle;          ///< of recalled points and their seconds: mean placed_P()
        Plane x, y;             ///< of that: place from the pixel's centre, pixels
        Planes Ci;              ///< added up light by light
    };
    /// One light as it reaches the samples.
    struct alignas(64) Reach {
        Plane cosine;           ///< <N.L>+
        Planes origin;          ///< of the shadow ray, world
        Planes gloss;           ///< what view() makes of this light alone, unshadowed
        int wanted[capacity];   ///< 1: whether the light is visible could change the pixel
        int visible[capacity];  ///< 1 or 0
    };
    /// Sums over a pixel's samples.
    struct alignas(64) PixelSums {
        Planes color, albedo, N, P;
        Plane depth;
        int hits[capacity];
        int recalled[capacity], age[capacity], occluded[capacity];
        Plane covered;            ///< hits, weighted
        int bad[capacity];        ///< 1: the colour is not finite
        Planes color_x, color_y;  ///< color, times the sample's place from the pixel's centre
        Plane hit_x, hit_y;       ///< sums of these places
        Plane moved[5];  ///< what recalled points add to the pattern's sums of x, y, xx, xy, yy
    };

    void clear_sums(const FrameContext& frame);
    void list_pixels(const FrameContext& frame, const glm::ivec2& corner);
    void list_points(const FrameContext& frame, int tile, const glm::ivec2& corner);
    void trace_own_rays(const FrameContext& frame);
    void test_some(const FrameContext& frame);
    void spread_doubt(const bool* hides);
    void recall(const FrameContext& frame);
    void list_candidates(const FrameContext& frame);
    void aim_at_candidates(const FrameContext& frame);
    void test_candidates(const FrameContext& frame);
    struct PlacedPoint {
        glm::vec3 P, Ng;  ///< of the mesh, bent where it is
    };
    PlacedPoint placed_point(const FrameContext& frame, std::uint32_t instance,
                             const float* record) const;
    bool lies_on(const FrameContext& frame, const Listed& point, const Hit& hit,
                 const glm::vec3& P) const;
    Listed& listed(const FrameContext& frame, int pixel, int sample) {
        const auto number = std::size_t(m_numbers[std::size_t(pixel)]);
        return m_listed[number * frame.pattern.size() + std::size_t(sample)];
    }
    const Hit* own_hit(const FrameContext& frame, int lane) {
        if (frame.reuse == nullptr) return nullptr;
        const int own = listed(frame, m_batch.pixel[lane], m_batch.sample[lane]).own;
        return own < 0 ? nullptr : &m_own_hits[std::size_t(own)];
    }
    void take_visible(const FrameContext& frame);
    void list_batch(const glm::ivec2& pixels, const glm::ivec2& samples);
    /// Where in the image the pattern's sample of a pixel lies.
    void place_ray(const FrameContext& frame, int ray, int pixel, int sample) {
        const glm::vec2 at =
            glm::vec2(m_pixels[std::size_t(pixel)]) + frame.pattern[std::size_t(sample)];
        m_x[ray] = at.x;
        m_y[ray] = at.y;
    }
    void trace(const FrameContext& frame);
    void shade(const FrameContext& frame, NewRecords& found);
    void group_by_instance(const FrameContext& frame);
    int sort_by_instance(const FrameContext& frame, const std::uint32_t* instances, int count,
                         std::vector<Group>& groups, int* order);
    void reserve_planes(const ShaderInfo& info);
    void add_recalled_groups();
    void shade_new(const FrameContext& frame, const Group& group, NewRecords& found);
    void shade_recalled(const FrameContext& frame, const Group& group);
    void keep(const FrameContext& frame, const Group& group, NewRecords& found);
    void keep_light(const FrameContext& frame, NewRecords& found);
    void take_normals(const FrameContext& frame, const Group& group);
    void turn_directions(const FrameContext& frame, const Group& group);
    void average_seconds(const FrameContext& frame, const Group& group, const RecordLayout& layout);
    void place_in_pixels(const FrameContext& frame, const Group& group);
    void place_in_world(const FrameContext& frame, const Group& group);
    void interpolate(const FrameContext& frame, const Group& group);
    MeshPoint mesh_point_of(const FrameContext& frame, const Group& group, int j) const;
    void turn_normals(const PosedInstance& instance, const Group& group);
    void bend(const FrameContext& frame, const Group& group);
    void carry_normals(const FrameContext& frame, const Group& group);
    void carry_directions(const FrameContext& frame, const Group& group, float* x);
    CarriedFrame carried_frame(const PosedInstance& instance, int j) const;
    const Planes& placed_P(const PosedInstance& instance) const noexcept {
        return instance.bent ? m_samples.P_bent : m_samples.surface.P;
    }
    void evaluate(const FrameContext& frame, const Group& group);
    void look_up(const FrameContext& frame, const Group& group, const ObjectShading& shading);
    void look_up_irradiance(const FrameContext& frame, const Group& group);
    void find_footprints(const FrameContext& frame, const Group& group);
    void light(const FrameContext& frame, int number);
    void reach_samples(const FrameContext& frame, const Group& group, const PosedLight& light);
    void want_shadows(const FrameContext& frame);
    void trace_shadows(const FrameContext& frame, const PosedLight& light);
    bool sees(const Group& group, int light) const;
    void recall_visibility(int light);
    void add_light();
    void close(const FrameContext& frame);
    void view(const FrameContext& frame, bool lit, Planes& Ci);
    void accumulate(const FrameContext& frame);
    void accumulate_places(const FrameContext& frame);
    PlaceMoments places_of(const FrameContext& frame, int pixel) const;
    void resolve(const FrameContext& frame, Film& film);
    void weigh_by_place(const FrameContext& frame);
    void resolve_aovs(const FrameContext& frame, Film& film);
    const ObjectShading& shading_of(const FrameContext& frame, const Group& group) const;
    ObjectCost& cost_of(const FrameContext& frame, const Group& group);

    std::vector<glm::ivec2> m_pixels;
    std::vector<int> m_numbers;  ///< of m_pixels in the tile: tiles may reach beyond the image
    PixelSums m_sums;
    Batch m_batch;
    int m_needs_ray[capacity];  ///< by lane; 1 or 0
    int m_ray_lane[capacity];   ///< of each primary ray
    int m_ray_count = 0;
    Plane m_x, m_y;  ///< where the rays go through the image
    RayBatch m_rays;
    HitBatch m_hits;
    std::vector<int> m_group_of_instance;  ///< -1: not hit in this tile
    std::vector<Group> m_groups;
    int m_order[capacity];         ///< hit of each sample, or candidate of a recalled one
    int m_count = 0;               ///< samples
    std::vector<Listed> m_listed;  ///< by number of the pixel in the tile and sample
    bool m_doubtful[capacity];     ///< by pixel: all its points are tested for occlusion
    std::vector<Hit> m_own_hits;
    OutlineFinder m_outlines;
    Candidates m_candidates;
    std::vector<Group> m_candidate_groups;
    int m_candidate_count = 0;
    int m_candidate_order[capacity];  ///< of the visible ones
    int m_candidate_of_ray[capacity];
    std::vector<std::uint32_t> m_sides;  ///< RecordLayout's words, by sample in each
    std::ptrdiff_t m_row[capacity];      ///< of a sample in NewRecords::floats, or -1
    Samples m_samples;
    Reach m_reach;
    int m_shadow_sample[capacity];  ///< of each shadow ray
    std::array<std::uint8_t, capacity> m_blocked, m_found;
    std::vector<float> m_planes;  ///< baked records of all samples
    std::vector<float> m_footprints;
    std::vector<int> m_missed;
    SurfaceBatch m_missed_batch;
    std::vector<float> m_missed_planes, m_irradiance;
};

}  // namespace estara
