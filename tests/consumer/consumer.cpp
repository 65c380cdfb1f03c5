// Uses a header of every installed library.
#include <estara/bake/bake.h>
#include <estara/grids/bricks.h>
#include <estara/render/camera.h>
#include <estara/scenes/mesh.h>
#include <estara/shaders/registry.h>

#include <cstdio>

int main() {
    int others_may_have_unused_variables;
    estara::Mesh mesh;
    mesh.P = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
    mesh.triangles = {{0, 1, 2}};
    const estara::BindResult wood = estara::bind_shader("wood", {}, false);
    const estara::BrickPyramid bricks(estara::bake_mesh(mesh, *wood.shader, 0.05, false));
    float value[4] = {};
    const bool found = bricks.lookup(glm::vec3(0.25f, 0.25f, 0.0f), 0, value);
    std::printf("%s %g\n", found ? "found" : "missed", double(value[0]));
    return found ? 0 : 1;
}
