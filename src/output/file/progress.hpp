// How far a long run is: one line on stderr that goes away; and how long it will take, said once, by what its own first
// piece took.
#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>
#include <cstdio>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>

namespace lostbits::output::file {

/// A progress bar on stderr with elapsed and remaining time.
class Progress {
public:
    /// `automatic` draws on a terminal only (and not on TERM=dumb), `bar` always, `none` never.
    enum class Mode { automatic, bar, none };

    /// `total` is the number of units to come; `quiet` (-q) wins over `mode`. `fd` is stderr but in tests.
    Progress(std::uint64_t total, std::string label, Mode mode = Mode::automatic, bool quiet = false, int fd = 2);
    ~Progress();
    Progress(const Progress&) = delete;
    Progress& operator=(const Progress&) = delete;

    /// `n` more units are done. From any thread; draws ten times a second at most.
    void advance(std::uint64_t n = 1) noexcept;

    /// A message on a line of its own on stderr, above the bar.
    void say(std::string_view message);

    /// Erases the bar and calls `print`, whose lines then stand by themselves; the next `advance` draws it again.
    template <class Print>
    void aside(const Print& print) {
        const std::lock_guard lock(mutex_);
        erase();
        print();
        std::fflush(stdout);
    }

    /// Erases the bar. Nothing is drawn after it.
    void finish() noexcept;

    [[nodiscard]] std::uint64_t done() const noexcept { return done_.load(); }

private:
    using Clock = std::chrono::steady_clock;
    void draw();
    void erase();
    void put(std::string_view text) noexcept;

    std::uint64_t total_;
    std::string label_;
    int fd_;
    std::atomic<bool> visible_;
    bool colour_;
    Clock::time_point start_ = Clock::now();
    std::atomic<std::uint64_t> done_{0};
    std::atomic<std::int64_t> next_draw_ms_;
    std::mutex mutex_;  // of what is on the screen
    std::size_t drawn_ = 0;
};

/// The text of the bar, `columns` characters at most: label, bar, percent, elapsed, remaining (`?` before anything is
/// known).
[[nodiscard]] std::string progress_line(std::string_view label, std::uint64_t done, std::uint64_t total,
                                        double elapsed_s, int columns);

/// A duration as `7s`, `2m05s` or `1h03m`.
[[nodiscard]] std::string duration_text(double seconds);

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
