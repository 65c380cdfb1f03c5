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

Record spatter(const Values& v, const SurfacePoint& x) {
    bool speck = false;
    for (int k = 0; k < int(v["sizes"]); ++k) {
        speck = speck || noise(dvec3(x.P) * std::exp2(-k) / v["specksize"], 3) > 0.7;
    }
    return record(v.color(speck ? "spattercolor" : "basecolor"));
}

Record carpet(const Values& v, const SurfacePoint& x) {
    const double w = x.filter_width, speckles = 100 / v["nap"];
    const double scuffed =
        std::min(1.0, 0.5 + turbulence(dvec3(x.P) * v["scuff"], w * v["scuff"], true));
    const double shade = noise(dvec3(x.P) * speckles, 3) < 0.5 ? 0.6 : 1.0;
    const double faded = smoothstep(0.2, 0.75, w * speckles);
    return record(v.color("Cs") * scuffed * ((1 - faded) * shade + faded * 0.8));
}

/// Hue in [0, 6), saturation and value of a colour, and back (Smith 1978).
dvec3 hsv_of(const dvec3& c) {
    const double high = std::max({c.x, c.y, c.z}), range = high - std::min({c.x, c.y, c.z});
    if (range == 0) return {0, 0, high};
    const double hue = high == c.x   ? mod((c.y - c.z) / range, 6)
                       : high == c.y ? 2 + (c.z - c.x) / range
                                     : 4 + (c.x - c.y) / range;
    return {hue, range / high, high};
}
dvec3 rgb_of(const dvec3& hsv) {
    const auto component = [&](double n) {
        const double k = mod(n + hsv.x, 6);
        return hsv.z * (1 - hsv.y * std::clamp(std::min(k, 4 - k), 0.0, 1.0));
    };
    return {component(5), component(3), component(1)};
}

Record cmarble(const Values& v, const SurfacePoint& x) {
    const double T = turbulence(dvec3(x.P) * v["veining"], x.filter_width * v["veining"], true);
    dvec3 hsv = hsv_of(v.color("Cs"));
    const double light = 0.8 + 0.2 * smoothstep(0.35, 0.6, T), far = smoothstep(0.08, 0.25, T);
    hsv.y *= 1 - smoothstep(0.03, 0.2, T);
    hsv.z = (1 - far) * hsv.z + far * light;
    return record(rgb_of(hsv));
}

Record colormarble(const Values& v, const SurfacePoint& x) {
    const double T = turbulence(dvec3(x.P) * v["txtscale"], x.filter_width * v["txtscale"], false);
    const dvec3 p = v.color("pale"), m = v.color("medium"), d = v.color("middark"),
                k = v.color("dark");
    const std::vector<dvec3> colors{p, p, m, m, m, p, p, d, d, k, k, p, k};
    dvec3 result(0.0);
    for (int c = 0; c < 3; ++c) {
        std::vector<double> knots;
        for (const dvec3& color : colors) knots.push_back(color[c]);
        result[c] = std::clamp(spline(4 * T - 3, knots), 0.0, 1.0);
    }
    return record(result);
}

dvec3 tangent(const SurfacePoint& x, const dvec3& N) {
    const dvec3 u = dvec3(x.dPdu);
    return glm::normalize(u - glm::dot(u, N) * N);
}

dvec3 bumped(const dvec3& N, const dvec3& gradient) {
    return glm::normalize(N - (gradient - glm::dot(gradient, N) * N));
}

/// What blocks knows about a point of its wall: solid in three dimensions, flat in two.
struct Wall {
    double inside;  ///< from the mortar's edge into the block, thicknesses of mortar
    double shade, pit, grain;
};
Wall wall(const Values& v, const dvec3& q, bool flat) {
    const double height = v["blockheight"], mortar = v["mortarthickness"];
    const double pitch[] = {v["blockwidth"] + mortar, height + mortar, v["blockwidth"] + mortar};
    dvec3 moved = q;
    for (int c = 0; c < 3; ++c) {
        moved[c] += v["jagged"] * height * snoise(q * 3.0 / height, 3, std::uint32_t(c + 1));
    }
    const double course = std::floor(moved.y / pitch[1]);
    if (mod(course, 2) == 1) moved += dvec3(pitch[0] / 2, 0, pitch[2] / 2);
    double distance = 1e300;
    dvec3 cell(0.0);
    for (int c = 0; c < (flat ? 2 : 3); ++c) {
        cell[c] = std::floor(moved[c] / pitch[c]);
        const double after = moved[c] - cell[c] * pitch[c];
        distance = std::min({distance, after, pitch[c] - after});
    }
    const double grain = snoise(q * 8.0 / height, 3, 4);
    return {distance / mortar - 0.5, 1 - v["blockvary"] * cellnoise(cell, 3),
            v["pitting"] * smoothstep(0.2, 0.45, grain), grain};
}

