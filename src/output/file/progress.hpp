// Progress of a long run on stderr: a bar that is erased at the end, and an estimate of the duration, which is printed
// once after the first part of the run.
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

    /// `total` is the number of units of work. `quiet` (-q) overrides `mode`. `fd` is stderr, except in tests.
    Progress(std::uint64_t total, std::string label, Mode mode = Mode::automatic, bool quiet = false, int fd = 2);
    ~Progress();
    Progress(const Progress&) = delete;
    Progress& operator=(const Progress&) = delete;

    /// Adds `n` finished units. Any thread may call this function. It draws at most ten times a second.
    void advance(std::uint64_t n = 1) noexcept;

    /// Prints a message on a line of its own on stderr, above the bar.
    void print_line(std::string_view message);

    /// Erases the bar and calls `print`, so that the printed lines do not mix with the bar. The next `advance` draws
    /// the bar again.
    template <class Print>
    void print_without_bar(const Print& print) {
        const std::lock_guard lock(mutex_);
        erase();
        print();
        std::fflush(stdout);
    }

    /// Erases the bar. Nothing is drawn after this call.
    void finish() noexcept;

    [[nodiscard]] std::uint64_t done() const noexcept { return done_.load(); }

private:
    using Clock = std::chrono::steady_clock;
    void draw();
    void erase();
    void write_raw(std::string_view text) noexcept;

    std::uint64_t total_;
    std::string label_;
    int fd_;
    std::atomic<bool> is_visible_;
    bool has_colour_;
    Clock::time_point start_ = Clock::now();
    std::atomic<std::uint64_t> done_{0};
    std::atomic<std::int64_t> next_draw_ms_;
    std::mutex mutex_;  // guards the state of the screen
    std::size_t drawn_length_ = 0;
};

/// Text of the bar, at most `columns` characters: label, bar, percent, elapsed and remaining time (`?` while the
/// remaining time is unknown).
[[nodiscard]] std::string progress_line(std::string_view label, std::uint64_t done, std::uint64_t total,
                                        double elapsed_s, int columns);

/// A duration as `7s`, `2m05s` or `1h03m`.
[[nodiscard]] std::string duration_text(double seconds);

/// Seconds for which a run is watched before its duration is estimated. They begin when the first units are finished,
/// because the time before includes the start of the run.
inline constexpr double estimate_window_s = 2;
/// Shortest duration, in seconds, for which an estimate is printed. A shorter run would end before anybody reads it.
inline constexpr double long_run_s = 30;

/// Number of units that were finished `seconds` after the start of the run.
struct ProgressPoint {
    std::uint64_t units = 0;
    double seconds = 0;
};

/// Estimate as text: `NAME will take about 3m20s: its first 1 % took 2s`. Nothing if the run was watched for less than
/// `estimate_window_s`, or if all `total` units would take less than `long_run_s`. Before the `first` units are
/// finished, a run starts up and finds the truth for all forms. It does so `starts` times: once per band of the picture
/// in a map.
[[nodiscard]] std::optional<std::string> estimate_text(std::string_view name, const ProgressPoint& first,
                                                       const ProgressPoint& now, std::uint64_t total,
                                                       std::uint64_t starts = 1);

/// Watches a run and, if it is long, prints an estimate on stderr, above the bar.
class Estimate {
public:
    /// `total` is the number of units of work; the work before the first unit is done `starts` times. With `quiet`, an
    /// estimate prints nothing.
    Estimate(Progress& progress, std::string name, std::uint64_t total, bool quiet, std::uint64_t starts = 1)
        : progress_(progress), name_(std::move(name)), total_(total), starts_(starts), is_announced_(quiet) {}

    /// Adds `n` finished units. Any thread may call this function.
    void advance(std::uint64_t n);

private:
    using Clock = std::chrono::steady_clock;
    Progress& progress_;
    std::string name_;
    std::uint64_t total_, starts_;
    std::mutex mutex_;  ///< guards `first_` and `now_`
    ProgressPoint first_, now_;
    std::atomic<bool> is_announced_;
    Clock::time_point start_ = Clock::now();
};

}  // namespace lostbits::output::file
