// The promise of `triangle.filtered` over every finite number: no wrong decision and 18 correct bits of 24 (47 of 53,
// p − 6 of p), against fractions, alone and in packs. Rays of all families, up to three last places beside them, moved
// by powers of two to where products over- and underflow; and numbers whose exponents are drawn one by one.
#include <array>
#include <sstream>
#include <string>
#include <vector>

#include "catch.hpp"
#include "counts.hpp"
#include "intersect/triangle/triangle_rays.hpp"
#include "intersect/way.hpp"
#include "number/pack.hpp"
#include "number/rounded.hpp"
#include "number/wide/wide_pack.hpp"
#include "shapes/triangle/forms/forms.hpp"

namespace lostbits::test::test_triangle_filtered {
using intersect::triangle::FilteredTriangle;

namespace {

/// Origin, direction, a, b and c.
using Numbers = std::array<double, 15>;

double value_of(double x) { return x; }
template <class F>
double value_of(const BasicRounded<F>& x) {
    return x.value();
}

Numbers numbers_of(const TriangleSample& s) {
    Numbers all;
    const Vec<double>* const points[] = {&s.ray.origin, &s.ray.direction, &s.triangle.a, &s.triangle.b, &s.triangle.c};
    for (std::size_t i = 0; i < all.size(); ++i) all[i] = (*points[i / 3])[static_cast<int>(i % 3)];
    return all;
}
TriangleSample sample_of(const Numbers& x) {
    return {{{x[0], x[1], x[2]}, {x[3], x[4], x[5]}},
            {{x[6], x[7], x[8]}, {x[9], x[10], x[11]}, {x[12], x[13], x[14]}}};
}

template <class T>
bool is_finite(const Numbers& all) {
    for (const double x : all)
        if (!std::isfinite(value_of(T(x)))) return false;
    return true;
}

/// Numbers of T.
template <class T>
Numbers rounded(Numbers all) {
    for (double& x : all) x = value_of(T(x));
    return all;
}

/// Lengths by one power of two and the direction by another, then some numbers a few last places off.
template <class T>
Numbers moved(Seeded& rng, const Numbers& from, int deepest) {
    Numbers x = from;
    if (rng.coin()) {
        const auto by = static_cast<int>(rng.integer(-deepest, deepest)),
                   along = static_cast<int>(rng.integer(-deepest, deepest));
        for (std::size_t i = 0; i < x.size(); ++i) x[i] = std::ldexp(x[i], i / 3 == 1 ? along : by);
        if (!is_finite<T>(x)) x = from;
    }
    for (std::int64_t n = rng.integer(0, 2); n > 0; --n) {
        double& at = x[static_cast<std::size_t>(rng.index(15))];
        T y = T(at);
        for (std::int64_t steps = rng.integer(1, 3); steps > 0; --steps) y = next_up(y);
        at = value_of(y);
    }
    return is_finite<T>(x) ? rounded<T>(x) : rounded<T>(from);
}

template <class T>
Numbers any_numbers(Seeded& rng, int deepest) {
    Numbers x;
    const auto base = static_cast<int>(rng.integer(-deepest, deepest - 3));
    for (double& one : x)
        one = rng.coin() ? rng.signed_magnitude(-deepest, deepest - 3) : rng.signed_magnitude(base, base + 2);
    return rounded<T>(x);
}

template <class T, class Load, class Watch>
Hit<T> ask(const Load& x, Watch& watch) {
    return FilteredTriangle::intersect(Ray<T>{{x(0), x(1), x(2)}, {x(3), x(4), x(5)}},
                                       Triangle<T>{{x(6), x(7), x(8)}, {x(9), x(10), x(11)}, {x(12), x(13), x(14)}},
                                       watch);
}

/// Whether t is within 32 u of itself of the right one, or within the distance of subnormal numbers, or beyond the
/// largest number where that is.
template <class T>
bool keeps_its_bits(const T& t, const Rational& right) {
    const double u = value_of(unit_roundoff<T>()), at = value_of(t);
    const double most = value_of(next_down(T(1) / T(0)));
    const Rational slack = Rational(32 * u) * right + Rational(value_of(next_up(T(0))));
    if (std::isinf(at)) return at > 0 && right + slack > Rational(most);
    return at >= 0 && abs(Rational(at) - right) <= slack;
}

struct Tally {
    long asked = 0, hits = 0, wrong = 0, lost = 0;
    std::array<long, 4> ways{};
    std::vector<Numbers> all;
    std::string first;

