// estara-bake: a procedural shader, a scene, and a .vdb file of what the shader paints.
#include <cstdio>
#include <set>

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
        const bool asked = options.dry_run || options.list_shaders || !options.describe.empty();
        const auto result = [&](const std::string& text) {
            if (!options.quiet || asked) std::puts(text.c_str());
        };
        std::set<std::string> said;  // the same warning once
        const auto message = [&](const std::string& text) {
            if (options.quiet || !said.insert(text).second) return;
            std::fprintf(stderr, "%s\n", estara::message_line("estara-bake", text).c_str());
        };
        estara::bake::run(options, {result, message});
    });
}
