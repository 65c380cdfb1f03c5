#include "rows.h"

#include <fmt/chrono.h>
#include <fmt/format.h>
#include <tbb/task_arena.h>

#include <ctime>
#include <fstream>
#include <nlohmann/json.hpp>

#include "meshes.h"

namespace estara::bench {
namespace {

std::string cpu_model() {
    std::ifstream file("/proc/cpuinfo");
    for (std::string line; std::getline(file, line);) {
        if (line.starts_with("model name")) return line.substr(line.find(':') + 2);
    }
    return "unknown processor";
}

std::string heading() {
    return fmt::format(
        "{}, {} threads, g++ {}, {:%Y-%m-%d %H:%M}. Surface: {}.\n"
        "Medians with minimum and maximum over the repetitions; a ratio is ours over theirs, of "
        "the same round.\n",
        cpu_model(), tbb::this_task_arena::max_concurrency(), __VERSION__,
        fmt::localtime(std::time(nullptr)), surface_name());
}

std::string line_of(const Row& row) {
    const Spread& v = row.value;
    return fmt::format("| {} | {:.4g} | {} | {:.4g} | {:.4g} | {} | {} |\n", row.name, v.median,
                       row.unit, v.min, v.max, row.error, row.what);
}

}  // namespace

std::string Rows::json() const {
    nlohmann::ordered_json list = nlohmann::ordered_json::array();
    for (const Row& row : m_rows) {
        list.push_back({{"name", row.name}, {"value", row.value.median}, {"unit", row.unit}});
    }
    return list.dump(2) + "\n";
}

std::string Rows::markdown() const {
    std::string text = heading() +
                       "\n| row | value | unit | min | max | error | what it is |\n"
                       "|---|---|---|---|---|---|---|\n";
    for (const bool ratios : {true, false}) {
        for (const Row& row : m_rows) {
            if ((row.unit == "ratio") == ratios) text += line_of(row);
        }
    }
    for (const std::string& fault : m_faults) text += "\n**" + fault + "**\n";
    return text;
}

}  // namespace estara::bench
