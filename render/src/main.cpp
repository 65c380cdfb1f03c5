// estara-render: renders an animation whose shaders are baked, or evaluated directly.
#include <cstdio>

#include "estara/render/run.h"
#include "estara/scenes/program.h"

namespace {

void say(const std::string& message) {
    std::fprintf(stderr, "%s\n", estara::message_line("estara-render", message).c_str());
}

void print(const std::string& text) { std::fputs(text.c_str(), stdout); }

}  // namespace

int main(int argc, char** argv) {
    return estara::run_program("estara-render", [&] {
        std::string help;
        const estara::Options options = estara::parse_options(argc, argv, help);
        if (!help.empty()) return print(help);
        const estara::RunRecord record = estara::run(options, say);
        print(estara::comparison_text(record));
        print(estara::result_line(record) + "\n");
    });
}
