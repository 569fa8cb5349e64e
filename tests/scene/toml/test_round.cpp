#include "scene/toml/round.hpp"

#include <cmath>
#include <random>

#include <mpfr.h>

#include "catch.hpp"
#include "number/rounded.hpp"
#include "scene/scene_text.hpp"

namespace test_round {

using namespace lostbits;
using namespace lostbits::scene;
using namespace lostbits::scene::toml;
using scene::test::real;

namespace {

constexpr FloatFormat formats[] = {binary16, bfloat16,         tensor_float32,    binary32,
                                   binary64, {2, -1022, 1023}, {27, -1022, 1023}, {4, -6, 7}};

/// The independent twin: MPFR's own emulation of a format, by exponent range and `mpfr_subnormalize`.
double by_emulation(const Real& x, const FloatFormat& f) {
    const mpfr_exp_t emin = mpfr_get_emin(), emax = mpfr_get_emax();
    mpfr_t y;
    mpfr_init2(y, f.precision);
    // MPFR's significands lie in [1/2, 1): exponents are one larger than ours.
    mpfr_set_emin(f.emin - f.precision + 2);
    mpfr_set_emax(f.emax + 1);
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

TEST_CASE("rounding to binary32 at its edges") {
    const double infinity = std::numeric_limits<double>::infinity();
    CHECK(scene::toml::round_to_format(real("0x1.fffffep+127"), binary32) == 0x1.fffffep+127);
    CHECK(round_to_format(real("0x1.fffffefffffffp+127"), binary32) == 0x1.fffffep+127);
    CHECK(round_to_format(real("0x1.ffffffp+127"), binary32) == infinity);  // the middle goes to even
    CHECK(round_to_format(real("-0x1.ffffffp+127"), binary32) == -infinity);
    CHECK(round_to_format(real("0x1p-149"), binary32) == 0x1p-149);
    CHECK(same(round_to_format(real("0x1p-150"), binary32), 0.0));  // half the smallest: even is zero
    CHECK(same(round_to_format(real("-0x1p-150"), binary32), -0.0));
    CHECK(round_to_format(real("0x1.00000000000000000001p-150"), binary32) == 0x1p-149);
    CHECK(round_to_format(real("0x1.8p-149"), binary32) == 0x1p-148);
    CHECK(round_to_format(real("0x1.ffffffp-127"), binary32) == 0x1p-126);  // up into the normal numbers
    CHECK(same(round_to_format(Real(0), binary32), 0.0));
    CHECK(same(round_to_format(real("-0"), binary32), -0.0));
    CHECK(round_to_format(real("1e-400"), binary64) == 0);
}

TEST_CASE("rounding agrees with MPFR's emulation of the format, subnormals and overflow included") {
    std::mt19937_64 engine(20190225);
    for (const FloatFormat& f : formats) {
        CAPTURE(f.precision, f.emin, f.emax);
        const int lowest = f.emin - f.precision - 3;
        const int span = f.emax + 3 - lowest;
        int subnormal = 0, infinite = 0, ties = 0;
        for (int i = 0; i < 4000; ++i) {
            // Few significant bits make ties; many sit next to them.
            const int cleared = engine() % 3 == 0 ? static_cast<int>(engine() % 63) : 62 - f.precision;
            Real x = Real(static_cast<long long>((engine() >> 1 | 1ULL << 62) & ~0ULL << cleared));
            const auto below = [&](int n) { return static_cast<int>(engine() % static_cast<unsigned>(n)); };
            const int where = below(4);
            const int exponent = where == 0   ? f.emin - below(f.precision + 3)
                                 : where == 1 ? f.emax + 1 - below(3)
                                              : lowest + below(span);
            x = ldexp(x, exponent - 62);
            if (engine() % 4 == 0) x += ldexp(x, -120);
            if (engine() % 2 == 0) x = -x;
            const double ours = scene::toml::round_to_format(x, f);
            CAPTURE(x, exponent);
            REQUIRE(same(ours, by_emulation(x, f)));
            subnormal += std::fabs(ours) < std::ldexp(1.0, f.emin);
            infinite += std::isinf(ours);
            ties += abs(abs(x) - std::fabs(ours)) * 2 == ldexp(Real(1), static_cast<int>(ulp_exponent(f, exponent)));
        }
        CHECK(subnormal > 100);
        CHECK(infinite > 100);
        CHECK(ties > 100);
    }
}

TEST_CASE("rounding a double agrees with the rounding of Rounded") {
    std::mt19937_64 engine(7);
    for (const FloatFormat& f : formats) {
        for (int i = 0; i < 2000; ++i) {
            const double x = std::bit_cast<double>(engine());
            if (!std::isfinite(x)) continue;
            CAPTURE(x, f.precision, f.emin);
            REQUIRE(same(scene::toml::round_to_format(Real(x), f), rounding::to_format(x, 0, f)));
        }
    }
}

}  // namespace test_round
