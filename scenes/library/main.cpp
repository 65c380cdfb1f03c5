// estara-scenes: writes the example scenes.
#include <CLI/CLI.hpp>
#include <cstdio>
#include <string>

#include "all.h"
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
    CLI::App app{"Writes an example scene as glTF, ready for estara-bake and estara-render."};
    app.add_option("SCENE", options.scene, "which scene; --list names them");
    app.add_option("-o,--output", options.output, "file to write")->type_name("FILE.glb");
    app.add_flag("--list", options.list, "name the scenes there are");
    app.set_version_flag("--version", estara::version);
    app.footer("Example:\n  estara-scenes still-life -o still-life.glb");
    try {
        app.parse(argc, argv);
    } catch (const CLI::Success& asked_for_help) {
        app.exit(asked_for_help);
        return;
    } catch (const CLI::ParseError& e) {
        throw Error(std::string(e.what()) + "; estara-scenes --help lists the options");
    }
    const std::vector<Example> examples = estara::examples::all();
    if (options.list) return list(examples);
    write(examples, options);
}

}  // namespace

int main(int argc, char** argv) {
    return estara::run_program("estara-scenes", [&] { run(argc, argv); });
}
