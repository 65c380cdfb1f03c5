#include "../end_to_end/journeys.h"

namespace estara::test {

std::vector<Journey> journeys() {
    const std::string folder = ESTARA_REAL_MODELS;
    return {
        {"BunnyOfGreenmarble",
         folder + "/stanford-bunny.obj",
         {"greenmarble --param veinfreq=20"},
         "1-2"},
        {"BunnyOfWood", folder + "/stanford-bunny.obj", {"wood --param ringscale=100"}, "1-2"},
        {"IgeaOfStone", folder + "/igea.ply", {"stone --param scale=0.1"}, "1-2"},
        {"IgeaOfSolidCobbles", folder + "/igea.ply", {"cobblestone --param txtscale=4"}, "1-2"},
    };
}

}  // namespace estara::test
