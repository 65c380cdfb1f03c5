// estara-scenes: writes the example scenes.
#include <cstdio>
#include <string>

#include "all.h"
#include "estara/scenes/command_line.h"
#include "estara/scenes/program.h"

namespace {

using estara::Error;
using estara::examples::Example;

struct Options {
    std::string scene, output;
    bool list = false;
};

const Example& find_example(const std::vector<Example>& examples, const std::string& name) {
    std::string known;
    for (const Example& example : examples) {
        if (example.name == name) return example;
        known += (known.empty() ? "" : ", ") + std::string(example.name);
    }
    throw Error("no scene '" + name + "'; there are: " + known);
}

void list(const std::vector<Example>& examples) {
    for (const Example& example : examples)
        std::printf("%-12s %s\n", std::string(example.name).c_str(),
                    std::string(example.summary).c_str());
}

void write(const std::vector<Example>& examples, const Options& options) {
    if (options.scene.empty())
        throw Error("no scene named; estara-scenes --list says which there are");
    const Example& example = find_example(examples, options.scene);
    if (options.output.empty()) throw Error("no file named; say where to write with -o FILE.glb");
    if (!options.output.ends_with(".glb"))
        throw Error(options.output + ": scenes are written as .glb; give the name that ending");
    estara::examples::GlbBuilder builder;
    example.build(builder);
    builder.write(options.output);
}

void run(int argc, char** argv) {
    Options options;
    CLI::App app{"Writes an example scene as glTF, ready for estara-bake and estara-render.",
                 "estara-scenes"};
    app.add_option("SCENE", options.scene, "which scene; --list names them");
    app.add_option("-o,--output", options.output, "file to write")->type_name("FILE.glb");
    app.add_flag("--list", options.list, "name the scenes there are");
    app.set_version_flag("--version", std::string("estara-scenes ") + estara::version);
    app.footer("Example:\n  estara-scenes still-life -o still-life.glb");
    const std::string help = estara::parse_command_line(app, argc, argv);
    if (!help.empty()) {
        std::fputs(help.c_str(), stdout);
        return;
    }
    const std::vector<Example> examples = estara::examples::all();
    if (options.list) return list(examples);
    write(examples, options);
}

}  // namespace

int main(int argc, char** argv) {
    return estara::run_program("estara-scenes", [&] { run(argc, argv); });
}
