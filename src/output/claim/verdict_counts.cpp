#include "output/claim/verdict_counts.hpp"

#include <fmt/format.h>

namespace lostbits::output::claim {

using measure::claim::ClaimResult;
using scene::claim::Claim;

void VerdictCounts::add(const Claim& claim, const ClaimResult& result) {
    switch (result.state) {
        case ClaimResult::State::agrees: break;
        case ClaimResult::State::disagrees: ++differing; return;
        case ClaimResult::State::broken: ++broken; return;
        case ClaimResult::State::skipped: ++skipped; return;
    }
    with_criterion += claim.criterion.has_value();
    switch (claim.verdict) {
        case Claim::Verdict::holds: ++held; break;
        case Claim::Verdict::qualified: ++qualified; break;
        case Claim::Verdict::refuted: ++refuted; break;
    }
}

std::string VerdictCounts::text() const {
    std::string text;
    const auto add = [&text](std::size_t n, const char* one, const char* several) {
        if (n > 0) text += fmt::format("{}{} {}", text.empty() ? "" : ", ", n, n == 1 ? one : several);
    };
    add(held, "holds", "hold");
    add(qualified, "is qualified", "are qualified");
    add(refuted, "is refuted", "are refuted");
    return text.empty() ? "none" : text;
}

std::string CountsBySource::text() const {
    std::string text;
    if (sourced.confirmed() > 0) text = "from a source " + sourced.text();
    if (own.confirmed() > 0) text += (text.empty() ? "" : "; ") + ("of our own " + own.text());
    return text.empty() ? "no verdict is confirmed" : text;
}

CountsBySource count_verdicts(const std::vector<Claim>& claims, const std::vector<ClaimResult>& results) {
    CountsBySource counts;
    for (std::size_t i = 0; i < claims.size(); ++i) {
        counts.all.add(claims[i], results[i]);
        (claims[i].is_sourced() ? counts.sourced : counts.own).add(claims[i], results[i]);
    }
    return counts;
}

}  // namespace lostbits::output::claim