Record blocks(const Values& v, const SurfacePoint& x) {
    const bool flat = v["variant"] == 0;
    const dvec3 q = flat ? dvec3(x.uv.x, x.uv.y, 0) : dvec3(x.P);
    const Wall at = wall(v, q, flat);
    Record result = record(mix(v.color("mortarcolor") * (0.925 + 0.075 * at.grain),
                               v.color("blockcolor") * at.shade * (1 - at.pit / 2),
                               smoothstep(0, 0.25, at.inside)));
    if (v["bump"] == 0) return result;
    const auto relief = [&](const dvec3& p) {
        const Wall w = wall(v, p, flat);
        return v["bump"] * v["blockheight"] / 30 * smoothstep(0, 1, w.inside) * (1 - w.pit);
    };
    dvec3 slope = change(relief, q, 1e-7);
    if (flat) {
        const dvec3 u = tangent(x, x.N);
        slope = slope.x * u + slope.y * glm::cross(dvec3(x.N), u);
    }
    const dvec3 N = bumped(x.N, slope);
    result.insert(result.end(), {N.x, N.y, N.z});
    return result;
}

Record velvet(const Values& v, const SurfacePoint&) { return record(v.color("Cs")); }

Record skin(const Values& v, const SurfacePoint& x) {
    const auto pores = [&](const dvec3& p) {
        return v["poresdepth"] *
               std::pow(skin_turbulence(p * v["poresfreq"], v["maxfreq"]), v["poresthresh"]);
    };
    const dvec3 N = bumped(x.N, change(pores, dvec3(x.P), 1e-9));
    const double place =
        std::pow(skin_turbulence(dvec3(x.P) * v["blemishfreq"], v["maxfreq"]), v["blemishthresh"]);
    dvec3 color(0.0);
    for (int c = 0; c < 3; ++c) {
        std::vector<double> knots;
        for (const double e : {.05, .0, -.05, .05, -.05, .0, -.05, -.1, -.05, -.1, .05}) {
            knots.push_back(v.color("skincolor")[c] + e);
        }
        color[c] = std::clamp(spline(place, knots), 0.0, 1.0);
    }
    const dvec3 u = tangent(x, N);
    const double angle = glm::radians(v["angle"]);
    const dvec3 X = std::cos(angle) * u + std::sin(angle) * glm::cross(N, u);
    Record result;
    for (const dvec3& part : {color, X, glm::cross(N, X), N}) {
        result.insert(result.end(), {part.x, part.y, part.z});
    }
    return result;
}

}  // namespace

double skin_turbulence(const dvec3& q, double maxfreq) {
    double sum = 0;
    for (double f = 1; f < maxfreq; f *= 2) sum += std::abs(snoise(q * f, 3)) / f;
    return sum;
}

std::optional<std::vector<double>> bake(const BoundShader& shader, const SurfacePoint& x) {
    struct Row {
        std::string_view name;
        Record (*function)(const Values&, const SurfacePoint&);
    };
    constexpr std::array rows{Row{"wood", wood},
                              Row{"stone", stone},
                              Row{"cobblestone", cobblestone},
                              Row{"greenmarble", greenmarble},
                              Row{"spatter", spatter},
                              Row{"carpet", carpet},
                              Row{"cmarble", cmarble},
                              Row{"colormarble", colormarble},
                              Row{"blocks", blocks},
                              Row{"velvet", velvet},
                              Row{"RCSkin", skin},
                              Row{"plastic", plastic}};
    for (const Row& row : rows) {
        if (row.name == shader.info().name) return row.function(Values(shader), x);
    }
    return std::nullopt;
}

Fresnel fresnel(const dvec3& I, const dvec3& N, double eta) {
    const double c = -glm::dot(I, N), mu = 1 / eta, G2 = mu * mu - 1 + c * c;
    if (G2 < 0) return {1, dvec3(0.0)};
    const double G = std::sqrt(G2), rs = (c - G) / (c + G),
                 rp = (mu * mu * c - G) / (mu * mu * c + G);
    const double behind = std::sqrt(1 - eta * eta * (1 - c * c));
    return {(rs * rs + rp * rp) / 2, eta * I + (eta * c - behind) * N};
}

double henyey_greenstein(double cosine, double g) {
    return (1 - g * g) / std::pow(1 + g * g - 2 * g * cosine, 1.5);
}

double single_scatter(const dvec3& wi, const dvec3& wo, const dvec3& n, double g, double albedo,
                      double thickness) {
    const double i = std::abs(glm::dot(wi, n)), o = std::abs(glm::dot(wo, n));
    return albedo * henyey_greenstein(-glm::dot(wo, wi), g) / (i + o) *
           (1 - std::exp(-thickness * (1 / i + 1 / o)));
}

