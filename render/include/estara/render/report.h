// --report: a page for people.
#pragma once

#include <string>

#include "estara/render/statistics.h"

namespace estara {

/// A self-contained HTML page: settings, objects, frames with time and error side by side, and the
/// PNG images, if there are any, by links relative to the page.
/// @param path  where the page will be
std::string html_text(const RunRecord& run, const std::string& path);

}  // namespace estara
