// Reading a command line with CLI11, alike in every program. Apart from program.h because CLI11's
// headers are slow to compile.
#pragma once

#include <CLI/CLI.hpp>

#include <algorithm>
#include <string>

#include "estara/scenes/error.h"

namespace estara {

/// Parses the words of main(). Error, one line, for what the app does not know.
/// @return  what --help or --version asked to print; empty if the options hold what to do
inline std::string parse_command_line(CLI::App& app, int argc, const char* const* argv) {
    try {
        app.parse(argc, argv);
    } catch (const CLI::CallForHelp&) {
        return app.help();
    } catch (const CLI::CallForVersion&) {
        return app.version() + "\n";
    } catch (const CLI::ParseError& error) {
        std::string text = error.what();
        std::replace(text.begin(), text.end(), '\n', ' ');
        throw Error(text + "; --help lists the options");
    }
    return "";
}

}  // namespace estara
