// What users are told about shaders and about their mistakes.
#include "estara/shaders/registry.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <charconv>
#include <cmath>
#include <limits>
#include <map>
#include <utility>

#include "sampling.h"

namespace estara {
namespace {

using testing::ElementsAre;
using testing::UnorderedElementsAreArray;

/// "setting | what | hint" of each problem.
std::vector<std::string> problems(const char* shader, const std::vector<Setting>& settings,
                                  bool has_uv = true) {
    const BindResult result = bind_shader(shader, settings, has_uv);
    EXPECT_EQ(result.shader == nullptr, !result.problems.empty());
    std::vector<std::string> texts;
    for (const Problem& p : result.problems)
        texts.push_back(p.setting + " | " + p.what + " | " + p.hint);
    return texts;
}

TEST(Bind, SuggestsTheShaderThatWasMeant) {
    const std::string all =
        "wood, stone, cobblestone, greenmarble, spatter, carpet, cmarble, colormarble, blocks, "
        "velvet, RCSkin, plastic";
    EXPECT_THAT(problems("woood", {}),
                ElementsAre("woood | no shader 'woood' | did you mean 'wood'? there are: " + all));
    EXPECT_THAT(problems("linen", {}),
                ElementsAre("linen | no shader 'linen' | there are: " + all));
    EXPECT_THAT(problems("", {}), ElementsAre(" | no shader '' | there are: " + all));
}

TEST(Bind, SuggestsTheParameterThatWasMeant) {
    EXPECT_THAT(
        problems("wood", {{"ringscael", {10}}}),
        ElementsAre("ringscael | shader 'wood' has no parameter 'ringscael' | did you mean "
                    "'ringscale'? it has: ringscale, lightwood, darkwood, Ka, Kd, Ks, roughness"));
    EXPECT_THAT(
        problems("wood", {{"nshades", {4}}}),
        ElementsAre("nshades | shader 'wood' has no parameter 'nshades' | it has: ringscale, "
                    "lightwood, darkwood, Ka, Kd, Ks, roughness"));
}

TEST(Bind, NamesTheRangeThatAValueIsOutsideOf) {
    EXPECT_THAT(problems("wood", {{"Ka", {-0.5f}}}),
                ElementsAre("Ka | shader 'wood': 'Ka' = -0.5 is outside [0, 10] | "));
    EXPECT_THAT(
        problems("wood", {{"ringscale", {1e7f}}}),
        ElementsAre("ringscale | shader 'wood': 'ringscale' = 1e+07 is outside [0, 1e+06] | "));
    EXPECT_THAT(problems("wood", {{"lightwood", {0.1f, 0.2f, 1.5f}}}),
                ElementsAre("lightwood | shader 'wood': 'lightwood' = 1.5 is outside [0, 1] | "));
    EXPECT_THAT(problems("cobblestone", {{"varCol", {1}}}),
                ElementsAre("varCol | shader 'cobblestone': 'varCol' = 1 is outside [0, 0.8] | "));
}

TEST(Bind, RefusesWhatIsNotANumber) {
    const float infinity = std::numeric_limits<float>::infinity();
    EXPECT_THAT(problems("stone", {{"scale", {std::nanf("")}}}),
                ElementsAre("scale | shader 'stone': 'scale' = nan is outside [1e-06, 1e+06] | "));
    EXPECT_THAT(problems("stone", {{"Cs", {0, infinity, 0}}}),
                ElementsAre("Cs | shader 'stone': 'Cs' = inf is outside [0, 1] | "));
    EXPECT_THAT(problems("stone", {{"nshades", {std::nanf("")}}}),
                ElementsAre("nshades | shader 'stone': 'nshades' = nan is outside [1, 256] | "));
}

TEST(Bind, RefusesAFractionForAWholeNumber) {
    EXPECT_THAT(problems("stone", {{"nshades", {2.5f}}}),
                ElementsAre("nshades | shader 'stone': 'nshades' = 2.5 is not a whole number | "));
}

TEST(Bind, RefusesAWrongCountOfNumbers) {
    EXPECT_THAT(problems("stone", {{"scale", {1, 2, 3}}}),
                ElementsAre("scale | shader 'stone': 'scale' is one number, not 3 | "));
    EXPECT_THAT(problems("stone", {{"scale", {}}}),
                ElementsAre("scale | shader 'stone': 'scale' is one number, not 0 | "));
    EXPECT_THAT(
        problems("stone", {{"Cs", {1, 0}}}),
        ElementsAre("Cs | shader 'stone': 'Cs' is a colour: give 3 numbers, or 1 for a grey | "));
}

TEST(Bind, RefusesAParameterSetTwice) {
    EXPECT_THAT(problems("stone", {{"scale", {1}}, {"Ka", {1}}, {"scale", {1}}}),
                ElementsAre("scale | shader 'stone': 'scale' is set twice | "));
}

TEST(Bind, NamesAllProblemsAtOnce) {
    EXPECT_THAT(
        problems(
            "plastic",
            {{"Kx", {1}}, {"Ks", {-1}}, {"roughness", {0.5f, 0.5f}}, {"Kd", {1}}, {"Kd", {2}}}),
        ElementsAre("Kx | shader 'plastic' has no parameter 'Kx' | did you mean 'Ka'? it has: Ka, "
                    "Kd, Ks, roughness, specularcolor, Cs",
                    "Ks | shader 'plastic': 'Ks' = -1 is outside [0, 10] | ",
                    "roughness | shader 'plastic': 'roughness' is one number, not 2 | ",
                    "Kd | shader 'plastic': 'Kd' is set twice | "));
}

TEST(Bind, RefusesTextureCoordinatesThatTheMeshDoesNotHave) {
    EXPECT_THAT(
        problems("cobblestone", {{"variant", {0}}}, false),
        ElementsAre(" | shader 'cobblestone' is set on texture coordinates, and the mesh has none "
                    "| add some, or use its solid variant"));
    EXPECT_THAT(problems("cobblestone", {{"variant", {0}}}, true), ElementsAre());
    EXPECT_THAT(
        problems("blocks", {{"variant", {0}}}, false),
        ElementsAre(" | shader 'blocks' is set on texture coordinates, and the mesh has none "
                    "| add some, or use its solid variant"));
}

TEST(Bind, TakesAMeshWithoutTextureCoordinatesWhereTheSurfaceAloneIsNeeded) {
    EXPECT_THAT(problems("RCSkin", {}, false), ElementsAre());
    EXPECT_THAT(problems("blocks", {{"variant", {1}}, {"bump", {1}}}, false), ElementsAre());
    EXPECT_EQ(bind_shader("RCSkin", {}, false).shader->domain(), Domain::surface);
    EXPECT_FALSE(bind_shader("RCSkin", {}, false).shader->needs_uv());
}

TEST(Bind, TakesAGreyForAColour) {
    const BoundShaderPtr shader =
        bind_shader("plastic", std::vector<Setting>{{"Cs", {0.25f}}}, false).shader;
    EXPECT_EQ(shader->values()[5], glm::vec3(0.25f));
}

TEST(Bind, TakesTheEndsOfARange) {
    for (const ShaderInfo& info : all_shaders()) {
        for (const ParamInfo& param : info.params) {
            for (const float end : {param.min, param.max}) {
                EXPECT_THAT(problems(info.name.data(), {{std::string(param.name), {end}}}),
                            ElementsAre());
            }
        }
    }
}

TEST(Cobblestone, IsSetOnTextureCoordinatesWhereThereAreSome) {
    const auto bound = [](float variant, bool has_uv) {
        return bind_shader("cobblestone", std::vector<Setting>{{"variant", {variant}}}, has_uv)
            .shader;
    };
    EXPECT_EQ(bound(-1, true)->domain(), Domain::surface);
    EXPECT_EQ(bound(-1, true)->values()[0].x, 0.0f);
    EXPECT_EQ(bound(-1, false)->domain(), Domain::point);
    EXPECT_EQ(bound(-1, false)->values()[0].x, 1.0f);
    EXPECT_EQ(bound(1, true)->domain(), Domain::point);
    // What the mesh decides and what the user says are the same shader: their grids are
    // exchangeable.
    EXPECT_EQ(shader_digest(*bound(-1, false)), shader_digest(*bound(1, true)));
    EXPECT_EQ(shader_digest(*bound(-1, true)), shader_digest(*bound(0, true)));
    EXPECT_NE(shader_digest(*bound(0, true)), shader_digest(*bound(1, true)));
}

TEST(Blocks, IsLayeredAndHasANormalWithBumpAlone) {
    const auto bound = [](float bump, bool has_uv) {
        return bind_shader("blocks", std::vector<Setting>{{"bump", {bump}}}, has_uv).shader;
    };
    for (const bool has_uv : {true, false}) {
        EXPECT_FALSE(bound(0, has_uv)->layered());
        EXPECT_EQ(bound(0, has_uv)->domain(), has_uv ? Domain::surface : Domain::point);
        EXPECT_EQ(bound(0, has_uv)->info().channels.size(), 1u);
        EXPECT_EQ(bound(0, has_uv)->info().baked_floats, 3);
        EXPECT_TRUE(bound(1, has_uv)->layered());
        EXPECT_EQ(bound(1, has_uv)->domain(), Domain::surface);
        EXPECT_EQ(bound(1, has_uv)->info().channels.back().kind, ChannelKind::normal);
        EXPECT_EQ(bound(1, has_uv)->info().baked_floats, 6);
    }
}

TEST(Registry, KnowsTheLayeredShaders) {
    std::vector<std::string_view> layered;
    for (const ShaderInfo& info : all_shaders()) {
        if (bind_shader(info.name, {}, true).shader->layered()) layered.push_back(info.name);
    }
    EXPECT_THAT(layered, ElementsAre("velvet", "RCSkin"));
}

TEST(Registry, KnowsEveryShaderByName) {
    std::string names;
    for (const ShaderInfo& info : all_shaders()) {
        EXPECT_EQ(find_shader(info.name), &info);
        EXPECT_FALSE(info.summary.empty()) << info.name;
        names += (names.empty() ? "" : ", ") + std::string(info.name);
    }
    EXPECT_EQ(shader_names(), names);
    EXPECT_EQ(find_shader("Wood"), nullptr);
    EXPECT_EQ(find_shader(""), nullptr);
}

TEST(Registry, DeclaresParametersAndChannelsCompletely) {
    for (const ShaderInfo& info : all_shaders()) {
        int floats = 0;
        for (const ChannelInfo& channel : info.channels) {
            EXPECT_TRUE(channel.components == 1 || channel.components == 3) << info.name;
            EXPECT_FALSE(channel.name.empty() || channel.help.empty()) << info.name;
            floats += channel.components;
        }
        EXPECT_EQ(floats, info.baked_floats) << info.name;
        EXPECT_EQ(info.channels.at(0).name, "color") << info.name;  // the grid that others know
        for (const ParamInfo& param : info.params) {
            EXPECT_FALSE(param.help.empty()) << info.name << " " << param.name;
            EXPECT_LT(param.min, param.max) << info.name << " " << param.name;
            for (int c = 0; c < param.components(); ++c) {
                EXPECT_GE(param.default_value[c], param.min) << info.name << " " << param.name;
                EXPECT_LE(param.default_value[c], param.max) << info.name << " " << param.name;
            }
            EXPECT_EQ(param.type == ValueType::color, param.unit == Unit::color)
                << info.name << " " << param.name;
        }
    }
}

// The shaders' published parameters; plastic is RSL's. Ours are Cs, the surface colour there, and
// all of cobblestone's, colormarble's and blocks'.
TEST(Registry, HasThePublishedDefaults) {
    const std::map<std::string, std::vector<std::string>> published{
        {"wood",
         {"ringscale=10", "lightwood=0.3,0.12,0.03", "darkwood=0.05,0.01,0.005", "Ka=0.2", "Kd=0.4",
          "Ks=0.6", "roughness=0.1"}},
        {"stone",
         {"Ks=0.9", "Kd=0.8", "Ka=0.2", "roughness=0.3", "scale=0.02", "nshades=4", "exponent=2",
          "specularcolor=1,1,1", "graincolor=0,0,0", "Cs=0.65,0.6,0.55"}},
        {"cobblestone",
         {"variant=0", "Kd=0.8", "jitter=0.75", "sscale=10", "tscale=10", "txtscale=1",
          "selfCol=0.5,0.47,0.42", "varCol=0.8,0.75,0.7", "Ka=0.2", "Ks=0.2", "roughness=0.2"}},
        {"greenmarble",
         {"Ka=0.1", "Kd=0.6", "Ks=0.4", "roughness=0.01", "darkcolor=0.01,0.12,0.004",
          "lightcolor=0.06,0.18,0.02", "veincolor=0.47,0.57,0.03", "veinfreq=1", "sharpness=25"}},
        {"spatter",
         {"Ka=1", "Kd=0.5", "Ks=0.7", "roughness=0.2", "specksize=0.01", "sizes=5",
          "basecolor=0.1,0.1,0.5", "spattercolor=1,1,1"}},
        {"carpet", {"Kd=0.6", "Ka=0.1", "scuff=1", "nap=1", "Cs=0.42,0.12,0.1"}},
        {"cmarble",
         {"Ka=0.1", "Kd=0.6", "Ks=0.4", "roughness=0.1", "veining=1", "Cs=0.5,0.26,0.16"}},
        {"colormarble",
         {"Ks=0.4", "Kd=0.6", "Ka=0.1", "roughness=0.1", "txtscale=1", "pale=0.9,0.86,0.78",
          "medium=0.8,0.66,0.52", "middark=0.55,0.34,0.26", "dark=0.25,0.14,0.12"}},
        {"blocks",
         {"variant=0", "Ka=0.7", "Kd=0.7", "blockwidth=0.3", "blockheight=0.15",
          "mortarthickness=0.01", "jagged=0.04", "blockvary=0.25", "pitting=0.5",
          "blockcolor=0.72,0.7,0.64", "mortarcolor=0.45,0.43,0.4", "bump=0"}},
        {"velvet",
         {"Ka=0.05", "Kd=0.1", "backscatter=0.1", "edginess=10", "sheen=0.25,0.25,0.25",
          "roughness=0.1", "Cs=0.4,0.05,0.12"}},
        {"RCSkin",
         {"Kd=0.1", "skincolor=0.7,0.56,0.52", "sheenColor=1,1,1", "blemishfreq=12",
          "blemishthresh=4", "blemishopac=1", "eta=1.01", "thickness=1", "angle=180", "oily=1.5",
          "xrough=0.3", "yrough=0.5", "poresfreq=60", "poresthresh=3", "poresdepth=-0.001",
          "maxfreq=8", "brightness=1"}},
        {"plastic",
         {"Ka=1", "Kd=0.5", "Ks=0.5", "roughness=0.1", "specularcolor=1,1,1", "Cs=0.5,0.5,0.5"}},
    };
    for (const ShaderInfo& info : all_shaders()) {
        const auto row = published.find(std::string(info.name));
        ASSERT_NE(row, published.end()) << "add the published defaults of " << info.name;
        std::vector<std::string> words;
        std::string word;
        for (const char c : describe_values(*bind_shader(info.name, {}, true).shader) + " ") {
            if (c == ' ')
                words.push_back(std::exchange(word, ""));
            else
                word += c;
        }
        EXPECT_THAT(words, UnorderedElementsAreArray(row->second)) << info.name;
    }
}

TEST(DescribeValues, NamesEveryParameterInOrder) {
    const std::vector<Setting> settings{
        {"roughness", {0.25f}}, {"darkwood", {0, 1, 0.125f}}, {"ringscale", {1e5f}}};
    EXPECT_EQ(describe_values(*bind_shader("wood", settings, false).shader),
              "ringscale=1e+05 lightwood=0.3,0.12,0.03 darkwood=0,1,0.125 Ka=0.2 Kd=0.4 Ks=0.6 "
              "roughness=0.25");
    EXPECT_EQ(describe_values(*bind_shader("cobblestone", {}, false).shader),
              "variant=1 Kd=0.8 jitter=0.75 sscale=10 tscale=10 txtscale=1 selfCol=0.5,0.47,0.42 "
              "varCol=0.8,0.75,0.7 Ka=0.2 Ks=0.2 roughness=0.2");
}

TEST(ShaderDigest, TellsShadersApart) {
    std::map<std::string, std::string_view> seen;
    for (const ShaderInfo& info : all_shaders()) {
        const std::string digest = shader_digest(*bind_shader(info.name, {}, true).shader);
        EXPECT_EQ(digest.size(), 16u);
        EXPECT_EQ(digest.find_first_not_of("0123456789abcdef"), std::string::npos) << digest;
        EXPECT_TRUE(seen.emplace(digest, info.name).second) << info.name;
    }
}

TEST(ShaderDigest, DoesNotDependOnHowTheParametersWereGiven) {
    const std::vector<Setting> one{{"ringscale", {10}}, {"Ka", {0.9f}}},
        other{{"Ka", {0.9f}}, {"ringscale", {10}}};
    const std::string plain = shader_digest(*bind_shader("wood", {}, false).shader);
    EXPECT_EQ(shader_digest(*bind_shader("wood", one, false).shader), plain);
    EXPECT_EQ(shader_digest(*bind_shader("wood", other, true, InstructionSet::baseline).shader),
              plain);
}

TEST(NearestWord, IsAtMostAThirdAway) {
    constexpr std::array<std::string_view, 4> words{"ringscale", "roughness", "Ka", "Ks"};
    EXPECT_EQ(nearest_word("ringscael", words), "ringscale");
    EXPECT_EQ(nearest_word("ring_scale", words), "ringscale");
    EXPECT_EQ(nearest_word("rooghnes", words), "roughness");
    EXPECT_EQ(nearest_word("ringsXXXX", words), "");           // four of nine letters
    EXPECT_EQ(nearest_word("ringsXXXe", words), "ringscale");  // three
    EXPECT_EQ(nearest_word("Ks", words), "Ks");
    EXPECT_EQ(nearest_word("ks", words), "Ks");  // one letter is allowed in short words
    EXPECT_EQ(nearest_word("zz", words), "");
    EXPECT_EQ(nearest_word("", words), "");
    EXPECT_EQ(nearest_word("wood", {}), "");
}

TEST(ToString, ReadsBackAsTheSameFloat) {
    test::Random random(1);
    for (int i = 0; i < 100000; ++i) {
        const float value = random.within(-1.0f, 1.0f) * std::exp2(random.within(-120.0f, 120.0f));
        const std::string text = to_string(value);
        float back = 0.0f;
        std::from_chars(text.data(), text.data() + text.size(), back);
        ASSERT_EQ(std::bit_cast<std::uint32_t>(back), std::bit_cast<std::uint32_t>(value)) << text;
    }
}

TEST(ToString, IsShort) {
    EXPECT_EQ(to_string(0.1f), "0.1");
    EXPECT_EQ(to_string(-0.0f), "-0");
    EXPECT_EQ(to_string(16777216.0f), "16777216");
    EXPECT_EQ(to_string(1e-6f), "1e-06");
    EXPECT_EQ(to_string(std::numeric_limits<float>::denorm_min()), "1e-45");
    EXPECT_EQ(to_string(std::numeric_limits<float>::infinity()), "inf");
    EXPECT_EQ(to_string(glm::vec3(0.3f, 0.12f, 0.03f)), "0.3,0.12,0.03");
}

TEST(ToString, NamesUnits) {
    EXPECT_EQ(to_string(Unit::none), "");
    EXPECT_EQ(to_string(Unit::per_length), "1/length");
    EXPECT_EQ(to_string(Unit::length), "length");
    EXPECT_EQ(to_string(Unit::color), "linear Rec. 709");
}

}  // namespace
}  // namespace estara
