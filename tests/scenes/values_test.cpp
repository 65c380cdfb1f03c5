// Values as they are written on a command line and in messages.
#include "estara/scenes/program.h"
#include "files.h"

namespace estara {
namespace {

using test::message_of;

TEST(ParseFrames, ReadsTheThreeForms) {
    const auto is = [](const std::string& text, int first, int last, int step) {
        const FrameRange range = parse_frames(text);
        return range.first == first && range.last == last && range.step == step;
    };
    EXPECT_TRUE(is("7", 7, 7, 1));
    EXPECT_TRUE(is("1-48", 1, 48, 1));
    EXPECT_TRUE(is("0-48x5", 0, 48, 5));
    EXPECT_EQ(parse_frames("0-48x5").count(), 10);
}

TEST(ParseFrames, NamesTheOptionAndTheForm) {
    for (const std::string bad : {"", "a", "1-", "-", "1-2x", "1-2x2x2", "1..2", "+1", "1-2-3"}) {
        EXPECT_EQ(
            message_of([&] { parse_frames(bad); }),
            "--frames '" + bad +
                "': must be A, A-B or A-BxSTEP, or a list of them, such as 1-48 or 1,20,40-60x5");
    }
    EXPECT_EQ(message_of([] { parse_frames("5-1"); }), "--frames '5-1': ends before it starts");
    EXPECT_EQ(message_of([] { parse_frames("1-5x0"); }),
              "--frames '1-5x0': the step must be at least 1");
    EXPECT_EQ(message_of([] { parse_frames("1-2000000000"); }),
              "--frames '1-2000000000': frames are counted from 0 to 1000000000");
}

TEST(ParseResolution, ReadsWidthAndHeight) {
    EXPECT_EQ(parse_resolution("1280x720"), glm::ivec2(1280, 720));
    for (const std::string bad :
         {"", "x", "1280", "0x5", "-1x5", "70000x5", "5x70000", "5X5", "5x5x5"}) {
        EXPECT_EQ(message_of([&] { parse_resolution(bad); }),
                  "--resolution '" + bad +
                      "': must be WIDTHxHEIGHT, such as 1280x720, each from 1 to 65536");
    }
}

TEST(ParseColor, ReadsThreeNumbersOrOne) {
    EXPECT_EQ(parse_color("0.5,0.25,1e-1"), glm::vec3(0.5f, 0.25f, 0.1f));
    EXPECT_EQ(parse_color("2"), glm::vec3(2));
    for (const std::string bad : {"", "1,2", "1,2,3,4", "red", "nan", "1,inf,2", "1,,2"}) {
        EXPECT_EQ(message_of([&] { parse_color(bad); }),
                  "'" + bad + "' is not a colour; it must be R,G,B or one number for all three");
    }
}

TEST(ParseSize, KnowsThePowersOf1024) {
    EXPECT_EQ(parse_size("800000"), 800000u);
    EXPECT_EQ(parse_size("1K"), 1024u);
    EXPECT_EQ(parse_size("512M"), 512u << 20);
    EXPECT_EQ(parse_size("2G"), std::uint64_t{2} << 30);
    EXPECT_EQ(parse_size("1.5GiB"), std::uint64_t{3} << 29);
    EXPECT_EQ(parse_size("1TB"), std::uint64_t{1} << 40);
    for (const std::string bad : {"", "G", "-1", "1X", "1GG", "1 G", "99999999T", "nan", "1.2.3"}) {
        EXPECT_EQ(message_of([&] { parse_size(bad); }),
                  "'" + bad +
                      "' is not a size; it must be bytes or such as 512M, 2G or 1.5GiB (K, M, G, T "
                      "are powers of 1024)");
    }
}

TEST(ParseSetting, ReadsANumberOrAColour) {
    EXPECT_EQ(parse_setting("ringscale=12").name, "ringscale");
    EXPECT_EQ(parse_setting("ringscale=12").value, std::vector<float>{12});
    EXPECT_EQ(parse_setting("Cs=0.5,1,0").value, (std::vector<float>{0.5f, 1, 0}));
    for (const std::string bad : {"", "a", "=1", "a=", "a=b", "a=1,2", "a=1,2,3,4", "a=nan"}) {
        EXPECT_EQ(message_of([&] { parse_setting(bad); }),
                  "--param '" + bad + "': must be NAME=NUMBER or NAME=R,G,B");
    }
}

TEST(ParseProgress, KnowsItsThreeWords) {
    EXPECT_EQ(parse_progress("auto"), ProgressStyle::automatic);
    EXPECT_EQ(parse_progress("plain"), ProgressStyle::plain);
    EXPECT_EQ(parse_progress("none"), ProgressStyle::none);
    EXPECT_EQ(message_of([] { parse_progress("bar"); }),
              "--progress 'bar': must be auto, plain or none");
}

TEST(FormatBytes, HasTwoDigitsOrMore) {
    EXPECT_EQ(format_bytes(0), "0 B");
    EXPECT_EQ(format_bytes(1023), "1023 B");
    EXPECT_EQ(format_bytes(1024), "1.0 KiB");
    EXPECT_EQ(format_bytes(312 * 1024), "312 KiB");
    EXPECT_EQ(format_bytes(1024 * 1024 - 1), "1.0 MiB");
    EXPECT_EQ(format_bytes(1503238554), "1.4 GiB");
    EXPECT_EQ(format_bytes(~std::uint64_t{0}), "16 EiB");
}

TEST(FormatSeconds, TurnsToMinutesAndHours) {
    EXPECT_EQ(format_seconds(0.84), "0.8 s");
    EXPECT_EQ(format_seconds(59.96), "1 min 00 s");
    EXPECT_EQ(format_seconds(125), "2 min 05 s");
    EXPECT_EQ(format_seconds(3720), "1 h 02 min");
    EXPECT_EQ(format_seconds(-1), "? s");
}

TEST(Memory, IsKnown) {
    EXPECT_GT(peak_memory(), std::uint64_t{1} << 20);
    EXPECT_GT(physical_memory(), peak_memory());
}

}  // namespace
}  // namespace estara
