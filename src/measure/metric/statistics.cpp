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
    const auto word = std::bit_cast<std::uint64_t>(x);
    const auto exponent = static_cast<unsigned>(word >> 52 & 0x7ff);
    const std::uint64_t fraction = word & ((std::uint64_t{1} << 52) - 1);
    const std::uint64_t significand = exponent == 0 ? fraction : fraction | std::uint64_t{1} << 52;
    const unsigned place = exponent == 0 ? 0 : exponent - 1;  // |x| = significand·2^(place − 1074)
    const unsigned shift = place % limb_bits;
    const std::uint64_t low = (significand & 0xffffffffU) << shift, high = (significand >> limb_bits) << shift;
    const std::uint64_t parts[3] = {low & 0xffffffffU, (low >> limb_bits) + (high & 0xffffffffU), high >> limb_bits};
    for (std::size_t i = 0; i < 3; ++i) {
        std::int64_t& limb = limbs_[place / limb_bits + i];
        limb += x < 0 ? -static_cast<std::int64_t>(parts[i]) : static_cast<std::int64_t>(parts[i]);
    }
    if (++unsettled_ == most_unsettled) settle();
}

void ExactTotal::add(const ExactTotal& other) {
    ExactTotal settled = other;
    settled.settle();
    settle();
    for (std::size_t i = 0; i < limbs_.size(); ++i) limbs_[i] += settled.limbs_[i];
    ++unsettled_;
}

void ExactTotal::settle() {
    for (std::size_t i = 0; i + 1 < limbs_.size(); ++i) {
        limbs_[i + 1] += limbs_[i] >> limb_bits;  // rounds down, so the rest is not negative
        limbs_[i] &= 0xffffffff;
    }
    unsettled_ = 0;
}

