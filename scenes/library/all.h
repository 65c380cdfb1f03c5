// The example scenes. To add one: write its file, add its name to the list.
#pragma once

#include <string_view>
#include <vector>

#include "glb.h"

#define ESTARA_EXAMPLES(scene)                                                          \
    scene(still_life) scene(tumble) scene(bend) scene(simple) scene(face) scene(face_b) \
        scene(interior)

namespace estara::examples {

struct Example {
    std::string_view name;  ///< on the command line
    std::string_view summary;
    void (*build)(GlbBuilder& out);
};

#define ESTARA_DECLARE(scene) extern const Example scene;
ESTARA_EXAMPLES(ESTARA_DECLARE)
#undef ESTARA_DECLARE

inline std::vector<Example> all() {
#define ESTARA_NAME(scene) scene,
    return {ESTARA_EXAMPLES(ESTARA_NAME)};
#undef ESTARA_NAME
}

}  // namespace estara::examples
