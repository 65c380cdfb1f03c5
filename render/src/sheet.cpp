#include "estara/render/sheet.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "estara/render/image_file.h"

namespace estara {
namespace {

constexpr int widest = 240, gap = 6, digit_scale = 2;
constexpr int label = 5 * digit_scale + 4;  // height of a line of digits

/// Digits of three by five dots, a bit each, the upper left one highest.
constexpr std::array<unsigned, 10> digits{
    0b111101101101111, 0b010110010010111, 0b111001111100111, 0b111001111001111, 0b101101111001001,
    0b111100111001111, 0b111100111101111, 0b111001001001001, 0b111101111101111, 0b111101111001111};

int columns_of(int count) { return std::max(1, int(std::ceil(std::sqrt(double(count))))); }
int thumbnail_width(int width) { return std::min(width, widest); }
int thumbnail_height(int width, int height) {
    return std::max(1, int(std::lround(double(height) * thumbnail_width(width) / width)));
}

Film blank(int count, int width, int height) {
    const int columns = columns_of(count), rows = (count + columns - 1) / columns;
    Film film(gap + columns * (thumbnail_width(width) + gap),
              gap + rows * (thumbnail_height(width, height) + label + gap), {});
    std::fill(film.color.begin(), film.color.end(), glm::vec4(0.03f, 0.03f, 0.03f, 1.0f));
    return film;
}

}  // namespace

ContactSheet::ContactSheet(int count, int width, int height)
    : m_columns(columns_of(count)),
      m_width(thumbnail_width(width)),
      m_height(thumbnail_height(width, height)),
      m_film(blank(count, width, height)) {}

void ContactSheet::add(int frame, const std::string& file) {
    const Film from = read_image(file);
    const int left = gap + m_next % m_columns * (m_width + gap);
    const int top = gap + m_next / m_columns * (m_height + label + gap);
    ++m_next;
    for (int y = 0; y < m_height; ++y) {
        for (int x = 0; x < m_width; ++x) {
            // The mean of the pixels that a small one covers.
            const auto part = [](int i, int size, int of) {
                return int(std::int64_t(i) * of / size);
            };
            const int x0 = part(x, m_width, from.width), y0 = part(y, m_height, from.height);
            const int x1 = std::max(x0 + 1, part(x + 1, m_width, from.width));
            const int y1 = std::max(y0 + 1, part(y + 1, m_height, from.height));
            glm::vec4 sum(0.0f);
            for (int v = y0; v < y1; ++v) {
                for (int u = x0; u < x1; ++u) {
                    sum += glm::clamp(from.color[from.index(u, v)], 0.0f, 1.0f);
                }
            }
            const glm::vec4 mean = sum / float((x1 - x0) * (y1 - y0));
            glm::vec4& to = m_film.color[m_film.index(left + x, top + y)];
            to = glm::vec4(glm::vec3(mean) + (1.0f - mean.a) * glm::vec3(to), 1.0f);
        }
    }
    const std::string text = std::to_string(frame);
    for (std::size_t d = 0; d < text.size(); ++d) {
        if (text[d] < '0' || text[d] > '9') continue;
        const unsigned dots = digits[std::size_t(text[d] - '0')];
        for (int y = 0; y < 5 * digit_scale; ++y) {
            for (int x = 0; x < 3 * digit_scale; ++x) {
                const int u = left + int(d) * 4 * digit_scale + x, v = top + m_height + 2 + y;
                const int dot = 14 - (y / digit_scale * 3 + x / digit_scale);
                if ((dots >> dot & 1u) == 0 || u >= m_film.width || v >= m_film.height) continue;
                m_film.color[m_film.index(u, v)] = glm::vec4(0.7f, 0.7f, 0.7f, 1.0f);
            }
        }
    }
}

void ContactSheet::write(const std::string& path) const {
    write_image(path, ImageFormat::png, m_film);
}

}  // namespace estara
