// Shaders and what they are made of, a batch of points at a time, on each instruction set.
#include <benchmark/benchmark.h>
#include <fmt/format.h>

#include <map>
#include <memory>
#include <random>

#include "estara/render/camera.h"
#include "estara/shaders/spline.h"
#include "loops.h"
#include "meshes.h"
#include "rows.h"

namespace estara::bench {
namespace {

// Building blocks as shaders of one channel, so that they are looped over as shaders are.
template <class Block>
struct Alone {
    float frequency = 20.0f;
    struct Baked {
        float value;
    };
    static constexpr auto channels() { return std::tuple{Channel{"value", &Baked::value, ""}}; }
    ESTARA_KERNEL Baked bake(const SurfacePoint& x) const noexcept {
        return {Block::value(x.P * frequency)};
    }
};
struct Noise3d {
    static constexpr const char* name = "noise/3d";
    static constexpr const char* what = "snoise of a point in space";
    ESTARA_KERNEL static float value(const glm::vec3& p) noexcept { return snoise(p); }
};
struct Voronoi27 {
    static constexpr const char* name = "voronoi/27cells";
    static constexpr const char* what = "f2 - f1 of voronoi in space";
    ESTARA_KERNEL static float value(const glm::vec3& p) noexcept {
        const Voronoi<glm::vec3> v = voronoi(p, 1.0f);
        return v.f2 - v.f1;
    }
};
struct Spline {
    static constexpr const char* name = "spline/9knots";
    static constexpr const char* what = "spline of nine knots";
    ESTARA_KERNEL static float value(const glm::vec3& p) noexcept {
        constexpr std::array<float, 9> knots{0, 0, .1f, .5f, .4f, .9f, .7f, 1, 1};
        return spline(p.x - std::floor(p.x), knots);
    }
};
struct Power {
    static constexpr const char* name = "power";
    static constexpr const char* what = "power(x, y)";
    ESTARA_KERNEL static float value(const glm::vec3& p) noexcept {
        return power(std::fabs(p.x), p.y);
    }
};

struct Set {
    InstructionSet set;
    const char* name;
    bool supported;
};
std::vector<Set> supported_sets() {
    std::vector<Set> sets{
        {InstructionSet::sse42, "sse42", bool(__builtin_cpu_supports("x86-64-v2"))},
        {InstructionSet::avx2, "avx2", bool(__builtin_cpu_supports("x86-64-v3"))},
        {InstructionSet::avx512, "avx512", bool(__builtin_cpu_supports("x86-64-v4"))}};
    std::erase_if(sets, [](const Set& s) { return !s.supported; });
    return sets;
}

/// A few batches of random surface points, more than branches are remembered for.
std::vector<SurfaceBatch> random_batches() {
    const Mesh& mesh = surface();
    std::mt19937 random(1);
    std::uniform_int_distribution<std::uint32_t> triangles(
        0, std::uint32_t(mesh.triangles.size()) - 1);
    std::uniform_real_distribution<float> share(0.0f, 0.5f);
    std::vector<SurfaceBatch> batches(8);
    for (SurfaceBatch& batch : batches) {
        batch.size = SurfaceBatch::capacity;
        batch.filter_width = bounds(mesh).diagonal() / 1024.0f;
        for (int i = 0; i < batch.size; ++i) {
            const MeshPoint p = mesh_point(mesh, triangles(random), share(random), share(random));
            batch.set(i, p.P, p.N, p.uv, tangent(mesh, p));
        }
    }
    return batches;
}

using Bake = std::function<void(const SurfaceBatch&, float*)>;

std::vector<float> planes_for(int floats) {
    return std::vector<float>(std::size_t(floats) * SurfaceBatch::capacity);
}

/// What is measured: a name of a row, and what goes into it.
struct Measured {
    std::string name, unit, error, what;
    std::function<void(std::size_t batch)> work;
};

class Plan {
public:
    explicit Plan(Rows& rows) : m_rows(rows), m_batches(random_batches()) {}

    /// bake over the batches; the bits must be those of `reference`.
    void add_bake(const std::string& name, const std::string& what, int floats, const Bake& bake,
                  const Bake& reference) {
        std::vector<float> planes = planes_for(floats), expected = planes;
        for (const SurfaceBatch& batch : m_batches) {
            bake(batch, planes.data());
            reference(batch, expected.data());
            if (planes != expected) m_rows.disagree(name + ": not the bits of plain x86-64");
        }
        m_measured.push_back(
            {name, "ns", "exact", what, [this, bake, planes](std::size_t b) mutable {
                 bake(m_batches[b % m_batches.size()], planes.data());
             }});
    }

    template <class Block>
    void add_block() {
        const Alone<Block> alone;
        const auto with = [alone](InstructionSet set) {
            return Bake([alone, set](const SurfaceBatch& in, float* planes) {
                wide([alone, &in, planes]()
                         ESTARA_LOOP { detail::bake_loop<true>(alone, in, 0, in.size, planes); },
                     set);
            });
        };
        for (const Set& set : supported_sets()) {
            add_bake(fmt::format("{}/{}", Block::name, set.name),
                     fmt::format("a value, {}, one thread", Block::what), 1, with(set.set),
                     with(InstructionSet::baseline));
        }
    }

