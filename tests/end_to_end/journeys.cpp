#include "journeys.h"

namespace estara::test {

std::vector<Journey> journeys() {
    return {
        {"StillLife",
         "still-life",
         {"wood", "stone", "greenmarble", "cobblestone"},
         "1-48x20",
         true},
        {"Tumble", "tumble", {"wood"}, "1-48x20", true},
        // The scan is 0.15 units large, the others 1 to 2.
        {"ScanOfGreenmarble", "scan.obj", {"greenmarble --param veinfreq=20"}, "1-2"},
        {"ScanOfWood", "scan.obj", {"wood --param ringscale=100"}, "1-2"},
        {"StripsOfStone", "strips.ply", {"stone --param scale=0.1"}, "1-2"},
        {"StripsOfSolidCobbles", "strips.ply", {"cobblestone --param txtscale=4"}, "1-2"},
        {"SpotOfCobblesOnUv", "spot.obj", {"cobblestone"}, "1-2"},
        {"SpotOfWood", "spot.obj", {"wood"}, "1-2"},
    };
}

}  // namespace estara::test
