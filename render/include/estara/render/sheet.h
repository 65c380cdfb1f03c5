// A contact sheet: all frames of an animation on one page.
#pragma once

#include <string>
#include <vector>

#include "estara/render/film.h"

namespace estara {

/// Makes frames small, row by row, with their numbers. Reads them from their files, so that those
/// that were there before are on it too.
class ContactSheet {
public:
    /// @param count  frames in all
    /// @param width, height  of a frame, pixels
    ContactSheet(int count, int width, int height);
    /// The next frame. Error if its file cannot be read.
    void add(int frame, const std::string& file);
    /// Error (failed) if it cannot be written whole.
    void write(const std::string& path) const;

private:
    int m_columns, m_width, m_height;  ///< of a thumbnail
    int m_next = 0;
    Film m_film;
};

}  // namespace estara
