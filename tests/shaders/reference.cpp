#include "reference.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string_view>

#include "estara/shaders/noise.h"  // detail::hash, and nothing else

namespace estara::reference {

using glm::dvec3;

double mod(double x, double b) { return x - b * std::floor(x / b); }
double step(double edge, double x) { return x < edge ? 0 : 1; }

double smoothstep(double a, double b, double x) {
    const double t = std::clamp((x - a) / (b - a), 0.0, 1.0);
    return 3 * t * t - 2 * t * t * t;
}

namespace {

int whole(double x) { return int(std::floor(std::clamp(x, -0x1p24, 0x1p24))); }

double unit(std::uint32_t h) { return double(h >> 8) / double(1 << 24); }

/// The gradients of Perlin 2002: a cube's edges, the last four of them for the second time.
constexpr int edges[16][3] = {
    {1, 1, 0}, {-1, 1, 0}, {1, -1, 0}, {-1, -1, 0}, {1, 0, 1}, {-1, 0, 1}, {1, 0, -1}, {-1, 0, -1},
    {0, 1, 1}, {0, -1, 1}, {0, 1, -1}, {0, -1, -1}, {1, 1, 0}, {0, -1, 1}, {-1, 1, 0}, {0, -1, -1}};
/// Eight directions of the plane.
constexpr int chess_knight[8][2] = {{1, 2}, {-1, 2}, {1, -2}, {-1, -2},
                                    {2, 1}, {2, -1}, {-2, 1}, {-2, -1}};

dvec3 gradient(std::uint32_t h, int dimensions) {
    if (dimensions == 1) return {(h & 8) ? -double(1 + h % 8) : double(1 + h % 8), 0, 0};
    if (dimensions == 2) return {chess_knight[h % 8][0], chess_knight[h % 8][1], 0};
    return {edges[h % 16][0], edges[h % 16][1], edges[h % 16][2]};
}

}  // namespace

double snoise(const dvec3& p, int dimensions, std::uint32_t seed) {
    constexpr double amplitude[] = {0, 0.188, 0.507, 0.936};
    double sum = 0;
    for (int corner = 0; corner < (1 << dimensions); ++corner) {
        int lattice[3] = {0, 0, 0};
        dvec3 offset(0.0);
        double weight = 1;
        for (int c = 0; c < dimensions; ++c) {
            const int bit = (corner >> c) & 1;
            lattice[c] = whole(p[c]) + bit;
            const double t = p[c] - std::floor(p[c]);
            const double fade = ((6 * t - 15) * t + 10) * t * t * t;
            offset[c] = t - bit;
            weight *= bit == 1 ? fade : 1 - fade;
        }
        const std::uint32_t h = detail::hash(lattice[0], lattice[1], lattice[2], seed);
        sum += weight * glm::dot(gradient(h, dimensions), offset);
    }
    return amplitude[dimensions] * sum;
}

double noise(const dvec3& p, int dimensions, std::uint32_t seed) {
    return (snoise(p, dimensions, seed) + 1) / 2;
}

dvec3 vnoise(const dvec3& p) { return {noise(p, 3, 1), noise(p, 3, 2), noise(p, 3, 3)}; }

double cellnoise(const dvec3& p, int dimensions, std::uint32_t seed) {
    return unit(detail::hash(whole(p.x), whole(p.y), dimensions == 3 ? whole(p.z) : 0, seed));
}

Voronoi voronoi(const dvec3& p, int dimensions, double jitter) {
    struct Feature {
        double distance;
        dvec3 cell;
    };
    std::vector<Feature> features;
    const int depth = dimensions == 3 ? 1 : 0;
    const int X = whole(p.x), Y = whole(p.y), Z = dimensions == 3 ? whole(p.z) : 0;
    for (int z = Z - depth; z <= Z + depth; ++z) {
        for (int y = Y - 1; y <= Y + 1; ++y) {
            for (int x = X - 1; x <= X + 1; ++x) {
                double square = 0;
                const int cell[3] = {x, y, z};
                for (int c = 0; c < dimensions; ++c) {
                    const double random = unit(detail::hash(x, y, z, std::uint32_t(c + 1)));
                    const double feature = cell[c] + 0.5 + jitter * (random - 0.5);
                    square += (feature - p[c]) * (feature - p[c]);
                }
                features.push_back({std::sqrt(square), dvec3(x, y, z)});
            }
        }
    }
    std::sort(features.begin(), features.end(),
              [](const Feature& a, const Feature& b) { return a.distance < b.distance; });
    return {features[0].distance, features[1].distance, features[0].cell};
}

namespace {

int whole_octaves(double w) { return std::max(0, int(std::ceil(std::log2(1 / (2 * w))))); }

}  // namespace

int turbulence_noises(double w) { return whole_octaves(w) + 1; }

double turbulence(const dvec3& q, double w, bool deviation) {
    const auto phi = [&](double frequency) {
        const double n = noise(q * frequency, 3);
        return deviation ? std::abs(n - 0.5) : n;
    };
    const int m = whole_octaves(w);
    double sum = 0;
    for (int k = 0; k < m; ++k) sum += std::exp2(-k) * phi(std::exp2(k));
    const double beta = std::clamp(std::exp2(-m) / w - 1, 0.0, 1.0);
    return sum + beta * std::exp2(-m) * phi(std::exp2(m));
}

double spline(double x, const std::vector<double>& k) {
    const std::size_t n = k.size();
    if (x <= 0) return k[1];
    if (x >= 1) return k[n - 2];
    const double z = x * double(n - 3), t = z - std::floor(z);
    const auto i = std::size_t(std::floor(z));
    const double a = k[i], b = k[i + 1], c = k[i + 2], d = k[i + 3];
    return b + t / 2 * (c - a) + t * t / 2 * (2 * a - 5 * b + 4 * c - d) +
           t * t * t / 2 * (-a + 3 * b - 3 * c + d);
}

Marble marble(const dvec3& P, double w, double veinfreq, double sharpness) {
    dvec3 offset(35.2, -21.9, 6.25);
    for (int k = 0; k < 6; ++k) offset += std::exp2(-k) * (vnoise(std::exp2(k) * P) - 0.5);
    const dvec3 warped = (P + offset) * veinfreq;
    double veins = 0;
    for (int k = 0; k < 3; ++k) {
        const double ridge = 1 - std::abs(snoise(std::exp2(k) * warped, 3));
        veins += (1 - veins) * std::exp2(-k) * std::pow(smoothstep(0.8, 1, ridge), sharpness);
    }
    return {smoothstep(0.1, 0.35, turbulence(P, w, true)), veins,
            smoothstep(-0.1, 0.05, snoise(2.0 * (warped + dvec3(-4.4, 8.34, 27.1)), 3))};
}

namespace {

/// The parameters of a shader by name.
class Values {
public:
    explicit Values(const BoundShader& shader) : m_info(shader.info()), m_values(shader.values()) {}
    dvec3 color(std::string_view name) const {
        const auto at = std::find_if(m_info.params.begin(), m_info.params.end(),
                                     [&](const ParamInfo& p) { return p.name == name; });
        return m_values.at(std::size_t(at - m_info.params.begin()));
    }
    double operator[](std::string_view name) const { return color(name).x; }

private:
    const ShaderInfo& m_info;
    std::vector<glm::vec3> m_values;
};

using Record = std::vector<double>;

Record record(const dvec3& color) { return {color.x, color.y, color.z}; }

dvec3 mix(const dvec3& a, const dvec3& b, double t) { return (1 - t) * a + t * b; }

Record plastic(const Values& v, const SurfacePoint&) { return record(v.color("Cs")); }

Record stone(const Values& v, const SurfacePoint& x) {
    const double t = noise(dvec3(x.P) / v["scale"], 3), n = v["nshades"];
    const double shade = std::round(n * std::pow(t, v["exponent"])) / n;
    return record(mix(v.color("graincolor"), v.color("Cs"), shade));
}

Record wood(const Values& v, const SurfacePoint& x) {
    const dvec3 q = dvec3(x.P) + vnoise(dvec3(x.P));
    double rho = v["ringscale"] * std::hypot(q.y, q.z);
    rho += noise(dvec3(rho, 0, 0), 1);
    const double phase = rho - std::floor(rho);
    const double r = smoothstep(0, 0.8, phase) - smoothstep(0.83, 1, phase);
    Record result = record(mix(v.color("lightwood"), v.color("darkwood"), r));
    result.push_back(0.3 * r + 0.7);
    return result;
}

Record cobblestone(const Values& v, const SurfacePoint& x) {
    const int dimensions = v["variant"] == 1 ? 3 : 2;
    const dvec3 p = dimensions == 3 ? dvec3(x.P) * v["txtscale"]
                                    : dvec3(v["sscale"] * x.uv.x, v["tscale"] * x.uv.y, 0);
    const Voronoi f = voronoi(p, dimensions, v["jitter"]);
    const double shade = cellnoise(f.cell + dvec3(-67, 55, 0), dimensions) + 1.5;
    return record(mix(v.color("selfCol") / 2.0, shade / 2 * v.color("varCol"),
                      smoothstep(0.03, 0.07, f.f2 - f.f1)));
}

Record greenmarble(const Values& v, const SurfacePoint& x) {
    const Marble m = marble(x.P, x.filter_width, v["veinfreq"], v["sharpness"]);
    const dvec3 substrate = mix(v.color("darkcolor"), v.color("lightcolor"), m.substrate);
    return record(mix(substrate, v.color("veincolor"), m.veins * m.mask));
}

}  // namespace

std::optional<std::vector<double>> bake(const BoundShader& shader, const SurfacePoint& x) {
    struct Row {
        std::string_view name;
        Record (*function)(const Values&, const SurfacePoint&);
    };
    constexpr std::array rows{Row{"wood", wood}, Row{"stone", stone},
                              Row{"cobblestone", cobblestone}, Row{"greenmarble", greenmarble},
                              Row{"plastic", plastic}};
    for (const Row& row : rows) {
        if (row.name == shader.info().name) return row.function(Values(shader), x);
    }
    return std::nullopt;
}

}  // namespace estara::reference
