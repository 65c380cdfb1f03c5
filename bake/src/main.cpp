// estara-bake: a procedural shader, a scene, and a .vdb file of what the shader paints.
#include <cstdio>

#include "estara/bake/run.h"
#include "estara/scenes/program.h"

int main(int argc, char** argv) {
    return estara::run_program("estara-bake", [&] {
        std::string help;
        const estara::bake::Options options = estara::bake::parse_options(argc, argv, help);
        if (!help.empty()) {
            std::fputs(help.c_str(), stdout);
            return;
        }
        const auto result = [](const std::string& text) { std::puts(text.c_str()); };
        const auto message = [](const std::string& text) {
            std::fprintf(stderr, "%s\n", estara::message_line("estara-bake", text).c_str());
        };
        estara::bake::run(options, {result, message});
    });
}
