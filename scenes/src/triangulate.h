// Polygons to triangles. Private to this folder.
#pragma once

#include <glm/glm.hpp>

#include <cstdint>
#include <span>
#include <vector>

namespace estara {

/// Cuts a polygon into triangles of the same orientation, without corners that repeat the one
/// before. A convex one becomes a fan around its first corner; others lose one ear after the other
/// (Meisters 1975, "Polygons Have Ears"), in double, on the plane of their Newell normal. What is
/// left of a polygon that crosses itself becomes triangles too.
/// @param corners  indices into P, in order around the polygon
/// @param out      triangles are appended
/// @return         whether there was any: a polygon of fewer than three different corners has none
bool triangulate(std::span<const std::uint32_t> corners, std::span<const glm::vec3> P,
                 std::vector<glm::uvec3>& out);

/// The same for corners that are numbered through, positions beside them.
/// @param places  position of each corner
/// @param out     indices into places
bool triangulate(std::span<const glm::dvec3> places, std::vector<glm::uvec3>& out);

}  // namespace estara
