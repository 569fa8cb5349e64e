// Proving, of floats and doubles, against intervals of thousands of bits: every operation holds the exact result of
// every number that it was given, over all exponents, and no comparison is decided wrongly; its words are the format's
// own.
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include "catch.hpp"
#include "counts.hpp"
#include "geometry/vec.hpp"
#include "number/interval.hpp"
#include "number/oracle.hpp"
#include "number/random.hpp"
#include "number/recorded.hpp"
#include "number/wide/proving.hpp"

namespace lostbits::test::test_proving {

using number::wide::Proving;

namespace {

constexpr long exact_bits = 2400;

/// A number and one that it holds.
template <class F>
struct Held {
    Proving<F> number;
    Interval exact;
};

template <class F>
F any_number(Random& random) {
    using Limits = std::numeric_limits<F>;
    const long least = Limits::min_exponent - Limits::digits - 1, most = Limits::max_exponent - 2;
    return static_cast<F>(random.sign() * std::ldexp(1 + random.unit(), static_cast<int>(random.between(least, most))));
}

template <class F>
Held<F> draw(Random& random, F w) {
    F bound = 0;
    if (random.one_in(16)) bound = std::fabs(any_number<F>(random));
    else if (!random.one_in(3))
        bound = static_cast<F>(std::fabs(w) * std::ldexp(1 + random.unit(), -static_cast<int>(random.between(1, 60))));
    const double part = random.one_in(2) ? random.sign() : 2 * random.unit() - 1;
    return {Proving<F>(w, bound), Interval(double{w}) + Interval(part) * Interval(double{bound})};
}

/// Two of like size, or nearly the same, or any.
template <class F>
std::array<Held<F>, 2> draw_two(Random& random) {
    const F x = random.one_in(50) ? F(0) : any_number<F>(random);
    F y = any_number<F>(random);
    if (random.one_in(2))
        y = static_cast<F>(x * std::ldexp(1 + random.unit(), static_cast<int>(random.between(-30, 30))));
    if (random.one_in(4))
        y = static_cast<F>(random.sign() * x * (1 + std::ldexp(1.0, -static_cast<int>(random.between(1, 60)))));
    if (!std::isfinite(y)) y = 1;
    return {draw<F>(random, x), draw<F>(random, y)};
}

struct Tried {
    std::size_t finite = 0, wrong = 0, other_words = 0;
    double most = 0;  ///< of the errors, over the bound
};

template <class F>
Tried try_operation(Op op, std::size_t all) {
    const Interval::Precision precision(exact_bits);
    Random random(43);
    Tried tried;
    for (std::size_t i = 0; i < all; ++i) {
        const auto [x, y] = draw_two<F>(random);
        const Proving<F> found = apply(op, x.number, y.number, x.number);
        const Interval exact = apply(op, x.exact, y.exact, x.exact);
        const double bound{found.radius()};
        const F own = op == Op::add        ? x.number.word() + y.number.word()
                      : op == Op::multiply ? x.number.word() * y.number.word()
                      : op == Op::divide   ? x.number.word() / y.number.word()
                                           : found.word();
        tried.other_words += !(own == found.word() || own != own);
        if (!(bound < HUGE_VAL)) continue;
        ++tried.finite;
        const Interval off = abs(exact - Interval(double{found.word()}));
        if (!(off <= Interval(bound)).is_yes()) ++tried.wrong;
        else if (bound > 0) tried.most = std::max(tried.most, mpfr_get_d((off / Interval(bound)).lower(), MPFR_RNDD));
    }
    return tried;
}

}  // namespace

TEMPLATE_TEST_CASE("a bound of the format's own holds every exact result", "[number][proving]", float, double) {
    const auto all = draws<std::size_t>(100'000);
    for (const Op op : every_op) {
        const Tried tried = try_operation<TestType>(op, all);
        INFO(op_names[static_cast<std::size_t>(op)]);
        CHECK(tried.wrong == 0);
        CHECK(tried.other_words == 0);
        CHECK(tried.finite > all / 20);
        // A bound that is much larger than it must be would settle nothing.
        for (const Op rounded : {Op::add, Op::subtract, Op::multiply, Op::divide, Op::root})
            if (op == rounded) CHECK(tried.most > 0.9);
    }
}

TEMPLATE_TEST_CASE("no comparison is decided wrongly by a bound of the format's own", "[number][proving]", float,
                   double) {
    const Interval::Precision precision(exact_bits);
    Random random(44);
    const auto all = draws<std::size_t>(100'000);
    std::size_t wrong = 0, told = 0;
    const auto held = [&](const Tris<bool>& said, const Tri& is) {
        wrong += (said.yes() && !is.is_yes()) || (said.no() && !is.is_no());
        told += said.yes() || said.no();
    };
    for (std::size_t i = 0; i < all; ++i) {
        const auto [a, b] = draw_two<TestType>(random);
        held(a.number < b.number, a.exact < b.exact);
        held(a.number <= b.number, a.exact <= b.exact);
        held(a.number > b.number, a.exact > b.exact);
        held(a.number >= b.number, a.exact >= b.exact);
    }
    CHECK(wrong == 0);
    CHECK(told > all);
    CHECK(told < 4 * all);
}

TEST_CASE("a bound is no operation on a tape, and a choice has both of its sides there", "[number][proving]") {
    using E = Proving<Recorded<float>>;
    const auto recorded = [](float x, float y) {
        Tape tape;
        const Tape::Scope scope(tape);
        const E a((Recorded<float>(x))), b((Recorded<float>(y)));
        const E c = select(a < b, a * b, a + b);
        CHECK(tape[c.word().node()].op == TapeOp::select);
        CHECK(c.word().value() == (x < y ? x * y : x + y));
        std::vector<TapeOp> operations;
        for (const TapeNode& n : tape.nodes) operations.push_back(n.op);
        CHECK(std::ranges::count(operations, TapeOp::mul) == 1);
        CHECK(std::ranges::count(operations, TapeOp::add) == 1);
        return operations;
    };
    // The same operations whichever side is taken: what a metric names of a form is there for every ray.
    CHECK(recorded(3, 4) == recorded(4, 3));
}

}  // namespace lostbits::test::test_proving
