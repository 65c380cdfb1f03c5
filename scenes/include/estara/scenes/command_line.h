// Reading a command line with CLI11, alike in every program. Apart from program.h because CLI11's
// headers are slow to compile.
#pragma once

#include <CLI/CLI.hpp>

#include <algorithm>
#include <string>
#include <string_view>
#include <vector>

#include "estara/scenes/error.h"
#include "estara/shaders/registry.h"

namespace estara {

/// Puts the name of an option before what is wrong with its value.
template <class F>
auto naming(const std::string& option, F value) {
    try {
        return value();
    } catch (const Error& error) {
        throw Error(option + ": " + error.what(), error.status());
    }
}

/// "no option --voxelsize (did you mean --voxel-size?)" for the first word an app does not know.
inline std::string unknown_word(const CLI::App& app) {
    const std::vector<std::string> words = app.remaining();
    const auto is_option = [](const std::string& word) { return word.starts_with("-"); };
    const auto found = std::find_if(words.begin(), words.end(), is_option);
    if (found == words.end())
        return words.empty() ? "" : "one word too many: '" + words.front() + "'";
    std::vector<std::string> names;
    for (const CLI::Option* option : app.get_options()) {
        for (const std::string& name : option->get_lnames()) names.push_back("--" + name);
    }
    const std::string word = found->substr(0, found->find('='));
    const std::vector<std::string_view> known(names.begin(), names.end());
    const std::string_view nearest = nearest_word(word, known);
    const std::string hint = nearest.empty() ? "" : " (did you mean " + std::string(nearest) + "?)";
    return "no option " + word + hint;
}

/// Parses the words of main(). Error, one line, for what the app does not know.
/// @return  what --help or --version asked to print; empty if the options hold what to do
inline std::string parse_command_line(CLI::App& app, int argc, const char* const* argv) {
    std::string problem;
    try {
        app.parse(argc, argv);
        return "";
    } catch (const CLI::CallForHelp&) {
        return app.help();
    } catch (const CLI::CallForVersion&) {
        return app.version() + "\n";
    } catch (const CLI::ExtrasError&) {
        problem = unknown_word(app);
    } catch (const CLI::ConversionError& error) {
        const std::string start = "Could not convert: ";  // then "--threads = many"
        problem = error.what();
        if (problem.starts_with(start))
            problem = problem.substr(start.size()) + ": not a number in its range";
    } catch (const CLI::ParseError& error) {
        problem = error.what();
    }
    std::replace(problem.begin(), problem.end(), '\n', ' ');
    throw Error(problem + "; --help lists the options");
}

}  // namespace estara
