// The surfaces that are baked and looked at.
#pragma once

#include <string>

#include "estara/scenes/mesh.h"
#include "estara/scenes/scene.h"
#include "estara/shaders/registry.h"

namespace estara::bench {

/// A closed sphere of radius 1 with bumps of a tenth, flat triangles.
/// @param triangles  about how many, >= 100
Mesh bumpy_sphere(double triangles);

/// What all groups bake: the bunny of the models folder, or bumpy_sphere() where there is none.
const Mesh& surface();
const std::string& surface_name();

/// The voxel size with which a bake has about so many active voxels.
double voxel_size_for(const Mesh& mesh, const BoundShader& shader, double voxels);

/// A scene of one object at the origin that wears the shader; a light, no camera.
Scene scene_of(Mesh mesh, const BoundShaderPtr& shader);

/// Binary PLY of positions and triangles. Error (failed) if it cannot be written.
void write_ply(const std::string& path, const Mesh& mesh);

/// A shader at its defaults, for a mesh without texture coordinates.
BoundShaderPtr bound(const std::string& name, InstructionSet limit = InstructionSet::avx512);

}  // namespace estara::bench
