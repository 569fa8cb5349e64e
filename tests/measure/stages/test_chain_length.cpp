// Number of consecutive roundings in a bound of `RunningError`: counted through the spans of all shapes, with a
// transform too, and through the stages. Also a sum whose words overflow internally, which decides nothing.
#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>

#include "catch.hpp"
#include "measure/stages/span_hits.hpp"
#include "shapes/primitive.hpp"

namespace lostbits::test::test_chain_length {

int longest = 0;  ///< chain of operations that was seen

/// A number of a bound, with the number of consecutive operations that computed it.
struct Steps {
    double x = 0;
    int count = 0;

    Steps() = default;
    explicit Steps(int whole) : x(whole) {}
    explicit Steps(double number) : x(number) {}
    Steps(double number, int steps) : x(number), count(steps) { longest = std::max(longest, steps); }

    friend Steps operator+(const Steps& a, const Steps& b) { return made(a.x + b.x, a, b); }
    friend Steps operator-(const Steps& a, const Steps& b) { return made(a.x - b.x, a, b); }
    friend Steps operator*(const Steps& a, const Steps& b) { return made(a.x * b.x, a, b); }
    friend Steps operator/(const Steps& a, const Steps& b) { return made(a.x / b.x, a, b); }
    friend Steps operator-(const Steps& a) { return {-a.x, a.count}; }
    friend bool operator<(const Steps& a, const Steps& b) { return a.x < b.x; }
    friend bool operator<=(const Steps& a, const Steps& b) { return a.x <= b.x; }
    friend bool operator>(const Steps& a, const Steps& b) { return a.x > b.x; }
    friend bool operator>=(const Steps& a, const Steps& b) { return a.x >= b.x; }
    friend Steps abs(const Steps& a) { return {std::fabs(a.x), a.count}; }
    /// Either may have been chosen.
    friend Steps select(bool mask, const Steps& a, const Steps& b) {
        return {mask ? a.x : b.x, std::max(a.count, b.count)};
    }
    /// No number is known to be 0, so no operation is left out.
    static constexpr std::size_t lanes = 1;
    [[nodiscard]] [[gnu::noinline]] std::array<std::uint64_t, 1> words() const {
        return {std::bit_cast<std::uint64_t>(x)};
    }

private:
    static Steps made(double x, const Steps& a, const Steps& b) { return {x, std::max(a.count, b.count) + 1}; }
};

/// A word, whose own roundings do not count for its bound.
struct Word {
    Steps value;

    Word() = default;
    explicit Word(int x) : value(x) {}
    explicit Word(const Steps& x) : value(x.x) {}
    explicit Word(double x) : value(x) {}

    friend Word operator+(const Word& a, const Word& b) { return Word(a.value.x + b.value.x); }
    friend Word operator*(const Word& a, const Word& b) { return Word(a.value.x * b.value.x); }
    friend Word operator/(const Word& a, const Word& b) { return Word(a.value.x / b.value.x); }
    friend Word operator-(const Word& a) { return Word(-a.value.x); }
    friend Word sqrt(const Word& a) { return Word(std::sqrt(a.value.x)); }
    friend Word abs(const Word& a) { return Word(std::fabs(a.value.x)); }
    friend Word select(bool mask, const Word& a, const Word& b) { return mask ? a : b; }
};

}  // namespace lostbits::test::test_chain_length

template <>
struct lostbits::number::wide::WordProperties<lostbits::test::test_chain_length::Word> {
    using W = lostbits::test::test_chain_length::Word;
    using Word = lostbits::test::test_chain_length::Steps;
    static constexpr double error = 0x1p-53;
    static const Word& first(const W& w) { return w.value; }
    static Word second(const W&) { return Word(0); }
    static W negative(const W& a) { return -a; }
    static W sum(const W& a, const W& b) { return a + b; }
    static W product(const W& a, const W& b) { return a * b; }
};

namespace lostbits::test::test_chain_length {

using number::wide::RunningError;
using E = RunningError<Word>;

namespace {

E lifted(double x) { return E(Word(x)); }

int longest_of(Shape shape, bool has_transform, bool ranged) {
    longest = 0;
    Primitive<double> stored = primitive_around(shape, Vec<double>(0.25, -0.5, 0.125), 2.0);
    if (has_transform) {
        const std::array<double, 12> matrix{1.5, 0.25, 0, 1, -0.5, 1, 0.125, 2, 0.25, 0, 0.75, -1};
        stored.transform = Transform<double>{matrix, false, 1};
    }
    const Primitive<E> primitive = convert_numbers(stored, lifted);
    for (const double away : {-8.0, 0.5}) {
        const auto vec = [](double x, double y, double z) { return Vec<E>(lifted(x), lifted(y), lifted(z)); };
        const Ray<E> ray{vec(0.75 + away, 0.5 - away / 2, away), vec(-0.25, 0.125, 1.5)};
        with_span(ray, primitive, [&](const auto& span) {
            const SpanRange<E> range{lifted(0.125), {lifted(64), lifted(1)}, {}};
            const auto met =
                ranged ? measure::stages::first_span_hit(span, range) : measure::stages::first_span_hit(span);
            return (met.t * sqrt(span.d2)).radius().x;
        });
    }
    return longest;
}

}  // namespace

TEST_CASE("bounds of every shape are no longer than their margin allows", "[running]") {
    int most = 0;
    for (const ShapeRow& row : shape_rows) {
        for (const bool has_transform : {false, true}) {
            for (const bool ranged : {false, true}) {
                const int steps = longest_of(row.shape, has_transform, ranged);
                INFO(row.name << (has_transform ? " with a transform" : "") << (ranged ? ", with a range" : ""));
                CHECK(steps > 4);
                CHECK(steps <= E::longest_chain);
                most = std::max(most, steps);
            }
        }
    }
    CHECK(most > 64);  // 95, so that the count sees the longest
    CHECK(std::expm1(E::longest_chain * std::log1p(0x1p-52)) < 0x1p-41);
    CHECK(std::expm1((E::longest_chain + 1) * std::log1p(0x1p-52)) > 0x1p-41);  // no more will do
}

TEST_CASE("a sum that overflows internally has a finite first word and decides nothing", "[running]") {
    using Two = number::wide::TwoWords<double>;
    using Certain = RunningError<Two>;
    const double largest = std::numeric_limits<double>::max();
    const Two words = number::wide::sum_of(-0x1.8p971, largest);
    REQUIRE(std::isfinite(words.hi));
    REQUIRE(std::isnan(words.lo));
    const Certain sum = Certain(Two(-0x1.8p971)) + Certain(Two(largest)), zero(0), one(1);
    CHECK_FALSE(((sum > zero).is_yes() || (sum > zero).is_no()));
    CHECK_FALSE(((sum <= one).is_yes() || (sum <= one).is_no()));
    for (const Certain& made : {sum + one, sum * one, sum / one, square(sum), sqrt(abs(sum)), one / sum})
        CHECK(std::isnan(made.first()));
}

}  // namespace lostbits::test::test_chain_length
