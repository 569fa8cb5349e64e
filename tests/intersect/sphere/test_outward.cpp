// The interval arithmetic inside `pbrt_interval`: moved outward by one number, the result of each operation encloses
// the exact one.
#include <tuple>

#include "catch.hpp"
#include "intersect/outward.hpp"
#include "number/draw.hpp"
#include "number/rounded.hpp"

namespace lostbits::test {
namespace {

using intersect::OutwardInterval;

double value(float x) { return x; }
double value(Half x) { return x.value(); }

/// Bounds drawn in the format, and a point of the interval: one of its ends or a number between them.
template <class T>
struct DrawnRay {
    OutwardInterval<T> interval{0};
    Mpfr point{200};
};

template <class T>
DrawnRay<T> draw(Random& random, const FloatFormat& format, bool positive) {
    const auto finite = [&] { return draw_finite(random, format); };
    double a = finite(), b = random.one_in(3)   ? a
                             : random.one_in(2) ? nearest(Mpfr(a * (1 + random.unit() / 64), 53), format)
                                                : finite();
    if (positive) a = std::fabs(a), b = std::fabs(b);
    if (a > b) std::swap(a, b);
    if (!std::isfinite(b) || !std::isfinite(a)) b = a = 1;
    DrawnRay<T> x{{static_cast<T>(a), static_cast<T>(b)}, Mpfr(200)};
    const long part = random.between(0, 2);
    mpfr_set_d(x.point, part == 0 ? a : b, MPFR_RNDN);
    if (part == 2) mpfr_set_d(x.point, a / 2 + b / 2, MPFR_RNDN);
    if (mpfr_cmp_d(x.point, a) < 0 || mpfr_cmp_d(x.point, b) > 0) mpfr_set_d(x.point, a, MPFR_RNDN);
    return x;
}

template <class T>
void enclose(const FloatFormat& format) {
    Random random(31);
    long wrong = 0, bounded = 0;
    constexpr int rounds = 30000;
    for (const Op op : {Op::add, Op::subtract, Op::multiply, Op::divide, Op::root})
        for (int i = 0; i < rounds; ++i) {
            const DrawnRay<T> a = draw<T>(random, format, op == Op::root), b = draw<T>(random, format, false);
            const auto& [x, y] = std::tie(a.interval, b.interval);
            const OutwardInterval<T> r = op == Op::add        ? x + y
                                         : op == Op::subtract ? x - y
                                         : op == Op::multiply ? x * y
                                         : op == Op::divide   ? x / y
                                                              : sqrt(x);
            Mpfr down(400), up(400);
            evaluate(op, down, {a.point, b.point, b.point}, MPFR_RNDD);
            evaluate(op, up, {a.point, b.point, b.point}, MPFR_RNDU);
            if (!mpfr_number_p(down)) continue;  // a point divided by zero
            wrong += !(mpfr_cmp_d(down, value(r.lo)) >= 0 && mpfr_cmp_d(up, value(r.hi)) <= 0);
            bounded += std::isfinite(value(r.lo)) && std::isfinite(value(r.hi));
        }
    for (int i = 0; i < rounds; ++i) {
        const DrawnRay<T> a = draw<T>(random, format, false);
        const OutwardInterval<T> r = square(a.interval);
        Mpfr exact(400);
        mpfr_sqr(exact, a.point, MPFR_RNDN);
        wrong += !(mpfr_cmp_d(exact, value(r.lo)) >= 0 && mpfr_cmp_d(exact, value(r.hi)) <= 0);
    }
    CHECK(wrong == 0);
    CHECK(bounded > rounds * 2);
}

}  // namespace

TEST_CASE("outward rounding encloses the exact result", "[intersect][outward]") {
    enclose<float>(binary32);
    enclose<Half>(binary16);
}

TEST_CASE("outward roots of sums of squares are never NaN", "[intersect][outward]") {
    // The lower bound of 0² + 0² is the largest negative number, and its root must not be NaN.
    const OutwardInterval<float> zero(0), root = sqrt(square(zero) + square(zero));
    CHECK((square(zero) + square(zero)).lo < 0);
    CHECK(root.lo == 0);
    CHECK(root.hi > 0);
    CHECK(root.hi < 1e-20f);
}

}  // namespace lostbits::test
