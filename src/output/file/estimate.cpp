#include "output/file/estimate.hpp"

#include <fmt/format.h>

namespace lostbits::output::file {

std::optional<std::string> estimate_text(std::string_view name, const Reached& first, const Reached& now,
                                         std::uint64_t total, std::uint64_t starts) {
    const double watched = now.seconds - first.seconds;
    if (now.units <= first.units || now.units >= total || watched < first_piece_s) return {};
    const double each = watched / static_cast<double>(now.units - first.units);
    const double whole = first.seconds * static_cast<double>(starts) + each * static_cast<double>(total - first.units);
    if (whole < long_run_s) return {};
    return fmt::format("lostbits: {} will take about {}: its first {:.2g} % took {}", name, duration_text(whole),
                       100 * static_cast<double>(now.units) / static_cast<double>(total), duration_text(now.seconds));
}

void Estimate::advance(std::uint64_t n) {
    if (said_) return;
    const std::lock_guard lock(mutex_);
    now_ = {now_.units + n, std::chrono::duration<double>(Clock::now() - start_).count()};
    if (first_.units == 0) first_ = now_;
    // One look is enough: after the first piece a short run stays short.
    if (now_.seconds - first_.seconds < first_piece_s || said_.exchange(true)) return;
    if (const auto text = estimate_text(name_, first_, now_, total_, starts_)) progress_.say(*text);
}

}  // namespace lostbits::output::file
