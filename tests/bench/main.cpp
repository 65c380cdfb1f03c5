// estara-bench: measures, prints a table and writes it as Markdown and JSON.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <filesystem>

#include "estara/scenes/program.h"
#include "rows.h"

namespace estara::bench {
namespace {

struct Group {
    const char* name;
    void (*run)(Bench&);
    bool only_if_named = false;
};
constexpr Group groups[]{{"lookup", bench::lookup},
                         {"shaders", bench::shaders},
                         {"frame", bench::frame},
                         {"bake", bench::bake},
                         {"load", bench::load},
                         {"large", bench::large, true},
                         {"renderers", bench::renderers, true}};

struct Options {
    std::vector<std::string> names;
    bool large = false;
    double large_voxels = 2e8;
    std::string folder = "build";
};

bool is_wanted(const Options& options, const Group& group) {
    const std::string name = group.name;
    if (name == "large" && options.large) return true;
    if (options.names.empty()) return !group.only_if_named;
    return std::find(options.names.begin(), options.names.end(), name) != options.names.end();
}

/// @return  whether everything was measured and all results agree
bool run(const Options& options) {
    Bench bench;
    bench.folder = std::filesystem::absolute(options.folder) / "bench";
    bench.large_voxels = options.large_voxels;
    std::filesystem::create_directories(bench.folder);
    for (const Group& group : groups) {
        if (!is_wanted(options, group)) continue;
        const Stopwatch watch;
        group.run(bench);
        fmt::print(stderr, "{}: {}\n", group.name, format_seconds(watch.seconds()));
    }
    const std::string table = bench.rows.markdown();
    write_text(options.folder + "/bench.json", bench.rows.json());
    write_text(options.folder + "/bench.md", table);
    fmt::print("{}", table);
    for (const std::string& fault : bench.rows.faults()) {
        fmt::print(stderr, "estara-bench: {}\n", fault);
    }
    return bench.rows.faults().empty();
}

int main_of(int argc, char** argv) {
    Options options;
    CLI::App app{"Measures estara, and writes bench.json and bench.md."};
    std::vector<std::string> names;
    for (const Group& group : groups) names.emplace_back(group.name);
    app.add_option("NAME", options.names, "groups to run; none: all but large and renderers")
        ->check(CLI::IsMember(names));
    app.add_flag("--large", options.large, "the group large too: minutes, and up to 20 GiB");
    app.add_option("--large-voxels", options.large_voxels, "voxels of the large bake")
        ->check(CLI::PositiveNumber)
        ->capture_default_str();
    app.add_option("--folder", options.folder, "where to write")->capture_default_str();
    try {
        app.parse(argc, argv);
    } catch (const CLI::ParseError& problem) {
        return app.exit(problem) == 0 ? 0 : int(ExitStatus::bad_input);
    }
    bool good = false;
    const int status = run_program("estara-bench", [&] { good = run(options); });
    return status == 0 && !good ? 1 : status;
}

}  // namespace
}  // namespace estara::bench

int main(int argc, char** argv) { return estara::bench::main_of(argc, argv); }
