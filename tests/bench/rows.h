// What a benchmark leaves: rows of figures, each with its error beside it.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "estara/render/statistics.h"

namespace estara::bench {

struct Row {
    std::string name;   ///< "lookup/coherent/2M/openvdb_ratio"
    Spread value;       ///< over the repetitions
    std::string unit;   ///< "ratio", "ns", "voxels/s", ...
    std::string error;  ///< what the results of this speed differ by, with its unit; or "exact"
    std::string what;   ///< in words; of a ratio "ours over theirs", ours first
};

/// A value that is not repeated.
inline Spread once(double value) { return {value, value, value}; }

/// The results of a run. Not thread-safe.
class Rows {
public:
    void add(Row row) { m_rows.push_back(std::move(row)); }

    /// Results that ought to be the same are not: figures of such a run are worth nothing.
    void disagree(const std::string& what) { m_faults.push_back("results disagree: " + what); }
    /// Rows that could not be made, and why.
    void missing(const std::string& what) { m_faults.push_back("not measured: " + what); }
    const std::vector<std::string>& faults() const noexcept { return m_faults; }

    /// A list of {"name", "value", "unit"}, in the order of their making.
    std::string json() const;
    /// A table of all rows, ratios first, under a heading that names the machine.
    std::string markdown() const;

private:
    std::vector<Row> m_rows;
    std::vector<std::string> m_faults;
};

/// What a run of all benchmarks has in hand.
struct Bench {
    Rows rows;
    std::filesystem::path folder;  ///< for what is written on the way
    double large_voxels = 2e8;     ///< of the large bake
};

// The groups, each a file of that name.
void lookup(Bench& bench);
void shaders(Bench& bench);
void frame(Bench& bench);
void bake(Bench& bench);
void load(Bench& bench);
void large(Bench& bench);
void renderers(Bench& bench);

}  // namespace estara::bench