    void add_shader(const ShaderInfo& info) {
        const std::string name(info.name);
        const auto with = [&](InstructionSet set) {
            return Bake([shader = bound(name, set)](const SurfaceBatch& in, float* planes) {
                shader->bake(in, planes);
            });
        };
        const auto add = [&](const std::string& row, InstructionSet set, const char* words) {
            add_bake("shader/" + name + "/" + row,
                     fmt::format("a point, bake() at its defaults, {}, one thread", words),
                     info.baked_floats, with(set), with(InstructionSet::baseline));
        };
        const std::vector<Set> sets = supported_sets();
        add("direct", InstructionSet::avx512, sets.empty() ? "plain x86-64" : sets.back().name);
        for (const Set& set : sets) {
            if (set.set != InstructionSet::avx512) {
                add(std::string("direct_") + set.name, set.set, set.name);
            }
        }
        add_view(name, info.baked_floats);
    }

    const std::vector<Measured>& measured() const noexcept { return m_measured; }

private:
    /// Points of the first batch, lit by one light, as a camera outside sees them.
    void add_view(const std::string& name, int floats) {
        const BoundShaderPtr shader = bound(name);
        const SurfaceBatch& batch = m_batches.front();
        std::vector<float> planes = planes_for(floats);
        shader->bake(batch, planes.data());
        const Box box = bounds(surface());
        const glm::vec3 eye = box.max + box.diagonal();
        const Camera camera({eye, {1, 0, 0}, {0, 1, 0}, {0, 0, -1}, 0.3f}, 640, 360);
        const glm::vec3 L = glm::normalize(glm::vec3(1, 2, 3));
        const auto seen = std::make_shared<SeenBatch>();
        std::vector<float> distance(batch_capacity);
        camera.sights(batch.P[0], 0, batch.size, seen->V, distance.data());
        for (int i = 0; i < batch.size; ++i) {
            const glm::vec3 N(batch.N[0][i], batch.N[1][i], batch.N[2][i]);
            const glm::vec3 facing = glm::dot(N, seen->V[i].vec()) < 0.0f ? -N : N;
            for (int c = 0; c < 3; ++c) {
                seen->N[c][i] = facing[c];
                seen->L[c][i] = L[c];
                seen->Cl[c][i] = 1.0f;
                seen->E[c][i] = std::max(0.0f, glm::dot(facing, L));
            }
        }
        seen->A = glm::vec3(0.2f);
        m_measured.push_back({"shader/" + name + "/view", "ns", "",
                              "a sample, view(): one light, then diffuse and ambient, one thread",
                              [shader, planes, seen, size = batch.size,
                               Ci = std::vector<float>(3 * batch_capacity)](std::size_t) mutable {
                                  for (const bool lit : {true, false}) {
                                      shader->view(planes.data(), *seen, 0, size, lit, Ci.data());
                                      benchmark::DoNotOptimize(Ci.data());
                                  }
                              }});
    }

    Rows& m_rows;
    std::vector<SurfaceBatch> m_batches;
    std::vector<Measured> m_measured;
};

/// Keeps every repetition's time a point.
class Repetitions : public benchmark::BenchmarkReporter {
public:
    bool ReportContext(const Context&) override { return true; }
    void ReportRuns(const std::vector<Run>& runs) override {
        for (const Run& run : runs) {
            if (run.run_type != Run::RT_Iteration) continue;
            const double seconds = run.cpu_accumulated_time / double(run.iterations);
            ns[run.run_name.function_name].push_back(1e9 * seconds / SurfaceBatch::capacity);
        }
    }
    std::map<std::string, std::vector<double>> ns;
};

void measure(const Plan& plan, Rows& rows) {
    std::string arguments[]{"estara-bench", "--benchmark_enable_random_interleaving=true"};
    char* argv[]{arguments[0].data(), arguments[1].data()};
    int argc = 2;
    benchmark::Initialize(&argc, argv);
    for (const Measured& one : plan.measured()) {
        const auto loop = [work = one.work](benchmark::State& state) mutable {
            std::size_t batch = 0;
            for (auto _ : state) {
                work(batch++);
                benchmark::ClobberMemory();
            }
        };
        benchmark::RegisterBenchmark(one.name.c_str(), loop)->MinTime(0.02)->Repetitions(9);
    }
    Repetitions repetitions;
    benchmark::RunSpecifiedBenchmarks(&repetitions);
    for (const Measured& one : plan.measured()) {
        rows.add({one.name, spread(repetitions.ns.at(one.name)), one.unit, one.error, one.what});
    }
}

}  // namespace

void shaders(Bench& bench) {
    Plan plan(bench.rows);
    plan.add_block<Noise3d>();
    plan.add_block<Voronoi27>();
    plan.add_block<Spline>();
    plan.add_block<Power>();
    for (const ShaderInfo& info : all_shaders()) plan.add_shader(info);
    measure(plan, bench.rows);
}

}  // namespace estara::bench
