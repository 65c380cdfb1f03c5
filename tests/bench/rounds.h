// Contenders timed in turns, so that whatever else the machine does strikes them alike.
#pragma once

#include <time.h>

#include <algorithm>
#include <functional>
#include <vector>

#include "estara/render/statistics.h"
#include "estara/scenes/program.h"

namespace estara::bench {

/// Seconds of one repetition: on the wall, and of all threads of the process together.
struct Cost {
    double wall, cpu;
};

inline double cpu_seconds() noexcept {
    timespec time{};
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &time);
    return double(time.tv_sec) + 1e-9 * double(time.tv_nsec);
}

inline Cost cost_of(const std::function<void()>& work) {
    const double cpu = cpu_seconds();
    const Stopwatch watch;
    work();
    return {watch.seconds(), cpu_seconds() - cpu};
}

/// Each contender once in each round, after a round that is not counted; every round starts with
/// another one.
/// @return  costs[contender][round]
inline std::vector<std::vector<Cost>> rounds(int count,
                                             const std::vector<std::function<void()>>& contenders) {
    std::vector<std::vector<Cost>> costs(contenders.size(), std::vector<Cost>(std::size_t(count)));
    for (const auto& work : contenders) work();
    for (std::size_t round = 0; round < std::size_t(count); ++round) {
        for (std::size_t i = 0; i < contenders.size(); ++i) {
            const std::size_t turn = (round + i) % contenders.size();
            costs[turn][round] = cost_of(contenders[turn]);
        }
    }
    return costs;
}

/// The spread of f(cost) over the rounds.
template <class F>
Spread spread_of(const std::vector<Cost>& costs, F&& f) {
    std::vector<double> values;
    for (const Cost& cost : costs) values.push_back(f(cost));
    return spread(std::move(values));
}

/// The spread of ours over theirs, round by round.
inline Spread ratio(const std::vector<Cost>& ours, const std::vector<Cost>& theirs,
                    double Cost::*time) {
    std::vector<double> values;
    for (std::size_t i = 0; i < ours.size(); ++i) {
        values.push_back(ours[i].*time / (theirs[i].*time));
    }
    return spread(std::move(values));
}

}  // namespace estara::bench
