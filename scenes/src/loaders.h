// What the readers of the formats share. Private to this folder.
#pragma once

#include <string>
#include <vector>

#include "estara/scenes/error.h"
#include "estara/scenes/scene.h"

namespace estara {

/// The readers. Objects come with names and choices; load_scene() binds the shaders and adds a
/// camera and lights where there are none. Messages of their Errors begin with the path.
Scene read_gltf(const std::string& path, bool allow_outside);
std::vector<Object> read_obj(const std::string& path, std::vector<std::string>& warnings);
Mesh read_ply(const std::string& path, std::vector<std::string>& warnings);

/// The shader a material's name means: "wood", or "wood.001" as Blender numbers its copies; or "".
std::string shader_named(const std::string& material);
/// The shader that it would mean if small and capital letters were alike, or "".
std::string shader_almost_named(const std::string& material);
/// The warning of a material that is almost named so.
std::string almost_named(const std::string& where, const std::string& shader);

/// Contents of a file. Error if it cannot be read.
std::string read_file(const std::string& path);

/// Text of somebody else's in one line of so many bytes at most, without control characters.
std::string one_line(const std::string& text, std::size_t longest = 300);
/// Bytes that a name of somebody else's may take in a message.
inline constexpr std::size_t longest_name = 100;

/// Normals of the vertices: mean of the triangles around, weighted by their angle there
/// (Thürmer & Wüthrich 1998, "Computing Vertex Normals from Polygonal Facets"). Unit length;
/// (0, 0, 1) where no triangle says.
std::vector<glm::vec3> smooth_normals(const std::vector<glm::vec3>& P,
                                      const std::vector<glm::uvec3>& triangles);

/// Makes given normals unit; those without a direction (zero) become smooth ones.
void mend_normals(Mesh& mesh);

/// Adds a camera that goes round the scene in frames 1 to 48 at 24 a second, with all of it in
/// view, square or wide.
void add_orbit_camera(Scene& scene);

/// Adds a key and a fill light that expose a mid-grey object well.
void add_studio_lights(Scene& scene);

/// Ambient light that goes with the studio lights.
inline constexpr float studio_ambient = 0.1f;

}  // namespace estara
