// Counts, moments and quantiles of a stream, in memory that does not grow with it.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
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

/// The quantiles that every table shows.
inline constexpr std::array<double, 3> reported_quantiles{0.5, 0.99, 1.0};

/// What the summary says of one metric: of |x|, over the samples where it exists.
class Distribution {
public:
    void add(double x);
    [[nodiscard]] std::uint64_t count() const { return count_; }
    /// Infinite when any sample is; NaN when there is none.
    [[nodiscard]] double mean() const;
    /// One of `reported_quantiles`, or any other before `seal`.
    [[nodiscard]] double quantile(double q) const;
    /// Keeps the reported quantiles and gives the buckets back: a sweep holds thousands of these.
    void seal();

private:
    std::uint64_t count_ = 0;
    Moments moments_;
    std::unique_ptr<Quantiles> quantiles_;
    std::array<double, reported_quantiles.size()> sealed_{};
    bool infinite_ = false;
};

}  // namespace lostbits::measure::metric
