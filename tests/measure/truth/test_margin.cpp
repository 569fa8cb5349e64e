// How much a problem may change before its answer does: against problems that are changed so much, in 2048 bits.
//
//   LOSTBITS_RAYS=13400 build/test_truth "[margin]"      so many rays of each of 75 families and formats, 10^6 in all
#include <cmath>
#include <cstdlib>
#include <functional>
#include <vector>

#include "catch.hpp"
#include "counts.hpp"
#include "intersect/triangle/triangle_rays.hpp"
#include "measure/seeded.hpp"
#include "measure/stability/margin.hpp"
#include "measure/truth/box_families.hpp"
#include "measure/truth/ray_families.hpp"
#include "measure/truth/textbook.hpp"
#include "measure/truth/truth.hpp"
#include "scene/sweep/families.hpp"

namespace test_margin {

using namespace lostbits;
using namespace testing::textbook;
using measure::stability::backward_error;
using measure::stability::decision_margin;
using measure::stability::Turned;
using measure::truth::find_truth;
using measure::truth::Perturbed;
using testing::Seeded;

namespace {

/// What decides whether the ray meets the solid: signs of these.
std::vector<Wide> deciding(Shape shape, const Numbers& x) {
    std::vector<Wide> signs;
    if (shape == Shape::sphere) {
        const Quadratic p(x);
        signs = {p.h * p.h - p.a * p.c, p.c, p.h};
    } else if (shape == Shape::box) {
        // Entry of one axis against exit of another, and exits against 0, multiplied out.
        for (std::size_t i = 0; i < 3; ++i) {
            const bool back = x[3 + i] < 0;
            const Wide in = x[(back ? 9 : 6) + i] - x[i], out = x[(back ? 6 : 9) + i] - x[i];
            signs.push_back(x[3 + i] == 0 ? Wide(x[6 + i] - x[i]) : out);
            signs.push_back(x[3 + i] == 0 ? Wide(x[9 + i] - x[i]) : in);
            for (std::size_t j = 0; j < 3; ++j) {
                const Wide leave = x[(x[3 + j] < 0 ? 6 : 9) + j] - x[j];
                if (i != j && x[3 + i] != 0 && x[3 + j] != 0)
                    signs.push_back(in * abs(x[3 + j]) * (back ? -1 : 1) -
                                    leave * abs(x[3 + i]) * (x[3 + j] < 0 ? -1 : 1));
            }
        }
    } else {
        const Vec<Wide> d = point(x, 3), a = point(x, 6) - point(x, 0), b = point(x, 9) - point(x, 0),
                        c = point(x, 12) - point(x, 0);
        const Wide u = dot(d, cross(b, c)), v = dot(d, cross(c, a)), w = dot(d, cross(a, b));
        signs = {u, v, w, u + v + w, dot(a, cross(b, c))};
    }
    return signs;
}

bool is_hit(Shape shape, const Numbers& x) {
    if (shape == Shape::sphere) {
        const Quadratic p(x);
        return p.c <= 0 || (p.h <= 0 && p.h * p.h - p.a * p.c >= 0);
    }
    if (shape == Shape::box) {
        Wide last = 0;
        std::optional<Wide> first;
        for (std::size_t k = 0; k < 3; ++k) {
            const Wide &o = x[k], &d = x[3 + k], &lo = x[6 + k], &hi = x[9 + k];
            if (d == 0 && (o < lo || o > hi)) return false;
            if (d == 0) continue;
            const Wide in = ((d < 0 ? hi : lo) - o) / d, out = ((d < 0 ? lo : hi) - o) / d;
            if (in > last) last = in;
            if (!first || out < *first) first = out;
        }
        return first && last <= *first;
    }
    const auto t = Textbook::through_triangle(x);
    return t && *t >= 0;
}

/// x moved by `by` of each number, in the direction in which `f` falls fastest towards 0.
template <class F>
Numbers towards(const Numbers& x, std::size_t count, const F& f, double by) {
    Numbers moved = x;
    const Wide here = f(x);
    for (std::size_t i = 0; i < count; ++i) {
        if (x[i] == 0) continue;
        Numbers aside = x;
        const Wide step = abs(x[i]) * ldexp(Wide(1), -900);
        aside[i] += step;
        const bool grows = f(aside) > here;
        moved[i] += abs(x[i]) * by * (grows == (here > 0) ? -1 : 1);
    }
    return moved;
}

Numbers random_corner(const Numbers& x, std::size_t count, Seeded& rng, double by) {
    Numbers moved = x;
    for (std::size_t i = 0; i < count; ++i) moved[i] += abs(x[i]) * by * rng.sign();
    return moved;
}

struct Tally {
    int tight = 0, all = 0;
    void take(bool found) { ++all, tight += found; }
};

/// A margin is never above what is found by looking. Of most a change a fifth larger that turns the decision is found:
/// not of rays from the surface or at a rim, where two signs decide together, nor where the second order does, as of
/// one through the middle of a sphere far away.
void check_margin(Tally& tally, const Ray<double>& ray, const Solid<double>& solid, Seeded& rng) {
    const Numbers x = numbers_of(ray, solid);
    const std::size_t count = 6 + solid.used().size();
    const bool hit = is_hit(solid.shape, x);
    const double margin = decision_margin(ray, solid, Turned::decision);
    const double root = decision_margin(ray, solid);
    REQUIRE((margin >= 0 && margin <= 0.5));
    CHECK(root <= margin);
    for (int k = 0; k < 4; ++k) CHECK(is_hit(solid.shape, random_corner(x, count, rng, margin)) == hit);
    const std::size_t signs = deciding(solid.shape, x).size();
    bool turned = false;
    for (std::size_t k = 0; k < signs; ++k) {
        const auto sign = [&](const Numbers& at) { return deciding(solid.shape, at)[k]; };
        CHECK(is_hit(solid.shape, towards(x, count, sign, margin)) == hit);
        turned |= is_hit(solid.shape, towards(x, count, sign, std::max(1.2 * margin, 0x1p-80))) != hit;
    }
    if (margin < 0x1p-8) tally.take(turned);
}

/// The same of the backward error of a t that is off by 2^-`bits`.
void check_backward(Tally& tally, const Ray<double>& ray, const Solid<double>& solid, Seeded& rng) {
    const auto truth = find_truth(ray, solid);
    if (!truth.is_hit() || truth.t.is_zero() || truth.t.exponent < -900 || truth.t.exponent > 900) return;
    const double exact = std::ldexp(truth.t.hi, static_cast<int>(truth.t.exponent));
    const double t = exact * (1 + rng.sign() * std::ldexp(1.0, -static_cast<int>(rng.integer(3, 45))));
    const double error = backward_error(ray, solid, t);
    const Numbers x = numbers_of(ray, solid);
    const std::size_t count = 6 + solid.used().size();
    Textbook book;
    for (std::size_t k = 0; k < 3; ++k) book.crossed[k] = x[3 + k] != 0;
    for (const int which : {-1, 1}) {
        book.which = which;
        const auto root = book.t(solid.shape, x);
        if (root && abs(Wide(*root - exact)) <= abs(exact) * Wide(0x1p-50)) break;
        if (which == 1) return;
    }
    const auto side = [&](const Numbers& at) {
        const auto here = book.t(solid.shape, at);
        return !here ? 0 : *here < t ? -1 : *here > t ? 1 : 2;
    };
    const int before = side(x);
    const auto stays = [&](const Numbers& at) {
        const int after = side(at);
        return after == 0 || after == before;
    };
    for (int k = 0; k < 4; ++k) CHECK(stays(random_corner(x, count, rng, error)));
    bool reached = false;
    for (std::size_t axis = 0; axis < (solid.shape == Shape::box ? 3U : 1U); ++axis) {
        if (x[3 + axis] == 0 && solid.shape == Shape::box) continue;
        const auto off = [&](const Numbers& at) { return residual(solid.shape, at, Wide(t), axis); };
        CHECK(stays(towards(x, count, off, error)));
        const Numbers farther = towards(x, count, off, std::max(1.2 * error, 0x1p-80));
        reached |= !stays(farther);
        // At the rim a triangle may be missed where its plane comes to t.
        reached |= solid.shape == Shape::triangle && (off(farther) > 0) != (off(x) > 0);
    }
    if (error < 0x1p-8) tally.take(reached);
}

const int rays_per_family = [] {
    const char* const asked = std::getenv("LOSTBITS_RAYS");
    return asked ? std::atoi(asked) : test::draws(400);
}();

void check_tightness(const Tally& margins, const Tally& errors) {
    CHECK(margins.all >= 150);
    CHECK(errors.all >= 150);
    CHECK(margins.tight * 100 >= margins.all * 65);
    CHECK(errors.tight * 100 >= errors.all * 65);
}

}  // namespace

TEST_CASE("no change within the margin turns a decision, none within the backward error makes t right - spheres",
          "[margin]") {
    Tally margins, errors;
    for (const std::span<const testing::RayFamily> families :
         {std::span<const testing::RayFamily>(testing::near_families),
          std::span<const testing::RayFamily>(testing::power_families)}) {
        for (const FloatFormat& format : {binary32, binary64}) {
            for (const testing::RayFamily& family : families) {
                INFO(family.name << ", " << format.precision << " bits");
                Seeded rng(0x3a61);
                for (int i = 0; i < rays_per_family; ++i) {
                    const auto s = family.make(rng, format);
                    check_margin(margins, s.ray, s.sphere, rng);
                    check_backward(errors, s.ray, s.sphere, rng);
                }
            }
        }
    }
    check_tightness(margins, errors);
}

TEST_CASE("no change within the margin turns a decision, none within the backward error makes t right - boxes",
          "[margin]") {
    Tally margins, errors;
    for (const FloatFormat& format : {binary32, binary64}) {
        for (const testing::BoxFamily& family : testing::box_families) {
            INFO(family.name << ", " << format.precision << " bits");
            Seeded rng(0x3a61);
            for (int i = 0; i < rays_per_family; ++i) {
                const auto s = family.make(rng, format);
                check_margin(margins, s.ray, s.box, rng);
                check_backward(errors, s.ray, s.box, rng);
            }
        }
    }
    check_tightness(margins, errors);
}

TEST_CASE("no change within the margin turns a decision, none within the backward error makes t right - triangles",
          "[margin]") {
    Tally margins, errors;
    for (const test::TriangleFamily& family : test::triangle_families) {
        INFO(family.name);
        Seeded rng(0x3a61);
        for (int i = 0; i < rays_per_family; ++i) {
            const auto s = test::in_floats(family.make(rng));
            if (on_one_line(s.triangle.a, s.triangle.b, s.triangle.c) || s.ray.direction == Vec<double>(0, 0, 0))
                continue;
            check_margin(margins, s.ray, s.triangle, rng);
            check_backward(errors, s.ray, s.triangle, rng);
        }
    }
    check_tightness(margins, errors);
}

TEST_CASE("no change within the margin turns a decision, of every shape", "[margin]") {
    for (const auto& family : scene::sweep::families()) {
        INFO(family.table);
        Seeded rng(0x3a61);
        int told = 0, asked = 0;
        for (const auto& set : family.sets()) {
            for (const auto& group : set.groups()) {
                if (asked >= 4 * rays_per_family) break;
                const Ray<double> ray = group.rays[0];
                const Solid<double> solid = group.solids.front();
                const auto truth = find_truth(ray, solid);
                ++asked;
                for (const Perturbed perturbed : {Perturbed::componentwise, Perturbed::normwise}) {
                    const double margin = decision_margin(ray, solid, Turned::decision, perturbed);
                    told += margin > 0;
                    const double by = margin * (1 - 0x1p-20) - 0x1p-52;
                    if (by <= 0) continue;
                    for (int k = 0; k < 4; ++k) {
                        Ray<double> r = ray;
                        Solid<double> s = solid;
                        for (int i = 0; i < 3; ++i)
                            r.origin[i] *= 1 + by * rng.sign(), r.direction[i] *= 1 + by * rng.sign();
                        for (double& number : s.used()) number *= 1 + by * rng.sign();
                        if (measure::truth::is_proper(s)) CHECK(find_truth(r, s).is_hit() == truth.is_hit());
                    }
                }
            }
        }
        CHECK(asked > 0);
        CHECK(told >= asked);
    }
}

TEST_CASE("margins and backward errors by hand", "[margin]") {
    const Ray<double> ray{{0, 0, 0}, {0, 0, 1}};
    // d = 1 at distance 4 from a unit sphere whose centre is off the line by 1 - 2^-10: r and the centre move.
    const Sphere<double> grazed{{1 - 0x1p-10, 0, 4}, 1};
    const double margin = decision_margin(ray, grazed);
    CHECK(margin > 0.95 * 0x1p-11);
    CHECK(margin < 1.01 * 0x1p-11);
    // t = 3 of the sphere in front, and 3.003: (4 - 1)(1 + e) against a direction that is longer by e.
    const Sphere<double> front{{0, 0, 4}, 1};
    CHECK(backward_error(ray, front, 3) == 0);
    const double error = backward_error(ray, front, 3.003);
    // 4 (1 + e) - (1 - e) = 3.003 (1 - e): e = 0.003/8.003
    CHECK(error < 0.003 / 8.003);
    CHECK(error > 0.95 * 0.003 / 8.003);
    CHECK(std::isnan(backward_error(ray, front, 0)));
    // Where componentwise the ray along an axis keeps its zeros, normwise it turns.
    const Box<double> box{{1, -1, 3}, {2, 1, 5}};
    CHECK(decision_margin({{0, 0, 0}, {0, 0, 1}}, box) == 0.5);
    CHECK(decision_margin({{0, 0, 0}, {0, 0, 1}}, box, Turned::root, Perturbed::normwise) < 0.25);
    // A t so small or so large that it has no place beside the other numbers.
    CHECK(backward_error({{0, 0, 0}, {0, 0, 0x1p-1000}}, front, 0x1p-1074) >= 0);
    CHECK(backward_error({{0, 0, 0}, {0, 0, 0x1p+1000}}, front, 0x1p-1070) >= 0);
    // Nothing is proved where the ray touches.
    CHECK(decision_margin({{1, 0, 0}, {0, 0, 1}}, Sphere<double>{{0, 0, 4}, 1}) == 0);
}

}  // namespace test_margin
