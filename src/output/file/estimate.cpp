#include "output/file/estimate.hpp"

#include <fmt/format.h>

namespace lostbits::output::file {

std::optional<std::string> estimate_text(std::string_view name, std::uint64_t done, std::uint64_t total,
                                         double elapsed_s) {
    if (done == 0 || done >= total || elapsed_s < first_piece_s) return {};
    const double part = static_cast<double>(done) / static_cast<double>(total), whole = elapsed_s / part;
    if (whole < long_run_s) return {};
    return fmt::format("lostbits: {} will take about {}: its first {:.2g} % took {}", name, duration_text(whole),
                       100 * part, duration_text(elapsed_s));
}

void Estimate::advance(std::uint64_t n) {
    const std::uint64_t done = done_.fetch_add(n) + n;
    if (said_) return;
    const double elapsed = std::chrono::duration<double>(Clock::now() - start_).count();
    // One look is enough: after the first piece a short run stays short.
    if (elapsed < first_piece_s || said_.exchange(true)) return;
    if (const auto text = estimate_text(name_, done, total_, elapsed)) progress_.say(*text);
}

}  // namespace lostbits::output::file
