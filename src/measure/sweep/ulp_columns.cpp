#include "measure/sweep/ulp_columns.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>

#include "measure/truth/lost_bits.hpp"

namespace lostbits::measure::sweep {

using answer::Outcome;

namespace {

/// 1/ulp(t*) in binary32 for t* = hi + lo ≥ 0, whose binade is proved: 2^(23 − max(⌊log2 t*⌋, −126)). Where hi is a
/// power of two and lo < 0, t* lies below it, and so does the double before hi. In operations that every width of
/// register has.
double per_ulp(double hi, double lo) {
    constexpr double smallest_normal = 0x1p-126;
    const auto below = std::bit_cast<double>(std::bit_cast<std::uint64_t>(hi) - (lo < 0 ? 1U : 0U));
    const double size = below > smallest_normal ? below : smallest_normal;
    constexpr std::uint64_t exponent = 0x7ff0000000000000U, sum = std::uint64_t{2 * 1023 + 23} << 52;
    return std::bit_cast<double>(sum - (std::bit_cast<std::uint64_t>(size) & exponent));
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

/// In eight parts, which registers can hold side by side.
double largest(const std::vector<double>& x) {
    constexpr std::size_t parts = 8;
    std::array<double, parts> most{};
    most.fill(-1);
    std::size_t i = 0;
    for (; i + parts <= x.size(); i += parts) {
        for (std::size_t k = 0; k < parts; ++k) most[k] = x[i + k] > most[k] ? x[i + k] : most[k];
    }
    for (; i < x.size(); ++i) most[0] = std::max(most[0], x[i]);
    return std::ranges::max(most);
}

}  // namespace

/// Into `outcome_`; counted. Most often all floats of a chunk have the same.
void UlpColumns::classify(std::span<const std::uint8_t> hit, const truth::TruthColumns& truth) {
    static const auto table = outcome_table();
    const std::size_t n = t_.size();
    // Local pointers: a store of bytes could reach the vectors themselves, and the loop would stay one float at a time.
    const auto* const decision = truth.decision.data();
    const std::uint8_t* const hits = hit.data();
    const float* const t = t_.data();
    std::uint8_t* const kind = outcome_.data();
    static_assert(sizeof *decision == 1);
    for (std::size_t i = 0; i < n; ++i)
        kind[i] = static_cast<std::uint8_t>(4 * static_cast<unsigned>(decision[i]) + 2U * (hits[i] != 0));
    for (std::size_t i = 0; i < n; ++i) kind[i] = static_cast<std::uint8_t>(kind[i] + (t[i] != t[i] ? 1 : 0));
    counts_ = {};
    if (std::memcmp(outcome_.data(), outcome_.data() + 1, n - 1) == 0) {
        counts_[table[outcome_[0]]] = n;
        std::ranges::fill(outcome_, table[outcome_[0]]);
        return;
    }
    for (std::size_t i = 0; i < n; ++i) {
        outcome_[i] = table[outcome_[i]];
        ++counts_[outcome_[i]];
    }
}

void UlpColumns::compare(std::span<const float> t, std::span<const std::uint8_t> hit,
                         const truth::TruthColumns& truth) {
    const std::size_t n = t.size();
    t_ = t;
    outcome_.resize(n);
    low_.resize(n);
    high_.resize(n);
    classify(hit, truth);
    most_low_ = most_high_ = -1;
    if (counts_[static_cast<std::size_t>(Outcome::agree_hit)] == 0) {
        std::ranges::fill(low_, -1.0);
        std::ranges::fill(high_, -1.0);
        return;
    }
    constexpr auto both_hit = static_cast<std::uint8_t>(Outcome::agree_hit);
    const double *const hi = truth.hi.data(), *const lo = truth.lo.data(), *const bound = truth.bound.data();
    const float* const answer = t.data();
    double *const low = low_.data(), *const high = high_.data();
    for (std::size_t i = 0; i < n; ++i) {
        const Between b = between(answer[i], hi[i], lo[i], bound[i]);
        low[i] = b.low;
        high[i] = b.high;
    }
    if (counts_[both_hit] < n) {
        for (std::size_t i = 0; i < n; ++i) {
            if (outcome_[i] != both_hit) low[i] = high[i] = -1;
        }
    }
    // The columns do not hold a length beyond 2^±900.
    for (const auto& [i, alone] : truth.alone) {
        if (outcome_[i] != both_hit || !std::isnan(truth.hi[i])) continue;
        const auto& length = terms_.length == truth::Length::parameter ? alone.t : alone.distance;
        settle(i, truth::ulp_error(static_cast<double>(t[i]), length, binary32));
    }
    most_low_ = largest(low_);
    most_high_ = largest(high_);
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
