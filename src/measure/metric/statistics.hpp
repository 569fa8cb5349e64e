// Counts, moments and quantiles of a stream, in memory that does not grow with it.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <memory>
#include <span>
#include <string_view>
#include <vector>

#include "measure/columns/raw_columns.hpp"
#include "measure/metric/exact_total.hpp"

namespace lostbits::measure::metric {

/// The mean of sizes, finite or not. Each list that is added is summed in two doubles a lane, to n·2^-104 of itself;
/// the lists are summed without error. So the mean is off by at most an ulp and n·2^-104 of itself, neither the order
/// of the lists nor how they were divided between shards can show, and no sample costs a division.
class Sums {
public:
    /// NaN is no sample.
    void add(std::span<const double> values);
    /// All that another has.
    void add(const Sums& other);
    [[nodiscard]] std::uint64_t count() const { return sizes_.count; }
    [[nodiscard]] std::uint64_t zeros() const { return sizes_.zeros; }
    [[nodiscard]] double largest() const { return sizes_.largest; }
    /// Of the sizes; infinite when any is. NaN when empty.
    [[nodiscard]] double mean() const;

    template <class Bits>
    void fields(Bits& bits) {
        bits(sizes_.largest, sizes_.count, sizes_.zeros, sizes_.beyond);
        total_.fields(bits);
    }

private:
    columns::RawSizes sizes_{};  ///< its sums are those of one list
    ExactTotal total_;           ///< of the finite sizes
};

/// Counts of non-negative numbers in 1024 buckets a binade: a quantile is off by at most 2^-11 of itself, zero and
/// infinity are exact, and the result does not depend on the order of the samples.
class Quantiles {
public:
    /// Of the sizes of these; NaN is no sample.
    void add(std::span<const double> values);
    /// The nearest-rank quantile, 0 < q ≤ 1, of all that was added, as `sums` knows it: NaN when empty. q = 1 is the
    /// largest sample, exactly.
    [[nodiscard]] double at(double q, const Sums& sums) const;
    /// All that another has.
    void add(const Quantiles& other);

    template <class Bits>
    void fields(Bits& bits) {
        std::vector<std::uint32_t> places;
        std::vector<std::uint64_t> counts;
        filled(places, counts);
        bits(places, counts);
        fill(places, counts);
    }

private:
    static constexpr std::uint32_t buckets_per_binade = 1024;
    /// The low 32 bits of the counts: of many sizes a histogram stays in the second-level cache.
    using Binade = std::array<std::uint32_t, buckets_per_binade>;

    [[nodiscard]] std::uint64_t in_bucket(std::uint32_t place) const;
    void set_bucket(std::uint32_t place, std::uint64_t samples);
    /// The place of each bucket that is not empty, rising, and how many samples it has.
    void filled(std::vector<std::uint32_t>& places, std::vector<std::uint64_t>& counts) const;
    void fill(const std::vector<std::uint32_t>& places, const std::vector<std::uint64_t>& counts);

    /// Zeros are in the first bucket of the first: no sample is a special case.
    std::array<std::unique_ptr<Binade>, 2048> binades_;
    /// How often a bucket went beyond 2^32 − 1, by its place: a count is this times 2^32, and the low bits.
    std::map<std::uint32_t, std::uint32_t> carries_;
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

/// Between which of n independent samples, by rank from 1, the q-quantile of what they were drawn from lies with a
/// probability of at least 95 %, whatever the distribution: of K samples at or below it, K is binomial, so
/// P(K < low) <= 2.5 % and P(K >= high) <= 2.5 %. Rank 0 and rank n + 1: no sample is low or high enough.
struct Ranks {
    std::uint64_t low, high;
};
Ranks ranks_around(double q, std::uint64_t n);

struct Bounds {
    double low, high;
    friend bool operator==(const Bounds&, const Bounds&) = default;
};

/// What the summary says of one metric: of |x|, over the samples where it exists.
class Distribution {
public:
    /// NaN is no sample.
    void add(std::span<const double> values);
    void add(double x) { add(std::span(&x, 1)); }
    /// All samples of another, none of the two sealed: the same as if they had been added here.
    void add(const Distribution& other);
    [[nodiscard]] std::uint64_t count() const { return count_; }
    /// Infinite when any sample is; NaN when there is none.
    [[nodiscard]] double mean() const;
    /// That of one of the `statistics`, or any other before `seal`.
    [[nodiscard]] double quantile(double q) const;
    /// Where the 99th percentile lies of what the samples were drawn from, with 95 %, if they are independent
    /// (`ranks_around`): from 0 where no sample is low enough, to infinity where none is high enough, as of fewer than
    /// 368 none is. NaN when there is none.
    [[nodiscard]] Bounds p99_bounds() const;
    /// Keeps the quantiles of the `statistics`, and these bounds, and gives the buckets back: a sweep holds thousands
    /// of these.
    void seal();

    /// What it knows, sealed or not, for `output::shard`.
    template <class Bits>
    void fields(Bits& bits) {
        bits(count_, sealed_, sealed_mean_, sealed_bounds_.low, sealed_bounds_.high, open_);
    }

private:
    struct Open {
        Sums sums;
        Quantiles quantiles;

        template <class Bits>
        friend void fields(Bits& bits, Open& open) {
            open.sums.fields(bits);
            open.quantiles.fields(bits);
        }
    };

    std::uint64_t count_ = 0;
    std::unique_ptr<Open> open_;
    std::array<double, quantiles.size()> sealed_{};
    double sealed_mean_ = 0;
    Bounds sealed_bounds_{};
};

}  // namespace lostbits::measure::metric
