// Largest gap between slabs in float: every significand that could cause a larger gap than the worst ray of data/hard
// was tried, and none does.
//
// A ray that hits enters by an axis i no later than it leaves by an axis j: (p − o_i)/d_i ≤ (q − o_j)/d_j. What a form
// computes is tmin = fl(fl(p − o_i) · fl(1/d_i)) and tmax in the same way. Of the differences only their rounded values
// S count, and p − o_i may be anything that rounds to S: o_i small has bits below those of p. So the gap is widest
// where the entry's difference is the least, and the exit's the greatest, that rounds so, half a last place from S.
//
// In units of the last place let tmax = 2^23 + x, tmin = tmax + 3 (from docs/bounds.md: four or more are at most 16/3
// u, and two or fewer 4 u). The padding is then 6 u/(1 + η), η = x/2^23. Each rounding's relative error is at most u/m,
// m in [1, 2) the significand of its result, so the six of them sum to 6 u/(1 + η) only where 1 − 1/m < 6 η of each; a
// reciprocal of d = 2^24 − j has m = 1/(1 − j/2^24), so j ≤ 12 x and a few for terms of order u². (Where tmin is in the
// binade above that of tmax, the rounding of that product is at most half as large: 5.5 u.)
#include <cstdint>

#include "catch.hpp"
#include "counts.hpp"

namespace test_padding {

namespace {

using Wide = unsigned __int128;
constexpr std::uint64_t half = std::uint64_t{1} << 23, whole = 2 * half;

std::uint64_t reciprocal(std::uint64_t d) {
    const std::uint64_t n = std::uint64_t{1} << 47, q = n / d, twice = 2 * (n - q * d);
    return q + (twice > d ? 1 : 0);  // no tie: d is no power of two
}
std::uint64_t product(std::uint64_t s, std::uint64_t r) {
    const std::uint64_t p = s * r, q = p >> 23, rest = p & (half - 1);
    return q + (rest > half / 2 || (rest == half / 2 && (q & 1)) ? 1 : 0);
}

/// (2s ± 1)/2d, for a difference half a last place from s; compared as what it is, a fraction.
struct Fraction {
    std::uint64_t n = 0, d = 0;
    friend bool operator<(const Fraction& a, const Fraction& b) { return Wide{a.n} * b.d < Wide{b.n} * a.d; }
};

struct Ends {
    Fraction last_exit, first_entry;  ///< of rays whose computed tmax and tmin are given; d = 0: no ray has them
};

Ends ends_of(std::uint64_t tmax, std::uint64_t tmin, std::uint64_t reach) {
    Ends ends;
    for (std::uint64_t j = 1; j <= reach; ++j) {
        const std::uint64_t d = whole - j, r = reciprocal(d);
        std::uint64_t s = (2 * tmax + 1) * (half / 2) / r;
        while (s >= half && product(s, r) > tmax) --s;
        const Fraction exit{2 * s + 1, d};
        if (s >= half && s < whole && product(s, r) == tmax && (ends.last_exit.d == 0 || ends.last_exit < exit))
            ends.last_exit = exit;
        std::uint64_t q = ((2 * tmin - 1) * (half / 2) + r - 1) / r;
        while (q < whole && product(q, r) < tmin) ++q;
        const Fraction entry{2 * q - 1, d};
        if (q >= half && q < whole && product(q, r) == tmin && (ends.first_entry.d == 0 || entry < ends.first_entry))
            ends.first_entry = entry;
    }
    return ends;
}

/// True if a ray hits whose slabs are three last places apart there.
bool can_be(const Ends& ends) {
    return ends.last_exit.d != 0 && ends.first_entry.d != 0 && !(ends.last_exit < ends.first_entry);
}

/// The nearest whole number to n/d, ties to even.
std::uint64_t quotient(Wide n, std::uint64_t d) {
    const Wide q = n / d, twice = 2 * (n % d);
    return static_cast<std::uint64_t>(q) + (twice > d || (twice == d && (q & 1) != 0) ? 1 : 0);
}

/// The same for t = fl(S/d). Every d is possible, since d is not rounded. For each S it takes the least d that gives
/// tmax, and the greatest that gives tmin. In units of the last place S/d is S 2^power/d, where power makes it 2^23 or
/// more.
Ends divided_ends_of(std::uint64_t tmax, std::uint64_t tmin, std::uint64_t reach) {
    Ends ends;
    for (std::uint64_t s = half; s <= half + reach; ++s) {
        for (int power = 23; power <= 24; ++power) {
            const std::uint64_t least = power == 23 ? half : s + 1, end = power == 23 ? s + 1 : whole;
            const auto is_in = [&](std::uint64_t d) { return d >= least && d < end; };
            const Wide n = Wide{s} << power, scale = Wide{1} << (power - 23);
            std::uint64_t d = static_cast<std::uint64_t>((2 * n + 2 * tmax) / (2 * tmax + 1));
            if (quotient(n, d) != tmax) ++d;
            const Fraction exit{static_cast<std::uint64_t>((2 * s + 1) * scale), d};
            if (is_in(d) && quotient(n, d) == tmax && (ends.last_exit.d == 0 || ends.last_exit < exit))
                ends.last_exit = exit;
            d = static_cast<std::uint64_t>(2 * n / (2 * tmin - 1));
            if (quotient(n, d) != tmin) --d;
            const Fraction entry{static_cast<std::uint64_t>((2 * s - 1) * scale), d};
            if (s > half && is_in(d) && quotient(n, d) == tmin && (ends.first_entry.d == 0 || entry < ends.first_entry))
                ends.first_entry = entry;
        }
    }
    return ends;
}

}  // namespace

TEST_CASE("in float no hit separates the slabs of a box further than the known hard ray", "[padding]") {
    constexpr std::uint64_t hard = 12294;
    std::uint64_t x = lostbits::test::is_long() ? 0 : hard - 300;
    while (x <= hard && !can_be(ends_of(half + x, half + x + 3, 12 * x + 64))) ++x;
    REQUIRE(x == hard);
    CHECK(6 / (1 + static_cast<double>(x) / static_cast<double>(half)) == Approx(5.99121951428549).epsilon(1e-14));
    // The directions of the ray in data/hard/padding.toml.
    const Ends ends = ends_of(half + x, half + x + 3, 12 * x + 64);
    CHECK(ends.last_exit.d == whole - 4094);
    CHECK(ends.first_entry.d == whole - 20468);
}

// Two last places are 4 u/(1 + η), and more are impossible. A difference of exactly S ± 1/2 is a tie and may round away
// from S, so the exit must be later than the entry, not equal to it. Each of the four errors is 1 − 1/m < 4 η from the
// largest possible, so S − 2^23 ≤ 4 x and a few; twice that is tried. (S = 2^23 is no entry: numbers below it are twice
// as dense.)
TEST_CASE("in float no hit separates slabs that divide further than the known ray", "[padding]") {
    constexpr std::uint64_t worst = 2896;
    const auto parts = [](std::uint64_t x) {
        const Ends ends = divided_ends_of(half + x, half + x + 2, 8 * x + 16);
        return ends.last_exit.d != 0 && ends.first_entry.d != 0 && ends.first_entry < ends.last_exit;
    };
    std::uint64_t x = 0;
    while (x <= worst && !parts(x)) ++x;
    REQUIRE(x == worst);
    // The directions of the ray in data/sweeps/theorems/slabs.toml.
    const Ends ends = divided_ends_of(half + x, half + x + 2, 8 * x + 16);
    CHECK(ends.last_exit.d == whole - 2896);
    CHECK(ends.first_entry.d == whole - 5791);
}

}  // namespace test_padding
