#include "measure/sweep/float_tally.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace lostbits::measure::sweep {

std::uint64_t FloatTally::floats() const { return std::accumulate(outcomes.begin(), outcomes.end(), std::uint64_t{0}); }

std::uint64_t FloatTally::wrong() const {
    std::uint64_t all = 0;
    for (const answer::Outcome o : answer::wrong_decisions) all += count(o);
    return all;
}

void FloatTally::add(std::uint32_t place, answer::Outcome outcome, double ulps) {
    const bool is_first = ++outcomes[static_cast<std::size_t>(outcome)] == 1, is_worse = std::fabs(ulps) > at_most;
    if (answer::is_wrong(outcome)) {
        if (!first_wrong) first_wrong = {place, outcome};
        last_wrong = {place, outcome};
    }
    if (is_worse) worst = {place, ulps}, at_most = std::fabs(ulps);
    if (!is_first && !is_worse) return;
    for (std::size_t e = 0; e < first_events.size(); ++e) {
        const auto& [event, bits] = first_events[e];
        if (!first[e] && (bits > 0 ? at_most >= std::exp2(bits - 1) : outcome == event)) first[e] = place;
    }
}

void FloatTally::append(const FloatTally& after) {
    for (std::size_t o = 0; o < outcomes.size(); ++o) outcomes[o] += after.outcomes[o];
    if (after.worst && (!worst || std::fabs(after.worst->ulps) > std::fabs(worst->ulps))) worst = after.worst;
    at_most = std::max(at_most, after.at_most);
    if (!first_wrong) first_wrong = after.first_wrong;
    if (after.last_wrong) last_wrong = after.last_wrong;
    for (std::size_t e = 0; e < first.size(); ++e) {
        if (!first[e]) first[e] = after.first[e];
    }
    if (after.padding && (!padding || after.padding->u > padding->u)) padding = after.padding;
}

}  // namespace lostbits::measure::sweep
