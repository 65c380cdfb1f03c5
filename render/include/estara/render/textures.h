// Which baked grid belongs to which object.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "estara/grids/texture_grid.h"
#include "estara/scenes/scene.h"

namespace estara {

/// Takes a message for the user, without the program's name.
using Say = std::function<void(const std::string&)>;

struct LoadedGrid {
    std::string file;
    TextureGrid grid;
};

/// The grids of several files, in order; of a folder those of its .vdb files by name, and `say` is
/// told of those that are not ours. Errors as read_vdb().
std::vector<LoadedGrid> load_grids(const std::vector<std::string>& names, const Say& say);

struct GridMatch {
    std::vector<int> grid_of_object;        ///< index into the grids; -1: none that fits
    std::vector<int> irradiance_of_object;  ///< likewise, of baked light
    std::vector<bool> is_stale;  ///< by object: a grid was meant for it and does not fit any more
    std::vector<std::string> warnings;
};

/// Finds each grid's object, and says why if there is none.
///
/// A grid belongs to the objects with the mesh it was baked on; among those to the one with its
/// name, if any has it. Without such a mesh it is meant for the object with its name, or the only
/// object there is, but stale. It is stale too if the object's shader or a parameter is another one
/// than it was baked with. An object that wears no shader puts on the grid's, stale or not.
/// Of several grids that fit the last one wins.
///
/// Baked light belongs to the object with its mesh and its name, if it stands in the scene once,
/// nothing but cameras moves and no light, mesh or place has changed since.
GridMatch match_grids(Scene& scene, const std::vector<LoadedGrid>& grids);

}  // namespace estara
