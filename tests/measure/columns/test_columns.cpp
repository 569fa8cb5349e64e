// Errors and residuals over columns have the bits of the metrics' own functions, at every register width. Only what a
// register cannot compute is left to those functions.
#include <algorithm>
#include <bit>
#include <cmath>

#include "catch.hpp"
#include "measure/columns/columns.hpp"
#include "measure/metric/metrics.hpp"
#include "measure/widths.hpp"
#include "number/random.hpp"
#include "number/rounded.hpp"

namespace lostbits::test::test_columns {

using measure::columns::TrueLengths;
using measure::metric::Sample;
using measure::truth::CertifiedNumber;
using measure::truth::missing;
using measure::truth::Truth;

namespace {

/// Runs `at_width()` at every width except that of single numbers, which leaves all rays to the functions.
template <class Run>
void in_registers(const Run& at_width) {
    test::at_every_width([&](intersect::simd::Isa isa) {
        if (isa != intersect::simd::Isa::scalar) at_width();
    });
}

bool same_bits(double x, double y) { return std::bit_cast<std::uint64_t>(x) == std::bit_cast<std::uint64_t>(y); }

double stored(double x, const Format& format) { return rounding::to_format(x, 0, format.parameters); }

/// Rays with an answer and a truth each; some are not measured.
struct Problems {
    Format format;
    std::vector<double> answers;
    std::vector<Truth> truths;
    TrueLengths lengths;

    Problems(const Format& f, std::size_t n, Random& random, bool extreme) : format(f) {
        lengths.resize(n);
        for (std::size_t i = 0; i < n; ++i) {
            const int e =
                static_cast<int>(extreme ? random.between(std::max(-1060, f.parameters.emin - 20), f.parameters.emax)
                                         : random.between(-12, std::min(30, f.parameters.emax - 2)));
            double hi = std::ldexp(1 + random.unit(), e);
            if (random.one_in(8)) hi = std::ldexp(1.0, e);  // where the binade depends on lo
            CertifiedNumber t = measure::truth::as_certified(hi);
            if (!random.one_in(6))
                t.lo = random.sign() *
                       std::ldexp(random.unit(), -54 - static_cast<int>(random.between(0, extreme ? 240 : 40)));
            if (extreme && random.one_in(50)) t = {};
            Truth truth{.decision = Truth::Decision::hit, .primitive = 0, .t = t, .distance = t};
            double answer = stored(hi, f);
            const int wrong = static_cast<int>(random.between(-3, f.parameters.precision + 2));
            if (wrong > 0)
                answer =
                    stored(hi * (1 + random.sign() * std::ldexp(random.unit(), wrong - f.parameters.precision)), f);
            if (random.one_in(extreme ? 20 : 1000))
                answer = random.sign() *
                         stored(std::ldexp(1 + random.unit(), static_cast<int>(random.between(-1000, 1000))), f);
            if (extreme && random.one_in(30)) answer = random.one_in(2) ? 0.0 : HUGE_VAL;
            if (random.one_in(5)) answer = missing;
            answers.push_back(answer);
            truths.push_back(truth);
            lengths.set(i, truth, intersect::Direction::any);
        }
    }
    [[nodiscard]] Sample sample(std::size_t i) const {
        return {.t = answers[i], .format = &format, .true_t = &truths[i].t};
    }
};

struct Columns {
    std::vector<double> values[5];
    std::vector<std::uint32_t> left;
    double largest = 0;

