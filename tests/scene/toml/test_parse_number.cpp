// Numbers as people write them, rounded once to a format.
#include <cmath>
#include <cstdlib>
#include <random>

#include <mpfr.h>

#include "catch.hpp"
#include "number/real.hpp"
#include "number/rounded.hpp"
#include "scene/scene_text.hpp"
#include "scene/toml/parse_number.hpp"
#include "scene/toml/round.hpp"

namespace test_parse_number {

using namespace lostbits;
using namespace lostbits::scene;
using namespace lostbits::scene::toml;
using scene::test::real;

namespace {

std::string fault(const std::string& text) {
    const auto parsed = parse_number(text);
    const auto* why = std::get_if<NumberFault>(&parsed);
    return why == nullptr ? "no fault" : why->why;
}

/// Exact comparison of Real with a decimal, through 4000 bits of MPFR: the sign of (x − text).
int compare_with_text(const Real& x, const std::string& text) {
    mpfr_t exact;
    mpfr_init2(exact, 4000);
    mpfr_set_str(exact, text.c_str(), 10, MPFR_RNDN);
    const int sign = mpfr_cmp(x.backend().data(), exact);
    mpfr_clear(exact);
    return sign;
}

constexpr FloatFormat formats[] = {binary16, bfloat16,         tensor_float32,    binary32,
                                   binary64, {2, -1022, 1023}, {27, -1022, 1023}, {4, -6, 7}};

/// The independent implementation: MPFR's own emulation of a format, by exponent range and `mpfr_subnormalize`.
double by_emulation(const Real& x, const FloatFormat& format) {
    const mpfr_exp_t emin = mpfr_get_emin(), emax = mpfr_get_emax();
    mpfr_t y;
    mpfr_init2(y, format.precision);
    // MPFR's significands lie in [1/2, 1): exponents are one larger than ours.
    mpfr_set_emin(format.emin - format.precision + 2);
    mpfr_set_emax(format.emax + 1);
    int inexact = mpfr_set(y, x.backend().data(), MPFR_RNDN);
    inexact = mpfr_check_range(y, inexact, MPFR_RNDN);
    mpfr_subnormalize(y, inexact, MPFR_RNDN);
    const double result = mpfr_get_d(y, MPFR_RNDN);
    mpfr_clear(y);
    mpfr_set_emin(emin);
    mpfr_set_emax(emax);
    return result;
}

bool same(double a, double b) { return a == b && std::signbit(a) == std::signbit(b); }

}  // namespace

TEST_CASE("decimals and hexadecimal floats are read exactly where Real can hold them") {
    CHECK(real("4100") == 4100);
    CHECK(real("+4100") == 4100);
    CHECK(real("-1e-3") * 1000 + 1 < ldexp(Real(1), -200));
    CHECK(real("-0.5") == Real(-0.5));
    CHECK(real(".5") == Real(0.5));
    CHECK(real("5.") == 5);
    CHECK(real("1E3") == 1000);
    CHECK(real("0x1.004p+12") == 4100);
    CHECK(real("-0x1.8P-1") == Real(-0.75));
    CHECK(real("0X10") == 16);
    CHECK(real("0x.8p0") == Real(0.5));
    CHECK(real("0x1p-149") == ldexp(Real(1), -149));
    CHECK(real("9007199254740993") == (Real(9007199254740992) + 1));
    CHECK(mpfr_signbit(real("-0").backend().data()) != 0);
}

TEST_CASE("a decimal is rounded once to a format, without a step through double") {
    // Just above the middle of 1 and the next float: the nearest double is the middle itself, and ties go to even.
    const std::string above = "1.00000005960464477539062500000000000001";
    REQUIRE(static_cast<float>(std::strtod(above.c_str(), nullptr)) == 1.0f);
    CHECK(round_to_format(real(above), binary32) == 1 + 0x1p-23);
    CHECK(round_to_format(real("1.000000059604644775390625"), binary32) == 1);
    const std::string below = "1.00000017881393432617187499999999999999";
    REQUIRE(static_cast<float>(std::strtod(below.c_str(), nullptr)) == 1 + 0x1p-22f);
    CHECK(round_to_format(real(below), binary32) == 1 + 0x1p-23);
}

TEST_CASE("Real rounds only once") {
    // Nearer to the middle than Real can resolve: rounded to nearest, these would be the middle, which rounds to even.
    const std::string zeros(300, '0');
    const std::string nines(300, '9');
    CHECK(round_to_format(real("1.000000059604644775390625" + zeros + "1"), binary32) == 1 + 0x1p-23);
    CHECK(round_to_format(real("-1.000000059604644775390625" + zeros + "1"), binary32) == -1 - 0x1p-23);
    CHECK(round_to_format(real("1.000000178813934326171874" + nines), binary32) == 1 + 0x1p-23);
    CHECK(round_to_format(real("-1.000000178813934326171874" + nines), binary32) == -1 - 0x1p-23);
}

TEST_CASE("a decimal that is not exact is truncated with a sticky last bit") {
    for (const std::string text :
         {"0.1", "-0.1", "0.3", "1e-3", "3.14159", "1e300", "-7e-300", "2.2250738585072011e-308"}) {
        const Real x = real(text);
        CHECK(mpfr_min_prec(x.backend().data()) == static_cast<mpfr_prec_t>(mpfr_get_prec(x.backend().data())));
        Real up = x, down = x;
        mpfr_nextabove(up.backend().data());
        mpfr_nextbelow(down.backend().data());
        CHECK(compare_with_text(up, text) > 0);
        CHECK(compare_with_text(down, text) < 0);
    }
}

TEST_CASE("a number that is not finite is refused with advice") {
    for (const std::string text :
         {"",    " ",  "abc",   "1e",   "1e+",      "e5",    ".",     "-",  "--1", "1.2.3", "1 ",      " 1",
          "1,5", "0x", "0x.p1", "0x1p", "0x1.8e4.", "1e5.0", "1_000", "1f", "1@5", "0b101", "infinite"}) {
        CAPTURE(text);
        CHECK(
            fault(text) ==
            R"(is not a number; write a decimal such as 4100 or "1e-3", or a hexadecimal float such as "0x1.004p+12")");
    }
    for (const std::string text : {"inf", "-inf", "+Inf", "INFINITY", "nan", "-NaN"}) {
        CAPTURE(text);
        CHECK(fault(text).starts_with("is not finite; write a decimal"));
    }
    for (const std::string text :
         {"1e400", "-1e400", "1.8e308", "0x1p1024", "1e999999999999999999999", "-1e999999999999999999999"}) {
        CAPTURE(text);
        CHECK(fault(text).starts_with("is larger than the largest binary64"));
    }
    CHECK(fault("1.7976931348623157e308") == "no fault");
}

TEST_CASE("a tiny number is not read as zero") {
    CHECK(real("1e-400") > 0);
    CHECK(real("-1e-400") < 0);
    CHECK(real("1e-999999999999999999999") > 0);
    CHECK(real("-1e-999999999999999999999") < 0);
}

TEST_CASE("the exact text of a number reads back as the same number") {
    for (const std::string text : {"0.1", "-4100", "1e-300", "0x1.004p+12", "0", "1.7976931348623157e308"}) {
        CAPTURE(text);
        CHECK(real(exact_text(real(text))) == real(text));
    }
    // Written as by C's %a and in the tables: the digit before the point is 1.
    const std::pair<const char*, const char*> texts[] = {
        {"1344", "0x1.5p+10"},    {"-4100", "-0x1.004p+12"},
        {"0x0.fp-1", "0x1.ep-2"}, {"1", "0x1p+0"},
        {"0x1p-149", "0x1p-149"}, {"0", "0x0p+0"},
        {"-0.0", "-0x0p+0"},      {"0x1.fffffep127", "0x1.fffffep+127"}};
    for (const auto& [text, exact] : texts) CHECK(exact_text(real(text)) == exact);
}

TEST_CASE("numbers round correctly at the limits of a format") {
    CHECK(std::isinf(round_to_format(real("0x1.ffffffp+127"), binary32)));  // the middle goes to even
    CHECK(same(round_to_format(real("-0x1p-150"), binary32), -0.0));        // half the smallest: even is zero
    CHECK(round_to_format(real("0x1.00000000000000000001p-150"), binary32) == 0x1p-149);
    CHECK(same(round_to_format(Real(0), binary32), 0.0));
    CHECK(same(round_to_format(real("-0"), binary32), -0.0));
    CHECK(round_to_format(real("1e-400"), binary64) == 0);
}

TEST_CASE("rounding agrees with MPFR's emulation of the format, also at subnormals and overflow") {
    std::mt19937_64 engine(20190225);
    for (const FloatFormat& format : formats) {
        CAPTURE(format.precision, format.emin, format.emax);
        const int lowest = format.emin - format.precision - 3;
        const int span = format.emax + 3 - lowest;
        int subnormal = 0, infinite = 0, ties = 0;
        for (int i = 0; i < 4000; ++i) {
            // Few significant bits make ties; many sit next to them.
            const int cleared = engine() % 3 == 0 ? static_cast<int>(engine() % 63) : 62 - format.precision;
            Real x = Real(static_cast<long long>((engine() >> 1 | 1ULL << 62) & ~0ULL << cleared));
            const auto below = [&](int n) { return static_cast<int>(engine() % static_cast<unsigned>(n)); };
            const int where = below(4);
            const int exponent = where == 0   ? format.emin - below(format.precision + 3)
                                 : where == 1 ? format.emax + 1 - below(3)
                                              : lowest + below(span);
            x = ldexp(x, exponent - 62);
            if (engine() % 4 == 0) x += ldexp(x, -120);
            if (engine() % 2 == 0) x = -x;
            const double ours = round_to_format(x, format);
            CAPTURE(x, exponent);
            REQUIRE(same(ours, by_emulation(x, format)));
            subnormal += std::fabs(ours) < std::ldexp(1.0, format.emin);
            infinite += std::isinf(ours);
            ties +=
                abs(abs(x) - std::fabs(ours)) * 2 == ldexp(Real(1), static_cast<int>(ulp_exponent(format, exponent)));
        }
        CHECK(subnormal > 100);
        CHECK(infinite > 100);
        CHECK(ties > 100);
    }
}

TEST_CASE("rounding a double agrees with Rounded") {
    std::mt19937_64 engine(7);
    for (const FloatFormat& format : formats) {
        for (int i = 0; i < 2000; ++i) {
            const double x = std::bit_cast<double>(engine());
            if (!std::isfinite(x)) continue;
            CAPTURE(x, format.precision, format.emin);
            REQUIRE(same(round_to_format(Real(x), format), rounding::to_format(x, 0, format)));
        }
    }
}

}  // namespace test_parse_number
