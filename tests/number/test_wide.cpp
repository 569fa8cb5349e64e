// Double-double and exact sums, compared with MPFR.
#include "catch.hpp"
#include "number/oracle.hpp"
#include "number/random.hpp"
#include "number/wide/exact_sum.hpp"
#include "number/wide/widening.hpp"

namespace lostbits::test {
namespace {

using number::wide::ExactSum;
using number::wide::TwoWords;

double draw(Random& random, int reach) {
    return random.sign() * std::ldexp(1 + random.unit(), static_cast<int>(random.between(-reach, reach)));
}

TwoWords<double> draw_words(Random& random) {
    const double hi = draw(random, 60);
    return number::wide::ordered_sum(hi, hi * 0x1p-54 * (2 * random.unit() - 1));
}

Mpfr exact(const TwoWords<double>& x) {
    Mpfr sum(x.hi, 3000);
    mpfr_add_d(sum, sum, x.lo, MPFR_RNDN);
    return sum;
}

/// |x − want| ≤ 2^-102 |want|
bool is_close(const TwoWords<double>& x, const Mpfr& want) {
    Mpfr error(3000), slack(3000);
    mpfr_sub(error, exact(x), want, MPFR_RNDA);
    mpfr_mul_2si(slack, want, -102, MPFR_RNDZ);
    return mpfr_cmpabs(error, slack) <= 0;
}

}  // namespace

TEST_CASE("operations on two words are accurate to 2^-102 of the result", "[number][wide]") {
    Random random(0x2d);
    int off = 0;
    for (int i = 0; i < 100000; ++i) {
        const TwoWords<double> a = draw_words(random),
                               b = random.one_in(4) ? -a + draw_words(random) : draw_words(random);
        Mpfr want(3000);
        mpfr_add(want, exact(a), exact(b), MPFR_RNDN);
        off += !is_close(a + b, want);
        mpfr_mul(want, exact(a), exact(b), MPFR_RNDN);
        off += !is_close(a * b, want);
        mpfr_div(want, exact(a), exact(b), MPFR_RNDN);
        off += b.hi != 0 && !is_close(a / b, want);
        mpfr_sqrt(want, exact(abs(a)), MPFR_RNDN);
        off += !is_close(sqrt(abs(a)), want);
        const int order = mpfr_cmp(exact(a), exact(b));
        off += (a < b) != (order < 0) || (a <= b) != (order <= 0) || (a > b) != (order > 0) || (a >= b) != (order >= 0);
    }
    CHECK(off == 0);
    CHECK(unit_roundoff<TwoWords<double>>().hi == 0x1p-102);
}

TEST_CASE("the sign of an exact sum is the sign of the sum", "[number][wide]") {
    Random random(0xe5);
    int wrong = 0, zeros = 0;
    for (int i = 0; i < 100000; ++i) {
        ExactSum<double, 12> sum;
        Mpfr want(0, 3000);
        const bool cancels = random.one_in(2);
        for (int k = 0; k < 3; ++k) {
            const double x = draw(random, 100), y = draw(random, 100);
            // The same products again with the opposite sign, in another order: only the added numbers are left.
            sum.add_product(x, y);
            sum.add_product(cancels ? -y : draw(random, 100), cancels ? x : draw(random, 100));
        }
        for (const double word : sum.words()) mpfr_add_d(want, want, word, MPFR_RNDN);
        const double got = sum.value();
        zeros += mpfr_zero_p(static_cast<mpfr_srcptr>(want)) != 0;
        wrong += (got > 0) != (mpfr_cmp_ui(want, 0) > 0) || (got < 0) != (mpfr_cmp_ui(want, 0) < 0);
        mpfr_sub_d(want, want, got, MPFR_RNDN);
        wrong += mpfr_cmpabs(want, Mpfr(std::fabs(got) * 0x1p-52, 53)) > 0;
    }
    CHECK(wrong == 0);
    CHECK(zeros > 40000);
    // Words as far apart as doubles go.
    ExactSum<double, 4> far;
    far.add({0x1p+1000, -0x1p-1000});
    far.add({-0x1p+1000, 0});
    CHECK(far.value() == -0x1p-1000);
}

}  // namespace lostbits::test
