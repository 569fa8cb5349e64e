// Bounds over boxes against every number in them: random formulas in a format of four bits, whose numbers run from
// subnormal to overflow, and single operations by hand.
#include <array>
#include <cmath>
#include <optional>
#include <vector>

#include "catch.hpp"
#include "counts.hpp"
#include "measure/apriori/tape_bound.hpp"
#include "measure/attribution/operation_error.hpp"
#include "number/random.hpp"
#include "number/real.hpp"
#include "number/rounded.hpp"

namespace test_tape_bound {

using namespace lostbits;
using measure::apriori::BoxBound;
using measure::apriori::InputBox;
using measure::apriori::TapeBound;
using test::Random;

namespace {

constexpr FloatFormat four_bits{4, -6, 4};
constexpr FloatFormat three_bits{3, -3, 4};

/// Value of a node at one point, with rounding and without. `exact` is empty if an operation is undefined.
struct Value {
    double computed = 0;
    std::optional<Real> exact = Real(0);
};

struct Point {
    std::vector<Value> nodes;

    Point(const Tape& tape, const std::vector<double>& inputs) {
        for (NodeId i = 0; i < tape.size(); ++i) nodes.push_back(value_of(tape, i, inputs));
    }
    [[nodiscard]] const Value& at(NodeId i) const { return nodes[i]; }

private:
    [[nodiscard]] Value value_of(const Tape& tape, NodeId i, const std::vector<double>& inputs) const {
        const TapeNode& n = tape[i];
        if (n.op == TapeOp::input) {
            const double x = inputs[n.operands[0]];
            return {x, Real(x)};
        }
        if (n.op == TapeOp::constant) return {n.value, Real(static_cast<int>(n.operands[0]))};
        std::array<Value, 3> x;
        for (std::size_t k = 0; k < tape.operands_of(i).size(); ++k) x[k] = at(n.operands[k]);
        const auto [a, b, c] = x;
        if (n.op == TapeOp::less) {
            // A comparison with what is undefined is false, as one with NaN.
            const bool less = a.exact && b.exact && *a.exact < *b.exact;
            return {a.computed < b.computed ? 1.0 : 0.0, Real(less ? 1 : 0)};
        }
        if (n.op == TapeOp::select) {
            const auto exact = !a.exact ? std::nullopt : *a.exact != 0 ? b.exact : c.exact;
            return {a.computed != 0 ? b.computed : c.computed, exact};
        }
        if (n.op == TapeOp::min || n.op == TapeOp::max) {
            const bool first = n.op == TapeOp::min ? a.computed < b.computed : a.computed > b.computed;
            Value r{first ? a.computed : b.computed, std::nullopt};
            if (a.exact && b.exact) r.exact = n.op == TapeOp::min ? min(*a.exact, *b.exact) : max(*a.exact, *b.exact);
            return r;
        }
        return {measure::attribution::result_of(n.op, {a.computed, b.computed, c.computed}, tape.format_of(i)),
                exactly(n.op, a.exact, b.exact, c.exact)};
    }

