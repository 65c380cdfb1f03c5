// Reading scenes: glTF 2.0 (.gltf, .glb), OBJ and PLY.
#pragma once

#include <string>

#include "estara/scenes/scene.h"

namespace estara {

/// Reads a scene by the ending of its name.
///
/// glTF: meshes (triangles, strips, fans; sparse and normalised accessors), nodes, instances,
/// perspective cameras, node animation (translation, rotation, scale; LINEAR, STEP, CUBICSPLINE),
/// KHR_lights_punctual. A material wears a shader by its extras, {"shader": "wood", "params":
/// {"ringscale": 12}}, or by its name if that is a shader's (also "wood.001"). The scene's extras
/// may hold "ambient": [r, g, b].
/// OBJ and PLY: one object; with a default orbiting camera (frames 1-48 at 24 a second) and lights.
/// A glTF scene without camera or light gets those too, and a line in Scene::warnings.
///
/// Errors name the file, the mesh or material, what is wrong and what to do: missing or truncated
/// file, NaN or infinite vertex, index out of range, no triangles, unknown shader or parameter,
/// required extension that is not supported.
///
/// @param allow_outside  whether files that a glTF names may lie outside of its folder
Scene load_scene(const std::string& path, bool allow_outside = false);

}  // namespace estara
