// Values as they are written on a command line and in messages.
#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <optional>
#include <set>
#include <string_view>

#include "estara/scenes/program.h"
#include "loaders.h"

namespace estara {
namespace {

/// The whole of a text as a number, or nothing.
template <class T>
std::optional<T> number(std::string_view text) {
    T value{};
    const char* end = text.data() + text.size();
    const auto [stop, code] = std::from_chars(text.data(), end, value);
    if (text.empty() || stop != end || code != std::errc()) return std::nullopt;
    if constexpr (std::is_floating_point_v<T>) {
        if (!std::isfinite(value)) return std::nullopt;
    }
    return value;
}

/// "1,2,3" to numbers; empty if any is none.
std::vector<float> numbers(std::string_view text) {
    std::vector<float> values;
    while (true) {
        const std::size_t comma = text.find(',');
        const std::optional<float> value = number<float>(text.substr(0, comma));
        if (!value) return {};
        values.push_back(*value);
        if (comma == std::string_view::npos) return values;
        text.remove_prefix(comma + 1);
    }
}

/// Power of 1024 that "K", "KB", "KiB" (and M, G, T; small letters too) stand for.
std::optional<int> power_named(std::string_view suffix) {
    if (suffix.empty() || suffix == "B") return 0;
    const std::string_view rest = suffix.substr(1);
    if (!rest.empty() && rest != "B" && rest != "iB") return std::nullopt;
    switch (suffix.front()) {
        case 'K':
        case 'k':
            return 1;
        case 'M':
        case 'm':
            return 2;
        case 'G':
        case 'g':
            return 3;
        case 'T':
        case 't':
            return 4;
        default:
            return std::nullopt;
    }
}

}  // namespace

namespace {

/// One part of a list of frames: "A", "A-B" or "A-BxSTEP".
FrameRange parse_range(std::string_view all, const std::string& text) {
    const auto fail = [&](const char* why) {
        throw Error(fmt::format("--frames '{}': {}", one_line(text, longest_name), why));
    };
    constexpr int last_frame = 1000000000;  // so that counting them cannot overflow
    const std::size_t cross = all.find('x');
    const std::string_view range = all.substr(0, cross);
    const std::size_t dash = range.find('-');
    const auto first = number<int>(range.substr(0, dash));
    const auto last = dash == std::string_view::npos ? first : number<int>(range.substr(dash + 1));
    const auto step = cross == std::string_view::npos ? std::optional<int>(1)
                                                      : number<int>(all.substr(cross + 1));
    if (!first || !last || !step) {
        fail("must be A, A-B or A-BxSTEP, or a list of them, such as 1-48 or 1,20,40-60x5");
    }
    if (*first < 0 || *last > last_frame) fail("frames are counted from 0 to 1000000000");
    if (*last < *first) fail("ends before it starts");
    if (*step < 1) fail("the step must be at least 1");
    return {*first, *last, *step};
}

}  // namespace

FrameRange parse_frames(const std::string& text) {
    std::string_view rest = text;
    std::vector<FrameRange> parts;
    for (std::size_t comma = 0; comma != std::string_view::npos; rest.remove_prefix(comma + 1)) {
        comma = rest.find(',');
        parts.push_back(parse_range(rest.substr(0, comma), text));
        if (comma == std::string_view::npos) break;
    }
    if (parts.size() == 1) return parts.front();
    std::set<int> frames;
    for (const FrameRange& part : parts) {
        constexpr int most = 10000000;
        if (part.count() > most) {
            throw Error(fmt::format("--frames '{}': a list of more than {} frames",
                                    one_line(text, longest_name), most));
        }
        for (int i = 0; i < part.count(); ++i) frames.insert(part.at(i));
    }
    return {*frames.begin(), *frames.rbegin(), 1, {frames.begin(), frames.end()}};
}

glm::ivec2 parse_resolution(const std::string& text) {
    const std::string_view all = text;
    const std::size_t cross = std::min(all.find('x'), all.size());
    const int width = number<int>(all.substr(0, cross)).value_or(0);
    const int height = cross == all.size() ? 0 : number<int>(all.substr(cross + 1)).value_or(0);
    const auto good = [](int n) { return n >= 1 && n <= 65536; };
    if (good(width) && good(height)) return {width, height};
    throw Error(fmt::format(
        "--resolution '{}': must be WIDTHxHEIGHT, such as 1280x720, each from 1 to 65536",
        one_line(text)));
}

glm::vec3 parse_color(const std::string& text) {
    const std::vector<float> values = numbers(text);
    if (values.size() == 1) return glm::vec3(values[0]);
    if (values.size() == 3) return {values[0], values[1], values[2]};
    throw Error(fmt::format("'{}' is not a colour; it must be R,G,B or one number for all three",
                            one_line(text)));
}

std::uint64_t parse_size(const std::string& text) {
    const std::size_t digits = text.find_first_not_of("0123456789.");
    const std::string_view all = text;
    const auto amount = number<double>(all.substr(0, digits));
    const auto power =
        power_named(digits == std::string::npos ? std::string_view{} : all.substr(digits));
    if (amount && power) {
        const double bytes = std::ldexp(*amount, 10 * *power);
        if (bytes < 0x1p63) return std::uint64_t(bytes);
    }
    throw Error(
        fmt::format("'{}' is not a size; it must be bytes or such as 512M, 2G or 1.5GiB (K, M, G, "
                    "T are powers of 1024)",
                    one_line(text)));
}

Setting parse_setting(const std::string& text) {
    const std::size_t equals = text.find('=');
    if (equals != std::string::npos && equals > 0) {
        const std::vector<float> values = numbers(std::string_view(text).substr(equals + 1));
        if (values.size() == 1 || values.size() == 3) return {text.substr(0, equals), values};
    }
    throw Error(fmt::format("--param '{}': must be NAME=NUMBER or NAME=R,G,B", one_line(text)));
}

std::string format_bytes(std::uint64_t bytes) {
    if (bytes < 1024) return fmt::format("{} B", bytes);
    static constexpr const char* units[] = {"KiB", "MiB", "GiB", "TiB", "PiB", "EiB"};
    double amount = double(bytes) / 1024.0;
    int unit = 0;
    for (; amount >= 1023.5 && unit < 5; ++unit) amount /= 1024.0;
    return fmt::format("{:.{}f} {}", amount, amount < 9.95 ? 1 : 0, units[unit]);
}

std::string format_seconds(double seconds) {
    if (!(seconds >= 0.0) || seconds > 1e15) return "? s";
    if (seconds < 59.95) return fmt::format("{:.1f} s", seconds);
    const std::int64_t whole = std::llround(seconds);
    const std::int64_t hours = whole / 3600, minutes = whole / 60 % 60;
    if (hours > 0) return fmt::format("{} h {:02} min", hours, minutes);
    return fmt::format("{} min {:02} s", minutes, whole % 60);
}

ProgressStyle parse_progress(const std::string& text) {
    if (text == "auto") return ProgressStyle::automatic;
    if (text == "plain") return ProgressStyle::plain;
    if (text == "none") return ProgressStyle::none;
    throw Error(fmt::format("--progress '{}': must be auto, plain or none", one_line(text)));
}

}  // namespace estara
