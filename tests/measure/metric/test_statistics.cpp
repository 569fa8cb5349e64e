// Means and quantiles of many numbers, compared with exact sums and sorted lists, at every register width.
#include <boost/multiprecision/gmp.hpp>

#include <algorithm>
#include <bit>
#include <cmath>

#include "catch.hpp"
#include "measure/metric/statistics.hpp"
#include "measure/widths.hpp"
#include "number/random.hpp"
#include "output/shard/fields.hpp"

namespace lostbits::test::test_statistics {

using measure::metric::Distribution;
using Rational = boost::multiprecision::mpq_rational;

namespace {

/// Signed numbers of very different sizes, some of them zero or missing.
std::vector<double> numbers(std::size_t n, int least, int most, Random& random) {
    std::vector<double> all;
    for (std::size_t i = 0; i < n; ++i) {
        const int e = static_cast<int>(random.between(least, most));
        all.push_back(random.one_in(9)    ? std::nan("")
                      : random.one_in(20) ? 0.0
                                          : random.sign() * std::ldexp(1 + random.unit(), e));
    }
    return all;
}

/// The mean size by rational numbers.
Rational exact_mean(const std::vector<double>& all) {
    Rational sum = 0;
    unsigned long count = 0;
    for (const double x : all) {
        if (std::isnan(x)) continue;
        sum += Rational(std::fabs(x));
        ++count;
    }
    return sum / count;
}

Distribution of(std::span<const double> all, std::size_t piece) {
    Distribution d;
    for (; !all.empty(); all = all.subspan(std::min(piece, all.size()))) d.add(all.first(std::min(piece, all.size())));
    return d;
}

}  // namespace

// Computed independently in rational numbers, by sums of binomial coefficients. Those for the median of 100 are in many
// books.
TEST_CASE("order statistics enclose a quantile with 95 % confidence, and closer ones do not", "[measure][metric]") {
    struct Case {
        double q;
        std::uint64_t n, low, high;
    };
    for (const auto& [q, n, low, high] :
         {Case{0.5, 100, 40, 61}, Case{0.99, 1024, 1007, 1020}, Case{0.99, 2000, 1971, 1989}, Case{0.99, 367, 359, 368},
          Case{0.99, 368, 360, 368}, Case{0.99, 100, 97, 101}, Case{0.5, 6, 1, 6}, Case{0.5, 1, 0, 2}}) {
        INFO(q << " of " << n);
        const auto ranks = measure::metric::ranks_around(q, n);
        CHECK(ranks.low == low);
        CHECK(ranks.high == high);
    }
}

TEST_CASE("the bounds of a 99th percentile are the samples of those ranks, sealed or not", "[measure][metric]") {
    Distribution d;
    CHECK(std::isnan(d.p99_bounds().low));
    for (int i = 1; i <= 367; ++i) d.add(i);
    CHECK(std::isinf(d.p99_bounds().high));  // of 367 samples the largest may lie below it: 0.99^367 > 2.5 %
    for (int i = 368; i <= 1024; ++i) d.add(i);
    const auto open = d.p99_bounds();
    CHECK(open.low == Approx(1007).epsilon(0x1p-11));
    CHECK(open.high == Approx(1020).epsilon(0x1p-11));
    d.seal();
    CHECK(d.p99_bounds() == open);
    // The bounds enclose the true percentile in at least 95 % of the sets, except by chance, and not in all of them.
    Random random(7);
    int enclosed = 0;
    constexpr int sets = 400;
    for (int set = 0; set < sets; ++set) {
        Distribution of_set;
        for (int i = 0; i < 1024; ++i) of_set.add(1 + random.unit());
        const auto bounds = of_set.p99_bounds();
        enclosed += bounds.low <= 1.99 && 1.99 <= bounds.high;
    }
    CHECK(enclosed >= 0.93 * sets);
    CHECK(enclosed < sets);
}

TEST_CASE("a mean is the exact mean to an ulp, whatever the order", "[measure][metric]") {
    Random random(99);
    for (const auto& [least, most] : {std::pair{-40, 20}, {-1074, -1000}, {-300, 300}, {800, 1015}}) {
        INFO("exponents " << least << " to " << most);
        std::vector<double> all = numbers(20'011, least, most, random);
        const Rational exact = exact_mean(all);
        const double mean = of(all, all.size()).mean();
        const Rational off = boost::multiprecision::abs(Rational(mean) - exact) / exact;
        CHECK(off <= Rational(0x1p-52));
        std::ranges::sort(all, [](double x, double y) { return std::isnan(y) ? !std::isnan(x) : x < y; });
        const double sorted = of(all, 1000).mean();
        CHECK(std::bit_cast<std::uint64_t>(sorted) == std::bit_cast<std::uint64_t>(mean));
    }
}

TEST_CASE("merged distributions of parts equal that of the whole, in any order and when read back",
          "[measure][metric]") {
    Random random(5);
    for (const auto& [least, most] : {std::pair{-40, 20}, {-1074, 1015}}) {
        std::vector<double> all = numbers(20'011, least, most, random);
        all.push_back(0);
        constexpr std::size_t piece = 512;
        const Distribution whole = of(all, piece);
        for (const std::size_t parts : {1U, 2U, 3U, 7U, 60U}) {
            INFO(parts << " parts");
            std::vector<Distribution> shards(parts);
            for (std::size_t begin = 0, k = 0; begin < all.size(); begin += piece, ++k)
                shards[k * parts / (all.size() / piece + 1)].add(
                    std::span(all).subspan(begin, std::min(piece, all.size() - begin)));
            Distribution joined;
            for (std::size_t k = 0; k < parts; ++k) {
                output::shard::BitReader bits(output::shard::bits_of(shards[(k + parts / 2) % parts]));
                Distribution again;
                bits(again);
                CHECK(bits.is_at_end());
                joined.add(again);
            }
            CHECK(joined.count() == whole.count());
            CHECK(std::bit_cast<std::uint64_t>(joined.mean()) == std::bit_cast<std::uint64_t>(whole.mean()));
            for (const double q : {0.01, 0.5, 0.99, 1.0}) CHECK(joined.quantile(q) == whole.quantile(q));
        }
    }
    Distribution sealed;
    sealed.add(3);
    sealed.seal();
    Distribution open;
    open.add(4);
    CHECK_THROWS_AS(open.add(sealed), std::logic_error);
    CHECK_THROWS_AS(sealed.add(open), std::logic_error);
}

TEST_CASE("a distribution counts more than 2^32 equal samples, merged with itself and read back", "[measure][metric]") {
    // 3 zeros, 5 ones, 2 each of 1.5 and 1024, all of them 2^37 times.
    Distribution d;
    d.add(std::vector<double>{0, 0, 0, 1, 1, 1, 1, 1, -1.5, 1.5, 1024, 1024});
    constexpr int doublings = 37;
    for (int k = 0; k < doublings; ++k) d.add(d);
    constexpr std::uint64_t times = std::uint64_t{1} << doublings;
    CHECK(d.count() == 12 * times);
    CHECK(d.mean() == 2056.0 / 12);
    const auto check_quantiles = [](const Distribution& all) {
        const auto is = [&all](double q, double x) {
            INFO("quantile " << q << " is " << all.quantile(q) << ", not " << x);
            CHECK(std::fabs(all.quantile(q) - x) <= x * 0x1p-11);
        };
        is(0.01, 0);  // to 3/12, to 8/12, to 10/12
        is(0.249, 0);
        is(0.251, 1);
        is(0.66, 1);
        is(0.67, 1.5);
        is(0.83, 1.5);
        is(0.84, 1024);
        is(0.9999, 1024);
    };
    check_quantiles(d);

    output::shard::BitReader bits(output::shard::bits_of(d));
    Distribution read;
    bits(read);
    CHECK(bits.is_at_end());
    check_quantiles(read);
    // Two shards are added, and then single samples to a count just below 2^32.
    Distribution just_below, more;
    just_below.add(1.5);
    for (int k = 0; k < 31; ++k) just_below.add(just_below);
    more.add(1.5);
    for (int k = 0; k < 30; ++k) more.add(more);
    just_below.add(more);
    for (int k = 0; k < 30; ++k) {  // and 2^29, 2^28 .. 1: together 2^32 - 1
        Distribution half;
        half.add(1.5);
        for (int j = 0; j < 29 - k; ++j) half.add(half);
        just_below.add(half);
    }
    CHECK(just_below.count() == 0xffffffffU);
    for (int k = 0; k < 7; ++k) just_below.add(1.5);
    just_below.add(HUGE_VAL);
    CHECK(just_below.count() == 0xffffffffU + std::uint64_t{8});
    CHECK(std::fabs(just_below.quantile(0.001) - 1.5) <= 1.5 * 0x1p-11);
    CHECK(std::fabs(just_below.quantile(0.999) - 1.5) <= 1.5 * 0x1p-11);
    CHECK(just_below.quantile(1) == HUGE_VAL);
    read.add(just_below);
    CHECK(read.count() == 12 * times + 0xffffffffU + 8);
    check_quantiles(read);  // 2^32 more of 1.5 are less than a hundredth
}

TEST_CASE("an exact total equals the rational sum", "[measure][metric]") {
    Random random(31);
    measure::metric::ExactTotal total;
    Rational exact = 0;
    double smallest_so_far = 0;
    for (const auto& [least, most] : {std::pair{-1074, -1022}, {-1060, 1020}, {1000, 1023}, {-30, 30}}) {
        for (const double x : numbers(500, least, most, random)) {
            if (std::isnan(x)) continue;
            const double size = std::fabs(x);
            // Ones that cancel leave nothing behind.
            total.add(size);
            total.add(-smallest_so_far);
            total.add(smallest_so_far);
            smallest_so_far = size;
            exact += Rational(size);
        }
        const Rational off = boost::multiprecision::abs(Rational(total.divided_by(1'000'003)) - exact / 1'000'003);
        CHECK(off <= exact / 1'000'003 * Rational(0x1p-52) + Rational(0x1p-1074));
    }
}

TEST_CASE("statistics have the same bits at every register width", "[measure][metric]") {
    Random random(7);
    for (const std::size_t n : {1U, 5U, 8U, 1003U, 5000U}) {
        const std::vector<double> all = numbers(n, -60, 60, random);
        std::vector<Distribution> got;
        test::at_every_width([&](intersect::simd::Isa) { got.push_back(of(all, 777)); });
        for (const Distribution& d : got) {
            CHECK(d.count() == got.front().count());
            if (d.count() == 0) continue;
            CHECK(std::bit_cast<std::uint64_t>(d.mean()) == std::bit_cast<std::uint64_t>(got.front().mean()));
            for (const double q : {0.01, 0.5, 0.99, 1.0}) CHECK(d.quantile(q) == got.front().quantile(q));
        }
    }
}

TEST_CASE("quantiles are those of the sorted list to 2^-11, zero and the largest exactly", "[measure][metric]") {
    Random random(12);
    for (const int shape : {0, 1, 2}) {
        // Ordinary sizes; subnormal ones beside zeros; a third of zeros and an infinity.
        std::vector<double> all = shape == 1 ? numbers(3001, -1074, -1030, random) : numbers(3001, -20, 20, random);
        if (shape == 2) {
            for (std::size_t i = 0; i < 1000; ++i) all.push_back(i % 2 == 0 ? 0.0 : -0.0);
            all.push_back(HUGE_VAL);
        }
        const Distribution d = of(all, 512);
        std::vector<double> sizes;
        for (const double x : all) {
            if (!std::isnan(x)) sizes.push_back(std::fabs(x));
        }
        std::ranges::sort(sizes);
        CHECK(d.count() == sizes.size());
        for (const double q : {0.001, 0.01, 0.05, 0.1, 0.25, 0.5, 0.75, 0.99, 0.9999, 1.0}) {
            const double want = sizes[static_cast<std::size_t>(std::ceil(q * static_cast<double>(sizes.size()))) - 1];
            INFO(shape << ": quantile " << q << " is " << want << ", not " << d.quantile(q));
            if (std::isinf(want)) {
                CHECK(d.quantile(q) == want);
                continue;
            }
            // Subnormal numbers share buckets of 2^-1033.
            CHECK(std::fabs(d.quantile(q) - want) <= std::max(want * 0x1p-11, want < 0x1p-1022 ? 0x1p-1033 : 0));
            if (want == 0 || q == 1) CHECK(d.quantile(q) == want);
        }
        if (shape == 2) CHECK(d.mean() == HUGE_VAL);
    }
}

TEST_CASE("a distribution gives the same numbers after it is sealed, and none when empty", "[measure][metric]") {
    Random random(2);
    Distribution d = of(numbers(500, -3, 9, random), 500);
    const double mean = d.mean(), middle = d.quantile(0.5), most = d.quantile(1);
    d.seal();
    CHECK(d.mean() == mean);
    CHECK(d.quantile(0.5) == middle);
    CHECK(d.quantile(1) == most);
    CHECK_THROWS(d.quantile(0.123));
    Distribution none;
    none.add(std::vector<double>(20, std::nan("")));
    CHECK(none.count() == 0);
    CHECK(std::isnan(none.mean()));
    CHECK(std::isnan(none.quantile(0.5)));
}

}  // namespace lostbits::test::test_statistics
