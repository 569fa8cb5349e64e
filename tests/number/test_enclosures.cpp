// Ball, Interval and their three-valued masks beyond the generic test: tightness, refinement, Kleene's tables.
#include <vector>

#include "catch.hpp"
#include "geometry/vec.hpp"
#include "number/kind.hpp"
#include "number/real.hpp"

namespace lostbits::test {
namespace {

constexpr Op enclosure_ops[] = {Op::add, Op::subtract, Op::multiply, Op::divide, Op::root, Op::fused};

Interval exactly(double x) {
    const Interval::Precision scope(53);
    return Interval(x);
}

bool inside(const Interval& fine, const Interval& coarse) {
    if (coarse.undefined() == Undefined::never && fine.undefined() != Undefined::never) return false;
    return mpfr_lessequal_p(coarse.lower(), fine.lower()) != 0 && mpfr_lessequal_p(fine.upper(), coarse.upper()) != 0;
}

/// An interval in MPFI alone, at the working precision.
struct Ends {
    mpfi_t value;

    explicit Ends(const Interval& x) : Ends(precision_of(x)) { mpfi_interv_fr(value, x.lower(), x.upper()); }
    Ends(Op op, const Ends& a, const Ends& b) : Ends(mpfi_get_prec(a.value)) {
        switch (op) {
            case Op::add: mpfi_add(value, a.value, b.value); break;
            case Op::subtract: mpfi_sub(value, a.value, b.value); break;
            case Op::multiply: mpfi_mul(value, a.value, b.value); break;
            case Op::square: mpfi_sqr(value, a.value); break;
            case Op::negate: mpfi_neg(value, a.value); break;
            default: mpfi_abs(value, a.value); break;
        }
    }
    Ends(Ends&& other) noexcept : Ends(mpfi_get_prec(other.value)) { mpfi_swap(value, other.value); }
    Ends& operator=(Ends&& other) noexcept {
        mpfi_swap(value, other.value);
        return *this;
    }
    ~Ends() { mpfi_clear(value); }

