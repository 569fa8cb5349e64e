// Counts, moments and quantiles of a stream, in memory that does not grow with it.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <string_view>
#include <vector>

namespace lostbits::measure::metric {

/// Mean and variance by Welford's recurrence: no sum of squares, no cancellation.
class Moments {
public:
    void add(double x) {
        ++count_;
        const double delta = x - mean_;
        mean_ += delta / static_cast<double>(count_);
        squares_ += delta * (x - mean_);
    }
    [[nodiscard]] std::uint64_t count() const { return count_; }
    [[nodiscard]] double mean() const { return mean_; }
    [[nodiscard]] double variance() const { return count_ > 1 ? squares_ / static_cast<double>(count_ - 1) : 0; }

private:
    std::uint64_t count_ = 0;
    double mean_ = 0, squares_ = 0;
};

/// Quantiles of non-negative numbers by counting in 1024 buckets a binade: a quantile is off by at most 2^-11 of
/// itself, zero and infinity are exact, and the result does not depend on the order of the samples. The largest is kept
/// as it is.
class Quantiles {
public:
    void add(double x);
    [[nodiscard]] std::uint64_t count() const { return count_; }
    /// The nearest-rank quantile, 0 < q ≤ 1; NaN when empty. q = 1 is the largest sample, exactly.
    [[nodiscard]] double at(double q) const;

private:
    static constexpr int buckets_per_binade = 1024;
    using Binade = std::array<std::uint32_t, buckets_per_binade>;

    std::uint64_t count_ = 0, zeros_ = 0;
    double largest_ = 0;
    std::array<std::unique_ptr<Binade>, 2048> binades_;
};

/// What tables say of many numbers: a column each.
struct Statistic {
    std::string_view name, meaning;
    double q;  ///< 0 for the mean

    template <class Numbers>
    [[nodiscard]] double of(const Numbers& numbers) const {
        return q == 0 ? numbers.mean() : numbers.quantile(q);
    }
};
inline constexpr std::array<Statistic, 4> statistics{
    {{"mean", "mean", 0}, {"p50", "median", 0.5}, {"p99", "99th percentile", 0.99}, {"max", "largest", 1}}};
/// Those that are quantiles.
inline constexpr std::span<const Statistic, 3> quantiles(statistics.begin() + 1, statistics.end());

/// What the summary says of one metric: of |x|, over the samples where it exists.
class Distribution {
public:
    void add(double x);
    [[nodiscard]] std::uint64_t count() const { return count_; }
    /// Infinite when any sample is; NaN when there is none.
    [[nodiscard]] double mean() const;
    /// That of one of the `statistics`, or any other before `seal`.
    [[nodiscard]] double quantile(double q) const;
    /// Keeps the quantiles of the `statistics` and gives the buckets back: a sweep holds thousands of these.
    void seal();

private:
    std::uint64_t count_ = 0;
    Moments moments_;
    std::unique_ptr<Quantiles> quantiles_;
    std::array<double, quantiles.size()> sealed_{};
    bool infinite_ = false;
};

}  // namespace lostbits::measure::metric
