// Parts of the consistency checks: any hit before an end, a segment in two ways, a chord from either end.
#include <algorithm>
#include <cmath>
#include <random>

#include "catch.hpp"
#include "measure/consistency/segments.hpp"
#include "measure/rows.hpp"
#include "number/real.hpp"
#include "number/rounded.hpp"

namespace test_checks {

using namespace lostbits;
using namespace lostbits::measure::consistency;
using measure::truth::Truth;
using test::form_named;

namespace {

const Primitive<double> unit_sphere(Sphere<double>{{0, 0, 0}, 1});
const Primitive<double> unit_box(Box<double>{{-1, -1, -1}, {1, 1, 1}});

bool meets(std::string_view form, std::string_view format, const Ray<double>& ray, double end,
           const std::vector<Primitive<double>>& primitives) {
    const FormKernels kernels(form_named(form), *find_format(format));
    auto rays = scene::rays::make_group(ray).rays;
    rays.tmax = {end};
    return std::ranges::any_of(primitives, [&](const Primitive<double>& primitive) {
        return find_hits_before_tmax(kernels, rays, primitive).front() != 0;
    });
}

/// −h ∓ √(h² − a c), all over a, in 256 bits; the library computes it differently, from |f × d|².
std::pair<Real, Real> chord_in_real(const Ray<double>& ray, const Sphere<double>& sphere) {
    Real a = 0, h = 0, c = -Real(sphere.radius) * Real(sphere.radius);
    for (int i = 0; i < 3; ++i) {
        const Real f = Real(ray.origin[i]) - Real(sphere.centre[i]), d = ray.direction[i];
        a += d * d;
        h += f * d;
        c += f * f;
    }
    const Real root = sqrt(Real(h * h - a * c));
    return {(-h - root) / a, (-h + root) / a};
}

}  // namespace

TEST_CASE("any hit before an end: sphere forms compare t, box forms decide", "[measure][consistency]") {
    const Ray<double> ray{{-3, 0, 0}, {1, 0, 0}};
    for (const char* format : {"f32", "f64", "bf16"}) {
        const FloatFormat f = find_format(format)->parameters;
        const double after = rounding::next_up(2.0, f), before = -rounding::next_up(-2.0, f);
        for (const char* form : {"sphere.half_b", "sphere.unified", "sphere.early_exit"}) {
            INFO(form << " " << format);
            CHECK(meets(form, format, ray, after, {unit_sphere}));
            CHECK_FALSE(meets(form, format, ray, 2, {unit_sphere}));
            CHECK_FALSE(meets(form, format, ray, before, {unit_sphere}));
            // Any of several primitives will do.
            const Primitive<double> far_away(Sphere<double>{{0, 50, 0}, 1});
            CHECK(meets(form, format, ray, after, {far_away, unit_sphere}));
            CHECK_FALSE(meets(form, format, ray, HUGE_VAL, {far_away}));
        }
        CHECK(meets("box.inclusive", format, ray, after, {unit_box}));
        CHECK(meets("box.inclusive", format, ray, 2, {unit_box}));
        CHECK_FALSE(meets("box.inclusive", format, ray, before, {unit_box}));
        CHECK_FALSE(meets("box.exclusive", format, ray, 2, {unit_box}));
    }
    // On the surface, t = 0 is not a hit of a shadow test, but the far side is.
    const Ray<double> across{{-1, 0, 0}, {1, 0, 0}};
    CHECK_FALSE(meets("sphere.half_b", "f32", across, 2, {unit_sphere}));
    CHECK(meets("sphere.half_b", "f32", across, 2.0000002384185791, {unit_sphere}));
    // From inside, the far side counts; a primitive behind the origin does not.
    CHECK(meets("sphere.half_b", "f32", {{0, 0, 0}, {1, 0, 0}}, 1.5, {unit_sphere}));
    CHECK_FALSE(meets("sphere.half_b", "f32", {{3, 0, 0}, {1, 0, 0}}, 100, {unit_sphere}));
}

TEST_CASE("a hit that truly lies before an end is proved, also exactly at the end", "[measure][consistency]") {
    using D = Truth::Decision;
    const auto truly = [](const Ray<double>& ray, double end, const Primitive<double>& primitive,
                          intersect::Touching touching = intersect::Touching::hit) {
        return truly_meets_before(ray, end, std::span(&primitive, 1), touching);
    };
    const Ray<double> ray{{-3, 0, 0}, {1, 0, 0}};
    CHECK(truly(ray, 2, unit_sphere) == D::miss);
    CHECK(truly(ray, std::nextafter(2.0, 3.0), unit_sphere) == D::hit);
    CHECK(truly(ray, HUGE_VAL, unit_sphere) == D::hit);
    CHECK(truly(ray, 0, unit_sphere) == D::miss);
    CHECK(truly(ray, 2, unit_box) == D::hit);
    CHECK(truly(ray, 2, unit_box, intersect::Touching::miss) == D::miss);
    CHECK(truly(ray, std::nextafter(2.0, 1.0), unit_box) == D::miss);
    const Ray<double> across{{-1, 0, 0}, {1, 0, 0}};
    CHECK(truly(across, 2, unit_sphere) == D::miss);
    CHECK(truly(across, std::nextafter(2.0, 3.0), unit_sphere) == D::hit);
    // t* = 3 − √(1 − y²) with y = 2^-60 is 2 + 2^-121 and some: closer to 2 than any double.
    const Ray<double> beside{{-3, 0x1p-60, 0}, {1, 0, 0}};
    CHECK(truly(beside, 2, unit_sphere) == D::miss);
    CHECK(truly(beside, std::nextafter(2.0, 3.0), unit_sphere) == D::hit);
}

TEST_CASE("a segment written in two ways rounds operation by operation in float", "[measure][consistency]") {
    const Vec<double> p(0.5F, -0.25F, 3.0F), q(7.3F, 2.1F, -9.7F);
    const auto s = write_segment(p, q, *find_format("f32"), SegmentEnd::shortened);
    const float x = 7.3F - 0.5F, y = 2.1F + 0.25F, z = -9.7F - 3.0F;
    const float xx = x * x, yy = y * y, zz = z * z;
    const float two = xx + yy, three = two + zz;
    const float size = std::sqrt(three);
    CHECK(s.by_difference.direction == Vec<double>(x, y, z));
    CHECK(s.by_unit.direction == Vec<double>(x / size, y / size, z / size));
    const float share = 1.0F - 1.0F / 10000.0F, end = share * size;
    CHECK(s.difference_end == share);
    CHECK(s.unit_end == end);
    CHECK(s.by_unit.origin == p);
    CHECK(write_segment(p, q, *find_format("f32"), SegmentEnd::whole).difference_end == 1);
}

TEST_CASE("a chord from either end agrees with one worked out by hand", "[measure][consistency]") {
    const double ulp = 0x1p-23;
    const ReversedRays ends{{{-2, 0, 0}, {4, 0, 0}}, {{2, 0, 0}, {-4, 0, 0}}, unit_sphere};
    const auto right = compute_chord_error(ends, {0.25, 0.75, 0.25, 0.75}, false, ulp);
    REQUIRE(right);
    CHECK(right->apart == 0);
    CHECK(right->excess == 0);
    const auto off = compute_chord_error(ends, {0.25, 0.75 + 3 * ulp, 0.25, 0.75 - ulp}, false, ulp);
    REQUIRE(off);
    CHECK(off->apart == 3);
    CHECK(off->excess == 3);
    // As distances, the length is 4.
    const auto distances = compute_chord_error(ends, {1, 3, 1, 3 + 0x1p-21}, true, 0x1p-21);
    REQUIRE(distances);
    CHECK(distances->apart == 1);
    // p is inside: the part behind it is not compared.
    const ReversedRays inside{{{0, 0, 0}, {2, 0, 0}}, {{2, 0, 0}, {-2, 0, 0}}, unit_sphere};
    const auto ahead = compute_chord_error(inside, {123, 0.5, 0.5, 456}, false, ulp);
    REQUIRE(ahead);
    CHECK(ahead->apart == 0);
    CHECK(std::isinf(compute_chord_error(ends, {NAN, 0.75, 0.25, 0.75}, false, ulp)->excess));
    const ReversedRays box{{{-2, 0.5, 0.25}, {4, 0, 0}}, {{2, 0.5, 0.25}, {-4, 0, 0}}, unit_box};
    CHECK(compute_chord_error(box, {0.25, 0.75, 0.25, 0.75}, false, ulp)->excess == 0);
}

TEST_CASE("a chord from either end agrees with 256 bits, where rounded ends are not quite on one line",
          "[measure][consistency]") {
    std::mt19937_64 random(7);
    std::uniform_real_distribution<double> any(-1, 1);
    int seen = 0;
    double largest = 0;
    for (int k = 0; k < 4000; ++k) {
        const Sphere<double> sphere{{any(random), any(random), any(random)}, 1 + std::fabs(any(random))};
        const auto in_float = [](double x) { return static_cast<double>(static_cast<float>(x)); };
        Vec<double> p(0, 0, 0), q(0, 0, 0), way(0, 0, 0), back(0, 0, 0);
        for (int i = 0; i < 3; ++i) {
            p[i] = in_float(9 * any(random));
            q[i] = in_float(-p[i] + any(random));
            way[i] = in_float(q[i] - p[i]);
            back[i] = -way[i];
        }
        const ReversedRays ends{{p, way}, {q, back}, Primitive<double>(sphere)};
        const auto [near, far] = chord_in_real(ends.forth, sphere);
        const auto [near_back, far_back] = chord_in_real(ends.back, sphere);
        // The ends must lie outside, or a side is left out.
        if (!(near > 0 && near < 1 && near_back > 0 && near_back < 1)) continue;
        ++seen;
        const auto to_answer = [](const Real& x) { return static_cast<double>(static_cast<float>(x)); };
        const ChordAnswer chord{to_answer(near), to_answer(far), to_answer(near_back), to_answer(far_back)};
        const double ulp = 0x1p-23;
        const auto error = compute_chord_error(ends, chord, false, ulp);
        REQUIRE(error);
        const auto worst = [](const Real& a, const Real& b) {
            return std::max(std::fabs(static_cast<double>(a)), std::fabs(static_cast<double>(b)));
        };
        const Real one = Real(chord.near) + Real(chord.far_back), other = Real(chord.far) + Real(chord.near_back);
        CHECK(error->apart == Approx(worst((one - 1) / ulp, (other - 1) / ulp)).margin(0x1p-10));
        CHECK(error->excess ==
              Approx(worst((one - near - far_back) / ulp, (other - far - near_back) / ulp)).margin(0x1p-10));
        // Answers that are rounded once keep the limit that the check sets.
        CHECK(error->excess <= 1);
        largest = std::max(largest, error->apart);
    }
    CHECK(seen > 500);
    CHECK(largest > 2);  // the inputs alone put the ends further apart than any rounding of t
}

}  // namespace test_checks
