// Truth of several spheres, of inputs beyond double, and at its precision limit.
#include <vector>

#include "catch.hpp"
#include "measure/truth/exact_reference.hpp"
#include "measure/truth/ray_builders.hpp"
#include "measure/truth/truth.hpp"
#include "number/error.hpp"
#include "number/real.hpp"

namespace test_truth_scenes {

using namespace lostbits;
using namespace lostbits::test;
using measure::truth::find_truth;
using measure::truth::ProofLimit;
using measure::truth::Truth;

namespace {

std::vector<Primitive<double>> primitives(const std::vector<Sphere<double>>& spheres) {
    return {spheres.begin(), spheres.end()};
}

/// A double times a 256-bit factor: a number that no double holds.
Real lifted(double x, const Real& factor) { return Real(x) * factor; }
Vec<Real> lifted(const Vec<double>& v, const Real& factor) {
    return {lifted(v.x, factor), lifted(v.y, factor), lifted(v.z, factor)};
}

}  // namespace

TEST_CASE("the nearest of many spheres is the minimum over single spheres") {
    Seeded rng(21);
    int hits = 0;
    for (int i = 0; i < 20'000; ++i) {
        const RaySample first = rng.coin() ? draw_random_ray(rng, binary64) : draw_integer_tangent(rng, binary32);
        std::vector<Sphere<double>> spheres{first.sphere};
        const int count = rng.index(9);
        for (int k = 0; k < count; ++k) {
            const bool again = rng.index(5) == 0;
            spheres.push_back(again ? spheres[rng.index(k + 1)] : draw_random_ray(rng, binary64).sphere);
            if (rng.index(8) == 0) spheres.back().radius = nudge(spheres.back().radius, 1, binary64);
        }
        std::swap(spheres.front(), spheres[rng.index(static_cast<int>(spheres.size()))]);
        const Truth all = find_truth(first.ray, primitives(spheres));
        INFO(i << ": " << paste(first.ray, first.sphere) << " and " << count << " more");
        bool any = false;
        int max_bits = 0;
        for (std::size_t k = 0; k < spheres.size(); ++k) {
            const Truth one = find_truth(first.ray, spheres[k]);
            max_bits = std::max(max_bits, one.proof_bits);
            if (!one.is_hit()) continue;
            any = true;
            if (!all.is_hit()) FAIL("a miss though sphere " << k << " is hit");
            if (measure::truth::compare(one.t, all.t) < 0) FAIL("sphere " << k << " is nearer");
            if (static_cast<int>(k) < all.primitive && measure::truth::compare(one.t, all.t) == 0)
                FAIL("not the lowest of equals");
        }
        if (all.is_hit() != any || all.decision == Truth::Decision::unresolved) FAIL("a hit of nothing");
        if (all.proof_bits != max_bits) FAIL("bits " << all.proof_bits << ", not " << max_bits);
        if (!any) continue;
        ++hits;
        const ExactHit exact(first.ray, spheres[all.primitive]);
        if (!exact.hit() || !encloses(all.t, exact) || !encloses_distance(all.distance, exact))
            FAIL("does not enclose the nearest");
    }
    CHECK(hits > 5000);
}

TEST_CASE("a tangent goes on to what lies behind where touching is a miss") {
    const Ray<double> ray{{3, 0, 0}, {0, 0, 0.5}};
    const std::vector<Primitive<double>> both{Sphere<double>{{0, 0, 5}, 3}, Sphere<double>{{3, 0, 20}, 1}};
    const Truth closed = find_truth(ray, both);
    CHECK(closed.touches);
    CHECK(closed.primitive == 0);
    CHECK(closed.t.hi * std::exp2(closed.t.exponent) == 10);
    const Truth open = find_truth(ray, both, {}, intersect::Touching::miss);
    CHECK(open.touches);
    CHECK(open.primitive == 1);
    CHECK(open.t.hi * std::exp2(open.t.exponent) == 38);
    CHECK(!find_truth(ray, both[0], {}, intersect::Touching::miss).is_hit());
    // From a point of the surface: a ray along the tangent plane touches, a ray into the sphere does not.
    const Sphere<double> unit{{0, 0, 0}, 1};
    CHECK(find_truth(Ray<double>{{1, 0, 0}, {0, 1, 0}}, unit).touches);
    CHECK(!find_truth(Ray<double>{{1, 0, 0}, {0x1p-80, 1, 0}}, unit).touches);
    CHECK(!find_truth(Ray<double>{{0, 0, -2}, {0, 0, 1}}, unit).touches);
}

TEST_CASE("a ray through the point where two spheres touch hits both there") {
    Seeded rng(23);
    for (int i = 0; i < 2'000; ++i) {
        const Frame frame = draw_frame(rng, 20);
        const std::int64_t a = rng.integer(1, 1000), b = rng.integer(1, 1000), far = rng.integer(2000, 5000);
        // Touching from outside, the ray in the common tangent plane; and one inside the other, the ray head-on.
        const bool head_on = rng.coin();
        const Integers& to = head_on ? frame.u : frame.v;
        const std::int64_t second = head_on ? b : -b;
        const std::vector<Sphere<double>> both{
            {combine(a, to, 0, to, 0, to), static_cast<double>(a * frame.length)},
            {combine(second, to, 0, to, 0, to), static_cast<double>(b * frame.length)}};
        const Ray<double> ray{combine(-far, frame.u, 0, frame.v, 0, frame.w),
                              combine(1, frame.u, 0, frame.v, 0, frame.w)};
        for (const auto& spheres : {both, std::vector(both.rbegin(), both.rend())}) {
            const Truth t = find_truth(ray, primitives(spheres));
            REQUIRE(t.is_hit());
            REQUIRE(t.primitive == 0);
            for (const Sphere<double>& sphere : spheres) {
                REQUIRE(encloses(t.t, ExactHit(ray, sphere)));
                REQUIRE(round_truth(t, ray, sphere, binary64) == static_cast<double>(far));
            }
        }
    }
}

TEST_CASE("one unresolved sphere leaves the scene unresolved at any position of the list") {
    // A tangent that double-double cannot decide: 2 · 53 bits and more in every product.
    const RaySample hard{{{0x1.9000000000117p+60, 0x1.836p+16, 0}, {-4, -3, 0}},
                         {{-0x1p-60, -0x1.8p-61, 0}, 0x1.dfffffffffee3p+59}};
    const Sphere<double> easy{hard.ray.origin, 1};
    for (const auto& spheres : {std::vector{hard.sphere, easy}, std::vector{easy, hard.sphere}}) {
        const Truth t = find_truth(hard.ray, primitives(spheres), ProofLimit{106});
        CHECK(t.decision == Truth::Decision::unresolved);
        CHECK_FALSE(t.is_hit());
    }
}

TEST_CASE("a low precision limit leaves a hard tangent unresolved that the default resolves") {
    Seeded rng(24);
    int needed_more = 0;
    for (int i = 0; i < 3'000; ++i) {
        const RaySample s = rng.coin() ? draw_wide_tangent(rng, binary64) : draw_integer_tangent(rng, binary64);
        const Truth full = find_truth(s.ray, s.sphere);
        INFO(paste(s.ray, s.sphere));
        REQUIRE(full.decision != Truth::Decision::unresolved);
        REQUIRE(full.is_hit() == ExactHit(s.ray, s.sphere).hit());
        if (full.proof_bits <= 106) continue;
        ++needed_more;
        const Truth limited = find_truth(s.ray, s.sphere, ProofLimit{full.proof_bits - 1});
        REQUIRE(limited.decision == Truth::Decision::unresolved);
        REQUIRE_FALSE(limited.is_hit());
        REQUIRE(find_truth(s.ray, s.sphere, ProofLimit{64}).decision == Truth::Decision::unresolved);
        REQUIRE(find_truth(s.ray, s.sphere, ProofLimit{full.proof_bits}).decision == full.decision);
    }
    CHECK(needed_more > 2000);
}

TEST_CASE("truth agrees with exact integers on 256-bit inputs") {
    Seeded rng(25);
    RaySample (*const distributions[])(Seeded&, const FloatFormat&) = {
        draw_random_ray, draw_near_tangent, draw_tangent, draw_on_surface, draw_near_surface,
        draw_inside,     draw_huge_sphere,  draw_tie,     draw_near_tie};
    int escalated = 0, hits = 0, beyond = 0;
    for (int i = 0; i < 20'000; ++i) {
        const RaySample s = distributions[rng.index(9)](rng, binary64);
        // One factor for all lengths: exact contacts become contacts to 256 bits, which need 512 bits to settle.
        const int over = rng.coin() ? 3 + rng.index(1000) : 1, under = rng.coin() ? 3 + rng.index(1000) : 1;
        const Real factor = Real(1) / over, stretch = Real(1) / under;
        const Ray<Real> ray{lifted(s.ray.origin, factor), lifted(s.ray.direction, stretch)};
        const Sphere<Real> sphere{lifted(s.sphere.centre, factor), lifted(s.sphere.radius, factor)};
        const Truth t = find_truth(ray, sphere);
        const ExactHit exact(ray, sphere);
        INFO(i << ": " << paste(s.ray, s.sphere) << " lengths over " << over << ", direction over " << under);
        if (t.decision == Truth::Decision::unresolved || t.is_hit() != exact.hit()) FAIL("decides otherwise");
        escalated += t.proof_bits > 106;
        beyond += t.proof_bits > 384;
        if (!t.is_hit()) continue;
        ++hits;
        if (!encloses(t.t, exact) || !encloses_distance(t.distance, exact)) FAIL("not within its bound");
        const auto side = [&](const Dyadic& x) { return exact.side(x); };
        for (const FloatFormat& format : {binary64, binary32, bfloat16})
            if (!is_rounded(round_truth(t, ray, sphere, format), side, format))
                FAIL("not correctly rounded to " << format.precision << " bits");
    }
    CHECK(hits > 10'000);
    CHECK(escalated > 2'000);
    CHECK(beyond > 50);
}

TEST_CASE("inputs far beyond the range of double keep their exponents") {
    const Real huge = ldexp(Real(1), 5000), tiny = ldexp(Real(1), -5000);
    for (const Real& unit : {huge, tiny}) {
        const Ray<Real> ray{{Real(0), Real(0), Real(0)}, {Real(1), Real(0), Real(0)}};
        const Sphere<Real> sphere{{Real(3) * unit, Real(0), Real(0)}, Real(2) * unit};
        const Truth t = find_truth(ray, sphere);
        REQUIRE(t.is_hit());
        CHECK(encloses(t.t, ExactHit(ray, sphere)));
        CHECK(encloses_distance(t.distance, ExactHit(ray, sphere)));
        CHECK(t.t.floor_log2() == (unit > 1 ? 5000 : -5000));
        CHECK(round_truth(t, ray, sphere, binary64) == (unit > 1 ? HUGE_VAL : 0.0));
    }
}

TEST_CASE("a decision that no precision within the limit proves is not guessed") {
    const Real tiny = ldexp(Real(1), -60'000);
    // f = (0, 5, 0) + τ·(3, 4, 0) and d = (3, 4, 0): a tangent of radius 3, seen as one only where 5 + 4τ is exact.
    const Ray<Real> along{{Real(0), Real(5), Real(0)}, {Real(-3), Real(-4), Real(0)}};
    const Sphere<Real> touched{{Real(-3) * tiny, Real(-4) * tiny, Real(0)}, Real(3)};
    CHECK(find_truth(along, touched).decision == Truth::Decision::unresolved);
    CHECK(find_truth(along, touched, ProofLimit{200'000}).is_hit());

    // t lies 2^-60000 below a tie: known to 2^-72, which does not show the side.
    const Ray<Real> ray{{Real(-1), Real(0), Real(0)}, {Real(1), Real(0), Real(0)}};
    const Sphere<Real> point{{ldexp(Real(1), 53) + 2, Real(0), Real(0)}, tiny};
    const Truth t = find_truth(ray, point);
    REQUIRE(t.is_hit());
    CHECK(round_truth(t, ray, point, binary32) == 0x1p53);
    CHECK_THROWS_AS(round_truth(t, ray, point, binary64), Error);
}

}  // namespace test_truth_scenes
