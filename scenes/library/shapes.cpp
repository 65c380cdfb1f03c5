#include "shapes.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace estara::examples {

namespace {

constexpr double pi = std::numbers::pi;
constexpr double step = 1e-5;  // of u and v, for slopes

using Surface = std::function<glm::dvec3(double, double)>;

/// Centre of the interval over which a slope is taken: kept off the ends where a surface stops,
/// because at a pole dP/du is 0.
double slope_centre(double x, bool closed) {
    return closed ? x : std::clamp(x, 2.0 * step, 1.0 - 2.0 * step);
}

glm::dvec3 normal(const Surface& at, double u, double v, Closed closed) {
    u = slope_centre(u, closed.u);
    v = slope_centre(v, closed.v);
    const glm::dvec3 du = at(u + step, v) - at(u - step, v);
    const glm::dvec3 dv = at(u, v + step) - at(u, v - step);
    return glm::normalize(glm::cross(dv, du));
}

/// Adds a triangle unless two of its corners lie in one place, as at a pole.
void add_triangle(Mesh& mesh, std::uint32_t a, std::uint32_t b, std::uint32_t c) {
    const glm::vec3 &A = mesh.P[a], &B = mesh.P[b], &C = mesh.P[c];
    if (A != B && B != C && C != A) mesh.triangles.emplace_back(a, b, c);
}

/// Two triangles for each quad of a grid of vertices that starts at `first`; rows of cells.u + 1.
void add_grid(Mesh& mesh, std::uint32_t first, Cells cells) {
    const auto columns = std::uint32_t(cells.u) + 1;
    for (std::uint32_t j = 0; j < std::uint32_t(cells.v); ++j)
        for (std::uint32_t i = 0; i < std::uint32_t(cells.u); ++i) {
            const std::uint32_t a = first + j * columns + i, d = a + columns;
            add_triangle(mesh, a, d, d + 1);
            add_triangle(mesh, a, d + 1, a + 1);
        }
}

/// A uniform cubic B-spline through its first and last point. Runs evenly by length and by turning,
/// half each: so a narrow lip gets as many vertices as it needs to look round.
class Profile {
public:
    explicit Profile(std::span<const glm::dvec2> points) {
        m_points.assign(2, points.front());
        m_points.insert(m_points.end(), points.begin(), points.end());
        m_points.insert(m_points.end(), 2, points.back());
        std::vector<double> lengths{0.0}, turns{0.0};
        glm::dvec2 before(0.0);
        for (int i = 1; i <= spans() * samples_per_span; ++i) {
            const glm::dvec2 chord = at_parameter(parameter(i)) - at_parameter(parameter(i - 1));
            lengths.push_back(lengths.back() + glm::length(chord));
            turns.push_back(turns.back() + angle_between(before, chord));
            before = chord;
        }
        const double turn = std::max(turns.back(), 1e-9);  // 0 for a straight profile
        for (std::size_t i = 0; i < lengths.size(); ++i)
            m_passed.push_back(lengths[i] / lengths.back() + turns[i] / turn);
    }

    /// @param v  how much of the curve has passed; beyond [0, 1] the ends
    glm::dvec2 at(double v) const {
        const double wanted = std::clamp(v, 0.0, 1.0) * m_passed.back();
        const auto above = std::upper_bound(m_passed.begin(), m_passed.end() - 1, wanted);
        const auto i = std::max<std::ptrdiff_t>(above - m_passed.begin(), 1);
        const double span = m_passed[i] - m_passed[i - 1];
        const double part = span > 0.0 ? (wanted - m_passed[i - 1]) / span : 0.0;
        return at_parameter(parameter(double(i - 1) + std::clamp(part, 0.0, 1.0)));
    }

private:
    static constexpr int samples_per_span = 64;

    int spans() const { return int(m_points.size()) - 3; }
    static double parameter(double sample) { return sample / samples_per_span; }
    static double angle_between(const glm::dvec2& a, const glm::dvec2& b) {
        return std::abs(std::atan2(a.x * b.y - a.y * b.x, glm::dot(a, b)));
    }

    glm::dvec2 at_parameter(double x) const {
        const int i = std::clamp(int(x), 0, spans() - 1);
        const double t = x - i, s = 1.0 - t;
        const double a = s * s * s / 6.0, d = t * t * t / 6.0;
        const double b = (3.0 * t * t * t - 6.0 * t * t + 4.0) / 6.0;
        const double c = 1.0 - a - b - d;
        return a * m_points[i] + b * m_points[i + 1] + c * m_points[i + 2] + d * m_points[i + 3];
    }

