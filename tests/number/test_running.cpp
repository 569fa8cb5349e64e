// Running, of one word and of two, against intervals of thousands of bits: every operation holds the exact result of
// every number that it was given, over all exponents; no comparison is decided wrongly, and none by a bound that is
// infinite or NaN.
#include <array>
#include <cmath>
#include <limits>

#include "catch.hpp"
#include "counts.hpp"
#include "number/interval.hpp"
#include "number/oracle.hpp"
#include "number/random.hpp"
#include "number/wide/running.hpp"

namespace lostbits::test::test_running {

using number::wide::Running;
using number::wide::TwoWords;

namespace {

/// Exact for sums of doubles, and for products of a few but where their exponents lie far apart.
constexpr long exact_bits = 2400;

Interval exactly(double x) { return Interval(x); }
Interval exactly(const TwoWords<double>& x) { return Interval(x.hi) + Interval(x.lo); }

/// A number and one that it holds.
template <class W>
struct Held {
    Running<W> number;
    Interval exact;
};

double any_double(Random& random) {
    return random.sign() * std::ldexp(1 + random.unit(), static_cast<int>(random.between(-1075, 1022)));
}

double words_of(double first, Random&, double) { return first; }
TwoWords<double> words_of(double first, Random& random, const TwoWords<double>&) {
    if (random.one_in(3)) return TwoWords<double>(first);
    return number::wide::ordered_sum(first, first * std::ldexp(random.unit() - 0.5, -52));
}

double any_bound(double size, Random& random) {
    if (random.one_in(3)) return 0;
    if (random.one_in(16)) return std::ldexp(1.0, static_cast<int>(random.between(-1074, 1000)));
    return std::fabs(size) * std::ldexp(1 + random.unit(), -static_cast<int>(random.between(1, 108)));
}

template <class W>
Held<W> draw(Random& random, double first) {
    const W words = words_of(first, random, W());
    const double bound = any_bound(first, random), part = random.one_in(2) ? random.sign() : 2 * random.unit() - 1;
    return {Running<W>(words, bound), exactly(words) + Interval(part) * Interval(bound)};
}

/// Two of like size, or nearly the same, or any.
template <class W>
std::array<Held<W>, 2> draw_two(Random& random) {
    const double x = random.one_in(50) ? 0 : any_double(random);
    double y = any_double(random);
    if (random.one_in(2)) y = x * std::ldexp(1 + random.unit(), static_cast<int>(random.between(-60, 60)));
    if (random.one_in(4)) y = random.sign() * x * (1 + std::ldexp(1.0, -static_cast<int>(random.between(1, 60))));
    if (!std::isfinite(y)) y = 1;
    return {draw<W>(random, x), draw<W>(random, y)};
}

struct Tried {
    std::size_t finite = 0, wrong = 0;
    double most = 0;  ///< of the errors, over the bound
    std::string first_wrong;
};

template <class W>
void hold(const Running<W>& found, const Interval& exact, const std::string& what, Tried& tried) {
    const double bound = found.radius();
    if (!(bound < HUGE_VAL)) return;
    ++tried.finite;
    const Interval off = abs(exact - exactly(found.words()));
    if ((off <= Interval(bound)).is_yes()) {
        if (bound > 0) tried.most = std::max(tried.most, mpfr_get_d((off / Interval(bound)).lower(), MPFR_RNDD));
        return;
    }
    if (tried.wrong++ == 0) tried.first_wrong = what;
}

template <class W>
Tried try_operation(Op op, std::size_t draws) {
    const Interval::Precision precision(exact_bits);
    Random random(41);
    Tried tried;
    for (std::size_t i = 0; i < draws; ++i) {
        const auto [x, y] = draw_two<W>(random);
        const auto found = apply(op, x.number, y.number, x.number);
        const Interval exact = apply(op, x.exact, y.exact, x.exact);
        const std::string what = Mpfr(x.number.first(), 53).text() + ", " + Mpfr(y.number.first(), 53).text() +
                                 " within " + Mpfr(y.number.radius(), 53).text();
        hold(found, exact, what, tried);
    }
    return tried;
}

template <class W>
void operations_hold(double least) {
    for (const Op op : every_op) {
        const Tried tried = try_operation<W>(op, draws<std::size_t>(200'000));
        INFO(op_names[static_cast<std::size_t>(op)] << " of " << tried.first_wrong);
        CHECK(tried.wrong == 0);
        CHECK(tried.finite > draws<std::size_t>(200'000) / 20);
        // A bound that is much larger than it must be would settle nothing.
        for (const Op rounded : {Op::add, Op::subtract, Op::multiply, Op::divide, Op::root})
            if (op == rounded) CHECK(tried.most > least);
    }
}

/// Sums of products, which have bounds of their own: of six numbers, of which some are alike, or of three squares.
template <class W>
std::array<Tried, 3> try_sums(std::size_t draws) {
    const Interval::Precision precision(exact_bits);
    Random random(43);
    std::array<Tried, 3> tried;
    for (std::size_t i = 0; i < draws; ++i) {
        const auto [a, b] = draw_two<W>(random);
        const auto [c, d] = draw_two<W>(random);
        const auto [f, g] = draw_two<W>(random);
        const std::string what = Mpfr(a.number.first(), 53).text() + ", " + Mpfr(c.number.first(), 53).text();
        // a d − b c cancels where a is nearly b and c nearly d.
        hold(difference_of_products(a.number, d.number, b.number, c.number), a.exact * d.exact - b.exact * c.exact,
             what, tried[0]);
        hold(sum_of_products(a.number, d.number, -b.number, c.number, f.number, g.number),
             a.exact * d.exact - b.exact * c.exact + f.exact * g.exact, what, tried[1]);
        hold(sum_of_squares(a.number, b.number, c.number), square(a.exact) + square(b.exact) + square(c.exact), what,
             tried[2]);
    }
    return tried;
}

template <class W>
void sums_hold(double least) {
    for (const Tried& tried : try_sums<W>(draws<std::size_t>(200'000))) {
        INFO(tried.first_wrong);
        CHECK(tried.wrong == 0);
        CHECK(tried.finite > draws<std::size_t>(200'000) / 20);
        CHECK(tried.most > least);
    }
}

template <class Mask>
std::size_t wrongly(const Tris<Mask>& said, const Tri& is) {
    return (said.yes() && is.is_no()) || (said.no() && is.is_yes());
}

template <class W>
void comparisons_hold() {
    const Interval::Precision precision(exact_bits);
    Random random(42);
    std::size_t wrong = 0, told = 0, products = 0;
    const std::size_t all = draws<std::size_t>(200'000);
    for (std::size_t i = 0; i < all; ++i) {
        const auto [a, b] = draw_two<W>(random);
        const auto [c, d] = draw_two<W>(random);
        const auto less = a.number < b.number;
        wrong += wrongly(less, a.exact < b.exact) + wrongly(a.number <= b.number, a.exact <= b.exact);
        wrong += wrongly(a.number > b.number, a.exact > b.exact) + wrongly(a.number >= b.number, a.exact >= b.exact);
        told += less.yes() || less.no();
        // a d against b c: where c is nearly d that is nearly a against b.
        const auto x = a.number * d.number, y = b.number * c.number;
        const Interval exact = a.exact * d.exact - b.exact * c.exact;
        wrong += wrongly(x < y, exact < Interval(0)) + wrongly(x <= y, exact <= Interval(0));
        products += (x < y).yes() || (x < y).no();
    }
    CHECK(wrong == 0);
    CHECK(told > all / 2);
    CHECK(products > all / 4);
}

template <class W>
void nothing_is_said_without_a_bound() {
    constexpr double inf = HUGE_VAL, none = std::numeric_limits<double>::quiet_NaN();
    const Running<W> one(1), two(2);
    const auto silent = [](const auto& said) { return !said.yes() && !said.no(); };
    const auto says_nothing = [&](const Running<W>& x) {
        CHECK(silent(x < one));
        CHECK(silent(one <= x));
        CHECK(silent(x > two));
        CHECK(silent(two >= x));
        for (const auto& y : {x + one, one - x, x * two, x / two, one / x, sqrt(x), -x, abs(x)}) CHECK(silent(y < two));
    };
    for (const double bound : {inf, none}) says_nothing(Running<W>(W(1), bound));
    for (const double word : {inf, -inf, none}) {
        const Running<W> x(W(word), 0);
        CHECK(silent(x < one));
        CHECK(silent(x > one));
        for (const auto& y : {x + one, x * two, sqrt(x)}) CHECK(silent(y < two));
    }
    // What overflows, and quotients and roots that may not exist.
    const Running<W> large(W(0x1p+1000), 0);
    says_nothing(large * large);
    says_nothing(one / Running<W>(W(1), 1.0));
    says_nothing(sqrt(Running<W>(W(1), 1.0)));
    says_nothing(sqrt(-one));
    // Both ways of a decision that is open.
    const Running<W> unsure(W(1), 0.5);
    says_nothing(select(unsure < one, one, two));
    CHECK((select(one < two, one, two) < two).yes());
    CHECK((one - one <= Running<W>(0)).yes());
    CHECK((Running<W>(W(0.25)) > Running<W>(0)).yes());
    CHECK((Running<W>(W(0.25)) < one).yes());
}

}  // namespace

TEST_CASE("running bounds of one word hold what is exact", "[number][running]") {
    operations_hold<double>(0.5);
    sums_hold<double>(0.5);
    comparisons_hold<double>();
    nothing_is_said_without_a_bound<double>();
}

TEST_CASE("running bounds of two words hold what is exact", "[number][running]") {
    operations_hold<TwoWords<double>>(0.1);
    sums_hold<TwoWords<double>>(0.1);
    comparisons_hold<TwoWords<double>>();
    nothing_is_said_without_a_bound<TwoWords<double>>();
}

}  // namespace lostbits::test::test_running
