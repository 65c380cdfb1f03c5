// What the programs print, whole: tests/cli/NAME/command is run and must give
// tests/cli/NAME/out.txt. ESTARA_UPDATE=1 writes out.txt anew: read what it has written.
#include "../programs.h"

#include <cstdlib>
#include <regex>
#include <sstream>

namespace estara {
namespace {

using test::Ran;
using test::TemporaryFolder;

std::string replaced(std::string text, const std::string& what, const std::string& by) {
    for (std::size_t at = 0; (at = text.find(what, at)) != std::string::npos; at += by.size()) {
        text.replace(at, what.size(), by);
    }
    return text;
}

/// Without what differs from machine to machine and from run to run.
std::string normalised(std::string text, const TemporaryFolder& folder) {
    text = replaced(text, folder.path(), "$TMP");
    text = replaced(text, ESTARA_MODELS, "$MODELS");
    text = std::regex_replace(text, std::regex(R"((estara-\w+) \d+\.\d+\.\d+)"), "$1 VERSION");
    text = std::regex_replace(text, std::regex(R"(\d+ min \d+ s\b)"), "TIME");
    text = std::regex_replace(text, std::regex(R"(\d+(\.\d+)?(e-\d+)? s\b)"), "TIME");
    return text;
}

std::string whole_text(const Ran& ran, const TemporaryFolder& folder) {
    return normalised(ran.out, folder) + "--- stderr\n" + normalised(ran.err, folder) +
           "--- exit status " + std::to_string(ran.status) + "\n";
}

/// What holds for every message of every program: it says whose it is, and is one line long.
void check_messages(const std::string& err) {
    std::istringstream lines(err);
    for (std::string line; std::getline(lines, line);) {
        EXPECT_TRUE(line.starts_with("estara-bake: ") || line.starts_with("estara-render: ") ||
                    line.starts_with("estara-scenes: "))
            << line;
        EXPECT_LT(line.size(), 500u) << line;
    }
}

class Cli : public ::testing::TestWithParam<std::string> {};

TEST_P(Cli, SaysWhatIsWrittenAndLeavesNothingAfterAFailure) {
    const std::string folder = std::string(ESTARA_CASES) + "/" + GetParam();
    const TemporaryFolder temporary;
    std::filesystem::create_directories(temporary / "in");
    std::filesystem::create_directories(temporary / "out");
    const std::string command = test::text_of(folder + "/command");
    if (command.find("$MODELS") != std::string::npos) {
        ASSERT_TRUE(std::filesystem::is_directory(ESTARA_MODELS))
            << ESTARA_MODELS << " is missing; the build makes it";
    }
    const Ran ran = test::run_in(temporary, command);
    if (ran.status != 0) {
        check_messages(ran.err);
        EXPECT_EQ(test::files_under(temporary / "out"), std::vector<std::string>{});
    }
    const std::string text = whole_text(ran, temporary);
    if (std::getenv("ESTARA_UPDATE") != nullptr) std::ofstream(folder + "/out.txt") << text;
    EXPECT_EQ(text, test::text_of(folder + "/out.txt")) << "ESTARA_UPDATE=1 writes it anew";
}

INSTANTIATE_TEST_SUITE_P(Programs, Cli, ::testing::ValuesIn(test::cases_in(ESTARA_CASES)),
                         [](const auto& named) { return named.param; });

}  // namespace
}  // namespace estara