namespace {

/// A lit point: normal on the side of the eye, and its record.
struct Lit {
    const Sight& sight;
    const Record& baked;
    dvec3 N;
    dvec3 color() const { return {baked[0], baked[1], baked[2]}; }
    dvec3 E() const {
        dvec3 sum(0.0);
        for (const Light& l : sight.lights) {
            sum += dvec3(l.Cl) * std::max(0.0, glm::dot(N, dvec3(l.L)));
        }
        return sum;
    }
};

dvec3 half(const Light& light, const dvec3& V) { return glm::normalize(dvec3(light.L) + V); }

dvec3 closing(const Values& v, const Lit& lit, double Ks, const dvec3& specularcolor) {
    dvec3 sum = lit.color() * (v["Ka"] * lit.sight.A + v["Kd"] * lit.E());
    if (Ks == 0) return sum;
    for (const Light& light : lit.sight.lights) {
        const double cosine = std::max(0.0, glm::dot(lit.N, half(light, lit.sight.V)));
        sum += specularcolor * Ks * dvec3(light.Cl) * std::pow(cosine, 8 / v["roughness"]);
    }
    return sum;
}

dvec3 velvet_closing(const Values& v, const Lit& lit) {
    const double facing = std::max(0.0, glm::dot(lit.N, lit.sight.V));
    dvec3 sum = closing(v, lit, 0, {}) +
                v.color("sheen") * lit.E() * std::pow(1 - facing * facing, v["edginess"] / 2);
    for (const Light& light : lit.sight.lights) {
        const double cosine = std::max(0.0, glm::dot(dvec3(light.L), lit.sight.V));
        sum += v.color("sheen") * v["backscatter"] * dvec3(light.Cl) *
               std::pow(cosine, 1 / v["roughness"]);
    }
    return sum;
}

dvec3 skin_closing(const Values& v, const Lit& lit) {
    const dvec3 V = lit.sight.V, N = lit.N;
    const dvec3 X = dvec3(lit.baked[3], lit.baked[4], lit.baked[5]) / v["xrough"];
    const dvec3 Y = dvec3(lit.baked[6], lit.baked[7], lit.baked[8]) / v["yrough"];
    const Fresnel eye = fresnel(-V, N, 1 / v["eta"]);
    const double Kr = smoothstep(0, 0.5, eye.Kr), d = v["thickness"];
    dvec3 G(0.0), W(0.0);
    for (const Light& light : lit.sight.lights) {
        const dvec3 L = light.L, H = half(light, V);
        const double cosine = glm::dot(L, N);
        if (cosine <= 0) continue;
        const dvec3 k = dvec3(light.Cl) * cosine;
        if (glm::dot(H, N) > 0) G += Kr * v.color("sheenColor") * k * std::pow(glm::dot(H, N), 4);
        G += 0.2 * Kr * v.color("sheenColor") * k;
        const Fresnel in = fresnel(-L, N, 1 / v["eta"]);
        const double scattered = single_scatter(eye.T, in.T, N, 0.8, 0.8, d) +
                                 single_scatter(eye.T, in.T, N, 0.3, 0.5, d) +
                                 single_scatter(eye.T, in.T, N, 0.0, 0.4, d);
        G += lit.color() * k * (1 - Kr) * (1 - smoothstep(0, 0.5, in.Kr)) * scattered;
        const double x = glm::dot(X, H), y = glm::dot(Y, H);
        const double seen = std::clamp(glm::dot(N, V), 1e-4, 1.0);
        W += k * std::exp(-2 * (x * x + y * y) / (1 + glm::dot(H, N))) / std::sqrt(cosine * seen);
    }
    W /= 4 * v["xrough"] * v["yrough"];
    return mix(v.color("skincolor"), G, v["blemishopac"]) +
           (0.1 * v["oily"] * W + v["Kd"] * lit.E()) * v["brightness"];
}

}  // namespace

std::optional<dvec3> render(const BoundShader& shader, const SurfacePoint& x, const Sight& sight) {
    const std::optional<Record> baked = bake(shader, x);
    if (!baked) return std::nullopt;
    dvec3 N(x.N);
    if (shader.info().channels.back().kind == ChannelKind::normal) {
        const std::size_t n = baked->size();
        N = {(*baked)[n - 3], (*baked)[n - 2], (*baked)[n - 1]};
    }
    const Lit lit{sight, *baked, glm::dot(N, sight.V) < 0 ? -N : N};
    const Values v(shader);
    const std::string_view name = shader.info().name;
    const dvec3 white(1.0);
    if (name == "velvet") return velvet_closing(v, lit);
    if (name == "RCSkin") return skin_closing(v, lit);
    if (name == "carpet" || name == "blocks") return closing(v, lit, 0, white);
    if (name == "wood") return closing(v, lit, v["Ks"] * (*baked)[3], white);
    if (name == "stone" || name == "plastic") {
        return closing(v, lit, v["Ks"], v.color("specularcolor"));
    }
    return closing(v, lit, v["Ks"], white);
}

}  // namespace estara::reference
