// All shaders. To add one: write its header in this folder, include it and add its name below.
#pragma once

#include <tuple>

#include "blocks.h"
#include "carpet.h"
#include "cmarble.h"
#include "cobblestone.h"
#include "colormarble.h"
#include "greenmarble.h"
#include "plastic.h"
#include "rcskin.h"
#include "spatter.h"
#include "stone.h"
#include "velvet.h"
#include "wood.h"

namespace estara {

using AllShaders = std::tuple<Wood, Stone, Cobblestone, Greenmarble, Spatter, Carpet, Cmarble,
                              Colormarble, Blocks, Velvet, RCSkin, Plastic>;

}  // namespace estara