    explicit Columns(const Problems& problems) {
        for (auto& v : values) v.assign(problems.answers.size(), -77.0);
        largest =
            measure::columns::compute_error_columns(problems.answers, problems.lengths, problems.format.parameters,
                                                    {.ulp = values[0].data(),
                                                     .lost = values[1].data(),
                                                     .correct = values[2].data(),
                                                     .relative = values[3].data(),
                                                     .absolute = values[4].data()},
                                                    left);
    }
};

constexpr std::array<const char*, 5> names{"ulp_error", "lost_bits", "correct_bits", "relative_error",
                                           "absolute_error"};

/// Checks that every ray is left to the functions or has the bits of each metric; returns the share that is left.
double compare(const Problems& problems) {
    const Columns columns(problems);
    CHECK(std::ranges::is_sorted(columns.left));
    std::vector<bool> is_left(problems.answers.size());
    for (const std::uint32_t i : columns.left) is_left[i] = true;
    std::size_t measured = 0, wrong = 0;
    double largest = 0;
    for (std::size_t i = 0; i < problems.answers.size(); ++i) {
        const bool wanted = !std::isnan(problems.answers[i]);
        measured += wanted;
        if (is_left[i]) {
            wrong += !wanted;
            continue;
        }
        for (std::size_t m = 0; m < names.size(); ++m) {
            const double want = wanted ? measure::metric::find_metric(names[m])->value(problems.sample(i)) : missing;
            if (same_bits(columns.values[m][i], want)) continue;
            ++wrong;
            UNSCOPED_INFO(names[m] << " of ray " << i << ": " << std::hexfloat << columns.values[m][i] << ", not "
                                   << want << "; t " << problems.answers[i] << ", t* " << problems.truths[i].t.hi
                                   << " + " << problems.truths[i].t.lo << " times 2^" << std::defaultfloat
                                   << problems.truths[i].t.exponent);
            if (wrong > 5) break;
        }
        if (wanted) largest = std::max(largest, std::fabs(columns.values[0][i]));
    }
    CHECK(wrong == 0);
    CHECK(largest == columns.largest);
    return static_cast<double>(columns.left.size()) / static_cast<double>(measured);
}

}  // namespace

TEST_CASE("columns of errors have the bits of the metrics", "[measure][columns]") {
    in_registers([] {
        Random random(20261122);
        for (const char* name : {"f32", "f64", "fp16", "bf16", "p5", "p40"}) {
            INFO(name);
            const Format format = find_format(name).value();
            CHECK(compare(Problems(format, 60'001, random, false)) < 0.01);  // few answers are far out of range
            const double left = compare(Problems(format, 60'003, random, true));
            CHECK(left > 0.02);
            CHECK(left < 0.9);
        }
    });
}

TEST_CASE("columns of any length leave the memory behind them unchanged", "[measure][columns]") {
    in_registers([] {
        Random random(3);
        const Format format = find_format("f32").value();
        for (const std::size_t n : {1U, 2U, 3U, 7U, 8U, 9U, 15U, 17U, 511U, 513U, 1025U}) {
            INFO(n);
            CHECK(compare(Problems(format, n, random, false)) <= 1);
        }
    });
}

TEST_CASE("an error of half an ulp loses no bit and 2^k ulps lose k + 1, in columns and ray by ray",
          "[measure][columns]") {
    const Format format = find_format("f64").value();
    Random random(1);
    Problems p(format, 8, random, false);
    in_registers([&] {
        for (int k = -1; k < 51; ++k) {
            for (std::size_t i = 0; i < 8; ++i) {
                p.truths[i].t = measure::truth::as_certified(1.0);
                p.answers[i] = 1 + std::ldexp(1.0, k - 52);  // exactly 2^k ulps, but for half an ulp
                if (k < 0) {
                    p.truths[i].t.lo = 0x1p-53;
                    p.answers[i] = 1;
                }
                p.lengths.set(i, p.truths[i], intersect::Direction::any);
            }
            CHECK(Columns(p).values[1] == std::vector<double>(8, k + 1));
            CHECK(measure::metric::find_metric("lost_bits")->value(p.sample(0)) == k + 1);
        }
    });
}

TEST_CASE("batches of one ray are left to the metrics", "[measure][columns]") {
    const auto before = intersect::simd::current_isa();
    intersect::simd::set_isa(intersect::simd::Isa::scalar);
    Random random(5);
    const Problems p(find_format("f32").value(), 1000, random, false);
    CHECK(Columns(p).left.size() ==
          static_cast<std::size_t>(std::ranges::count_if(p.answers, [](double t) { return !std::isnan(t); })));
    intersect::simd::set_isa(before);
}

}  // namespace lostbits::test::test_columns
