#include "estara/bake/irradiance.h"

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <tuple>

#include "error_figures.h"
#include "estara/bake/bake.h"
#include "estara/bake/surface_band.h"
#include "estara/grids/bricks.h"
#include "estara/grids/irradiance.h"
#include "estara/scenes/error.h"
#include "estara/scenes/program.h"
#include "estara/scenes/static_light.h"
#include "surface_sampler.h"

namespace estara {
namespace {

constexpr double most_masked = 0.05;  // share of the surface; more: smaller voxels
constexpr const char* masked_param = "masked";
constexpr int floats = 4;  // irradiance and mask
constexpr std::size_t batch = SurfaceSampler::batch_size;

/// Bytes of a bake's memory for each voxel of its finest level: planes and levels, distance-free,
/// and the lookup structure beside them.
constexpr double bytes_per_voxel = 60.0;

int only_instance(const Scene& scene, int object) {
    const std::string why = why_no_static_light(scene, object);
    if (!why.empty()) throw Error(why);
    return instances_of(scene, object).front();
}

/// One object's light, as it is baked and looked up.
class IrradianceBake {
public:
    IrradianceBake(const Scene& scene, const RayScene& rays, int object, int instance,
                   const IrradianceSettings& settings)
        : m_mesh(scene.objects[std::size_t(object)].mesh),
          m_light(scene, rays, instance),
          m_settings(settings) {
        m_result.closed = is_closed(m_mesh);
        m_result.shader = irradiance_shader;
        m_result.mesh_digest = mesh_digest(m_mesh);
        m_result.lights_digest = lights_digest(scene, instance);
        m_result.tool_version = version;
        m_result.channels = {{irradiance_channel, 3}, {irradiance_mask_channel, 1}};
    }

    /// @return masked share of the surface
    double bake(double voxel_size) {
        fill(voxel_size);
        mask(voxel_size);
        const double masked = masked_area();
        m_result.params = {{"max_error", {float(m_settings.max_error)}},
                           {masked_param, {float(masked)}}};
        return masked;
    }

    std::uint64_t voxels() const noexcept { return m_result.levels.front().voxels(); }

    TextureGrid finish() {
        add_levels(m_result);
        if (m_settings.half) round_to_half(m_result);
        m_result.errors = measure();
        return std::move(m_result);
    }

private:
    /// Light at the surface point nearest to every voxel; nothing is masked yet.
    void fill(double voxel_size) {
        SurfaceBand band = surface_band(m_mesh, voxel_size);
        band.distance = {};  // the grid of colours has them
        m_result.voxel_size = voxel_size;
        m_result.origin = band.origin;
        m_result.levels.assign(1, {});
        GridLevel& level = m_result.levels.front();
        level.planes.assign(floats, std::vector<float>(band.voxels(), 0.0f));
        tbb::parallel_for(std::size_t{0}, band.blocks.size(), [&](std::size_t b) {
            thread_local std::vector<MeshPoint> points;
            thread_local std::vector<glm::vec3> E;
            nearest_points(m_mesh, band, b, points);
            E.resize(points.size());
            m_light.irradiance(points, E.data());
            for (std::size_t i = 0; i < E.size(); ++i) {
                for (int c = 0; c < 3; ++c) {
                    level.planes[std::size_t(c)][band.blocks[b].first + i] = E[i][c];
                }
            }
        });
        level.blocks = std::move(band.blocks);
        level.cells = std::move(band.cells);
    }

    /// Calls f(points, E, values) for batches of surface points: the light there, and what a lookup
    /// of level 0 finds. The points do not depend on the threads.
    template <class F>
    void compare(std::uint64_t samples, std::uint64_t seed, const F& f) const {
        const SurfaceSampler sampler(m_mesh);
        const BrickPyramid bricks = finest_level();
        tbb::parallel_for(std::uint64_t{0}, (samples + batch - 1) / batch, [&](std::uint64_t b) {
            thread_local std::vector<MeshPoint> points;
            thread_local std::vector<glm::vec3> E, P;
            thread_local std::vector<float> values;
            thread_local std::vector<std::uint8_t> found;
            const std::uint64_t first = b * batch;
            const auto count = std::size_t(std::min<std::uint64_t>(batch, samples - first));
            sampler.points(seed, b, count, points);
            E.resize(count);
            P.resize(count);
            values.resize(floats * batch);
            found.resize(count);
            for (std::size_t i = 0; i < count; ++i) P[i] = points[i].P;
            m_light.irradiance(points, E.data());
            const std::vector<float> finest(count, 0.0f);
            bricks.lookup(P, finest, values.data(), batch, found.data());
            f(first, points, E, values);
        });
    }

    /// The lookup structure without coarser levels.
    BrickPyramid finest_level() const {
        if (m_result.levels.size() == 1) return BrickPyramid(m_result);
        TextureGrid finest;
        finest.voxel_size = m_result.voxel_size;
        finest.origin = m_result.origin;
        finest.channels = m_result.channels;
        finest.levels = {m_result.levels.front()};
        return BrickPyramid(finest);
    }

    static float worst(const glm::vec3& E, const std::vector<float>& values, std::size_t i) {
        float error = 0.0f;
        for (std::size_t c = 0; c < 3; ++c) {
            error = std::max(error, std::abs(values[c * batch + i] - E[int(c)]));
        }
        return error;
    }

