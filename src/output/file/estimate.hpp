// How long a long run will take, said once, by what its own first piece took.
#pragma once

#include <atomic>
#include <chrono>
#include <optional>
#include <string>
#include <string_view>

#include "output/file/progress.hpp"

namespace lostbits::output::file {

/// Seconds of a first piece: shorter ones are mostly start-up.
inline constexpr double first_piece_s = 2;
/// Seconds of a run that is long: a shorter one is over before its estimate is read.
inline constexpr double long_run_s = 30;

/// `NAME will take about 3m20s: 1 % took 2s`; nothing before so many units took `first_piece_s`, nor where all of them
/// would take less than `long_run_s`.
[[nodiscard]] std::optional<std::string> estimate_text(std::string_view name, std::uint64_t done, std::uint64_t total,
                                                       double elapsed_s);

/// Watches a run; says its estimate on stderr, above the bar, where it is long.
class Estimate {
public:
    /// `total` units are to come. `quiet`: says nothing.
    Estimate(Progress& progress, std::string name, std::uint64_t total, bool quiet)
        : progress_(progress), name_(std::move(name)), total_(total), said_(quiet) {}

    /// `n` more units are done. From any thread.
    void advance(std::uint64_t n);

private:
    using Clock = std::chrono::steady_clock;
    Progress& progress_;
    std::string name_;
    std::uint64_t total_;
    std::atomic<std::uint64_t> done_{0};
    std::atomic<bool> said_;
    Clock::time_point start_ = Clock::now();
};

}  // namespace lostbits::output::file
