#include "shade.h"

#include <fmt/format.h>
#include <tbb/blocked_range.h>
#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <atomic>

#include "estara/scenes/error.h"
#include "estara/shaders/math.h"

namespace estara {

namespace {

/// The widest loop over a batch takes so many points at once, and the rest one by one.
constexpr int widest_step = 16;
static_assert(SurfaceBatch::capacity % widest_step == 0);

/// Blocks that are shaded one after another: some batches.
constexpr std::size_t blocks_at_a_time = 16;

/// Takes voxels in row order and passes them through the shader, a full batch at a time wherever
/// blocks begin and end: a batch that is a block is a quarter full.
class Shading {
public:
    Shading(const Mesh& mesh, const BoundShader& shader, const SurfaceBand& band, TextureGrid& grid,
            const VoxelsDone& done, std::atomic<bool>& finite)
        : m_mesh(mesh),
          m_shader(shader),
          m_band(band),
          m_grid(grid),
          m_done(done),
          m_finite(finite),
          m_values(std::size_t(shader.info().baked_floats) * SurfaceBatch::capacity) {
        m_batch.filter_width = float(band.voxel_size);
        // A Domain::point shader reads P alone; the rest is some surface, once and for all.
        for (int i = 0; i < SurfaceBatch::capacity; ++i) {
            m_batch.set(i, glm::vec3(0.0f), {0, 0, 1}, {0, 0}, {1, 0, 0});
        }
    }

    /// Shades blocks [begin, end).
    void shade(std::size_t begin, std::size_t end) {
        m_first = m_band.blocks[begin].first;
        for (std::size_t b = begin; b < end; ++b) {
            if (m_shader.domain() == Domain::point) {
                add_voxels(b);
            } else {
                add_surface_points(b);
            }
        }
        flush();
    }

private:
    void add_voxels(std::size_t b) {
        const Block& block = m_band.blocks[b];
        float at[3][8];
        for (int i = 0; i < 8; ++i) {
            const glm::vec3 p = m_band.position(block.origin + i);
            for (int c = 0; c < 3; ++c) at[c][i] = p[c];
        }
        for_each_bit(block.active, [&](int x, int y, int z) {
            const int i = next();
            m_batch.P[0][i] = at[0][x];
            m_batch.P[1][i] = at[1][y];
            m_batch.P[2][i] = at[2][z];
        });
    }

    void add_surface_points(std::size_t b) {
        nearest_points(m_mesh, m_band, b, m_points);
        for (const MeshPoint& point : m_points) {
            m_batch.set(next(), point.P, point.N, point.uv, tangent(m_mesh, point));
        }
    }

    /// Where the next point of the batch goes.
    int next() {
        if (m_batch.size == SurfaceBatch::capacity) flush();
        return m_batch.size++;
    }

    void flush() {
        const int size = m_batch.size;
        if (size == 0) return;
        for (; m_batch.size % widest_step != 0; ++m_batch.size) repeat_last();
        m_shader.bake(m_batch, m_values.data());
        for (std::size_t k = 0; k < m_grid.levels.front().planes.size(); ++k) {
            const float* const values = m_values.data() + k * SurfaceBatch::capacity;
            int bad = 0;
            for (int i = 0; i < size; ++i) {
                bad |= int(!is_finite(values[i]));
            }
            if (bad != 0) m_finite = false;
            std::copy_n(values, size,
                        m_grid.levels.front().planes[k].begin() + std::ptrdiff_t(m_first));
        }
        m_first += std::uint64_t(size);
        m_batch.size = 0;
        if (m_done) m_done(std::uint64_t(size));
    }

    void repeat_last() noexcept {
        const int i = m_batch.size, last = i - 1;
        m_batch.set(i, {m_batch.P[0][last], m_batch.P[1][last], m_batch.P[2][last]},
                    {m_batch.N[0][last], m_batch.N[1][last], m_batch.N[2][last]},
                    {m_batch.uv[0][last], m_batch.uv[1][last]},
                    {m_batch.dPdu[0][last], m_batch.dPdu[1][last], m_batch.dPdu[2][last]});
    }

    const Mesh& m_mesh;
    const BoundShader& m_shader;
    const SurfaceBand& m_band;
    TextureGrid& m_grid;
    const VoxelsDone& m_done;
    std::atomic<bool>& m_finite;
    SurfaceBatch m_batch;
    std::vector<MeshPoint> m_points;
    std::vector<float> m_values;  ///< planes as the shader writes them
    std::uint64_t m_first = 0;    ///< row of the batch's first point
};

}  // namespace

void shade(const Mesh& mesh, const BoundShader& shader, const SurfaceBand& band, TextureGrid& grid,
           const VoxelsDone& done) {
    const std::size_t voxels = band.voxels();
    std::vector<std::vector<float>>& planes = grid.levels.emplace_back().planes;
    planes.resize(std::size_t(shader.info().baked_floats));
    tbb::parallel_for(std::size_t{0}, planes.size(),
                      [&](std::size_t k) { planes[k].resize(voxels); });

    std::atomic<bool> finite{true};
    tbb::enumerable_thread_specific<Shading> workers(std::cref(mesh), std::cref(shader),
                                                     std::cref(band), std::ref(grid),
                                                     std::cref(done), std::ref(finite));
    tbb::parallel_for(
        tbb::blocked_range<std::size_t>(0, band.blocks.size(), blocks_at_a_time),
        [&](const auto& blocks) { workers.local().shade(blocks.begin(), blocks.end()); });
    if (!finite) {
        throw Error(
            fmt::format("shader '{}' gives values that are not finite on this surface with {}",
                        shader.info().name, describe_values(shader)));
    }
}

}  // namespace estara