    std::vector<glm::dvec2> m_points;
    std::vector<double> m_passed;  ///< up to each sample
};

/// Point of the unit sphere: u around the y axis, v from the lower pole to the upper one.
glm::dvec3 direction(double u, double v) {
    const double around = 2.0 * pi * u, up = pi * (v - 0.5);
    return {std::cos(up) * std::cos(around), std::sin(up), std::cos(up) * std::sin(around)};
}

/// Coordinates of the vertices along an edge of a rounded box: dense in the bends.
std::vector<double> edge_points(double half, double radius, int flat, int bend) {
    std::vector<double> points;
    const double core = half - radius;
    points.push_back(-half);
    for (int i = 1; i < bend; ++i)  // equal angles, from 45 degrees to 0
        points.push_back(-core - radius * std::tan(pi / 4.0 * (bend - i) / bend));
    for (int i = 0; i <= flat; ++i) points.push_back(core * (2.0 * i / flat - 1.0));
    for (int i = bend - 1; i >= 0; --i) points.push_back(-points[i]);
    return points;
}

}  // namespace

Mesh tessellate(const Surface& at, Cells cells, Closed closed) {
    Mesh mesh;
    for (int j = 0; j <= cells.v; ++j)
        for (int i = 0; i <= cells.u; ++i) {
            // The far side of a seam is computed as the near side is.
            const double u = double(closed.u ? i % cells.u : i) / cells.u;
            const double v = double(closed.v ? j % cells.v : j) / cells.v;
            mesh.P.emplace_back(at(u, v));
            mesh.N.emplace_back(normal(at, u, v, closed));
            mesh.uv.emplace_back(float(i) / float(cells.u), float(j) / float(cells.v));
        }
    add_grid(mesh, 0, cells);
    return mesh;
}

Mesh lathe(std::span<const glm::dvec2> points, Cells cells) {
    const Profile profile(points);
    const auto at = [&](double u, double v) {
        const glm::dvec2 p = profile.at(v);
        const double around = 2.0 * pi * u;
        return glm::dvec3(p.x * std::cos(around), p.y, p.x * std::sin(around));
    };
    return tessellate(at, cells, {.u = true, .v = false});
}

Mesh sphere(double radius, Cells cells) {
    // Rounded to the poles themselves: cos(pi / 2) is not 0 in binary.
    const auto at = [&](double u, double v) {
        if (v <= 0.0 || v >= 1.0) return glm::dvec3(0.0, v <= 0.0 ? -radius : radius, 0.0);
        return radius * direction(u, v);
    };
    return tessellate(at, cells, {.u = true, .v = false});
}

Mesh torus(double ring, double tube, Cells cells) {
    const auto at = [&](double u, double v) {
        const double around = 2.0 * pi * u, through = 2.0 * pi * v;
        const double r = ring + tube * std::cos(through);
        return glm::dvec3(r * std::cos(around), tube * std::sin(through), r * std::sin(around));
    };
    return tessellate(at, cells, {.u = true, .v = true});
}

Mesh torus_knot(int p, int q, double ring, double winding, double tube, Cells cells) {
    const auto at = [&](double u, double v) {
        const double around = 2.0 * pi * p * u, through = 2.0 * pi * q * u;
        const glm::dvec3 out(std::cos(around), 0.0, std::sin(around));
        const glm::dvec3 forward(-out.z, 0.0, out.x), up(0.0, 1.0, 0.0);
        const double r = ring + winding * std::cos(through);
        // The torus's own normal stays across the curve, so the frame closes without twist.
        const glm::dvec3 n = std::cos(through) * out + std::sin(through) * up;
        const glm::dvec3 turned = std::cos(through) * up - std::sin(through) * out;
        const glm::dvec3 tangent =
            glm::normalize(double(p) * r * forward + double(q) * winding * turned);
        const glm::dvec3 b = glm::cross(tangent, n);
        const double side = 2.0 * pi * v;
        return r * out + winding * std::sin(through) * up +
               tube * (std::cos(side) * n + std::sin(side) * b);
    };
    return tessellate(at, cells, {.u = true, .v = true});
}

Mesh superellipsoid(const glm::dvec3& radii, double side_squareness, double top_squareness,
                    Cells cells) {
    const double side = 2.0 / side_squareness, top = 2.0 / top_squareness;
    const auto at = [&](double u, double v) {
        if (v <= 0.0 || v >= 1.0) return glm::dvec3(0.0, v <= 0.0 ? -radii.y : radii.y, 0.0);
        const glm::dvec3 d = direction(u, v), a = glm::abs(d) / radii;
        const double across = std::pow(std::pow(a.x, top) + std::pow(a.z, top), 1.0 / top);
        return d / std::pow(std::pow(across, side) + std::pow(a.y, side), 1.0 / side);
    };
    return tessellate(at, cells, {.u = true, .v = false});
}

