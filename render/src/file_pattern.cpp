#include "estara/render/file_pattern.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <filesystem>

#include "estara/scenes/error.h"

namespace estara {
namespace {

constexpr int max_digits = 20;

ImageFormat format_of(const std::string& text) {
    const std::filesystem::path path(text);
    std::string ending = path.extension().string();
    std::transform(ending.begin(), ending.end(), ending.begin(),
                   [](unsigned char c) { return char(std::tolower(c)); });
    if (ending == ".exr") return ImageFormat::exr;
    if (ending == ".png") return ImageFormat::png;
    throw Error(fmt::format("-o {}: the name must end in .exr or .png", text));
}

/// Reads %d or %0Nd at text[at] and moves `at` behind it.
int printf_digits(const std::string& text, std::size_t& at) {
    std::size_t i = at + 1;
    int digits = 0;
    if (i < text.size() && text[i] == '0') {
        while (i < text.size() && text[i] >= '0' && text[i] <= '9' && digits <= max_digits) {
            digits = digits * 10 + (text[i++] - '0');
        }
    }
    if (i >= text.size() || text[i] != 'd' || digits > max_digits) {
        throw Error(fmt::format("-o {}: a % must be %d or %0Nd with N up to {}, as in %04d", text,
                                max_digits));
    }
    at = i + 1;
    return std::max(1, digits);
}

}  // namespace

FilePattern::FilePattern(const std::string& text) : m_text(text), m_format(format_of(text)) {
    std::string part;
    for (std::size_t i = 0; i < text.size();) {
        if (text[i] != '#' && text[i] != '%') {
            part += text[i++];
            continue;
        }
        if (text[i] == '#') {
            const std::size_t end = std::min(text.find_first_not_of('#', i), text.size());
            m_digits.push_back(int(std::min<std::size_t>(end - i, max_digits)));
            i = end;
        } else {
            m_digits.push_back(printf_digits(text, i));
        }
        m_parts.push_back(std::move(part));
        part.clear();
    }
    m_parts.push_back(std::move(part));
}

std::string FilePattern::path(int frame) const {
    std::string path = m_parts[0];
    for (std::size_t i = 0; i < m_digits.size(); ++i) {
        path += fmt::format("{:0{}}", frame, m_digits[i]) + m_parts[i + 1];
    }
    return path;
}

}  // namespace estara
