// estara-render: renders an animation whose shaders are baked, or evaluated directly.
#include <cstdio>
#include <set>
#include <string>

#include "estara/render/run.h"
#include "estara/scenes/program.h"

namespace {

/// The same warning once.
void say(const std::string& message) {
    static std::set<std::string> said;
    if (!said.insert(message).second) return;
    std::fprintf(stderr, "%s\n", estara::message_line("estara-render", message).c_str());
}

void print(const std::string& text) { std::fputs(text.c_str(), stdout); }

}  // namespace

int main(int argc, char** argv) {
    return estara::run_program("estara-render", [&] {
        std::string help;
        const estara::Options options = estara::parse_options(argc, argv, help);
        if (!help.empty()) return print(help);
        const estara::Say quiet = [](const std::string&) {};
        const estara::RunRecord record = estara::run(options, options.quiet ? quiet : say);
        if (options.quiet) return;
        print(estara::comparison_text(record));
        print(estara::result_line(record) + "\n");
    });
}