Mesh rounded_box(const glm::dvec3& half_size, double radius, int flat, int bend) {
    Mesh mesh;
    const glm::dvec3 core = half_size - radius;
    const std::array<std::vector<double>, 3> points{edge_points(half_size.x, radius, flat, bend),
                                                    edge_points(half_size.y, radius, flat, bend),
                                                    edge_points(half_size.z, radius, flat, bend)};
    for (int face = 0; face < 6; ++face) {
        const int across = face % 3, sign = face < 3 ? 1 : -1;
        // add_grid() has its outside at dv x du: swapped for the three faces on the far side.
        const int iu = (across + (sign > 0 ? 2 : 1)) % 3, iv = 3 - across - iu;
        const Cells cells{int(points[iu].size()) - 1, int(points[iv].size()) - 1};
        const auto first = std::uint32_t(mesh.P.size());
        for (int j = 0; j <= cells.v; ++j)
            for (int i = 0; i <= cells.u; ++i) {
                glm::dvec3 q;  // on the box with sharp edges
                q[across] = sign * half_size[across];
                q[iu] = points[iu][i];
                q[iv] = points[iv][j];
                const glm::dvec3 nearest = glm::clamp(q, -core, core);
                const glm::dvec3 n = glm::normalize(q - nearest);
                mesh.P.emplace_back(nearest + radius * n);
                mesh.N.emplace_back(n);
                mesh.uv.emplace_back(float(i) / float(cells.u), float(j) / float(cells.v));
            }
        add_grid(mesh, first, cells);
    }
    return mesh;
}

Mesh rolling_ground(double size, double height, double wavelength, Cells cells) {
    const double k = 2.0 * pi / wavelength;
    const auto at = [&](double u, double v) {
        const double x = size * (u - 0.5), z = size * (v - 0.5);
        // Two waves that do not share a direction or a length: hills without a lattice.
        const double y = 0.6 * std::sin(k * (0.8 * x + 0.6 * z)) * std::cos(0.7 * k * z) +
                         0.4 * std::sin(0.61 * k * (x - 0.9 * z) + 1.0);
        return glm::dvec3(x, height * y, z);
    };
    return tessellate(at, cells, {.u = false, .v = false});
}

Mesh scaled(Mesh mesh, float factor) {
    for (glm::vec3& p : mesh.P) p *= factor;
    return mesh;
}

Mesh planar_tube(const std::function<glm::dvec2(double)>& curve,
                 const std::function<double(double)>& radius, Cells cells) {
    const auto at = [&](double u, double v) {
        const glm::dvec2 ahead = glm::normalize(curve(v + step) - curve(v - step));
        const glm::dvec3 n(ahead.y, -ahead.x, 0.0);
        const double around = 2.0 * pi * u;
        return glm::dvec3(curve(v), 0.0) +
               radius(v) * (std::cos(around) * n + glm::dvec3(0.0, 0.0, std::sin(around)));
    };
    return tessellate(at, cells, {.u = true, .v = false});
}

Mesh moved(Mesh mesh, const glm::vec3& by, const glm::quat& rotation) {
    for (glm::vec3& p : mesh.P) p = rotation * p + by;
    for (glm::vec3& n : mesh.N) n = glm::normalize(rotation * n);
    return mesh;
}

Mesh joined(std::span<const Mesh> parts) {
    Mesh all;
    for (const Mesh& part : parts) {
        const auto first = glm::uint(all.P.size());
        all.P.insert(all.P.end(), part.P.begin(), part.P.end());
        all.N.insert(all.N.end(), part.N.begin(), part.N.end());
        all.uv.insert(all.uv.end(), part.uv.begin(), part.uv.end());
        for (const glm::uvec3& t : part.triangles) all.triangles.push_back(t + first);
    }
    return all;
}

Mesh with_metric_uv(Mesh mesh) {
    for (const glm::uvec3& t : mesh.triangles) {
        const glm::vec3 n = glm::cross(mesh.P[t.y] - mesh.P[t.x], mesh.P[t.z] - mesh.P[t.x]);
        const glm::vec3 size = glm::abs(n);
        for (int c = 0; c < 3; ++c) {
            const glm::vec3& p = mesh.P[t[c]];
            if (size.y >= size.x && size.y >= size.z)
                mesh.uv[t[c]] = {p.x, n.y > 0.0f ? -p.z : p.z};
            else if (size.x >= size.z)
                mesh.uv[t[c]] = {n.x > 0.0f ? -p.z : p.z, p.y};
            else
                mesh.uv[t[c]] = {n.z > 0.0f ? p.x : -p.x, p.y};
        }
    }
    return mesh;
}

}  // namespace estara::examples