    static std::optional<Real> exactly(TapeOp op, const std::optional<Real>& a, const std::optional<Real>& b,
                                       const std::optional<Real>& c) {
        const std::size_t count = row_of(op).operand_count;
        if (!a || (count > 1 && !b) || (count > 2 && !c)) return {};
        switch (op) {
            case TapeOp::add: return *a + *b;
            case TapeOp::sub: return *a - *b;
            case TapeOp::mul: return *a * *b;
            case TapeOp::fma: return *a * *b + *c;
            case TapeOp::div: return *b == 0 ? std::nullopt : std::optional<Real>(*a / *b);
            case TapeOp::sqrt: return *a < 0 ? std::nullopt : std::optional<Real>(sqrt(*a));
            case TapeOp::neg: return -*a;
            case TapeOp::abs: return abs(*a);
            case TapeOp::copysign: return *b < 0 ? Real(-abs(*a)) : abs(*a);
            default: return *a;  // a neighbour or the number in another format
        }
    }
};

/// Three inputs, and some operations on earlier nodes; the condition of the hit is 0 < 1.
Tape random_tape(Random& random, int operations) {
    Tape tape;
    for (int k = 0; k < 3; ++k) tape.add_input(four_bits, 1);
    const NodeId zero = tape.add(TapeOp::constant, four_bits, 0, {0}),
                 one = tape.add(TapeOp::constant, four_bits, 1, {1});
    std::vector<NodeId> numbers{0, 1, 2, one, tape.add(TapeOp::constant, four_bits, 2, {2})};
    const auto any = [&] { return numbers[random.between(0, static_cast<long>(numbers.size()) - 1)]; };
    constexpr std::array ops{TapeOp::add, TapeOp::sub,    TapeOp::mul,     TapeOp::div,       TapeOp::sqrt,
                             TapeOp::fma, TapeOp::neg,    TapeOp::abs,     TapeOp::copysign,  TapeOp::min,
                             TapeOp::max, TapeOp::select, TapeOp::next_up, TapeOp::next_down, TapeOp::convert,
                             TapeOp::add, TapeOp::sub,    TapeOp::mul,     TapeOp::mul,       TapeOp::div};
    for (int k = 0; k < operations; ++k) {
        const TapeOp op = ops[random.between(0, static_cast<long>(ops.size()) - 1)];
        NodeId a = any(), b = any(), c = any();
        if (k > 0 && !random.one_in(3)) a = numbers.back();
        if (op == TapeOp::select) a = tape.add(TapeOp::less, four_bits, 0, {a, b});
        if (op == TapeOp::convert) {
            a = tape.add(op, three_bits, 0, {a});
            numbers.push_back(tape.add(op, four_bits, 0, {a}));
            continue;
        }
        const std::size_t count = row_of(op).operand_count;
        numbers.push_back(tape.add(op, four_bits, 0, {a, count > 1 ? b : no_node, count > 2 ? c : no_node}));
    }
    tape.outputs = {tape.add(TapeOp::less, four_bits, 1, {zero, one}), numbers.back(), numbers.back(), numbers.back()};
    return tape;
}

/// Some numbers of the format in a row, more of the small and of the large ones.
std::vector<double> neighbours(Random& random) {
    double x = std::ldexp(static_cast<double>(random.between(8, 15)), static_cast<int>(random.between(-12, 1)));
    if (random.one_in(6)) x = 0;
    x = rounding::to_format(random.sign() * x, 0, four_bits);
    std::vector<double> all{x};
    for (long k = random.between(0, 3); k > 0; --k) {
        x = rounding::next_up(x, four_bits);
        if (!std::isinf(x)) all.push_back(x);
    }
    return all;
}

struct Tally {
    long boxes = 0, bounded = 0, tight = 0;
};

void check_box(const Tape& tape, const std::array<std::vector<double>, 3>& rows, Tally& tally) {
    InputBox box;
    for (const auto& row : rows) box.push_back({row.front(), row.back()});
    const TapeBound bound(tape);
    const BoxBound b = bound.bound_over(box);
    ++tally.boxes;
    REQUIRE(!b.misses);
    if (!(b.error < HUGE_VAL)) return;
    ++tally.bounded;
    double worst = 0, sum = 0;
    for (const double x : rows[0])
        for (const double y : rows[1])
            for (const double z : rows[2]) {
                const Value t = Point(tape, {x, y, z}).at(tape.outputs.t);
                INFO("inputs " << x << ", " << y << ", " << z << ", bound " << b.error << ", computed " << t.computed);
                REQUIRE(std::isfinite(t.computed));
                REQUIRE(t.exact);
                const double off = static_cast<double>(abs(Real(t.computed) - *t.exact));
                REQUIRE(off <= b.error * (1 + 0x1p-40));
                REQUIRE(static_cast<double>(abs(*t.exact)) >= b.min_t * (1 - 0x1p-40));
                worst = std::fmax(worst, off);
            }
    for (const double share : bound.node_contributions(box)) sum += share;
    REQUIRE(sum >= b.error * (1 - 0x1p-40));
    tally.tight += worst >= b.error / 2;
}

}  // namespace

TEST_CASE("errors of random formulas of four bits stay within the bound over ranges", "[apriori]") {
    Random random(0xa921);
    Tally tally;
    for (int i = 0; i < test::draws(40000); ++i) {
        const Tape tape = random_tape(random, static_cast<int>(random.between(1, 6)));
        for (int k = 0; k < 2; ++k)
            check_box(tape, {neighbours(random), neighbours(random), neighbours(random)}, tally);
    }
    // Most boxes must have a bound, and in many boxes an error must reach half of the bound.
    CHECK(tally.bounded * 2 > tally.boxes);
    CHECK(tally.tight * 3 > tally.bounded);
}

namespace {

/// t = op(x, y), hit always.
BoxBound bound_of(TapeOp op, const FloatFormat& format, const InputBox& box) {
    Tape tape;
    const NodeId x = tape.add_input(format, 1), y = tape.add_input(format, 1);
    const NodeId zero = tape.add(TapeOp::constant, format, 0, {0}), one = tape.add(TapeOp::constant, format, 1, {1});
    const NodeId t = tape.add(op, format, 0, {x, row_of(op).operand_count > 1 ? y : no_node});
    tape.outputs = {tape.add(TapeOp::less, format, 1, {zero, one}), t, t, t};
    return TapeBound(tape).bound_over(box);
}

}  // namespace

TEST_CASE("bounds of single operations agree with those worked out by hand", "[apriori]") {
    const double u = 0x1p-24;
    CHECK(bound_of(TapeOp::mul, binary32, {{1, 1.25}, {1, 1.5}}).error == u);
    CHECK(bound_of(TapeOp::mul, binary32, {{1, 1.25}, {1, 2}}).error == 2 * u);
    // Products that underflow, in float and in double, which cannot hold half of its own smallest number.
    CHECK(bound_of(TapeOp::mul, binary32, {{0x1p-80, 0x1p-79}, {0x1p-80, 0x1p-70}}).error == 0x1p-150);
    CHECK(bound_of(TapeOp::mul, binary64, {{0x1p-600, 0x1p-599}, {0x1p-600, 0x1p-599}}).error == 0x1p-1074);
    CHECK(bound_of(TapeOp::add, binary32, {{0, 0x1p-127}, {-0x1p-127, 0x1p-127}}).error == 0);
    CHECK(bound_of(TapeOp::sub, binary32, {{1, 1.5}, {1, 1.75}}).error == 0);
    CHECK(bound_of(TapeOp::sub, binary32, {{1, 1.5}, {0.25, 1.75}}).error == u);
    CHECK(bound_of(TapeOp::div, binary32, {{1, 1.5}, {2, 3}}).error == u / 2);
    CHECK(bound_of(TapeOp::sqrt, binary32, {{1, 2}, {0, 0}}).error == u);
    // A result that overflows, or that may be undefined, has no bound.
    CHECK(bound_of(TapeOp::mul, binary32, {{0x1p100, 0x1p100}, {1, 0x1p28}}).error == HUGE_VAL);
    CHECK(bound_of(TapeOp::div, binary32, {{1, 1}, {-1, 1}}).error == HUGE_VAL);
    CHECK(bound_of(TapeOp::sqrt, binary32, {{-1, 1}, {0, 0}}).error == HUGE_VAL);
    // A box of one point has the error of that point.
    CHECK(bound_of(TapeOp::add, binary32, {{1, 1}, {u / 4, u / 4}}).error == u / 4);
}

}  // namespace test_tape_bound
