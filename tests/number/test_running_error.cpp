// RunningError, of one word and of two, and ProvingNumber, of floats and doubles, against intervals of thousands of
// bits: every operation holds the exact result of every number that it was given, over all exponents; no comparison is
// decided wrongly, and none by a bound that is infinite or NaN. The words of ProvingNumber are the format's own.
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include "catch.hpp"
#include "counts.hpp"
#include "number/interval.hpp"
#include "number/oracle.hpp"
#include "number/random.hpp"
#include "number/recorded.hpp"
#include "number/recorders/tape_recorder.hpp"
#include "number/wide/proving_number.hpp"
#include "number/wide/running_error.hpp"

namespace lostbits::test::test_running_error {

using number::wide::ProvingNumber;
using number::wide::RunningError;
using number::wide::TwoWords;

namespace {

/// Exact for sums of doubles, and for products of a few doubles unless their exponents are far apart.
constexpr long exact_bits = 2400;

template <class N>
constexpr bool proves = false;
template <class F>
constexpr bool proves<ProvingNumber<F>> = true;

/// Words of a number with a bound, and their format.
template <class N>
auto words_of(const N& x) {
    if constexpr (proves<N>) return x.word();
    else return x.words();
}
template <class N>
using Words = decltype(words_of(std::declval<N>()));
template <class N>
using Format = std::conditional_t<std::same_as<Words<N>, float>, float, double>;

Interval exactly(float x) { return Interval(double{x}); }
Interval exactly(double x) { return Interval(x); }
Interval exactly(const TwoWords<double>& x) { return Interval(x.hi) + Interval(x.lo); }

/// A number and an exact value that it contains.
template <class N>
struct ContainedValue {
    N number;
    Interval exact;
    double first;
};

template <class F>
F any_number(Random& random) {
    using Limits = std::numeric_limits<F>;
    const long least = Limits::min_exponent - Limits::digits - 1, most = Limits::max_exponent - 2;
    return static_cast<F>(random.sign() * std::ldexp(1 + random.unit(), static_cast<int>(random.between(least, most))));
}

template <class W>
W draw_words(double first, Random& random) {
    if constexpr (std::floating_point<W>) return static_cast<W>(first);
    else {
        if (random.one_in(3)) return W(first);
        return number::wide::ordered_sum(first, first * std::ldexp(random.unit() - 0.5, -52));
    }
}

template <class F>
F any_bound(double size, Random& random) {
    if (random.one_in(3)) return 0;
    if (random.one_in(16)) return std::fabs(any_number<F>(random));
    return static_cast<F>(std::fabs(size) * std::ldexp(1 + random.unit(), -static_cast<int>(random.between(1, 108))));
}

template <class N>
ContainedValue<N> draw(Random& random, double first) {
    const auto words = draw_words<Words<N>>(first, random);
    const auto bound = any_bound<Format<N>>(first, random);
    const double part = random.one_in(2) ? random.sign() : 2 * random.unit() - 1;
    return {N(words, bound), exactly(words) + Interval(part) * exactly(bound), first};
}

/// Two numbers of similar size, or nearly equal, or any.
template <class N>
std::array<ContainedValue<N>, 2> draw_two(Random& random) {
    using F = Format<N>;
    const double x = random.one_in(50) ? 0 : static_cast<double>(any_number<F>(random));
    double y = any_number<F>(random);
    if (random.one_in(2)) y = x * std::ldexp(1 + random.unit(), static_cast<int>(random.between(-60, 60)));
    if (random.one_in(4)) y = random.sign() * x * (1 + std::ldexp(1.0, -static_cast<int>(random.between(1, 60))));
    if (!std::isfinite(static_cast<F>(y))) y = 1;
    return {draw<N>(random, x), draw<N>(random, y)};
}

struct TriedCounts {
    std::size_t finite = 0, wrong = 0;
    double most = 0;  ///< of the errors, over the bound
    std::string first_wrong;
};

template <class N>
void hold(const N& found, const Interval& exact, const std::string& what, TriedCounts& tried) {
    const double bound{found.radius()};
    if (!(bound < HUGE_VAL)) return;
    ++tried.finite;
    const Interval off = abs(exact - exactly(words_of(found)));
    if ((off <= Interval(bound)).is_yes()) {
        if (bound > 0) tried.most = std::max(tried.most, mpfr_get_d((off / Interval(bound)).lower(), MPFR_RNDD));
        return;
    }
    if (tried.wrong++ == 0) tried.first_wrong = what;
}

/// True if what found it is the format's own operation, of those that have a sign of their own.
template <class N>
bool are_own_words(Op op, const N& x, const N& y, const N& found) {
    if constexpr (!proves<N>) return true;
    else {
        const auto own = op == Op::add        ? x.word() + y.word()
                         : op == Op::multiply ? x.word() * y.word()
                         : op == Op::divide   ? x.word() / y.word()
                                              : found.word();
        return own == found.word() || own != own;
    }
}

template <class N>
TriedCounts try_operation(Op op, std::size_t draws) {
    const Interval::Precision precision(exact_bits);
    Random random(41);
    TriedCounts tried;
    for (std::size_t i = 0; i < draws; ++i) {
        const auto [x, y] = draw_two<N>(random);
        const auto found = apply(op, x.number, y.number, x.number);
        const Interval exact = apply(op, x.exact, y.exact, x.exact);
        const std::string what = Mpfr(x.first, 53).text() + ", " + Mpfr(y.first, 53).text() + " within " +
                                 Mpfr(double{y.number.radius()}, 53).text();
        hold(found, exact, what, tried);
        tried.wrong += !are_own_words(op, x.number, y.number, found);
    }
    return tried;
}

template <class N>
void operations_hold(double least) {
    for (const Op op : every_op) {
        const TriedCounts tried = try_operation<N>(op, draws<std::size_t>(200'000));
        INFO(op_names[static_cast<std::size_t>(op)] << " of " << tried.first_wrong);
        CHECK(tried.wrong == 0);
        CHECK(tried.finite > draws<std::size_t>(200'000) / 20);
        // A bound that is much larger than necessary would settle nothing.
        for (const Op rounded : {Op::add, Op::subtract, Op::multiply, Op::divide, Op::root})
            if (op == rounded) CHECK(tried.most > least);
    }
}

/// Sums of products, which have bounds of their own: of six numbers, of which some are alike, or of three squares.
template <class N>
std::array<TriedCounts, 3> try_sums(std::size_t draws) {
    const Interval::Precision precision(exact_bits);
    Random random(43);
    std::array<TriedCounts, 3> tried;
    for (std::size_t i = 0; i < draws; ++i) {
        const auto [a, b] = draw_two<N>(random);
        const auto [c, d] = draw_two<N>(random);
        const auto [f, g] = draw_two<N>(random);
        const std::string what = Mpfr(a.first, 53).text() + ", " + Mpfr(c.first, 53).text();
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

template <class N>
void sums_hold(double least) {
    for (const TriedCounts& tried : try_sums<N>(draws<std::size_t>(200'000))) {
        INFO(tried.first_wrong);
        CHECK(tried.wrong == 0);
        CHECK(tried.finite > draws<std::size_t>(200'000) / 20);
        CHECK(tried.most > least);
    }
}

template <class Mask>
std::size_t wrongly(const TriMask<Mask>& said, const Tri& is) {
    return (said.yes() && is.is_no()) || (said.no() && is.is_yes());
}

template <class N>
void comparisons_hold() {
    const Interval::Precision precision(exact_bits);
    Random random(42);
    std::size_t wrong = 0, decided_count = 0, products = 0;
    const std::size_t all = draws<std::size_t>(200'000);
    for (std::size_t i = 0; i < all; ++i) {
        const auto [a, b] = draw_two<N>(random);
        const auto [c, d] = draw_two<N>(random);
        const auto less = a.number < b.number;
        wrong += wrongly(less, a.exact < b.exact) + wrongly(a.number <= b.number, a.exact <= b.exact);
        wrong += wrongly(a.number > b.number, a.exact > b.exact) + wrongly(a.number >= b.number, a.exact >= b.exact);
        decided_count += less.yes() || less.no();
        // a d compared with b c: if c is nearly d, then a with b.
        const auto x = a.number * d.number, y = b.number * c.number;
        const Interval exact = a.exact * d.exact - b.exact * c.exact;
        wrong += wrongly(x < y, exact < Interval(0)) + wrongly(x <= y, exact <= Interval(0));
        products += (x < y).yes() || (x < y).no();
    }
    CHECK(wrong == 0);
    CHECK(decided_count > all / 2);
    CHECK(products > all / 4);
}

template <class W>
void nothing_is_said_without_a_bound() {
    constexpr double inf = HUGE_VAL, none = std::numeric_limits<double>::quiet_NaN();
    const RunningError<W> one(1), two(2);
    const auto silent = [](const auto& said) { return !said.yes() && !said.no(); };
    const auto says_nothing = [&](const RunningError<W>& x) {
        CHECK(silent(x < one));
        CHECK(silent(one <= x));
        CHECK(silent(x > two));
        CHECK(silent(two >= x));
        for (const auto& y : {x + one, one - x, x * two, x / two, one / x, sqrt(x), -x, abs(x)}) CHECK(silent(y < two));
    };
    for (const double bound : {inf, none}) says_nothing(RunningError<W>(W(1), bound));
    for (const double word : {inf, -inf, none}) {
        const RunningError<W> x(W(word), 0);
        CHECK(silent(x < one));
        CHECK(silent(x > one));
        for (const auto& y : {x + one, x * two, sqrt(x)}) CHECK(silent(y < two));
    }
    // Results that overflow, and quotients and roots that may not exist.
    const RunningError<W> large(W(0x1p+1000), 0);
    says_nothing(large * large);
    says_nothing(one / RunningError<W>(W(1), 1.0));
    says_nothing(sqrt(RunningError<W>(W(1), 1.0)));
    says_nothing(sqrt(-one));
    // Both sides of an open decision.
    const RunningError<W> unsure(W(1), 0.5);
    says_nothing(select(unsure < one, one, two));
    CHECK((select(one < two, one, two) < two).yes());
    CHECK((one - one <= RunningError<W>(0)).yes());
    CHECK((RunningError<W>(W(0.25)) > RunningError<W>(0)).yes());
    CHECK((RunningError<W>(W(0.25)) < one).yes());
}

}  // namespace

TEST_CASE("running bounds of one word hold the exact value", "[number][running]") {
    operations_hold<RunningError<double>>(0.5);
    sums_hold<RunningError<double>>(0.5);
    comparisons_hold<RunningError<double>>();
    nothing_is_said_without_a_bound<double>();
}

TEST_CASE("running bounds of two words hold the exact value", "[number][running]") {
    operations_hold<RunningError<TwoWords<double>>>(0.1);
    sums_hold<RunningError<TwoWords<double>>>(0.1);
    comparisons_hold<RunningError<TwoWords<double>>>();
    nothing_is_said_without_a_bound<TwoWords<double>>();
}

TEMPLATE_TEST_CASE("a bound computed in the format itself holds every exact result", "[number][proving]", float,
                   double) {
    operations_hold<ProvingNumber<TestType>>(0.9);
    comparisons_hold<ProvingNumber<TestType>>();
}

TEST_CASE("bounds add no operation to a tape, and a selection records both of its sides", "[number][proving]") {
    using E = ProvingNumber<Recorded>;
    const auto recorded = [](float x, float y) {
        Tape tape;
        const number::recorders::TapeRecorder recorder(tape, binary32);
        const E a((Recorded(x))), b((Recorded(y)));
        const E c = select(a < b, a * b, a + b);
        CHECK(tape[c.word().node()].op == TapeOp::select);
        CHECK(static_cast<float>(c.word().value().value()) == (x < y ? x * y : x + y));
        std::vector<TapeOp> operations;
        for (const TapeNode& node : tape.nodes) operations.push_back(node.op);
        CHECK(std::ranges::count(operations, TapeOp::mul) == 1);
        CHECK(std::ranges::count(operations, TapeOp::add) == 1);
        return operations;
    };
    // The operations are the same whichever side is chosen, so that an operation that a metric names exists for every
    // ray.
    CHECK(recorded(3, 4) == recorded(4, 3));
}

}  // namespace lostbits::test::test_running_error
