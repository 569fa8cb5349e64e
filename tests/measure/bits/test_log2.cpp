// log2_of: within its bound of MPFR's result, exact at powers of two, and monotone.
#include <mpfr.h>

#include <cmath>
#include <ios>
#include <limits>

#include "catch.hpp"
#include "counts.hpp"
#include "measure/bits/log2.hpp"
#include "number/random.hpp"

namespace lostbits::test::test_log2 {

using measure::bits::log2_of;

namespace {

/// |y − log2 x| in ulps of log2 x, by MPFR at 128 bits.
class Reference {
public:
    Reference() { mpfr_inits2(128, x_, y_, static_cast<mpfr_ptr>(nullptr)); }
    ~Reference() { mpfr_clears(x_, y_, static_cast<mpfr_ptr>(nullptr)); }
    Reference(const Reference&) = delete;
    Reference& operator=(const Reference&) = delete;

    double error(double x, double y) {
        mpfr_set_d(x_, x, MPFR_RNDN);
        mpfr_log2(y_, x_, MPFR_RNDN);
        if (mpfr_zero_p(y_) != 0) return y == 0 ? 0 : HUGE_VAL;
        const auto ulp = mpfr_get_exp(y_) - 53;
        mpfr_d_sub(y_, y, y_, MPFR_RNDN);
        return std::fabs(std::ldexp(mpfr_get_d(y_, MPFR_RNDN), static_cast<int>(-ulp)));
    }

private:
    mpfr_t x_, y_;
};

}  // namespace

TEST_CASE("log2 is within 1.4 ulp of the truth", "[measure][bits]") {
    Reference reference;
    double worst = 0;
    const auto look = [&](double x) {
        const double error = reference.error(x, log2_of(x));
        if (error > worst) worst = error;
        if (error >= 1.4) FAIL(std::hexfloat << x << ": off by " << std::defaultfloat << error << " ulp");
    };
    Random random(20260801);
    for (int i = 0; i < test::draws(400'000); ++i) {
        look(std::ldexp(1 + random.unit(), static_cast<int>(random.between(-1022, 1022))));
        look(1 + random.unit());                                                              // one binade above 1
        look(1 - random.unit() / 2);                                                          // and one below
        look(1 + std::ldexp(random.unit() - 0.5, static_cast<int>(random.between(-50, 0))));  // close to 1
        look(std::sqrt(0.5) *
             (1 + std::ldexp(random.unit() - 0.5, -static_cast<int>(random.between(0, 40)))));  // where m turns over
    }
    for (int e = -1022; e <= 1023; ++e) {
        const double power = std::ldexp(1.0, e);
        for (const double x : {power, std::nextafter(power, 0.0), std::nextafter(power, HUGE_VAL)}) {
            if (std::isnormal(x)) look(x);
        }
    }
    look(std::numeric_limits<double>::max());
    INFO(worst);
    CHECK(worst > 0.8);  // a reference without enough bits would give 0
}

TEST_CASE("log2 of a power of two is its exponent", "[measure][bits]") {
    for (int e = -1022; e <= 1023; ++e) REQUIRE(log2_of(std::ldexp(1.0, e)) == e);
}

TEST_CASE("log2 never falls from one double to the next", "[measure][bits]") {
    Random random(7);
    for (int i = 0; i < 2000; ++i) {
        double x = i % 2 == 0 ? std::ldexp(1 + random.unit(), static_cast<int>(random.between(-30, 60)))
                              : std::ldexp(1.0, i / 2 % 60 - 2) * (1 - 0x1p-49);
        for (int k = 0; k < 64; ++k) {
            const double above = std::nextafter(x, HUGE_VAL);
            REQUIRE(log2_of(x) <= log2_of(above));
            x = above;
        }
    }
}

}  // namespace lostbits::test::test_log2
