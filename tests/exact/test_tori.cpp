// Tests of tori only: forms without rounding, the reach of t, and lines through the hole.
#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "catch.hpp"
#include "counts.hpp"
#include "exact/draw.hpp"
#include "measure/offset/half_line.hpp"
#include "measure/seeded.hpp"
#include "measure/truth/conditioning.hpp"
#include "measure/truth/reach_of_t.hpp"
#include "number/real.hpp"
#include "shapes/torus/forms/forms.hpp"

namespace test_tori {

using namespace lostbits;
using namespace lostbits::exact;
using measure::truth::find_truth, measure::truth::Truth;

namespace {

Vec<Real> lifted(const Vec<double>& v) { return {Real(v.x), Real(v.y), Real(v.z)}; }

template <class Form>
Hit<Real> unrounded(const Ray<double>& ray, const Torus<double>& torus) {
    const Vec<Real> d = lifted(ray.direction);
    const Real size = length(d);
    Hit<Real> h = Form::template intersect<Real>(
        {lifted(ray.origin), Vec<Real>(d.x / size, d.y / size, d.z / size)},
        {lifted(torus.centre), lifted(torus.axis), Real(torus.major_radius), Real(torus.minor_radius)});
    h.t /= size;
    return h;
}

Ray<double> ray_of(const Problem& problem) {
    return {{problem.ray[0], problem.ray[1], problem.ray[2]}, {problem.ray[3], problem.ray[4], problem.ray[5]}};
}
template <class E>
std::pair<int, int> roots_in(const Problem& problem) {
    const Sturm<E> quartic = quartic_of(ObjectProblem<E>(problem));
    return {quartic.all(), quartic.all() - quartic.up_to(E())};
}
/// Number of roots, and number of roots ahead.
std::pair<int, int> roots_of(const Ray<double>& ray, const Primitive<double>& primitive) {
    const Vec<double>&o = ray.origin, &d = ray.direction;
    Problem p{.ray = {o.x, o.y, o.z, d.x, d.y, d.z}};
    std::ranges::copy(primitive.shape_numbers(), p.primitive.begin());
    in_doubt = false;
    const auto roots = roots_in<Enclosed>(p);
    return in_doubt ? roots_in<Whole>(p) : roots;
}

}  // namespace

TEST_CASE("Sturm chains miss a torus that a line in the plane of its top passes", "[intersect][torus]") {
    // Outside its circle: the quartic is (x² + β)², β > 0, so the numbers of the chain from u x − v on are 0. Rounding
    // gives them signs, but −, ±, + is one change with either sign, and with 0.
    const Torus<double> torus{{0, 0, 0}, {0, 0, 1}, 875, 450};
    test::Seeded rng(0x70f5);
    std::vector<Ray<double>> rays{{{-1087, 9, -450}, {-3, -4, 0}}};
    const auto whole = [&rng](double low, double high) { return std::floor(rng.uniform(low, high)); };
    for (int i = 0; i < 300; ++i)
        rays.push_back({{whole(-2000, 2000), whole(-2000, 2000), 450}, {whole(-9, 9), whole(1, 9), 0}});
    int ray_count = 0;
    for (const Ray<double>& ray : rays) {
        if (find_truth(ray, Primitive<double>(torus)).is_hit()) continue;
        REQUIRE(roots_of(ray, torus).second == 0);
        ++ray_count;
        CHECK_FALSE(unrounded<intersect::torus::SturmTorus>(ray, torus).hit);
        CHECK_FALSE(unrounded<intersect::torus::Bracketed>(ray, torus).hit);
        CHECK_FALSE(unrounded<intersect::torus::FilteredTorus>(ray, torus).hit);
    }
    CHECK(ray_count > 100);
}

TEST_CASE("Sturm chains find the wall of a torus from its planes of symmetry", "[intersect][torus]") {
    // The quartic is n x⁴ + p x² + r, so that numbers of the chain are 0 where the ray begins.
    const Torus<double> torus{{0, 0, 0}, {0, 0, 1}, 1.25, 0.75};
    int ray_count = 0;
    for (const double x : {0.625, 0.75, 1.0, 1.25, 1.5, 1.875}) {
        for (const Vec<double>& d : {Vec<double>(0, 0, 1), Vec<double>(0, 0, -1), Vec<double>(0, 1, 0)}) {
            const Ray<double> ray{{x, 0, 0}, d};
            const Truth truth = find_truth(ray, Primitive<double>(torus));
            REQUIRE(truth.is_hit());
            const double t = std::ldexp(truth.t.hi, static_cast<int>(truth.t.exponent));
            CAPTURE(x, d.y, d.z, t);
            const auto check = [t](const Hit<Real>& hit) {
                CHECK(hit.hit);
                CHECK(std::fabs(hit.t.convert_to<double>() - t) < 1e-12 * t);
            };
            check(unrounded<intersect::torus::SturmTorus>(ray, torus));
            check(unrounded<intersect::torus::Bracketed>(ray, torus));
            ++ray_count;
        }
    }
    REQUIRE(ray_count == 18);
}

TEST_CASE("an absolute threshold makes Quilez's torus wrong without rounding", "[intersect][torus][formula]") {
    // Through the tiny hole of a torus: where |d1| < 1e-4 the root of d1 is treated as 0.
    test::Seeded rng(0x7051);
    int ray_count = 0, off = 0;
    double most = 0;
    for (int i = 0; i < 300; ++i) {
        const Torus<double> torus{rng.vec(-1, 1), rng.vec(-1, 1), 1, rng.uniform(0.5, 0.95)};
        const double hole = 1 - torus.minor_radius;
        const Vec<double> from = torus.centre + 3.0 * torus.axis + hole * rng.vec(-1, 1);
        const Ray<double> ray{from, torus.centre + 1.25 * hole * rng.vec(-1, 1) - from};
        const Truth truth = find_truth(ray, Primitive<double>(torus));
        const Hit<Real> h = unrounded<intersect::torus::QuilezTorus>(ray, torus);
        if (!truth.is_hit() || !h.hit) continue;
        ++ray_count;
        const double t = std::ldexp(truth.t.hi, static_cast<int>(truth.t.exponent));
        const double wrong = std::fabs(h.t.convert_to<double>() - t) / t;
        off += wrong > 1e-6, most = std::max(most, wrong);
    }
    CHECK(ray_count > 50);
    CHECK(off > 3);
    CHECK(most > 0.001);
    CHECK(most < 0.1);
}

TEST_CASE("half an ulp in each number moves t of a torus by no more than its reach", "[truth][torus]") {
    test::Seeded rng(0x706);
    Chance chance(9);
    int ray_count = 0, wide = 0;
    double share = 0;
    const auto moved = [&rng](double x) {
        const double ulp = x == 0 ? 0 : std::ldexp(1.0, std::max(std::ilogb(x), -126) - 24);
        return x + rng.uniform(-1, 1) * ulp;
    };
    std::vector<Problem> problems(test::draws(std::size_t{4000}));
    for (const bool made : {false, true}) {
        (made ? draw_made : draw_random)(shapes[10], true, {}, chance, problems);
        for (const Problem& problem : problems) {
            const Ray<double> ray = ray_of(problem);
            Primitive<double> primitive(Shape::torus);
            std::copy_n(problem.primitive.begin(), primitive.shape_numbers().size(), primitive.numbers.begin());
            const Truth truth = find_truth(ray, primitive);
            if (!truth.is_hit() || truth.touches || truth.on_surface) continue;
            const double reach = test::reach_of_t(ray, primitive, truth.t, binary32);
            const auto roots = roots_of(ray, primitive);
            for (int k = 0; k < 4; ++k) {
                Problem q = problem;
                for (double& x : q.ray) x = moved(x);
                const Primitive<double> other = convert_numbers(primitive, moved);
                // Another root is another answer.
                if (roots_of(ray_of(q), other) != roots) continue;
                const Truth there = find_truth(ray_of(q), other);
                if (!there.is_hit()) continue;
                const double apart = std::fabs(scaled_difference(there.t, truth.t, truth.t.exponent));
                const double allowed = std::ldexp(reach, -static_cast<int>(truth.t.exponent));
                INFO(made);
                REQUIRE(apart <= allowed);
                ++ray_count, wide += std::isinf(allowed) && !made;
                if (!made) share = std::max(share, apart / allowed);
            }
        }
    }
    CHECK(ray_count > 500);
    CHECK(wide == 0);
    CHECK(share > 0.1);
}

TEST_CASE("the condition number of t of a torus agrees with its derivatives", "[truth][torus]") {
    // t = 5 − (R + r) = 2, with derivatives −1 by o.x, −t by d.x, −1 by R and by r; turning the axis moves nothing.
    const Ray<double> ray{{-5, 0, 0}, {1, 0, 0}};
    CHECK(measure::truth::condition(ray, Primitive<double>(Torus<double>{{0, 0, 0}, {0, 0, 1}, 2, 1})) == Approx(5));
    // A line along the top touches: no derivative exists.
    CHECK(measure::truth::condition({{-5, 0, 1}, {1, 0, 0}},
                                    Primitive<double>(Torus<double>{{0, 0, 0}, {0, 0, 1}, 2, 1})) == HUGE_VAL);
}

TEST_CASE("half-lines and segments meet a torus in its ring and not in its hole", "[torus]") {
    using measure::offset::find_meeting, measure::offset::Meeting, measure::offset::passes_through;
    const Primitive<double> torus(Torus<double>{{0, 0, 0}, {0, 0, 3}, 2, 1});
    const auto from = [&](const Vec<double>& o, const Vec<double>& d) { return find_meeting({{o, d}, 0}, torus); };
    CHECK(from({0, 0, 0}, {1, 0, 0}) == Meeting{.inside = false, .outside = true, .meets = true});
    CHECK(from({0, 0, 0}, {0, 0, 1}) == Meeting{.inside = false, .outside = true, .meets = false});
    CHECK(from({2, 0, 0}, {1, 0, 0}) == Meeting{.inside = true, .outside = false, .meets = true});
    CHECK(from({1, 0, 0}, {1, 0, 0}) == Meeting{.inside = false, .outside = false, .meets = true});
    CHECK(from({1, 0, 0}, {-1, 0, 0}) == Meeting{.inside = false, .outside = false, .meets = true});
    CHECK(from({1, 0, 0}, {0, 0, 1}) == Meeting{.inside = false, .outside = false, .meets = false});
    CHECK(from({3, 0, 0}, {1, 0, 0}) == Meeting{.inside = false, .outside = false, .meets = false});
    CHECK(from({-9, 0, 1}, {1, 0, 0}) == Meeting{.inside = false, .outside = true, .meets = false});
    CHECK(from({-9, 1, 0}, {1, 0, 0}) == Meeting{.inside = false, .outside = true, .meets = true});
    CHECK_FALSE(passes_through({0, 0, -5}, {0, 0, 5}, torus));
    CHECK_FALSE(passes_through({-0.9, 0, 0}, {0.9, 0, 0}, torus));
    CHECK(passes_through({0, 0, 0}, {1.5, 0, 0}, torus));
    CHECK(passes_through({-5, 0, 0}, {5, 0, 0}, torus));
    CHECK(passes_through({2, 0, 0}, {2.5, 0, 0}, torus));
    CHECK_FALSE(passes_through({-5, 0, 1}, {5, 0, 1}, torus));
}

}  // namespace test_tori
