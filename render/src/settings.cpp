#include "estara/render/settings.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <xxhash.h>

#include <filesystem>
#include <fstream>
#include <memory>
#include <set>
#include <sstream>
#include <vector>

namespace estara {
namespace {

std::string file_digest(const std::string& path) {
    std::ifstream file(path, std::ios::binary);
    if (!file) throw Error(fmt::format("{}: no such file", path));
    const std::unique_ptr<XXH3_state_t, decltype(&XXH3_freeState)> state(XXH3_createState(),
                                                                         &XXH3_freeState);
    XXH3_64bits_reset(state.get());
    std::vector<char> bytes(1 << 20);
    while (file.read(bytes.data(), std::streamsize(bytes.size())), file.gcount() > 0) {
        XXH3_64bits_update(state.get(), bytes.data(), std::size_t(file.gcount()));
    }
    return fmt::format("{:016x}", XXH3_64bits_digest(state.get()));
}

std::string grids_text(const Options& options) {
    std::vector<std::string> digests;
    for (const std::string& name : options.grids) {
        std::error_code code;
        if (!std::filesystem::is_directory(name, code)) {
            digests.push_back(file_digest(name));
            continue;
        }
        std::set<std::string> files;
        for (const auto& entry : std::filesystem::directory_iterator(name, code)) {
            if (entry.path().extension() == ".vdb") files.insert(entry.path().string());
        }
        for (const std::string& file : files) digests.push_back(file_digest(file));
    }
    return digests.empty() ? "none" : fmt::format("{}", fmt::join(digests, ","));
}

std::string params_text(const Options& options) {
    std::string text = options.shader.empty() ? "none" : options.shader;
    for (const Setting& setting : options.params) {
        text += fmt::format(" {}={}", setting.name, fmt::join(setting.value, ","));
    }
    return text;
}

std::vector<std::pair<std::string, std::string>> parsed(const std::string& text) {
    std::vector<std::pair<std::string, std::string>> settings;
    std::istringstream parts(text);
    for (std::string part; std::getline(parts, part, ';');) {
        const std::size_t start = part.find_first_not_of(' ');
        if (start == std::string::npos) continue;
        const std::size_t blank = part.find(' ', start);
        if (blank == std::string::npos) continue;
        settings.emplace_back(part.substr(start, blank - start), part.substr(blank + 1));
    }
    return settings;
}

}  // namespace

std::string settings_text(const Options& options, const Scene& scene, int camera) {
    const FrameSettings& f = options.frame;
    const bool may_cache =
        options.strategy == Strategy::cache || options.strategy == Strategy::automatic;
    std::string text = fmt::format(
        "version {}; scene {}; resolution {}x{}; spp {}; seed {}; exposure {}; shadows {}; camera "
        "{}; "
        "fps {:.9g}; shader {}; strategy {}; grids {}; aovs {}{}{}{}",
        version, scene_digest(scene), f.width, f.height, f.spp, f.seed, f.exposure,
        f.shadows ? "on" : "off", camera, *options.fps, params_text(options),
        to_string(options.strategy), grids_text(options), int(f.aovs.albedo), int(f.aovs.normal),
        int(f.aovs.position), int(f.aovs.depth));
    if (may_cache) {
        text += fmt::format("; window {}; cache-memory {}; cache-light {}; cache-test-all {}",
                            options.window, options.cache_memory,
                            options.cache_light ? (*options.cache_light ? "on" : "off") : "auto",
                            f.test_all_points ? "on" : "off");
    }
    return text;
}

std::string first_difference(const std::string& was, const std::string& is) {
    if (was == is) return "";
    const auto old = parsed(was), now = parsed(is);
    for (std::size_t i = 0; i < std::max(old.size(), now.size()); ++i) {
        if (i >= old.size()) return now[i].first + " was not given";
        if (i >= now.size()) return old[i].first + " is not given";
        if (old[i] == now[i]) continue;
        if (old[i].first != now[i].first) return now[i].first + " was not given";
        if (now[i].first == "scene" || now[i].first == "grids") {
            return fmt::format("the {} changed", now[i].first);
        }
        return fmt::format("{} was {}, is {}", now[i].first, old[i].second, now[i].second);
    }
    return "the settings changed";
}

}  // namespace estara
