#include "measure/sweep/ulp_columns.hpp"

#include <algorithm>
#include <bit>
#include <cmath>

#include "measure/truth/lost_bits.hpp"

namespace lostbits::measure::sweep {

using answer::Outcome;

namespace {

/// 1/ulp(t*) in binary32 for t* = hi + lo ≥ 0, whose binade is proved: 2^(23 − max(⌊log2 t*⌋, −126)). Where hi is a
/// power of two and lo < 0, t* lies below it, and so does the double before hi.
double per_ulp(double hi, double lo) {
    const std::uint64_t bits = std::bit_cast<std::uint64_t>(hi) - (lo < 0 ? 1 : 0);
    const std::uint64_t exponent = std::max<std::uint64_t>(bits >> 52, 1023 - 126);
    return std::bit_cast<double>((2046 + 23 - exponent) << 52);
}

struct Between {
    double low, high;
};

/// |t − t*|/ulp(t*) where |t* − (hi + lo)| ≤ bound. t − hi is rounded once, and so is the difference with lo, each to
/// 2^-53 of itself; where they cancel, t − hi is exact. 2^-50 covers both, and the product with the bound.
Between between(float t, double hi, double lo, double bound) {
    const double scale = per_ulp(hi, lo);
    const double size = std::fabs((static_cast<double>(t) - hi) - lo) * scale;
    const double aside = bound * scale;
    return {size * (1 - 0x1p-50) - aside * (1 + 0x1p-50), (size + aside) * (1 + 0x1p-50)};
}

/// The outcome by decision (miss, hit, unresolved), the form's hit and NaN in its t: as `classify` has it.
constexpr std::size_t outcome_kinds = 12;
std::array<std::uint8_t, outcome_kinds> outcome_table() {
    std::array<std::uint8_t, outcome_kinds> table{};
    for (std::size_t k = 0; k < outcome_kinds; ++k) {
        const auto decision = static_cast<truth::Truth::Decision>(k / 4);
        table[k] = static_cast<std::uint8_t>(answer::classify(decision, (k & 2) != 0, (k & 1) != 0 ? NAN : 0));
    }
    return table;
}

}  // namespace

void UlpColumns::compare(std::span<const float> t, std::span<const std::uint8_t> hit,
                         const truth::TruthColumns& truth) {
    static const auto table = outcome_table();
    const std::size_t n = t.size();
    t_ = t;
    outcome_.resize(n);
    low_.resize(n);
    high_.resize(n);
    for (std::size_t i = 0; i < n; ++i) {
        outcome_[i] = static_cast<std::uint8_t>(static_cast<std::uint8_t>(truth.decision[i]) * 4 + (hit[i] != 0) * 2 +
                                                (t[i] != t[i]));
    }
    counts_ = {};
    for (std::size_t k = 0; k < outcome_kinds; ++k) {
        counts_[table[k]] += static_cast<std::uint64_t>(std::ranges::count(outcome_, static_cast<std::uint8_t>(k)));
    }
    for (std::size_t i = 0; i < n; ++i) outcome_[i] = table[outcome_[i]];
    most_low_ = most_high_ = -1;
    if (counts_[static_cast<std::size_t>(Outcome::agree_hit)] == 0) {
        std::ranges::fill(low_, -1.0);
        std::ranges::fill(high_, -1.0);
        return;
    }
    constexpr auto both_hit = static_cast<std::uint8_t>(Outcome::agree_hit);
    for (std::size_t i = 0; i < n; ++i) {
        const Between b = between(t[i], truth.hi[i], truth.lo[i], truth.bound[i]);
        const bool counts = outcome_[i] == both_hit;
        low_[i] = counts ? b.low : -1;
        high_[i] = counts ? b.high : -1;
        most_low_ = low_[i] > most_low_ ? low_[i] : most_low_;
        most_high_ = high_[i] > most_high_ ? high_[i] : most_high_;
    }
    // The columns do not hold a length beyond 2^±900, and no bound is right for an infinite answer.
    for (const auto& [i, alone] : truth.alone) {
        if (outcome_[i] != both_hit || !std::isnan(truth.hi[i])) continue;
        const auto& length = terms_.length == truth::Length::parameter ? alone.t : alone.distance;
        settle(i, truth::ulp_error(static_cast<double>(t[i]), length, binary32));
        most_low_ = std::max(most_low_, low_[i]);
        most_high_ = std::max(most_high_, high_[i]);
    }
}

void UlpColumns::settle(std::size_t i, double ulps) { low_[i] = high_[i] = std::fabs(ulps); }

void UlpColumns::refine(std::span<const std::size_t> places) {
    std::vector<float> values(places.size());
    std::ranges::transform(places, values.begin(), [&](std::size_t i) { return columns_.values()[i]; });
    truth::ColumnTerms terms = terms_;
    terms.tightness = truth::Tightness::certified;
    find_truth_columns(columns_.problems(values), terms, closer_);
    for (std::size_t k = 0; k < places.size(); ++k) {
        const std::size_t i = places[k];
        if (std::isnan(closer_.hi[k]) || std::isinf(t_[i])) continue;
        const Between b = between(t_[i], closer_.hi[k], closer_.lo[k], closer_.bound[k]);
        low_[i] = b.low;
        high_[i] = b.high;
    }
}

double UlpColumns::exact(std::size_t i) {
    const truth::Truth truth = columns_.find_truth(i, terms_);
    const auto& length = terms_.length == truth::Length::parameter ? truth.t : truth.distance;
    const double ulps = truth::ulp_error(static_cast<double>(t_[i]), length, binary32);
    settle(i, ulps);
    return ulps;
}

}  // namespace lostbits::measure::sweep
