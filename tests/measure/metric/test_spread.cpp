// Hits behind a quantile, spreads over draws, and the interval of a claim that is computed from them.
#include "measure/metric/statistics.hpp"

#include "catch.hpp"
#include "measure/check/claim.hpp"

namespace test_spread {

using namespace lostbits;
using namespace lostbits::measure;
using metric::Agreement;

namespace {

const double none = std::nan("");

check::ClaimResult result_of(double own, std::vector<double> further) {
    check::ClaimResult r;
    r.measured = own;
    r.sample_count = 1024;
    r.further_measured = std::move(further);
    return r;
}

scene::check::Claim claim_about(const std::string& metric, const std::string& onset = "") {
    scene::check::Claim c;
    c.metric = metric;
    c.onset = onset;
    return c;
}

}  // namespace

TEST_CASE("a spread covers the draws that have the number, and its median is one of them") {
    const auto s = metric::spread_of(3, {1, none, 2, 9});
    CHECK((s.low == 1 && s.median == 2 && s.high == 9 && s.draws == 4));
    const auto alone = metric::spread_of(7, {});
    CHECK((alone.low == 7 && alone.median == 7 && alone.high == 7 && alone.draws == 1));
    const auto missing = metric::spread_of(none, {none});
    CHECK(missing.draws == 0);
    CHECK(std::isnan(missing.median));
}

TEST_CASE("a claim's interval is the range of its draws plus half of it on either side, within possible values") {
    const auto interval = [](const scene::check::Claim& claim, double own, std::vector<double> further) {
        const auto s = check::expected_interval(claim, result_of(own, std::move(further)));
        return std::pair(s.low, s.high);
    };
    CHECK(interval(claim_about("lost_bits_p50"), 10, {12, 11}) == std::pair(9.0, 13.0));
    CHECK(interval(claim_about("lost_bits_p50"), 0.5, {1.5}) == std::pair(0.0, 2.0));      // no bits below 0
    CHECK(interval(claim_about("rounding_error_mean"), -1, {1}) == std::pair(-2.0, 2.0));  // but signed errors
    CHECK(interval(claim_about("lost_bits_p50"), 24, {24, 24}) == std::pair(24.0, 24.0));
    // In powers of two: a fraction that is never 0 stays above 0, and none is above 1.
    CHECK(interval(claim_about("false_miss_fraction"), 0.01, {0.04}) == std::pair(0.005, 0.08));
    CHECK(interval(claim_about("false_miss_fraction"), 0, {0.5}) == std::pair(0.0, 0.75));
    CHECK(interval(claim_about("false_hit_fraction"), 0.25, {1}) == std::pair(0.125, 1.0));
    CHECK(interval(claim_about("", "false_miss"), 100, {400}) == std::pair(50.0, 800.0));
    // An onset is known to 2^-9 of itself.
    const auto [low, high] = interval(claim_about("", "lost_bits"), 1024, {1024});
    CHECK(low == Approx(1022));
    CHECK(high == 1026);
}

TEST_CASE("a quantile represents a form only if a tenth of the true hits agree") {
    CHECK(Agreement{10, 100}.is_enough());
    CHECK_FALSE(Agreement{9, 100}.is_enough());
    CHECK(Agreement{100, 100}.is_enough());
    CHECK(Agreement{1, 10}.is_enough());
    CHECK_FALSE(Agreement{1, 11}.is_enough());
    // Without any hit there are never enough, even where there is nothing to hit.
    CHECK_FALSE(Agreement{0, 0}.is_enough());
    CHECK_FALSE(Agreement{0, 5}.is_enough());
    CHECK(std::isnan(Agreement{0, 0}.agreed_fraction()));
    CHECK(Agreement{1, 4}.agreed_fraction() == 0.25);
}

TEST_CASE("the number of hits behind a quantile is written out correctly") {
    CHECK(Agreement{6860, 25600}.of_agreed_hits_text() == "of 6860 agreed hits");
    CHECK(Agreement{1, 3}.of_agreed_hits_text() == "of 1 agreed hit");
    CHECK(Agreement{55, 16384}.too_few_text() == "55 of 16384 hits agree");
    CHECK(Agreement{1, 1024}.too_few_text() == "1 of 1024 hits agrees");
    CHECK(Agreement{0, 1}.too_few_text() == "0 of 1 hit agree");
}

}  // namespace test_spread
