// All shaders. To add one: write its header in this folder, include it and add its name below.
#pragma once

#include <tuple>

#include "cobblestone.h"
#include "greenmarble.h"
#include "plastic.h"
#include "stone.h"
#include "wood.h"

namespace estara {

using AllShaders = std::tuple<Wood, Stone, Cobblestone, Greenmarble, Plastic>;

}  // namespace estara
