#include "measure/metric/statistics.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <stdexcept>

#include "measure/columns/columns.hpp"
#include "measure/truth/missing.hpp"
#include "number/error_free.hpp"

namespace lostbits::measure::metric {

void Sums::add(std::span<const double> values) {
    const std::uint64_t before = sizes_.beyond;
    columns::add_sizes(values, sizes_);
    if (sizes_.beyond == before) return;
    for (const double x : values) {
        if (std::fabs(x) > columns::largest_summed) huge_ += std::fabs(x) / huge_unit;
    }
}

double Sums::mean() const {
    if (sizes_.count == 0) return truth::missing;
    DoubleDouble sum{0, 0};
    for (std::size_t lane = 0; lane < columns::most_lanes; ++lane) {
        const DoubleDouble s = two_sum(sum.hi, sizes_.hi[lane]);
        sum = quick_two_sum(s.hi, s.lo + (sum.lo + sizes_.lo[lane]));
    }
    const auto n = static_cast<double>(sizes_.count);
    if (sizes_.beyond > 0) return (huge_ + sum.hi / huge_unit) / n * huge_unit;
    const double mean = sum.hi / n;
    return mean + (quotient_residual(sum.hi, n, mean) + sum.lo) / n;
}

void Quantiles::add(std::span<const double> values) {
    for (const double x : values) {
        if (x != x) continue;  // rays without a value lie together: no work, and nothing to wait for
        const auto bits = std::bit_cast<std::uint64_t>(x);
        auto& binade = binades_[bits >> 52 & 0x7ff];
        if (!binade) [[unlikely]]
            binade = std::make_unique<Binade>();
        ++(*binade)[bits >> 42 & (buckets_per_binade - 1)];
    }
}

double Quantiles::at(double q, const Sums& sums) const {
    if (sums.count() == 0) return truth::missing;
    const auto rank = static_cast<std::uint64_t>(std::ceil(q * static_cast<double>(sums.count())));
    if (rank >= sums.count()) return sums.largest();
    std::uint64_t seen = sums.zeros();
    if (rank <= seen) return 0;
    for (std::uint64_t b = 0; b < binades_.size(); ++b) {
        if (!binades_[b]) continue;
        for (std::uint64_t i = 0; i < buckets_per_binade; ++i) {
            const std::uint32_t all = (*binades_[b])[i];
            seen += b == 0 && i == 0 ? all - static_cast<std::uint32_t>(sums.zeros()) : all;
            if (rank > seen) continue;
            const double low = std::bit_cast<double>(b << 52 | i << 42);
            const double middle = std::bit_cast<double>(b << 52 | i << 42 | std::uint64_t{1} << 41);
            return std::isinf(low) ? low : std::min(middle, sums.largest());
        }
    }
    return sums.largest();
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

double Distribution::mean() const {
    if (count_ == 0) return truth::missing;
    return open_ ? open_->sums.mean() : sealed_mean_;
}

double Distribution::quantile(double q) const {
    if (count_ == 0) return truth::missing;
    if (open_) return open_->quantiles.at(q, open_->sums);
    const auto kept = std::ranges::find(quantiles, q, &Statistic::q);
    if (kept == quantiles.end())
        throw std::logic_error("a sealed distribution keeps the quantiles of the tables alone");
    return sealed_[static_cast<std::size_t>(kept - quantiles.begin())];
}

void Distribution::seal() {
    if (!open_) return;
    for (std::size_t i = 0; i < sealed_.size(); ++i) sealed_[i] = quantile(quantiles[i].q);
    sealed_mean_ = mean();
    open_.reset();
}

}  // namespace lostbits::measure::metric
