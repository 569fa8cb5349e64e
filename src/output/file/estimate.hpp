// How long a long run will take, said once, by what its own first piece took.
#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>

#include "output/file/progress.hpp"

namespace lostbits::output::file {

/// Seconds that are watched, after the first units are done: what came before them is not their pace.
inline constexpr double first_piece_s = 2;
/// Seconds of a run that is long: a shorter one is over before its estimate is read.
inline constexpr double long_run_s = 30;

/// Units that were done so many seconds after a beginning.
struct Reached {
    std::uint64_t units = 0;
    double seconds = 0;
};

/// `NAME will take about 3m20s: its first 1 % took 2s`; nothing before `first_piece_s` were watched, nor where all of
/// the `total` units would take less than `long_run_s`. Until the `first` units are done a run starts up and finds the
/// truth for all forms, which happens `starts` times: a map has bands of the picture.
[[nodiscard]] std::optional<std::string> estimate_text(std::string_view name, const Reached& first, const Reached& now,
                                                       std::uint64_t total, std::uint64_t starts = 1);

/// Watches a run; says its estimate on stderr, above the bar, where it is long.
class Estimate {
public:
    /// `total` units are to come, and what comes before the first of them comes `starts` times. `quiet`: says nothing.
    Estimate(Progress& progress, std::string name, std::uint64_t total, bool quiet, std::uint64_t starts = 1)
        : progress_(progress), name_(std::move(name)), total_(total), starts_(starts), said_(quiet) {}

    /// `n` more units are done. From any thread.
    void advance(std::uint64_t n);

private:
    using Clock = std::chrono::steady_clock;
    Progress& progress_;
    std::string name_;
    std::uint64_t total_, starts_;
    std::mutex mutex_;  ///< of the two below
    Reached first_, now_;
    std::atomic<bool> said_;
    Clock::time_point start_ = Clock::now();
};

}  // namespace lostbits::output::file
