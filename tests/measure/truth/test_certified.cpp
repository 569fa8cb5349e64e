// Certified values, which enclosures produce: every operation is compared with exact integers.
#include <bit>
#include <cmath>

#include "catch.hpp"
#include "measure/seeded.hpp"
#include "measure/truth/certified.hpp"
#include "measure/truth/exact_reference.hpp"
#include "measure/truth/lost_bits.hpp"
#include "number/rounded.hpp"

namespace test_certified {

using namespace lostbits;
using namespace lostbits::test;
using measure::truth::as_certified;
using measure::truth::CertifiedNumber;
using measure::truth::certify;
using measure::truth::nearer;
using measure::truth::ordinal;
using measure::truth::round_certified;
using measure::truth::scaled_difference;

namespace {

/// Two words and a valid bound of any size; the words are often on a boundary of some format.
CertifiedNumber any_certified(Seeded& rng, int exponents) {
    CertifiedNumber x;
    x.hi = rng.signed_magnitude(0, 0);
    if (rng.coin()) {  // few bits: powers of two and ties among them
        const double unit = std::ldexp(1.0, -rng.index(53));
        x.hi = std::trunc(x.hi / unit) * unit;
    }
    const double half = (std::nextafter(std::fabs(x.hi), 4.0) - std::fabs(x.hi)) / 2;
    switch (rng.index(4)) {
        case 0: break;
        case 1: x.lo = half * rng.sign(); break;  // a tie of 53 bits
        case 2: x.lo = half * rng.signed_magnitude(-30, -1); break;
        default: x.lo = half * rng.signed_magnitude(-1021, -1); break;
    }
    if (std::fabs(x.hi) == 1 && std::signbit(x.hi) != std::signbit(x.lo))
        x.lo /= 2;  // the places below are half as large
    if (rng.index(3) != 0) x.bound = rng.magnitude(rng.coin() ? -1074 : -110, -73);
    x.exponent = rng.integer(-exponents, exponents);
    return x;
}

/// A number that differs from x by a few units of its last places.
CertifiedNumber close_to(Seeded& rng, const CertifiedNumber& x) {
    CertifiedNumber y = x;
    if (rng.coin()) y.hi += std::ldexp(rng.sign(), -52);
    if (std::fabs(y.hi) < 1 || std::fabs(y.hi) >= 2) y.hi = x.hi;
    if (rng.coin()) y.lo = rng.signed_magnitude(-60, -54);
    else y.lo = std::nextafter(x.lo, rng.sign());
    return y;
}

}  // namespace

TEST_CASE("scaled_difference is accurate even where the words cancel") {
    Seeded rng(11);
    for (int i = 0; i < 200'000; ++i) {
        const CertifiedNumber x = any_certified(rng, rng.coin() ? 5 : 2000);
        const CertifiedNumber y = rng.coin() ? any_certified(rng, 2000) : close_to(rng, x);
        const std::int64_t e = std::max(x.exponent, y.exponent);
        const double computed = scaled_difference(x, y, e);
        const Dyadic exact = (Dyadic(x) - Dyadic(y)).scaled(-e);
        const Dyadic error = Dyadic(computed) - exact;
        // |error| ≤ 2^-50 |exact| + 2^-1073, squared
        const Dyadic allowed = exact.scaled(-50) * exact.scaled(-50) + Dyadic(1.0).scaled(-2146);
        INFO(std::hexfloat << x.hi << ' ' << x.lo << ' ' << x.exponent << "; " << y.hi << ' ' << y.lo << ' '
                           << y.exponent);
        if (compare(error * error, allowed) > 0) FAIL("computed " << std::hexfloat << computed);
    }
}

TEST_CASE("scaled_difference overflows to infinity and underflows to zero with its scale") {
    const CertifiedNumber x = as_certified(3.0), y = as_certified(1.0);
    CHECK(scaled_difference(x, y, -3000) == HUGE_VAL);
    CHECK(scaled_difference(y, x, -3000) == -HUGE_VAL);
    CHECK(scaled_difference(x, y, 3000) == 0);
    CHECK(scaled_difference(x, y, 1) == 1);
    CHECK(scaled_difference(x, {}, 0) == 3);
    CHECK(scaled_difference({}, x, 0) == -3);
    CHECK(scaled_difference({}, {}, 0) == 0);
}

TEST_CASE("compare answers only where both bounds allow it, and always where they are disjoint") {
    Seeded rng(12);
    int decided_count = 0, value_of = 0;
    for (int i = 0; i < 200'000; ++i) {
        const CertifiedNumber x = any_certified(rng, 3);
        CertifiedNumber y = rng.index(3) == 0 ? any_certified(rng, 3) : close_to(rng, x);
        if (rng.index(20) == 0) y = {};
        const int order = lostbits::measure::truth::compare(x, y);
        const bool below = compare(upper_end(x), lower_end(y))<0, above = compare(lower_end(x), upper_end(y))> 0;
        INFO(std::hexfloat << x.hi << ' ' << x.lo << ' ' << x.bound << "; " << y.hi << ' ' << y.lo << ' ' << y.bound);
        if ((order < 0 && !below) || (order > 0 && !above)) FAIL("claims " << order);
        if (order != -lostbits::measure::truth::compare(y, x)) FAIL("depends on the order of its arguments");
        // If two values are twice their bounds apart, there must be an answer.
        const Dyadic gap = Dyadic(x) - Dyadic(y);
        const Dyadic sum = Dyadic(x.bound).scaled(x.exponent) + Dyadic(y.bound).scaled(y.exponent);
        const Dyadic bounds = sum.scaled(1) + Dyadic(1.0).scaled(-990);
        if (order == 0 && compare(gap * gap, bounds * bounds) > 0) FAIL("says nothing");
        ++(order == 0 ? value_of : decided_count);
    }
    CHECK(decided_count > 10'000);
    CHECK(value_of > 1'000);
}

TEST_CASE("nearer encloses the smaller of any two numbers within the bounds") {
    Seeded rng(13);
    const auto smaller = [](const Dyadic& a, const Dyadic& b) { return compare(a, b) <= 0 ? a : b; };
    for (int i = 0; i < 200'000; ++i) {
        const CertifiedNumber x = any_certified(rng, 3);
        const CertifiedNumber y = rng.index(3) == 0 ? any_certified(rng, 3) : close_to(rng, x);
        const CertifiedNumber r = nearer(x, y);
        INFO(std::hexfloat << x.hi << ' ' << x.lo << ' ' << x.bound << "; " << y.hi << ' ' << y.lo << ' ' << y.bound);
        if (compare(lower_end(r), smaller(lower_end(x), lower_end(y))) > 0) FAIL("lower end");
        if (compare(upper_end(r), smaller(upper_end(x), upper_end(y))) < 0) FAIL("upper end");
    }
}

TEST_CASE("both ends round correctly to any format, also ties and tails of a thousand digits") {
    Seeded rng(14);
    static constexpr FloatFormat formats[] = {binary64, binary32, binary16, bfloat16, tensor_float32};
    int straddled = 0;
    for (int i = 0; i < 400'000; ++i) {
        const FloatFormat f =
            rng.coin() ? formats[rng.index(5)] : FloatFormat{static_cast<int>(rng.integer(2, 53)), -1022, 1023};
        CertifiedNumber x = any_certified(rng, 1100);
        if (rng.coin()) x.exponent = rng.integer(f.emin - f.precision - 2, f.emin + 1);
        if (rng.index(8) == 0) x.exponent = f.emax + rng.index(2);
        if (rng.coin()) x.hi = std::copysign(2 - std::ldexp(1.0, -rng.index(53)), x.hi);  // all ones
        if (std::fabs(x.hi) == 1 && std::signbit(x.hi) != std::signbit(x.lo)) x.lo = 0;
        const measure::truth::Neighbours ends = measure::truth::round_ends(x, f);
        const auto correct = [&](double rounded, const Dyadic& end) {
            if (end.sign() >= 0)
                return is_rounded(
                    rounded, [&](const Dyadic& m) { return compare(end, m); }, f);
            return is_rounded(
                -rounded, [&](const Dyadic& m) { return compare(-end, m); }, f);
        };
        INFO(std::hexfloat << x.hi << ", " << x.lo << ", " << x.bound << ", " << x.exponent << " to " << f.precision
                           << " bits");
        if (!correct(ends.lower, lower_end(x))) FAIL("lower end " << std::hexfloat << ends.lower);
        if (!correct(ends.upper, upper_end(x))) FAIL("upper end " << std::hexfloat << ends.upper);
        const auto rounded = round_certified(x, f);
        if (rounded.has_value() != (ends.lower == ends.upper)) FAIL("round_certified differs");
        if (rounded && *rounded != ends.lower) FAIL("round_certified differs");
        straddled += !rounded;
    }
    CHECK(straddled > 1000);
    CHECK(round_certified({}, binary16) == 0.0);
}

TEST_CASE("certify keeps the enclosure of a ball or an interval") {
    Seeded rng(15);
    for (int i = 0; i < 20'000; ++i) {
        const Ball exact = Ball(rng.signed_magnitude(-900, 890)) + Ball(rng.signed_magnitude(-1000, 890));
        if (const auto c = certify(exact)) {
            const Dyadic value = Dyadic(exact.hi()) + Dyadic(exact.lo());
            INFO(std::hexfloat << exact.hi() << ' ' << exact.lo());
            if (compare(lower_end(*c), value) > 0 || compare(upper_end(*c), value) < 0)
                FAIL("the ball is not enclosed");
            if (!(std::fabs(c->hi) >= 1 && std::fabs(c->hi) < 2)) FAIL("hi is not normalised");
        }
        const Interval::Precision precision(rng.integer(96, 3000));
        const Interval far = Interval(rng.signed_magnitude(-1000, 1000)) / Interval(rng.magnitude(-1000, 1000));
        const Interval aside(rng.coin() ? 0.0 : rng.magnitude(-1074, 900));
        const Interval x = far * far / (rng.coin() ? Interval(1) : Interval(-3)) + aside;
        if (const auto c = certify(x)) {
            if (compare(lower_end(*c), Dyadic(x.lower())) > 0 || compare(upper_end(*c), Dyadic(x.upper())) < 0)
                FAIL("the interval is not enclosed");
            if (!(std::fabs(c->hi) >= 1 && std::fabs(c->hi) < 2)) FAIL("hi is not normalised");
            if (!(c->bound <= 2 * measure::truth::certified_tightness)) FAIL("the bound is not tight");
        }
    }
    CHECK_FALSE(certify(Ball::all_reals()));
    CHECK_FALSE(certify(Ball(1.0, 0, 0x1p-60)));
    CHECK_FALSE(certify(Interval::between(-1, 1)));
    CHECK_FALSE(certify(Interval::between(0, 1)));
    CHECK_FALSE(certify(Interval::between(1, 1 + 0x1p-52)));
    CHECK(certify(Ball(0))->is_zero());
    CHECK(certify(Interval(0))->is_zero());
}

TEST_CASE("a double certifies itself, and its binade is known") {
    for (const double x : {1.0, -1.0, 1.5, 0x1p-1074, 0x1.8p-1073, 0x1.fffffffffffffp+1023, -0x1p-1022}) {
        const CertifiedNumber c = as_certified(x);
        CHECK(compare(Dyadic(c), Dyadic(x)) == 0);
        CHECK(c.bound == 0);
        CHECK(c.floor_log2() == std::ilogb(x));
        CHECK(round_certified(c, binary64) == x);
    }
    CHECK(as_certified(0.0).is_zero());
    CHECK(CertifiedNumber{1, -0x1p-70, 0, 5}.floor_log2() == 4);
    CHECK(CertifiedNumber{-1, 0x1p-70, 0, 5}.floor_log2() == 4);
    CHECK(CertifiedNumber{1, 0x1p-70, 0, 5}.floor_log2() == 5);
    CHECK(CertifiedNumber{-1, -0x1p-70, 0, 5}.floor_log2() == 5);
}

TEST_CASE("ordinals are the bit patterns of the formats") {
    Seeded rng(16);
    for (int i = 0; i < 100'000; ++i) {
        const double x = std::bit_cast<double>(rng.bits(64));
        if (!std::isnan(x)) REQUIRE(ordinal(std::fabs(x), binary64) == std::bit_cast<std::int64_t>(std::fabs(x)));
        const float y = std::bit_cast<float>(static_cast<std::uint32_t>(rng.bits(32)));
        if (!std::isnan(y)) REQUIRE(ordinal(-std::fabs(y), binary32) == -std::bit_cast<std::int32_t>(std::fabs(y)));
    }
    CHECK(ordinal(HUGE_VAL, binary64) == 0x7ff0000000000000);
    CHECK(ordinal(-HUGE_VAL, binary32) == -0x7f800000);
    CHECK(ordinal(-0.0, binary64) == 0);
    // From zero to infinity, one by one: the position is the number of steps, which is the bit pattern.
    for (const auto& [f, infinity] : {std::pair{binary16, 0x7c00}, {bfloat16, 0x7f80}, {FloatFormat{2, -2, 3}, 14}}) {
        double x = 0;
        for (int n = 0; n <= infinity; ++n, x = rounding::next_up(x, f)) {
            if (ordinal(x, f) != n || ordinal(-x, f) != -n) FAIL(x << " at " << n);
        }
        CHECK(std::isinf(x));
    }
}

TEST_CASE("an infinite answer loses nothing where the truth rounds to infinity, and all bits elsewhere") {
    using measure::truth::lost_bits;
    using measure::truth::ulp_error;
    for (const FloatFormat& format : {binary32, binary64, FloatFormat(binary16)}) {
        const int p = format.precision;
        CertifiedNumber tie{.hi = 2 - std::ldexp(1.0, -p), .exponent = 1 - format.emin};
        if (p == 53) tie = {.hi = 2 - 0x1p-52, .lo = 0x1p-53, .exponent = 1 - format.emin};
        CertifiedNumber below = tie, beyond = tie;
        below.lo -= 0x1p-70, beyond.exponent += 5000;
        for (const auto& x : {tie, beyond}) CHECK(ulp_error(HUGE_VAL, x, format) == 0);
        CHECK(ulp_error(HUGE_VAL, below, format) == HUGE_VAL);
        CHECK(ulp_error(-HUGE_VAL, beyond, format) == -HUGE_VAL);
        CHECK(lost_bits(ulp_error(HUGE_VAL, as_certified(1), format), p) == p);
        CHECK(lost_bits(ulp_error(0, beyond, format), p) == p);
    }
}

}  // namespace test_certified
