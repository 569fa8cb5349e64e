#include "measure/metric/statistics.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "measure/truth/missing.hpp"

namespace lostbits::measure::metric {

void Quantiles::add(double x) {
    ++count_;
    largest_ = std::max(largest_, x);
    if (x == 0) {
        ++zeros_;
        return;
    }
    const auto bits = std::bit_cast<std::uint64_t>(x);
    auto& binade = binades_[bits >> 52 & 0x7ff];
    if (!binade) binade = std::make_unique<Binade>();
    ++(*binade)[bits >> 42 & (buckets_per_binade - 1)];
}

double Quantiles::at(double q) const {
    if (count_ == 0) return truth::missing;
    const auto rank = static_cast<std::uint64_t>(std::ceil(q * static_cast<double>(count_)));
    if (rank >= count_) return largest_;
    std::uint64_t seen = zeros_;
    if (rank <= seen) return 0;
    for (std::uint64_t b = 0; b < binades_.size(); ++b) {
        if (!binades_[b]) continue;
        for (std::uint64_t i = 0; i < buckets_per_binade; ++i) {
            seen += (*binades_[b])[i];
            if (rank > seen) continue;
            const double low = std::bit_cast<double>(b << 52 | i << 42);
            const double middle = std::bit_cast<double>(b << 52 | i << 42 | std::uint64_t{1} << 41);
            return std::isinf(low) ? low : std::min(middle, largest_);
        }
    }
    return largest_;
}

void Distribution::add(double x) {
    if (std::isnan(x)) return;
    const double size = std::fabs(x);
    ++count_;
    if (!quantiles_) quantiles_ = std::make_unique<Quantiles>();
    quantiles_->add(size);
    if (std::isinf(size)) infinite_ = true;
    else moments_.add(size);
}

double Distribution::mean() const {
    if (count_ == 0) return truth::missing;
    return infinite_ ? std::numeric_limits<double>::infinity() : moments_.mean();
}

double Distribution::quantile(double q) const {
    if (count_ == 0) return truth::missing;
    if (quantiles_) return quantiles_->at(q);
    const auto kept = std::ranges::find(quantiles, q, &Statistic::q);
    if (kept == quantiles.end())
        throw std::logic_error("a sealed distribution keeps the quantiles of the tables alone");
    return sealed_[static_cast<std::size_t>(kept - quantiles.begin())];
}

void Distribution::seal() {
    if (!quantiles_) return;
    for (std::size_t i = 0; i < sealed_.size(); ++i) sealed_[i] = quantiles_->at(quantiles[i].q);
    quantiles_.reset();
}

}  // namespace lostbits::measure::metric
