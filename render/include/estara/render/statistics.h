// What a run has cost and how good it is, for people and programs.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "estara/render/compare.h"
#include "estara/render/dress.h"

namespace estara {

struct FrameRecord {
    int frame;
    std::vector<std::string> files;
    FrameStatistics cost;
    std::optional<FrameStatistics> direct;  ///< with --compare: of the direct frame
    std::optional<ImageError> error;        ///< and the difference to it
};

struct RunRecord {
    Options options;
    FrameRange range;
    int skipped = 0;  ///< frames that --resume found finished
    std::vector<ObjectRecord> objects;
    std::vector<FrameRecord> frames;
    double seconds = 0.0;  ///< all of it, loading included
};

struct Spread {
    double median = 0.0, min = 0.0, max = 0.0;
};

/// Of at least one value; the mean of the middle two for an even number.
Spread spread(std::vector<double> values);

/// Everything about frames that have been rendered together.
struct Summary {
    Spread frame, evaluation;  ///< seconds
    std::uint64_t misses = 0, lookups = 0, bad_pixels = 0;
    Spread shading;  ///< all but rays to the eye: light, shadow rays and the cache included
    std::optional<Spread> direct_frame, direct_evaluation, direct_shading;
    std::optional<ImageError> error;
};

/// Of a run with at least one frame.
Summary summary(const RunRecord& run);

/// --stats: all settings, objects, frames and the summary. render/README.md names the fields.
std::string json_text(const RunRecord& run);

/// What --compare prints before the last line: two lines on error and time; "" without comparison.
std::string comparison_text(const RunRecord& run);

/// The last line on stdout.
std::string result_line(const RunRecord& run);

}  // namespace estara
