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
