// Counts, means and quantiles of a stream of numbers, in memory that does not grow with the stream. Also the agreement
// between a form and the truth, and the spread of a number over several draws of random rays.
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
#include "text/count_with_noun.hpp"

namespace lostbits::measure::metric {

/// Exact sum Σ limbs[i]·2^(32·i − 1074), which holds every sum of up to 2^64 finite doubles (Kulisch's long
/// accumulator, with space for carries in every limb). Its sign is that of the top limb.
class ExactTotal {
public:
    /// Adds x, which must be finite.
    void add(double x);
    void add(const ExactTotal& other);
    /// Total divided by n, rounded to a double: off by at most an ulp if it is normal. The total must not be
    /// negative.
    [[nodiscard]] double divided_by(std::uint64_t n) const;

    template <class Archive>
    void fields(Archive& archive) {
        normalise();
        archive(limbs_);
    }

private:
    void normalise();

    static constexpr int limb_bits = 32;
    static constexpr std::uint32_t max_pending_terms = std::uint32_t{1} << 29;  // each moves a limb by less than 2^32

    std::array<std::int64_t, 68> limbs_{};
    std::uint32_t pending_terms_ = 0;  // terms added since all limbs were from 0 to 2^32 − 1
};

/// Mean of absolute values, finite or not. The values of one `add` are summed in double-double, with a relative error
/// of at most n·2^-104; the sums of several `add` are added exactly. So the mean is off by at most one ulp plus a
/// relative error of n·2^-104. It depends neither on the order of the calls nor on how they were divided between
/// shards, and no sample costs a division.
class AbsoluteMean {
public:
    /// Adds samples; NaN is skipped.
    void add(std::span<const double> values);
    /// Adds all samples of another.
    void add(const AbsoluteMean& other);
    [[nodiscard]] std::uint64_t count() const { return sums_.count; }
    [[nodiscard]] std::uint64_t zeros() const { return sums_.zeros; }
    [[nodiscard]] double largest() const { return sums_.largest; }
    /// Mean of the absolute values; infinite when any sample is infinite, NaN when empty.
    [[nodiscard]] double mean() const;

    template <class Archive>
    void fields(Archive& archive) {
        archive(sums_.largest, sums_.count, sums_.zeros, sums_.beyond);
        total_.fields(archive);
    }

private:
    columns::RawAbsoluteSums
        sums_{};        ///< counts of all samples; its sums are of the list being added, and 0 after `add`
    ExactTotal total_;  ///< sum of the finite absolute values
};

/// Counts of non-negative numbers in 1024 buckets for each binade: a quantile is off by at most 2^-11 of itself, zero
/// and infinity are exact, and the result does not depend on the order of the samples.
class QuantileHistogram {
public:
    /// Counts the absolute values; NaN is skipped.
    void add(std::span<const double> values);
    /// Nearest-rank quantile, 0 < q ≤ 1, of all added samples, with the counts that `absolute_mean` has. NaN when
    /// empty. For q = 1, it is exactly the largest sample.
    [[nodiscard]] double at(double q, const AbsoluteMean& absolute_mean) const;
    /// Adds all samples of another.
    void add(const QuantileHistogram& other);

    template <class Archive>
    void fields(Archive& archive) {
        std::vector<std::uint32_t> indices;
        std::vector<std::uint64_t> counts;
        list_buckets(indices, counts);
        archive(indices, counts);
        set_buckets(indices, counts);
    }

private:
    static constexpr std::uint32_t buckets_per_binade = 1024;
    /// Low 32 bits of the counts: a histogram of many values still fits into the second-level cache.
    using Binade = std::array<std::uint32_t, buckets_per_binade>;

    [[nodiscard]] std::uint64_t bucket_count(std::uint32_t index) const;
    void set_bucket(std::uint32_t index, std::uint64_t sample_count);
    /// Lists the index of each bucket that is not empty, in rising order, and its number of samples.
    void list_buckets(std::vector<std::uint32_t>& indices, std::vector<std::uint64_t>& counts) const;
    void set_buckets(const std::vector<std::uint32_t>& indices, const std::vector<std::uint64_t>& counts);

