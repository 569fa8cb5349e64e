#include "output/file/progress.hpp"

#include <fmt/format.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>

#include "intersect/process/process_state.hpp"

namespace lostbits::output::file {
namespace {

constexpr std::int64_t first_draw_ms = 200;  // a run shorter than this shows nothing
constexpr std::int64_t redraw_ms = 100;

bool is_environment_set(const char* name) {
    const char* value = intersect::process::own_environment(name);
    return value != nullptr && *value != '\0';
}

bool is_terminal(int fd) {
    const char* term = intersect::process::own_environment("TERM");
    return ::isatty(fd) == 1 && !(term != nullptr && std::string_view(term) == "dumb");
}

int terminal_columns(int fd) {
    winsize size{};
    if (::ioctl(fd, TIOCGWINSZ, &size) == 0 && size.ws_col > 0) return size.ws_col;
    return 80;
}

}  // namespace

std::string duration_text(double seconds) {
    if (!(seconds >= 0) || seconds > 1e7) return "?";
    const auto s = static_cast<std::int64_t>(std::llround(seconds));
    if (s < 60) return fmt::format("{}s", s);
    if (s < 3600) return fmt::format("{}m{:02}s", s / 60, s % 60);
    return fmt::format("{}h{:02}m", s / 3600, s / 60 % 60);
}

std::string progress_line(std::string_view label, std::uint64_t done, std::uint64_t total, double elapsed_s,
                          int columns) {
    const double fraction = total == 0 ? 0.0 : std::min(1.0, static_cast<double>(done) / static_cast<double>(total));
    const std::string remaining = fraction > 0 ? duration_text(elapsed_s / fraction - elapsed_s) : "?";
    const std::string tail = fmt::format(" {:3}%  {} elapsed, {} left", static_cast<int>(fraction * 100),
                                         duration_text(elapsed_s), remaining);

    const int space = columns - 1 - static_cast<int>(label.size() + tail.size()) - 3;  // the last column wraps
    std::string line(label);
    if (space >= 5) {
        const int length = std::min(space, 40);
        const int filled = static_cast<int>(fraction * length);
        line += " [" + std::string(static_cast<std::size_t>(filled), '#') +
                std::string(static_cast<std::size_t>(length - filled), '.') + "]";
    }
    line += tail;
    return line.substr(0, static_cast<std::size_t>(std::max(columns - 1, 0)));
}

Progress::Progress(std::uint64_t total, std::string label, Mode mode, bool quiet, int fd)
    : total_(total),
      label_(std::move(label)),
      fd_(fd),
      is_visible_(!quiet && (mode == Mode::bar || (mode == Mode::automatic && is_terminal(fd)))),
      has_colour_(is_terminal(fd) && !is_environment_set("NO_COLOR")),
      next_draw_ms_(mode == Mode::bar ? 0 : first_draw_ms) {}

Progress::~Progress() { finish(); }

void Progress::advance(std::uint64_t n) noexcept {
    done_.fetch_add(n);
    if (!is_visible_) return;
    const auto now_ms = std::chrono::duration_cast<std::chrono::milliseconds>(Clock::now() - start_).count();
    std::int64_t due_ms = next_draw_ms_.load();
    if (now_ms < due_ms || !next_draw_ms_.compare_exchange_strong(due_ms, now_ms + redraw_ms)) return;
    try {
        const std::lock_guard lock(mutex_);
        draw();
    } catch (...) {
        // The work goes on if the bar cannot be drawn.
    }
}

void Progress::draw() {
    if (!is_visible_) return;
    const double elapsed = std::chrono::duration<double>(Clock::now() - start_).count();
    const std::string line = progress_line(label_, done_.load(), total_, elapsed, terminal_columns(fd_));
    std::string text = "\r" + line;
    if (line.size() < drawn_length_) text.append(drawn_length_ - line.size(), ' ');
    drawn_length_ = std::max(drawn_length_, line.size());

    // The filled part of the bar is green.
    if (has_colour_) {
        const auto bar_start = text.find('['), filled_end = text.find_last_of('#');
        if (bar_start != std::string::npos && filled_end != std::string::npos && filled_end > bar_start) {
            text.insert(filled_end + 1, "\x1b[0m");
            text.insert(bar_start + 1, "\x1b[32m");
        }
    }
    write_raw(text);
}

void Progress::erase() {
    if (drawn_length_ == 0) return;
    std::string blank = "\r";
    blank.append(drawn_length_, ' ');
    write_raw(blank += '\r');
    drawn_length_ = 0;
}

void Progress::print_line(std::string_view message) {
    const std::lock_guard lock(mutex_);
    const bool was_drawn = drawn_length_ > 0;
    erase();
    write_raw(std::string(message) + "\n");
    if (was_drawn) draw();
}

void Progress::finish() noexcept {
    try {
        const std::lock_guard lock(mutex_);
        erase();
        is_visible_ = false;
    } catch (...) {}
}

void Progress::write_raw(std::string_view text) noexcept {
    while (!text.empty()) {
        const ssize_t n = ::write(fd_, text.data(), text.size());
        if (n <= 0) return;
        text.remove_prefix(static_cast<std::size_t>(n));
    }
}

std::optional<std::string> estimate_text(std::string_view name, const ProgressPoint& first, const ProgressPoint& now,
                                         std::uint64_t total, std::uint64_t starts) {
    const double watched_seconds = now.seconds - first.seconds;
    if (now.units <= first.units || now.units >= total || watched_seconds < estimate_window_s) return {};
    const double seconds_per_unit = watched_seconds / static_cast<double>(now.units - first.units);
    const double total_seconds =
        first.seconds * static_cast<double>(starts) + seconds_per_unit * static_cast<double>(total - first.units);
    if (total_seconds < long_run_s) return {};
    return fmt::format("lostbits: {} will take about {}: its first {:.2g} % took {}", name,
                       duration_text(total_seconds), 100 * static_cast<double>(now.units) / static_cast<double>(total),
                       duration_text(now.seconds));
}

void Estimate::advance(std::uint64_t n) {
    if (is_announced_) return;
    const std::lock_guard lock(mutex_);
    now_ = {now_.units + n, std::chrono::duration<double>(Clock::now() - start_).count()};
    if (first_.units == 0) first_ = now_;
    // One estimate is enough: a run that is short after its first part stays short.
    if (now_.seconds - first_.seconds < estimate_window_s || is_announced_.exchange(true)) return;
    if (const auto text = estimate_text(name_, first_, now_, total_, starts_)) progress_.print_line(*text);
}

}  // namespace lostbits::output::file