double ExactTotal::over(std::uint64_t n) const {
    ExactTotal settled = *this;
    settled.settle();
    const auto& limbs = settled.limbs_;
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

void Sums::add(std::span<const double> values) {
    const std::uint64_t before = sizes_.beyond;
    columns::add_sizes(values, sizes_);
    for (std::size_t lane = 0; lane < columns::most_lanes; ++lane) {
        total_.add(std::exchange(sizes_.hi[lane], 0));
        total_.add(std::exchange(sizes_.lo[lane], 0));
    }
    if (sizes_.beyond == before) return;
    for (const double x : values) {
        if (std::fabs(x) > columns::largest_summed && !std::isinf(x)) total_.add(std::fabs(x));
    }
}

void Sums::add(const Sums& other) {
    total_.add(other.total_);
    sizes_.largest = std::max(sizes_.largest, other.sizes_.largest);
    sizes_.count += other.sizes_.count;
    sizes_.zeros += other.sizes_.zeros;
    sizes_.beyond += other.sizes_.beyond;
}

double Sums::mean() const {
    if (sizes_.count == 0) return truth::missing;
    return std::isinf(sizes_.largest) ? sizes_.largest : total_.over(sizes_.count);
}

void Quantiles::add(std::span<const double> values) {
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

std::uint64_t Quantiles::in_bucket(std::uint32_t place) const {
    const auto& binade = binades_[place / buckets_per_binade];
    if (!binade) return 0;
    const std::uint64_t low = (*binade)[place % buckets_per_binade];
    if (carries_.empty()) return low;
    const auto carry = carries_.find(place);
    return carry == carries_.end() ? low : std::uint64_t{carry->second} << 32 | low;
}

void Quantiles::set_bucket(std::uint32_t place, std::uint64_t samples) {
    auto& binade = binades_.at(place / buckets_per_binade);
    if (!binade) binade = std::make_unique<Binade>();
    (*binade)[place % buckets_per_binade] = static_cast<std::uint32_t>(samples);
    if (samples >> 32 != 0) carries_[place] = static_cast<std::uint32_t>(samples >> 32);
}

void Quantiles::add(const Quantiles& other) {
    // All of `other` is read before anything is written, because it may be this object.
    std::vector<std::uint32_t> places;
    std::vector<std::uint64_t> counts;
    other.filled(places, counts);
    for (std::size_t k = 0; k < places.size(); ++k) set_bucket(places[k], in_bucket(places[k]) + counts[k]);
}

void Quantiles::filled(std::vector<std::uint32_t>& places, std::vector<std::uint64_t>& counts) const {
    for (std::uint32_t b = 0; b < binades_.size(); ++b) {
        for (std::uint32_t i = 0; binades_[b] && i < buckets_per_binade; ++i) {
            const std::uint64_t samples = in_bucket(b * buckets_per_binade + i);
            if (samples == 0) continue;
            places.push_back(b * buckets_per_binade + i);
            counts.push_back(samples);
        }
    }
}

void Quantiles::fill(const std::vector<std::uint32_t>& places, const std::vector<std::uint64_t>& counts) {
    for (std::size_t k = 0; k < places.size(); ++k) set_bucket(places[k], counts.at(k));
}

double Quantiles::at(double q, const Sums& sums) const {
    if (sums.count() == 0) return truth::missing;
    const auto rank = static_cast<std::uint64_t>(std::ceil(q * static_cast<double>(sums.count())));
    if (rank >= sums.count()) return sums.largest();
    std::uint64_t seen = sums.zeros();
    if (rank <= seen) return 0;
    for (std::uint32_t b = 0; b < binades_.size(); ++b) {
        if (!binades_[b]) continue;
        if (b > 0 && carries_.empty()) {
            const std::uint64_t all = std::accumulate(binades_[b]->begin(), binades_[b]->end(), std::uint64_t{0});
            if (rank > seen + all) {
                seen += all;
                continue;
            }
        }
        for (std::uint32_t i = 0; i < buckets_per_binade; ++i) {
            const std::uint32_t place = b * buckets_per_binade + i;
            seen += in_bucket(place) - (place == 0 ? sums.zeros() : 0);
            if (rank > seen) continue;
            const auto low_bits = std::uint64_t{place} << 42;
            const double low = std::bit_cast<double>(low_bits);
            const double middle = std::bit_cast<double>(low_bits | std::uint64_t{1} << 41);
            return std::isinf(low) ? low : std::min(middle, sums.largest());
        }
    }
    return sums.largest();
}

Ranks ranks_around(double q, std::uint64_t n) {
    // P(K = k)/P(K = k - 1) = (n - k + 1)/k q/(1 - q), from the likeliest k in both directions until nothing is left.
    const double odds = q / (1 - q), samples = static_cast<double>(n);
    constexpr double nothing = 1e-20;
    const auto likeliest = static_cast<std::uint64_t>(std::min(samples, std::floor((samples + 1) * q)));
    std::vector<double> below, above{1};
    double p = 1;
    for (std::uint64_t k = likeliest; k > 0 && p > nothing; --k) {
        p *= static_cast<double>(k) / ((samples - static_cast<double>(k) + 1) * odds);
        below.push_back(p);
    }
    p = 1;
    for (std::uint64_t k = likeliest + 1; k <= n && p > nothing; ++k) {
        p *= (samples - static_cast<double>(k) + 1) / static_cast<double>(k) * odds;
        above.push_back(p);
    }
    const double all =
        std::accumulate(below.begin(), below.end(), 0.0) + std::accumulate(above.begin(), above.end(), 0.0);
    std::ranges::reverse(below);
    below.insert(below.end(), above.begin(), above.end());
    const std::uint64_t first = likeliest - (below.size() - above.size());
    Ranks ranks{first, n + 1};
    double sum = 0;  // P(K <= k) all
    for (std::size_t i = 0; i < below.size(); ++i) {
        sum += below[i];
        const std::uint64_t next = first + i + 1;
        if (sum <= 0.025 * all) ranks.low = next;
        if (sum >= 0.975 * all) {
            ranks.high = next;
            break;
        }
    }
    return ranks;
}

void Distribution::add(std::span<const double> values) {
    if (!open_) {
        if (std::ranges::all_of(values, [](double x) { return std::isnan(x); })) return;
        open_ = std::make_unique<Open>();
    }
    open_->sums.add(values);
    open_->quantiles.add(values);
    count_ = open_->sums.count();
}

void Distribution::add(const Distribution& other) {
    if (other.count_ == 0) return;
    if (!other.open_ || (!open_ && count_ > 0))
        throw std::logic_error("a sealed distribution cannot be added to another one, nor can one be added to it");
    if (!open_) open_ = std::make_unique<Open>();
    open_->sums.add(other.open_->sums);
    open_->quantiles.add(other.open_->quantiles);
    count_ = open_->sums.count();
}

double Distribution::mean() const {
    if (count_ == 0) return truth::missing;
    return open_ ? open_->sums.mean() : sealed_mean_;
}

double Distribution::quantile(double q) const {
    if (count_ == 0) return truth::missing;
    if (open_) return open_->quantiles.at(q, open_->sums);
    const auto kept = std::ranges::find(quantiles, q, &Statistic::q);
    if (kept == quantiles.end())
        throw std::logic_error("a sealed distribution has only the quantiles that tables show");
    return sealed_[static_cast<std::size_t>(kept - quantiles.begin())];
}

Bounds Distribution::p99_bounds() const {
    if (count_ == 0) return {truth::missing, truth::missing};
    if (!open_) return sealed_bounds_;
    const Ranks ranks = ranks_around(0.99, count_);
    const auto sample = [this](std::uint64_t rank) {
        return quantile((static_cast<double>(rank) - 0.5) / static_cast<double>(count_));
    };
    return {ranks.low == 0 ? 0 : sample(ranks.low), ranks.high > count_ ? HUGE_VAL : sample(ranks.high)};
}

void Distribution::seal() {
    if (!open_) return;
    sealed_bounds_ = p99_bounds();
    for (std::size_t i = 0; i < sealed_.size(); ++i) sealed_[i] = quantile(quantiles[i].q);
    sealed_mean_ = mean();
    open_.reset();
}

}  // namespace lostbits::measure::metric