    /// Masks the cells in which a lookup was seen to be wrong.
    void mask(double voxel_size) {
        GridLevel& level = m_result.levels.front();
        // An active voxel stands for about a third of a voxel's square of surface.
        const std::uint64_t samples =
            std::clamp<std::uint64_t>(3 * level.voxels(), 1u << 16, std::uint64_t{1} << 30);
        std::vector<std::vector<glm::vec3>> bad((samples + batch - 1) / batch);
        compare(samples, 2 * m_settings.seed,
                [&](std::uint64_t first, const std::vector<MeshPoint>& points,
                    const std::vector<glm::vec3>& E, const std::vector<float>& values) {
                    for (std::size_t i = 0; i < points.size(); ++i) {
                        if (worst(E[i], values, i) > float(m_settings.max_error)) {
                            bad[first / batch].push_back(points[i].P);
                        }
                    }
                });
        for (const std::vector<glm::vec3>& some : bad) {
            for (const glm::vec3& P : some) {
                const glm::ivec3 cell(glm::floor((glm::dvec3(P) - m_result.origin) / voxel_size));
                for (int corner = 0; corner < 8; ++corner) {
                    set_mask(level, cell + glm::ivec3(corner >> 2, (corner >> 1) & 1, corner & 1));
                }
            }
        }
    }

    /// Share of the surface at which a lookup finds the mask: the cells that mask() marks, and
    /// what it reaches into their neighbours.
    double masked_area() const {
        const SurfaceSampler sampler(m_mesh);
        const BrickPyramid bricks = finest_level();
        constexpr std::uint64_t batches = 128;
        const std::vector<float> finest(batch, 0.0f);
        std::vector<MeshPoint> points;
        std::vector<glm::vec3> P(batch);
        std::vector<float> values(floats * batch);
        std::vector<std::uint8_t> found(batch);
        std::uint64_t masked = 0;
        for (std::uint64_t b = 0; b < batches; ++b) {
            sampler.points(2 * m_settings.seed, b, batch, points);
            for (std::size_t i = 0; i < batch; ++i) P[i] = points[i].P;
            bricks.lookup(P, finest, values.data(), batch, found.data());
            for (std::size_t i = 0; i < batch; ++i) {
                masked += values[3 * batch + i] > irradiance_mask_limit ? 1 : 0;
            }
        }
        return double(masked) / double(batches * batch);
    }

    static void set_mask(GridLevel& level, const glm::ivec3& voxel) {
        const glm::ivec3 origin = voxel & ~7, local = voxel & 7;
        const auto found =
            std::lower_bound(level.blocks.begin(), level.blocks.end(), origin,
                             [](const Block& block, const glm::ivec3& o) {
                                 return std::tie(block.origin.x, block.origin.y, block.origin.z) <
                                        std::tie(o.x, o.y, o.z);
                             });
        if (found == level.blocks.end() || found->origin != origin) return;
        const int bit = BlockMask::bit(local.x, local.y, local.z);
        if (!found->active.test(bit)) return;
        level.planes[3][found->first + std::uint64_t(found->active.before(bit))] = 1.0f;
    }

    /// Errors at other points, outside the mask; of the mask itself there is none to tell.
    std::vector<ErrorFigures> measure() const {
        std::vector<float> errors(3 * error_samples, -1.0f);
        compare(error_samples, 2 * m_settings.seed + 1,
                [&](std::uint64_t first, const std::vector<MeshPoint>& points,
                    const std::vector<glm::vec3>& E, const std::vector<float>& values) {
                    for (std::size_t i = 0; i < points.size(); ++i) {
                        if (values[3 * batch + i] > irradiance_mask_limit) continue;
                        for (std::size_t c = 0; c < 3; ++c) {
                            errors[3 * (first + i) + c] =
                                std::abs(values[c * batch + i] - E[i][int(c)]);
                        }
                    }
                });
        std::erase(errors, -1.0f);
        if (errors.empty()) return {};
        const std::uint64_t samples = errors.size() / 3;
        return {error_figures(errors, samples), ErrorFigures{}};
    }

    const Mesh& m_mesh;
    StaticLight m_light;
    IrradianceSettings m_settings;
    TextureGrid m_result;
};

}  // namespace

double masked_share(const TextureGrid& grid) {
    for (const auto& [name, value] : grid.params) {
        if (name == masked_param) return value.front();
    }
    return 0.0;
}

TextureGrid bake_irradiance(const Scene& scene, const RayScene& rays, int object,
                            const IrradianceSettings& settings) {
    const int instance = only_instance(scene, object);
    const Mesh& mesh = scene.objects[std::size_t(object)].mesh;
    IrradianceBake bake(scene, rays, object, instance, settings);
    if (settings.voxel_size) {
        bake.bake(*settings.voxel_size);
        return bake.finish();
    }
    const double diagonal = bounds(mesh).diagonal();
    const double finest = std::max(settings.finest, finest_voxel_size(mesh));
    double size = std::max(diagonal / 64.0, finest);
    while (bake.bake(size) > most_masked && size / 2.0 >= finest) {
        const double voxels = 4.0 * double(bake.voxels());
        if (voxels * bytes_per_voxel > double(settings.max_bytes)) break;
        size /= 2.0;
    }
    return bake.finish();
}

}  // namespace estara
