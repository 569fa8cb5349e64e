// Multiple compared with intervals of thousands of bits: what it proves is true, and it proves it if the bits suffice.
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <tuple>
#include <utility>

#include "catch.hpp"
#include "counts.hpp"
#include "number/interval.hpp"
#include "number/random.hpp"
#include "number/wide/multiple.hpp"

namespace lostbits::test::test_multiple {

using number::wide::UnitAndSize;
using Number = number::wide::Multiple<double>;

namespace {

constexpr long exact_bits = 4000;

/// Bits of the numbers, spread of their exponents, and bits that the grid must have.
struct Bits {
    int number, spread, grid;
};

/// Some numbers of one kind and their grid.
struct Kind {
    std::array<double, 6> numbers;
    UnitAndSize<double> grid;

    Kind(Random& random, const Bits& bits) {
        const int place = static_cast<int>(random.between(-150, 100));
        for (double& x : numbers) {
            const auto whole = static_cast<double>(random.between(1, (1L << bits.number) - 1));
            x = random.sign() * std::ldexp(whole, place - static_cast<int>(random.between(0, bits.spread)));
        }
        grid = std::apply([&](const auto&... x) { return UnitAndSize<double>::of(bits.grid, x...); }, numbers);
    }
    [[nodiscard]] Number at(std::size_t k) const { return {numbers[k], grid}; }
    [[nodiscard]] Interval exact(std::size_t k) const { return Interval(numbers[k]); }
};

/// (a − b)·((c − d) × (e − f)) in one plane and out of it: a polynomial like those of triangles. If `zero`, p = 2q.
template <class T, class At>
T volume(const At& of_points, const At& of_directions, bool zero) {
    const T px = of_points(0) - of_points(3), py = of_points(1) - of_points(4), pz = of_points(2) - of_points(5);
    const T two(2), qx = zero ? two * px : of_points(1) - of_points(5),
                    qy = zero ? two * py : of_points(2) - of_points(3);
    const T qz = zero ? two * pz : of_points(0) - of_points(4);
    return (of_directions(0) * (py * qz - pz * qy) + of_directions(1) * (pz * qx - px * qz)) +
           of_directions(2) * (px * qy - py * qx);
}

bool is_same(const Interval& a, const Interval& b) { return (a <= b).is_yes() && (a >= b).is_yes(); }

struct TriedCounts {
    std::size_t known = 0, wrong = 0, zeros = 0;
};

TriedCounts try_volumes(const Bits& bits, std::size_t draws) {
    const Interval::Precision precision(exact_bits);
    Random random(7);
    TriedCounts tried;
    for (std::size_t i = 0; i < draws; ++i) {
        const Kind points(random, bits), directions(random, bits);
        using At = std::function<Number(std::size_t)>;
        using ExactAt = std::function<Interval(std::size_t)>;
        const bool zero = random.one_in(3);
        const auto found = volume<Number, At>([&](std::size_t k) { return points.at(k); },
                                              [&](std::size_t k) { return directions.at(k); }, zero);
        const auto exact = volume<Interval, ExactAt>([&](std::size_t k) { return points.exact(k); },
                                                     [&](std::size_t k) { return directions.exact(k); }, zero);
        const Number nothing(0);
        const auto less = found < nothing, at_most = found <= nothing;
        const bool is_decided = less.yes() || less.no();
        tried.wrong +=
            is_decided != (found.running_error().radius() < HUGE_VAL) || is_decided != (at_most.yes() || at_most.no());
        if (!is_decided) continue;
        ++tried.known;
        const auto words = found.running_error().words();
        tried.wrong += !is_same(exact, Interval(words.hi) + Interval(words.lo));
        tried.wrong += less.yes() != (exact < Interval(0)).is_yes() || at_most.yes() != (exact <= Interval(0)).is_yes();
        tried.zeros += (at_most && !less).yes();
    }
    return tried;
}

}  // namespace

TEST_CASE("multiples of a unit have the stated values, and zeros are proved", "[number][multiple]") {
    const std::size_t all = draws<std::size_t>(20'000);
    for (const Bits& bits : {Bits{24, 0, 31},
                             {24, 7, 31},
                             {3, 28, 31},
                             {31, 0, 31},
                             {24, 9, 31},
                             {24, 40, 31},
                             {33, 0, 31},
                             {36, 0, 36},
                             {40, 0, 40},
                             {50, 0, 50}}) {
        CAPTURE(bits.number, bits.spread, bits.grid);
        const TriedCounts tried = try_volumes(bits, all);
        const bool fits = bits.number + bits.spread <= bits.grid && bits.grid <= 31;
        CHECK(tried.wrong == 0);
        CHECK((tried.known == all) == fits);
        CHECK((tried.zeros > all / 4) == fits);
        if (bits.grid > 31) CHECK(tried.known == 0);
    }
}

TEST_CASE("numbers that are not on a grid prove nothing", "[number][multiple]") {
    constexpr double none = std::numeric_limits<double>::quiet_NaN();
    const auto silent = [](const Number& x) {
        const auto less = x < Number(0), at_most = x <= Number(0);
        return !less.yes() && !less.no() && !at_most.yes() && !at_most.no();
    };
    using G = UnitAndSize<double>;
    for (const double x : {HUGE_VAL, -HUGE_VAL, none}) {
        const G grid = G::of(31, x, 1.0);
        CHECK(silent({x, grid}));
        CHECK(silent(Number(x, grid) * Number(1, grid) + Number(1, grid)));
    }
    CHECK(silent(Number(1) / Number(3)));
    CHECK(silent(sqrt(Number(2))));
    CHECK(silent(select(sqrt(Number(2)) < Number(2), Number(1), Number(1))));
    // Products that underflow, numbers with too many bits, and sums that one word cannot hold.
    const G tiny = G::of(1, 0x1p-600), few = G::of(3, 5.0, 0.25), wide = G::of(50, 0x1p53, 16.0);
    CHECK(silent(Number(0x1p-600, tiny) * Number(0x1p-600, tiny)));
    CHECK(silent(Number(5.0, few)));
    CHECK((Number(5.0, G::of(5, 5.0, 0.25)) > Number(0)).yes());
    const Number sum = Number(0x1p53, wide) + Number(1);
    CHECK((silent(sum) || (sum - Number(0x1p53, wide) > Number(0)).yes()));
    // The unit is the lowest of this many bits of the largest number.
    for (const auto& [x, unit] : {std::pair{1.0, 0.25}, {-7.0, 1.0}, {0x1p-1000, 0x1p-1002}, {0x1.cp+900, 0x1p+898}}) {
        const G grid = G::of(3, x, x / 4, 0.0);
        CHECK(grid.unit == unit);
        CHECK((grid.size == std::fabs(x)) == (x != -7 && x != 0x1.cp+900));
    }
}

}  // namespace lostbits::test::test_multiple