    [[nodiscard]] bool are_those_of(const Interval& x) const {
        return mpfr_equal_p(&value->left, x.lower()) != 0 && mpfr_equal_p(&value->right, x.upper()) != 0 &&
               mpfi_get_prec(value) == precision_of(x) && mpfr_get_prec(x.upper()) == precision_of(x);
    }
    [[nodiscard]] Tri is_below(const Ends& b, bool or_equal) const {
        const int least = mpfr_cmp(&value->left, &b.value->right), most = mpfr_cmp(&value->right, &b.value->left);
        if (or_equal) return most <= 0 ? Tri::yes : least > 0 ? Tri::no : Tri::unknown;
        return most < 0 ? Tri::yes : least >= 0 ? Tri::no : Tri::unknown;
    }

private:
    explicit Ends(mpfr_prec_t bits) { mpfi_init2(value, bits); }
};

}  // namespace

TEST_CASE("three-valued logic follows Kleene's strong tables", "[number][tri]") {
    const Tri no = Tri::no, unknown = Tri::unknown, yes = Tri::yes;
    const Tri value[] = {no, unknown, yes};
    const Tri both[3][3] = {{no, no, no}, {no, unknown, unknown}, {no, unknown, yes}};
    const Tri either[3][3] = {{no, unknown, yes}, {unknown, unknown, yes}, {yes, yes, yes}};
    const Tri negation[3] = {yes, unknown, no};
    for (int i = 0; i < 3; ++i) {
        CHECK((!value[i]) == negation[i]);
        CHECK(any_of(value[i]) == (i != 0));
        CHECK((value[i].is_no() + value[i].is_unknown() + value[i].is_yes()) == 1);
        for (int j = 0; j < 3; ++j) {
            CHECK((value[i] && value[j]) == both[i][j]);
            CHECK((value[i] || value[j]) == either[i][j]);
        }
        CHECK(guard_undefined(value[i], Undefined::never) == value[i]);
        CHECK(guard_undefined(value[i], Undefined::always) == no);
        CHECK(guard_undefined(value[i], Undefined::maybe) == (i == 2 ? unknown : value[i]));
    }
    CHECK(Tri(true) == yes);
    CHECK(Tri(false) == no);
    CHECK(combine_undefined(Undefined::never, Undefined::maybe) == Undefined::maybe);
    CHECK(combine_undefined(Undefined::always, Undefined::maybe) == Undefined::always);
}

TEST_CASE("an interval's ends are the exact result rounded down and up", "[number][interval]") {
    Random random(5);
    int wrong = 0, seen = 0;
    for (int i = 0; i < 60000; ++i) {
        const Op op = enclosure_ops[random.between(0, 4)];  // fma rounds twice
        const auto [a, b, c] = draw_operands(random, binary64, op);
        if (!std::isfinite(a) || !std::isfinite(b) || (op == Op::divide && b == 0) || (op == Op::root && a < 0))
            continue;
        const long precision = random.between(2, 200);
        const Interval x = exactly(a), y = exactly(b);
        const Interval::Precision scope(precision);
        const Interval r = apply(op, x, y, y);
        Mpfr down(precision), up(precision);
        evaluate(op, down, {Mpfr(a, 53), Mpfr(b, 53), Mpfr(b, 53)}, MPFR_RNDD);
        evaluate(op, up, {Mpfr(a, 53), Mpfr(b, 53), Mpfr(b, 53)}, MPFR_RNDU);
        wrong += !mpfr_equal_p(r.lower(), down) || !mpfr_equal_p(r.upper(), up) || r.undefined() != Undefined::never;
        ++seen;
    }
    CHECK(wrong == 0);
    CHECK(seen > 40000);
}

/// Compares the ends of point intervals, which are stored in two words, with those of MPFI.
TEST_CASE("a point interval has the same ends as in MPFI", "[number][interval]") {
    Random random(9);
    int wrong = 0, zeros = 0, wide = 0;
    for (int i = 0; i < 20000; ++i) {
        const Interval::Precision scope(192 * random.between(1, 2));
        std::vector<Interval> all;
        std::vector<Ends> ends;
        const int reach = random.one_in(8) ? 960 : 20;
        const long digits = random.one_in(2) ? 53 : random.between(1, 30);
        for (int k = 0; k < 4; ++k) {
            const double x = random.one_in(9) ? 0 : random.sign() * draw_significand(random, static_cast<int>(digits));
            all.emplace_back(std::ldexp(x, static_cast<int>(random.between(-reach, reach))));
            ends.emplace_back(all.back());
        }
        for (int step = 0; step < 12; ++step) {
            const auto any = [&] { return static_cast<std::size_t>(random.between(0, 3)); };
            const std::size_t a = any(), b = any(), to = any();
            constexpr Op of_points[] = {Op::add, Op::subtract, Op::multiply, Op::square, Op::negate, Op::absolute};
            const Op op = of_points[random.between(0, 5)];
            wrong += (all[a] < all[b]) != ends[a].is_below(ends[b], false);
            wrong += (all[a] <= all[b]) != ends[a].is_below(ends[b], true);
            ends[to] = Ends(op, ends[a], ends[b]);
            all[to] = apply(op, all[a], all[b], all[b]);
            wrong += !ends[to].are_those_of(all[to]) || all[to].undefined() != Undefined::never;
            zeros += all[to].is_exact() && mpfr_zero_p(all[to].lower()) != 0, wide += !all[to].is_exact();
        }
    }
    CHECK(wrong == 0);
    CHECK(zeros > 10000);
    CHECK(wide > 10000);

    // A product whose second word is so small that no double holds its rounding error.
    const Interval::Precision scope(192);
    const Interval first(std::ldexp(0x1p30 - 1, -470)), second(std::ldexp(0x1p53 - 1, -610));
    const Interval both = Interval(0x1p-440) + second;
    CHECK(Ends(Op::multiply, Ends(first), Ends(both)).are_those_of(first * both));
}

TEST_CASE("more precision never widens an interval", "[number][interval]") {
    Random random(6);
    int wrong = 0, narrower = 0;
    for (const Op op : every_op)
        for (int i = 0; i < 10000; ++i) {
            const auto x = Kind<Interval>::draw(random, op);
            const long coarse_bits = random.between(2, 200);
            const auto at = [&](long bits) {
                const Interval::Precision scope(bits);
                // Three operations deep, so that rounded enclosures occur as operands too.
                const Interval r = apply(op, x[0].value, x[1].value, x[2].value);
                return (r + x[1].value) * x[2].value - r;
            };
            const Interval coarse = at(coarse_bits), fine = at(coarse_bits + random.between(1, 200));
            wrong += !inside(fine, coarse);
            narrower += fine.is_bounded() && !inside(coarse, fine);
        }
    CHECK(wrong == 0);
    CHECK(narrower > 10000);
}

TEST_CASE("the working precision applies to results within its scope only", "[number][interval]") {
    const Interval::Precision outer(100);
    const Interval third = Interval(1) / Interval(3);
    CHECK(mpfr_get_prec(third.lower()) == 100);
    {
        const Interval::Precision inner(20);
        CHECK(mpfr_get_prec((Interval(1) / Interval(3)).lower()) == 20);
        const Interval copy = third;
        CHECK(mpfr_get_prec(copy.lower()) == 100);
        CHECK(mpfr_get_prec((third + third).lower()) == 20);
    }
    CHECK(mpfr_get_prec((third + third).lower()) == 100);

    Interval target(5), source(7);
    target = source;
    CHECK(Kind<Interval>::is(target, 7));
    CHECK(Kind<Interval>::is(source, 7));
    target = std::move(source);
    CHECK(Kind<Interval>::is(target, 7));
    CHECK_FALSE(Interval(std::nan("")).is_bounded());
    CHECK_FALSE(Interval(HUGE_VAL).is_bounded());
    CHECK_FALSE(Ball(std::nan("")).is_bounded());
    CHECK_FALSE(Ball(HUGE_VAL).is_bounded());
    CHECK(mpfr_cmp_d(Interval(Real(-0.375)).lower(), -0.375) == 0);
}

TEST_CASE("the square of an interval is never negative, its product with itself can be", "[number][interval]") {
    const Interval x = Interval::between(-1, 2), product = x * x, squared = square(x);
    CHECK(mpfr_cmp_si(product.lower(), -2) == 0);
    CHECK(mpfr_cmp_si(product.upper(), 4) == 0);
    CHECK(mpfr_zero_p(squared.lower()) != 0);
    CHECK(mpfr_cmp_si(squared.upper(), 4) == 0);
    CHECK(mpfr_cmp_si(fma_square(x, Interval(1)).lower(), 1) == 0);
    const Vec<Interval> v(x, x, Interval(0));
    CHECK(sqrt(dot(v, v)).undefined() == Undefined::maybe);
    CHECK(length(v).undefined() == Undefined::never);
}

TEST_CASE("an undecided selection covers both sides", "[number][interval]") {
    const Interval wide = Interval::between(-1, 1), zero(0);
    const Interval both = select(wide < zero, Interval(2), Interval(5));
    CHECK(mpfr_cmp_si(both.lower(), 2) == 0);
    CHECK(mpfr_cmp_si(both.upper(), 5) == 0);
    const Interval half_undefined = select(wide < zero, Interval(2), sqrt(Interval(-1)));
    CHECK(half_undefined.undefined() == Undefined::maybe);
    const Ball either = select(Ball(0, 0, 1) < Ball(0), Ball(2, 0, 0.5), Ball(5, 0, 0.25));
    CHECK(either.hi() - either.radius() <= 1.5);
    CHECK(either.hi() + either.radius() >= 5.25);
    CHECK_FALSE(select(Ball(0, 0, 1) < Ball(0), Ball(2), sqrt(Ball(-1))).is_bounded());
    CHECK(select(Ball(0, 0, 1) < Ball(0), Ball(2), Ball(2)).hi() == 2);
}

TEST_CASE("the root of an interval that may be negative may be undefined", "[number][interval]") {
    const Interval r = sqrt(Interval::between(-1, 4));
    CHECK(r.undefined() == Undefined::maybe);
    CHECK(mpfr_cmp_si(r.lower(), 0) == 0);
    CHECK(mpfr_cmp_si(r.upper(), 2) == 0);
    CHECK((r < Interval(3)).is_unknown());  // it may be NaN, and then it is not
    CHECK((r > Interval(3)).is_no());
    CHECK(sqrt(Interval::between(-4, -1)).undefined() == Undefined::always);
    CHECK(sqrt(Ball(-2, 0, 1)).undefined() == Undefined::always);
    CHECK(sqrt(Ball(2, 0, 3)).undefined() == Undefined::maybe);
}

TEST_CASE("a ball of exact operands is as narrow as double-double allows", "[number][ball]") {
    Random random(8);
    int wrong = 0, seen = 0;
    for (int i = 0; i < 60000; ++i) {
        const Op op = enclosure_ops[random.between(0, 4)];
        double a = std::ldexp(draw_significand(random, 53), static_cast<int>(random.between(-300, 200)));
        const double b =
            random.sign() * std::ldexp(draw_significand(random, 53), static_cast<int>(random.between(-300, 200)));
        if (op == Op::subtract && random.one_in(2)) a = b * (1 + 0x1p-51);
        const Ball r = apply(op, Ball(a), Ball(b), Ball(b));
        if (op == Op::root && a < 0) continue;
        const bool exact = op == Op::add || op == Op::subtract || op == Op::multiply;
        wrong += !r.is_bounded() || (exact ? !r.is_exact() : !(r.radius() <= std::fabs(r.hi()) * 0x1p-99 + 0x1p-959));
        ++seen;
    }
    CHECK(wrong == 0);
    CHECK(seen > 40000);
}

TEST_CASE("a ball outside its exponent range is unbounded and decides nothing", "[number][ball]") {
    const Ball huge(0x1p+600), tiny(0x1p-600);
    CHECK_FALSE((huge * huge).is_bounded());
    CHECK_FALSE((tiny * tiny).is_bounded());
    CHECK_FALSE((huge / tiny).is_bounded());
    CHECK_FALSE((Ball(0x1p+1000) + Ball(0x1p+1000)).is_bounded());
    CHECK((huge * huge > Ball(1)).is_unknown());
    CHECK_FALSE((Ball(1) / Ball(1, 0, 2)).is_bounded());
    CHECK((Ball(1, 0, 0.5) < Ball(1, 0, 0.25)).is_unknown());
    CHECK((Ball(1, 0, 0.25) < Ball(2, 0, 0.5)).is_yes());
}

}  // namespace lostbits::test
