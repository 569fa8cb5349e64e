// Every pair of numbers of a format of four bits, exact and with errors from the smallest to infinity: no operation of
// `Bounded` gives a bound below the error, and no comparison that it proves is wrong.
#include <array>
#include <vector>

#include "catch.hpp"
#include "number/bounded.hpp"
#include "number/random.hpp"
#include "number/tiny_format.hpp"

namespace lostbits::test {
namespace {

using B = Bounded<Tiny>;

/// A number with an error, and exact numbers that it may stand for: multiples of 2^-10 that are small enough for their
/// products and sums to be doubles.
struct KnownPair {
    B number;
    std::vector<double> points;
};

KnownPair known(double value, double error) {
    const B number{Tiny(value), Tiny(error)};
    if (error == 0) return {number, {value}};
    if (error < HUGE_VAL) return {number, {value - error, value, value + error}};
    return {number, {-1000, -0x1p-10, 0, 1, HUGE_VAL, std::nan("")}};
}

std::vector<double> all_values(bool negative_too) {
    std::vector<double> values{0.0, HUGE_VAL, std::nan("")};
    for (Tiny x(Tiny::least); x.value() < HUGE_VAL; x = next_up(x)) values.push_back(x.value());
    if (negative_too) {
        const std::size_t count = values.size();
        for (std::size_t i = 0; i < count; ++i) values.push_back(-values[i]);
    }
    return values;
}

std::vector<KnownPair> operands(bool negative_too) {
    std::vector<KnownPair> all;
    for (const double value : all_values(negative_too)) {
        for (const double error : {0.0, Tiny::least, 2 * Tiny::least, 3 * Tiny::least, 0x1p-6, 0x1.2p-4, 0x1.cp-1, 1.0,
                                   7.5, 16.0, HUGE_VAL}) {
            if (error == 0 || error == HUGE_VAL || std::isfinite(value)) all.push_back(known(value, error));
        }
    }
    return all;
}

bool same(double a, double b) { return a == b || (std::isnan(a) && std::isnan(b)); }

/// True if `got` may stand for `exact`.
bool holds(const B& got, double exact) {
    const double value = got.value().value(), error = got.error().value();
    if (!(error < HUGE_VAL)) return error == HUGE_VAL;
    if (!std::isfinite(exact) || !std::isfinite(value)) return error == 0 && same(value, exact);
    return std::fabs(value - exact) <= error;
}

/// The same for a quotient, through the product, which is exact.
bool holds_quotient(const B& got, double a, double b) {
    const double value = got.value().value(), error = got.error().value();
    if (!(error < HUGE_VAL) || !std::isfinite(a) || !std::isfinite(b) || b == 0 || !std::isfinite(value))
        return holds(got, a / b);
    return std::fabs(value * b - a) <= error * std::fabs(b);
}

bool holds_root(const B& got, double a) {
    const double value = got.value().value(), error = got.error().value();
    if (!(error < HUGE_VAL) || !(a >= 0) || !std::isfinite(a) || !std::isfinite(value)) return holds(got, std::sqrt(a));
    const double low = value - error, high = value + error;
    return (low <= 0 || low * low <= a) && a <= high * high;
}

bool holds_decision(const BoundedMask& mask, bool exact) { return !mask.is_proved() || mask.value() == exact; }

enum ObjectProblem {
    sum,
    difference,
    product,
    quotient,
    least_of,
    greatest_of,
    signed_as,
    chosen,
    below,
    at_most,
    count
};
constexpr std::array<const char*, count> asked_names{"a + b", "a - b",    "a * b",  "a / b", "min",
                                                     "max",   "copysign", "select", "a < b", "a <= b"};

/// Counts, for each operation of two numbers, the points that its result does not enclose.
void try_pair(const KnownPair& a, const KnownPair& b, std::array<long, count>& broken) {
    const BoundedMask lower = a.number < b.number, no_higher = a.number <= b.number;
    const B results[] = {a.number + b.number,          a.number - b.number,
                         a.number * b.number,          a.number / b.number,
                         min(a.number, b.number),      max(a.number, b.number),
                         copysign(a.number, b.number), select(lower, b.number, a.number)};
    for (const double x : a.points) {
        for (const double y : b.points) {
            const double exact[] = {x + y,        x - y, x * y, 0, x < y ? x : y, x > y ? x : y, std::copysign(x, y),
                                    x < y ? y : x};
            for (int k = 0; k < below; ++k) {
                if (k == signed_as && std::isnan(y)) continue;
                broken[k] += k == quotient ? !holds_quotient(results[k], x, y) : !holds(results[k], exact[k]);
            }
            broken[below] += !holds_decision(lower, x < y);
            broken[at_most] += !holds_decision(no_higher, x <= y);
        }
    }
}

}  // namespace

TEST_CASE("four bits: every bound of a pair holds and every proved comparison is right", "[number][bounded]") {
    const std::vector<KnownPair> first = operands(false), second = operands(true);
    std::array<long, count> broken{};
    for (const KnownPair& a : first) {
        for (const KnownPair& b : second) try_pair(a, b, broken);
    }
    for (std::size_t k = 0; k < count; ++k) {
        INFO(asked_names[k] << ": " << broken[k] << " of " << first.size() * second.size() << " pairs' points");
        CHECK(broken[k] == 0);
    }
}

TEST_CASE("four bits: every bound of an operation on one number holds", "[number][bounded]") {
    long roots = 0, sizes = 0, neighbours = 0, copies = 0;
    for (const KnownPair& a : operands(true)) {
        for (const double x : a.points) {
            roots += !holds_root(sqrt(a.number), x);
            sizes += !holds(abs(a.number), std::fabs(x));
            // Numbers without rounding have no neighbours: what is enclosed is the number itself.
            neighbours += !holds(next_up(a.number), x) || !holds(next_down(a.number), x);
            copies += !holds(-a.number, -x);
        }
    }
    CHECK(roots == 0);
    CHECK(sizes == 0);
    CHECK(neighbours == 0);
    CHECK(copies == 0);
}

TEST_CASE("four bits: every bound of a fused product holds", "[number][bounded]") {
    const std::vector<KnownPair> all = operands(true);
    Random random(34);
    const auto one = [&]() -> const KnownPair& { return all[random.between(0, static_cast<long>(all.size()) - 1)]; };
    long broken = 0;
    for (int i = 0; i < 300000; ++i) {
        const KnownPair &a = one(), &b = one(), &c = one();
        const B got = fma(a.number, b.number, c.number);
        for (const double x : a.points)
            for (const double y : b.points)
                for (const double z : c.points) broken += !holds(got, x * y + z);
    }
    CHECK(broken == 0);
}

TEST_CASE("a product of errors that underflows is not taken for an exact zero", "[number][bounded]") {
    using F = Bounded<float>;
    const float tiny = 0x1p-149F;
    // 0 ± 2^-149 times 2^-1: at most 2^-150 off, which underflows to 0 in float.
    const F product = F(0.0F, tiny) * F(0.5F);
    CHECK(product.value() == 0);
    CHECK(product.error() >= tiny);
    CHECK_FALSE((product < F(0.0F, tiny)).is_proved());
    CHECK((F(0.0F) * F(1.0F, tiny)).error() == 0);
    // A bound that is NaN counts as no bound: the sum below overflows while it computes its error.
    const float most = 0x1.fffffep+127F;
    CHECK(F(1.0F, std::nanf("")).error() == HUGE_VALF);
    CHECK(min(F(2.0F, std::nanf("")), F(2.0F, 1.0F)).error() == HUGE_VALF);
    CHECK((F(most) + F(-0x1p102F)).error() < HUGE_VALF);
}

}  // namespace lostbits::test
