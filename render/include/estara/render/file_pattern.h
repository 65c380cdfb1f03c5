// Names of numbered image files.
#pragma once

#include <string>
#include <vector>

namespace estara {

enum class ImageFormat { exr, png };

/// "frames/####.exr" or "frames/%04d.exr": a run of # is the frame's number with at least as many
/// digits, %d and %04d are as printf has them. Every such place is filled.
class FilePattern {
public:
    /// Error for a name that does not end in .exr or .png, and for a % that is not %d or %0Nd.
    explicit FilePattern(const std::string& text);

    const std::string& text() const noexcept { return m_text; }
    ImageFormat format() const noexcept { return m_format; }
    /// Whether frames get different names.
    bool is_numbered() const noexcept { return !m_digits.empty(); }
    std::string path(int frame) const;

private:
    std::string m_text;
    ImageFormat m_format;
    std::vector<std::string> m_parts;  ///< the text between the numbers, one more than m_digits
    std::vector<int> m_digits;         ///< least digits of each number
};

}  // namespace estara
