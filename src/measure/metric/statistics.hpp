// Counts, moments and quantiles of a stream, in memory that does not grow with it; on how many hits they are, and what
// a number comes to when its random rays are drawn again.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <iterator>
#include <limits>
#include <map>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "measure/columns/raw_columns.hpp"
#include "measure/truth/missing.hpp"
#include "number/error_free.hpp"
#include "scene/toml/counted.hpp"

namespace lostbits::measure::metric {

/// A number Σ limbs[i]·2^(32·i − 1074), in which every sum of up to 2^64 finite doubles has room (Kulisch's long
/// accumulator, with room for carries in every limb). Its sign is that of the top limb.
class ExactTotal {
public:
    /// x is finite.
    void add(double x);
    void add(const ExactTotal& other);
    /// The total over n, rounded to a double: off by at most an ulp where it is normal. The total is not negative.
    [[nodiscard]] double over(std::uint64_t n) const;

    template <class Bits>
    void fields(Bits& bits) {
        settle();
        bits(limbs_);
    }

private:
    void settle();

    static constexpr int limb_bits = 32;
    static constexpr std::uint32_t most_unsettled = std::uint32_t{1} << 29;  // each moves a limb by less than 2^32

    std::array<std::int64_t, 68> limbs_{};
    std::uint32_t unsettled_ = 0;  // terms since all limbs were from 0 to 2^32 − 1
};

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

/// A form that misses nearly everything may be exact on the few hits that are left to it. Below this share of the rays
/// that truly hit, pictures, plots, tables on the terminal and the page withhold quantiles over agreed hits, and say
/// so. CSV files have them all the same, beside the counts.
inline constexpr double least_agreement = 0.1;

struct Agreement {
    std::uint64_t agreed;     ///< rays whose error is measured: form and truth agree on the hit
    std::uint64_t true_hits;  ///< rays that truly hit

    /// NaN where no ray truly hits.
    [[nodiscard]] double share() const { return truth::fraction(agreed, true_hits); }
    /// Whether a quantile over the agreed hits may stand for the form.
    [[nodiscard]] bool is_enough() const {
        return agreed > 0 && static_cast<double>(agreed) >= least_agreement * static_cast<double>(true_hits);
    }
    /// `of 55 agreed hits`: stands beside a quantile.
    [[nodiscard]] std::string of_agreed_hits() const { return "of " + scene::toml::counted(agreed, "agreed hit"); }
    /// `55 of 16384 hits agree`: stands in place of a withheld one.
    [[nodiscard]] std::string too_few() const {
        return std::to_string(agreed) + " of " + scene::toml::counted(true_hits, "hit") +
               (agreed == 1 ? " agrees" : " agree");
    }
};

/// Smallest, middle and largest of several draws. The middle one is a measured number: the lower of two.
struct Spread {
    double low, median, high;
    int draws;  ///< on which the number exists
};

/// Of a file's own draw and of further ones; NaN is a draw on which the number does not exist. All NaN where none has
/// it.
inline Spread spread_of(double own, const std::vector<double>& further) {
    std::vector<double> all;
    const auto exists = [](double x) { return !std::isnan(x); };
    if (exists(own)) all.push_back(own);
    std::ranges::copy_if(further, std::back_inserter(all), exists);
    constexpr double none = std::numeric_limits<double>::quiet_NaN();
    if (all.empty()) return {none, none, none, 0};
    std::ranges::sort(all);
    return {all.front(), all[(all.size() - 1) / 2], all.back(), static_cast<int>(all.size())};
}

}  // namespace lostbits::measure::metric