    template <class T>
    void add(const Numbers& x) {
        intersect::WayWatch watch;
        const Hit<T> found = ask<T>([&](std::size_t i) { return T(x[i]); }, watch);
        const TriangleAnswer right = answer_of(sample_of(x));
        const bool is_wrong = found.hit != right.meets(),
                   is_lost = !is_wrong && found.hit && !keeps_its_bits(found.t, right.t);
        ++asked, hits += found.hit, wrong += is_wrong, lost += is_lost;
        ++ways[static_cast<std::size_t>(watch.widest)];
        if ((is_wrong || is_lost) && first.empty()) {
            std::ostringstream text;
            text << std::hexfloat;
            for (const double number : x) text << number << ' ';
            first = text.str();
        }
        all.push_back(x);
    }
};

template <class T>
Tally judged(int deepest) {
    Tally tally;
    Seeded rng(0xf117);
    for_each_triangle(static_cast<int>(draws(6000)), [&](const TriangleFamily&, const TriangleSample& s) {
        const Numbers x = numbers_of(s);
        if (is_finite<T>(x)) tally.add<T>(moved<T>(rng, x, deepest));
    });
    for (std::size_t i = draws(std::size_t{20000}); i > 0; --i) tally.add<T>(any_numbers<T>(rng, deepest));
    return tally;
}

void check(const Tally& t) {
    INFO(t.asked << " rays, " << t.hits << " hits; in its own arithmetic " << t.ways[0] << ", wider " << t.ways[1]
                 << ", two words " << t.ways[2] << ", exact " << t.ways[3] << "; first " << t.first);
    CHECK(t.wrong == 0);
    CHECK(t.lost == 0);
    CHECK(t.hits > t.asked / 8);
    CHECK(t.hits < t.asked);
    CHECK(t.ways[0] > t.asked / 50);
    CHECK(t.ways[3] > t.asked / 50);
}

/// The rays that packs answer otherwise than they are answered alone.
template <class S>
int different_in_packs(const std::vector<Numbers>& all) {
    using P = Pack<S, Registers<16>>;
    constexpr std::size_t lanes = P::lanes;
    int different = 0;
    intersect::NoWatch watch;
    for (std::size_t from = 0; from + lanes <= all.size(); from += lanes) {
        const Hit<P> packed = ask<P>(
            [&](std::size_t i) {
                S column[lanes];
                for (std::size_t lane = 0; lane < lanes; ++lane) column[lane] = static_cast<S>(all[from + lane][i]);
                return P::load(column);
            },
            watch);
        S t[lanes];
        bool hit[lanes];
        packed.t.store(t);
        packed.hit.store(hit);
        for (std::size_t lane = 0; lane < lanes; ++lane) {
            const Hit<S> one = ask<S>([&](std::size_t i) { return static_cast<S>(all[from + lane][i]); }, watch);
            different += hit[lane] != one.hit || !(t[lane] == one.t || (t[lane] != t[lane] && one.t != one.t));
        }
    }
    return different;
}

}  // namespace

TEST_CASE("filtered triangles decide right and keep their bits in float", "[intersect][triangle][filtered]") {
    const Tally tally = judged<float>(126);
    check(tally);
    CHECK(different_in_packs<float>(tally.all) == 0);
}

TEST_CASE("filtered triangles decide right and keep their bits in double", "[intersect][triangle][filtered]") {
    const Tally tally = judged<double>(1022);
    check(tally);
    CHECK(different_in_packs<double>(tally.all) == 0);
}

TEST_CASE("filtered triangles decide right and keep their bits in 16 bits and half",
          "[intersect][triangle][filtered]") {
    check(judged<Rounded<16>>(1022));
    check(judged<Rounded<16, -126, 127>>(126));
    check(judged<Half>(14));
}

TEST_CASE("two filtered triangles lose no ray through the edge between them", "[intersect][triangle][filtered]") {
    Seeded rng(0xed6e);
    intersect::NoWatch watch;
    int between = 0, both = 0;
    for (int i = 0; i < static_cast<int>(draws(20000)); ++i) {
        const double height = rng.uniform(1, 2);
        const Vec<double> a(rng.unit(), rng.unit(), height), b(rng.unit() + 2, rng.unit(), height + 0.25);
        const Vec<double> c(1, -3, height), d(1, 4, height), on = a + rng.unit() * (b - a);
        const auto meets = [&](const Vec<double>& side) {
            const Numbers x = rounded<float>(numbers_of({{{0, 0, 0}, on}, {a, b, side}}));
            return ask<float>([&](std::size_t k) { return static_cast<float>(x[k]); }, watch).hit;
        };
        const bool first = meets(c), second = meets(d);
        between += !first && !second, both += first && second;
    }
    CHECK(between == 0);
    CHECK(both < static_cast<int>(draws(20000)) / 2);
}

}  // namespace lostbits::test::test_triangle_filtered
