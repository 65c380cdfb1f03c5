// Recalled pictures of what moves, bends or stands still are as near to the truth as those of
// another sample pattern, and no darker.
#include <cmath>
#include <cstdint>
#include <cstring>

#include "../programs.h"

namespace estara {
namespace {

using test::done_in;
using test::Image;
using test::TemporaryFolder;

/// Of a picture's linear colours, against another's.
struct Difference {
    double rmse = 0.0, worst = 0.0, p999 = 0.0, mean = 0.0;
};

Difference distance_between(const Image& a, const Image& b) {
    Difference d;
    std::vector<double> pixels;
    for (int y = 0; y < a.height(); ++y) {
        for (int x = 0; x < a.width(); ++x) {
            double most = 0.0;
            for (int c = 0; c < 3; ++c) {
                const double off = double(a.at(x, y, c)) - double(b.at(x, y, c));
                most = std::max(most, std::abs(off));
                d.rmse += off * off;
                d.mean += off;
            }
            pixels.push_back(most);
        }
    }
    const double count = 3.0 * double(pixels.size());
    d.rmse = std::sqrt(d.rmse / count);
    d.mean /= count;
    std::sort(pixels.begin(), pixels.end());
    d.worst = pixels.back();
    d.p999 = pixels[pixels.size() * 999 / 1000];
    return d;
}

/// Turns nodes of a .glb as the first channel of its animation turns another.
void turn_too(const std::string& path, const std::vector<std::string>& names) {
    const std::string all = test::text_of(path);
    std::uint32_t length = 0;
    std::memcpy(&length, all.data() + 12, 4);
    auto json = nlohmann::json::parse(all.substr(20, length));
    for (std::size_t i = 0; i < json["nodes"].size(); ++i) {
        const std::string name = json["nodes"][i].value("name", "");
        if (std::find(names.begin(), names.end(), name) == names.end()) continue;
        auto channel = json["animations"][0]["channels"][0];
        channel["target"]["node"] = i;
        json["animations"][0]["channels"].push_back(channel);
    }
    std::string text = json.dump();
    text.resize((text.size() + 3) / 4 * 4, ' ');
    const auto word = [](std::size_t value) {
        const auto bits = std::uint32_t(value);
        return std::string(reinterpret_cast<const char*>(&bits), 4);
    };
    const std::string rest = all.substr(20 + length);
    std::ofstream(path, std::ios::binary)
        << all.substr(0, 8) << word(20 + text.size() + rest.size()) << word(text.size())
        << all.substr(16, 4) << text << rest;
}

struct Moving {
    const char *scene, *frames, *last;
    std::vector<std::string> turned;
};

class CacheOf : public ::testing::TestWithParam<Moving> {};

TEST_P(CacheOf, IsAnotherSamplePattern) {
    const Moving& what = GetParam();
    const TemporaryFolder folder;
    const std::string last = what.last;
    done_in(folder, std::string("estara-scenes ") + what.scene + " -o scene.glb");
    if (!what.turned.empty()) turn_too(folder / "scene.glb", what.turned);
    const auto render = [&](const std::string& name, const std::string& options) {
        done_in(folder, "estara-render scene.glb --resolution 192x108 --progress none -o '" + name +
                            ".#.exr' " + options);
        return Image(folder / (name + "." + last + ".exr"));
    };
    const Image truth = render("truth", "--strategy direct --spp 256 --frames " + last);
    for (const std::string spp : {"4", "16"}) {
        const Difference cache = distance_between(
            render("cache", "--strategy cache --spp " + spp + " --frames " + what.frames), truth);
        Difference other;
        for (const std::string seed : {"0", "1", "2", "3"}) {
            const Difference one =
                distance_between(render("direct", "--strategy direct --spp " + spp + " --seed " +
                                                      seed + " --frames " + last),
                                 truth);
            other.rmse += one.rmse / 4.0;
            other.worst = std::max(other.worst, one.worst);
            other.p999 = std::max(other.p999, one.p999);
            other.mean = std::max(other.mean, std::abs(one.mean));
        }
        // Recalled points lie a little less evenly in their pixels than a pattern's: single pixels
        // show it.
        EXPECT_LT(cache.rmse, 1.1 * other.rmse) << spp;
        EXPECT_LT(cache.p999, 1.15 * other.p999) << spp;
        EXPECT_LT(cache.worst, 1.75 * other.worst) << spp;
        EXPECT_LT(std::abs(cache.mean), other.mean + 5e-5) << spp;
    }
}

INSTANTIATE_TEST_SUITE_P(Scenes, CacheOf,
                         ::testing::Values(Moving{"tumble", "1-8", "8", {}},
                                           Moving{"still-life", "1-6", "6", {"vase", "knot"}},
                                           Moving{"bend", "1-8", "8", {}}),
                         [](const auto& named) {
                             std::string name = named.param.scene;
                             std::erase(name, '-');
                             return name;
                         });

}  // namespace
}  // namespace estara
