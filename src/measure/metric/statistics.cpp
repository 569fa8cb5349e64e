#include "measure/metric/statistics.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <numeric>
#include <stdexcept>
#include <utility>
#include <vector>

#include "measure/columns/columns.hpp"
#include "measure/truth/missing.hpp"

namespace lostbits::measure::metric {

void ExactTotal::add(double x) {
    if (x == 0) return;

    // |x| = significand·2^(position − 1074)
    const auto bits = std::bit_cast<std::uint64_t>(x);
    const auto exponent = static_cast<unsigned>(bits >> 52 & 0x7ff);
    const std::uint64_t fraction = bits & ((std::uint64_t{1} << 52) - 1);
    const std::uint64_t significand = exponent == 0 ? fraction : fraction | std::uint64_t{1} << 52;
    const unsigned position = exponent == 0 ? 0 : exponent - 1;

    // The shifted significand lies in three limbs.
    const unsigned shift = position % limb_bits;
    const std::uint64_t low = (significand & 0xffffffffU) << shift, high = (significand >> limb_bits) << shift;
    const std::uint64_t parts[3] = {low & 0xffffffffU, (low >> limb_bits) + (high & 0xffffffffU), high >> limb_bits};
    for (std::size_t i = 0; i < 3; ++i) {
        std::int64_t& limb = limbs_[position / limb_bits + i];
        limb += x < 0 ? -static_cast<std::int64_t>(parts[i]) : static_cast<std::int64_t>(parts[i]);
    }
    if (++pending_terms_ == max_pending_terms) normalise();
}

void ExactTotal::add(const ExactTotal& other) {
    ExactTotal normalised = other;
    normalised.normalise();
    normalise();
    for (std::size_t i = 0; i < limbs_.size(); ++i) limbs_[i] += normalised.limbs_[i];
    ++pending_terms_;
}

void ExactTotal::normalise() {
    for (std::size_t i = 0; i + 1 < limbs_.size(); ++i) {
        limbs_[i + 1] += limbs_[i] >> limb_bits;  // the shift rounds down, so the remaining low bits are not negative
        limbs_[i] &= 0xffffffff;
    }
    pending_terms_ = 0;
}

double ExactTotal::divided_by(std::uint64_t n) const {
    ExactTotal normalised = *this;
    normalised.normalise();
    const auto& limbs = normalised.limbs_;
    std::size_t top = limbs.size() - 1;
    while (top > 0 && limbs[top] == 0) --top;

    // Everything is in units of the top limb. Five limbs have at least 129 bits, more than two doubles.
    DoubleDouble sum{0, 0};
    for (std::size_t i = 0; i < 5 && i <= top; ++i) {
        const double term = std::ldexp(static_cast<double>(limbs[top - i]), -limb_bits * static_cast<int>(i));
        const DoubleDouble s = two_sum(sum.hi, term);
        sum = quick_two_sum(s.hi, s.lo + sum.lo);
    }

    const auto count = static_cast<double>(n);
    const double mean = sum.hi / count;
    return std::ldexp(mean + (quotient_residual(sum.hi, count, mean) + sum.lo) / count,
                      limb_bits * static_cast<int>(top) - 1074);
}

void AbsoluteMean::add(std::span<const double> values) {
    const std::uint64_t beyond_before = sums_.beyond;
    columns::add_absolute_values(values, sums_);
    for (std::size_t lane = 0; lane < columns::max_lanes; ++lane) {
        total_.add(std::exchange(sums_.hi[lane], 0));
        total_.add(std::exchange(sums_.lo[lane], 0));
    }
    if (sums_.beyond == beyond_before) return;
    for (const double x : values) {
        if (std::fabs(x) > columns::largest_summed && !std::isinf(x)) total_.add(std::fabs(x));
    }
}

void AbsoluteMean::add(const AbsoluteMean& other) {
    total_.add(other.total_);
    sums_.largest = std::max(sums_.largest, other.sums_.largest);
    sums_.count += other.sums_.count;
    sums_.zeros += other.sums_.zeros;
    sums_.beyond += other.sums_.beyond;
}

double AbsoluteMean::mean() const {
    if (sums_.count == 0) return truth::missing;
    return std::isinf(sums_.largest) ? sums_.largest : total_.divided_by(sums_.count);
}

void QuantileHistogram::add(std::span<const double> values) {
    for (const double x : values) {
        if (x != x) continue;  // rays without a value lie side by side, so this branch is cheap
        const auto bits = std::bit_cast<std::uint64_t>(x);
        auto& binade = binades_[bits >> 52 & 0x7ff];
        if (!binade) [[unlikely]]
            binade = std::make_unique<Binade>();
        if (++(*binade)[bits >> 42 & (buckets_per_binade - 1)] == 0) [[unlikely]]
            ++carries_[static_cast<std::uint32_t>(bits >> 42 & (binades_.size() * buckets_per_binade - 1))];
    }
}

std::uint64_t QuantileHistogram::bucket_count(std::uint32_t index) const {
    const auto& binade = binades_[index / buckets_per_binade];
    if (!binade) return 0;
    const std::uint64_t low = (*binade)[index % buckets_per_binade];
    if (carries_.empty()) return low;
    const auto carry = carries_.find(index);
    return carry == carries_.end() ? low : std::uint64_t{carry->second} << 32 | low;
}

void QuantileHistogram::set_bucket(std::uint32_t index, std::uint64_t sample_count) {
    auto& binade = binades_.at(index / buckets_per_binade);
    if (!binade) binade = std::make_unique<Binade>();
    (*binade)[index % buckets_per_binade] = static_cast<std::uint32_t>(sample_count);
    if (sample_count >> 32 != 0) carries_[index] = static_cast<std::uint32_t>(sample_count >> 32);
}

void QuantileHistogram::add(const QuantileHistogram& other) {
    // Reads all of `other` before it writes, because `other` may be this object.
    std::vector<std::uint32_t> indices;
    std::vector<std::uint64_t> counts;
    other.list_buckets(indices, counts);
    for (std::size_t k = 0; k < indices.size(); ++k) set_bucket(indices[k], bucket_count(indices[k]) + counts[k]);
}

void QuantileHistogram::list_buckets(std::vector<std::uint32_t>& indices, std::vector<std::uint64_t>& counts) const {
    for (std::uint32_t b = 0; b < binades_.size(); ++b) {
        for (std::uint32_t i = 0; binades_[b] && i < buckets_per_binade; ++i) {
            const std::uint64_t sample_count = bucket_count(b * buckets_per_binade + i);
            if (sample_count == 0) continue;
            indices.push_back(b * buckets_per_binade + i);
            counts.push_back(sample_count);
        }
    }
}

void QuantileHistogram::set_buckets(const std::vector<std::uint32_t>& indices,
                                    const std::vector<std::uint64_t>& counts) {
    for (std::size_t k = 0; k < indices.size(); ++k) set_bucket(indices[k], counts.at(k));
}

double QuantileHistogram::at(double q, const AbsoluteMean& absolute_mean) const {
    if (absolute_mean.count() == 0) return truth::missing;
    const auto rank = static_cast<std::uint64_t>(std::ceil(q * static_cast<double>(absolute_mean.count())));
    if (rank >= absolute_mean.count()) return absolute_mean.largest();
    std::uint64_t cumulative_count = absolute_mean.zeros();
    if (rank <= cumulative_count) return 0;

    for (std::uint32_t b = 0; b < binades_.size(); ++b) {
        if (!binades_[b]) continue;

        // Skips a binade below the rank as a whole. Binade 0 has the zeros, which are counted already.
        if (b > 0 && carries_.empty()) {
            const std::uint64_t binade_count =
                std::accumulate(binades_[b]->begin(), binades_[b]->end(), std::uint64_t{0});
            if (rank > cumulative_count + binade_count) {
                cumulative_count += binade_count;
                continue;
            }
        }
        for (std::uint32_t i = 0; i < buckets_per_binade; ++i) {
            // Finds the bucket that has the rank, and returns its middle.
            const std::uint32_t index = b * buckets_per_binade + i;
            cumulative_count += bucket_count(index) - (index == 0 ? absolute_mean.zeros() : 0);
            if (rank > cumulative_count) continue;
            const auto low_bits = std::uint64_t{index} << 42;
            const double low = std::bit_cast<double>(low_bits);
            const double middle = std::bit_cast<double>(low_bits | std::uint64_t{1} << 41);
            return std::isinf(low) ? low : std::min(middle, absolute_mean.largest());
        }
    }
    return absolute_mean.largest();
}

Ranks ranks_around(double q, std::uint64_t n) {
    // P(K = k)/P(K = k - 1) = (n - k + 1)/k q/(1 - q), from the likeliest k in both directions until the rest is
    // negligible.
    const double odds = q / (1 - q), samples = static_cast<double>(n);
    constexpr double negligible = 1e-20;
    const auto likeliest = static_cast<std::uint64_t>(std::min(samples, std::floor((samples + 1) * q)));
    std::vector<double> below, above{1};
    double p = 1;
    for (std::uint64_t k = likeliest; k > 0 && p > negligible; --k) {
        p *= static_cast<double>(k) / ((samples - static_cast<double>(k) + 1) * odds);
        below.push_back(p);
    }
    p = 1;
    for (std::uint64_t k = likeliest + 1; k <= n && p > negligible; ++k) {
        p *= (samples - static_cast<double>(k) + 1) / static_cast<double>(k) * odds;
        above.push_back(p);
    }

    // Lists the probabilities of all k that matter, in rising order.
    const double total =
        std::accumulate(below.begin(), below.end(), 0.0) + std::accumulate(above.begin(), above.end(), 0.0);
    std::ranges::reverse(below);
    below.insert(below.end(), above.begin(), above.end());
    const std::uint64_t first = likeliest - (below.size() - above.size());

    // Moves each rank inwards as long as at most 2.5 % of the probability lies outside it.
    Ranks ranks{first, n + 1};
    double sum = 0;  // P(K <= k), times the total
    for (std::size_t i = 0; i < below.size(); ++i) {
        sum += below[i];
        const std::uint64_t next = first + i + 1;
        if (sum <= 0.025 * total) ranks.low = next;
        if (sum >= 0.975 * total) {
            ranks.high = next;
            break;
        }
    }
    return ranks;
}

void Distribution::add(std::span<const double> values) {
    if (!unsealed_) {
        if (std::ranges::all_of(values, [](double x) { return std::isnan(x); })) return;
        unsealed_ = std::make_unique<UnsealedState>();
    }
    unsealed_->absolute_mean.add(values);
    unsealed_->histogram.add(values);
    count_ = unsealed_->absolute_mean.count();
}

void Distribution::add(const Distribution& other) {
    if (other.count_ == 0) return;
    if (!other.unsealed_ || (!unsealed_ && count_ > 0))
        throw std::logic_error(
            "a sealed distribution cannot be added to another one, and no other one can be added to it");
    if (!unsealed_) unsealed_ = std::make_unique<UnsealedState>();
    unsealed_->absolute_mean.add(other.unsealed_->absolute_mean);
    unsealed_->histogram.add(other.unsealed_->histogram);
    count_ = unsealed_->absolute_mean.count();
}

double Distribution::mean() const {
    if (count_ == 0) return truth::missing;
    return unsealed_ ? unsealed_->absolute_mean.mean() : sealed_mean_;
}

double Distribution::quantile(double q) const {
    if (count_ == 0) return truth::missing;
    if (unsealed_) return unsealed_->histogram.at(q, unsealed_->absolute_mean);
    const auto found = std::ranges::find(quantile_statistics, q, &Statistic::q);
    if (found == quantile_statistics.end())
        throw std::logic_error("a sealed distribution has only the quantiles that tables show");
    return sealed_quantiles_[found - quantile_statistics.begin()];
}

Bounds Distribution::p99_bounds() const {
    if (count_ == 0) return {truth::missing, truth::missing};
    if (!unsealed_) return sealed_bounds_;
    const Ranks ranks = ranks_around(0.99, count_);
    const auto sample = [this](std::uint64_t rank) {
        return quantile((static_cast<double>(rank) - 0.5) / static_cast<double>(count_));
    };
    return {ranks.low == 0 ? 0 : sample(ranks.low), ranks.high > count_ ? HUGE_VAL : sample(ranks.high)};
}

void Distribution::seal() {
    if (!unsealed_) return;
    sealed_bounds_ = p99_bounds();
    for (std::size_t i = 0; i < sealed_quantiles_.size(); ++i)
        sealed_quantiles_[i] = quantile(quantile_statistics[i].q);
    sealed_mean_ = mean();
    unsealed_.reset();
}

}  // namespace lostbits::measure::metric