    /// Zeros are in the first bucket of the first binade, so no sample is a special case.
    std::array<std::unique_ptr<Binade>, 2048> binades_;
    /// Overflows of each bucket beyond 2^32 − 1, by its index: a count is this times 2^32, plus the low bits.
    std::map<std::uint32_t, std::uint32_t> carries_;
};

/// Statistic of many numbers that tables show in a column.
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
/// The statistics that are quantiles.
inline constexpr std::span<const Statistic, 3> quantile_statistics(statistics.begin() + 1, statistics.end());

/// Confidence interval of the q-quantile by ranks. The quantile of the distribution from which n independent samples
/// were drawn lies between the samples of these two ranks (from 1) with a probability of at least 95 %, whatever the
/// distribution. The number K of samples at or below the quantile is binomial, so P(K < low) <= 2.5 % and P(K >= high)
/// <= 2.5 %. Rank 0 or rank n + 1 means that no sample is low or high enough.
struct Ranks {
    std::uint64_t low, high;
};
Ranks ranks_around(double q, std::uint64_t n);

struct Bounds {
    double low, high;
    friend bool operator==(const Bounds&, const Bounds&) = default;
};

/// Summary of one metric: statistics of |x|, over the samples that have a value.
class Distribution {
public:
    /// Adds samples; NaN is skipped.
    void add(std::span<const double> values);
    void add(double x) { add(std::span(&x, 1)); }
    /// Adds all samples of another; neither of the two may be sealed. The result is the same as if they had been added
    /// here.
    void add(const Distribution& other);
    [[nodiscard]] std::uint64_t count() const { return count_; }
    /// Mean of |x|; infinite when any sample is infinite, NaN when no sample was added.
    [[nodiscard]] double mean() const;
    /// Quantile q: one of the `statistics`, or, before `seal`, any other.
    [[nodiscard]] double quantile(double q) const;
    /// Bounds of the 99th percentile of the distribution that the samples were drawn from, with 95 % confidence, if
    /// they are independent (`ranks_around`). The lower bound is 0 if no sample is low enough; the upper bound is
    /// infinity if no sample is high enough, as with fewer than 368 samples. Both are NaN without samples.
    [[nodiscard]] Bounds p99_bounds() const;
    /// Keeps only the quantiles of the `statistics`, the mean and the bounds of the 99th percentile, and frees the
    /// buckets: a sweep holds thousands of distributions.
    void seal();

    /// Reads or writes the whole state, sealed or not, for `output::shard`.
    template <class Archive>
    void fields(Archive& archive) {
        archive(count_, sealed_quantiles_, sealed_mean_, sealed_bounds_.low, sealed_bounds_.high, unsealed_);
    }

private:
    struct UnsealedState {
        AbsoluteMean absolute_mean;
        QuantileHistogram histogram;

        template <class Archive>
        friend void fields(Archive& archive, UnsealedState& state) {
            state.absolute_mean.fields(archive);
            state.histogram.fields(archive);
        }
    };

    std::uint64_t count_ = 0;
    std::unique_ptr<UnsealedState> unsealed_;
    std::array<double, quantile_statistics.size()> sealed_quantiles_{};
    double sealed_mean_ = 0;
    Bounds sealed_bounds_{};
};

/// Least fraction of the true hits on which form and truth must agree. A form that misses nearly everything may be
/// exact on the few hits that it finds. Below this fraction, pictures, plots, tables on the terminal and the page
/// withhold quantiles over agreed hits, and say so. CSV files contain the quantiles in any case, beside the counts.
inline constexpr double min_agreement = 0.1;

struct Agreement {
    std::uint64_t agreed_count;    ///< rays whose error is measured: form and truth agree on the hit
    std::uint64_t true_hit_count;  ///< rays that truly hit

    /// Fraction of the true hits that agree; NaN if no ray truly hits.
    [[nodiscard]] double agreed_fraction() const { return truth::fraction(agreed_count, true_hit_count); }
    /// True if a quantile over the agreed hits may stand for the form.
    [[nodiscard]] bool is_enough() const {
        return agreed_count > 0 &&
               static_cast<double>(agreed_count) >= min_agreement * static_cast<double>(true_hit_count);
    }
    /// Text beside a quantile: `of 55 agreed hits`.
    [[nodiscard]] std::string of_agreed_hits_text() const {
        return "of " + text::count_with_noun(agreed_count, "agreed hit");
    }
    /// Text in place of a withheld quantile: `55 of 16384 hits agree`.
    [[nodiscard]] std::string too_few_text() const {
        return std::to_string(agreed_count) + " of " + text::count_with_noun(true_hit_count, "hit") +
               (agreed_count == 1 ? " agrees" : " agree");
    }
};

/// Smallest, middle and largest value of several draws. The middle value is a measured one: the lower of the two if the
/// number of values is even.
struct Spread {
    double low, median, high;
    int draws;  ///< number of draws on which the number exists
};

/// Spread of a number over the draw of the file and further draws. A NaN means that a draw has no such number; if none
/// has, all three values are NaN.
inline Spread spread_of(double own, const std::vector<double>& other_draws) {
    std::vector<double> values;
    const auto exists = [](double x) { return !std::isnan(x); };
    if (exists(own)) values.push_back(own);
    std::ranges::copy_if(other_draws, std::back_inserter(values), exists);

    constexpr double no_value = std::numeric_limits<double>::quiet_NaN();
    if (values.empty()) return {no_value, no_value, no_value, 0};
    std::ranges::sort(values);
    return {values.front(), values[(values.size() - 1) / 2], values.back(), static_cast<int>(values.size())};
}

}  // namespace lostbits::measure::metric
