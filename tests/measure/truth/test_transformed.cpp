// Truth of transformed primitives: in packs, and for every shape compared with a primitive whose numbers were moved;
// tests/exact compares it with integers.
#include <array>

#include "catch.hpp"
#include "measure/seeded.hpp"
#include "measure/truth/conditioning.hpp"
#include "measure/truth/truth.hpp"
#include "measure/truth/truth_columns.hpp"

namespace test_transformed {

using namespace lostbits;
using measure::truth::find_truth;
using measure::truth::Truth;
using test::Seeded;

namespace {

using Matrix = std::array<double, 12>;

Matrix rows_of(const Vec<double>& a, const Vec<double>& b, const Vec<double>& c, const Vec<double>& shift) {
    return {a.x, a.y, a.z, shift.x, b.x, b.y, b.z, shift.y, c.x, c.y, c.z, shift.z};
}

/// A ray from outside, aimed near a point of the primitive.
Ray<double> draw_aimed_ray(Seeded& r, const Transform<double>& transform, const Vec<double>& at) {
    const Vec<double> from = r.vec(-8, 8), near = at + r.vec(-3, 3);
    const Affine<double> m = transform.map();
    if (!transform.is_inverse) return {m.point(near) + from, -from};
    return {times(m.adjugate(), near - m.shift) / m.determinant() + from, -from};
}

}  // namespace

TEST_CASE("packs decide most rays at transformed primitives, as single rays do") {
    const auto stored = [](double x) { return test::stored(x, binary32); };
    for (const bool is_inverse : {false, true}) {
        CAPTURE(is_inverse);
        Seeded r(9);
        const Vec<double> corner = r.vec(-3, 3), size = r.vec(1, 3);
        std::vector<Primitive<double>> primitives{Sphere<double>{r.vec(-3, 3), r.uniform(1, 3)},
                                                  Box<double>{corner, corner + size},
                                                  Triangle<double>{r.vec(-3, 3), r.vec(-3, 3), r.vec(-3, 3)}};
        for (Primitive<double>& primitive : primitives) {
            const Vec<double> a = r.vec(-2, 2), b = r.vec(-2, 2), c = r.vec(-2, 2), shift = r.vec(-9, 9);
            primitive = convert_numbers(primitive, stored);
            primitive.transform = convert_numbers(Transform<double>{rows_of(a, b, c, shift), is_inverse, 1}, stored);
            REQUIRE((primitive.transform->is_proper() && !broken_limit(primitive)));
        }
        scene::rays::RayBlock rays;
        rays.width = 4500, rays.y1 = 1;
        while (rays.size() < 4500) {
            const Primitive<double>& at = primitives[rays.size() % 3];
            const Ray<double> ray = draw_aimed_ray(r, *at.transform, at.point(0));
            rays.push({test::stored(ray.origin, binary32), test::stored(ray.direction, binary32)});
        }
        const scene::rays::PrimitiveList<double> list(primitives);
        measure::truth::RayTruths found;
        const auto counts = measure::truth::find_truths({rays, list}, {}, found);
        std::size_t hits = 0;
        for (std::size_t i = 0; i < rays.size(); ++i) {
            const Truth packed = found[i], alone = find_truth(rays[i], primitives);
            REQUIRE(packed.decision == alone.decision);
            REQUIRE(packed.primitive == alone.primitive);
            if (!alone.is_hit()) continue;
            ++hits;
            REQUIRE(compare(packed.t, alone.t) == 0);
            REQUIRE(compare(packed.distance, alone.distance) == 0);
        }
        INFO(counts.double_double << " of " << counts.ray_count());
        CHECK(hits > 300);
        CHECK(counts.double_double > counts.ray_count() / 10 * 9);
    }
}

TEST_CASE("the sign of a determinant is exact") {
    const auto sign = [](std::array<double, 12> m) { return orientation_of(m); };
    CHECK(sign(rows_of({1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {5, 6, 7})) == 1);
    CHECK(sign(rows_of({1, 2, 3}, {4, 5, 6}, {7, 8, 9}, {})) == 0);
    CHECK(sign(rows_of({1, 2, 3}, {4, 5, 6}, {7, 8, 0x1.2000000000001p+3}, {})) == -1);
    CHECK(sign(rows_of({0x1p-1000, 0, 0}, {0, 0x1p-1000, 0}, {0, 0, -0x1p-1000}, {})) == -1);
    CHECK(sign(rows_of({0x1p1000, 0, 0}, {0, 0x1p1000, 0}, {0, 0, 0x1p1000}, {})) == 1);
    CHECK(sign(rows_of({0x1p1000, 1, 0}, {1, 0x1p-1000, 0}, {0, 0, 1}, {})) == 0);
    CHECK(sign(rows_of({HUGE_VAL, 0, 0}, {0, 1, 0}, {0, 0, 1}, {})) == 0);
    CHECK(sign(rows_of({1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {0, NAN, 0})) == 0);
}

namespace {

/// A quarter turn about z, a doubling, and a shift in whole numbers, which no number rounds.
Vec<double> turned(const Vec<double>& v) { return {-2 * v.y, 2 * v.x, 2 * v.z}; }

}  // namespace

TEST_CASE("a transformed primitive equals the primitive with moved numbers for every shape") {
    const Vec<double> shift(16, -32, 8);
    Seeded r(7);
    for (const ShapeRow& row : shape_rows) {
        CAPTURE(row.name);
        int hits = 0;
        for (int i = 0; i < 400; ++i) {
            const auto part = [&r] { return static_cast<double>(r.integer(-8, 8)) / 4; };
            const double x = part(), y = part(), z = part();
            const Vec<double> at(x, y, z);
            const Primitive<double> primitive = primitive_around<double>(row.shape, at, 1.5);
            // Shapes with directions of their own, such as the planes of a box or radii by axis, do not turn with their
            // numbers.
            bool turns = row.shape != Shape::box;
            Primitive<double> moved = primitive, transformed = primitive;
            for_each_key(row.shape, [&](const Key& key, std::size_t k) {
                turns = turns && key.kind != Key::Kind::lengths;
                if (key.kind == Key::Kind::point) moved.set_point(k, turned(primitive.point(k)) + shift);
                else if (key.kind == Key::Kind::direction) moved.set_point(k, turned(primitive.point(k)));
                else if (key.kind == Key::Kind::length) moved.numbers[k] = 2 * primitive.numbers[k];
            });
            if (!turns) continue;
            transformed.transform = Transform<double>{rows_of({0, -2, 0}, {2, 0, 0}, {0, 0, 2}, shift), false, 1};
            const Vec<double> from = r.vec(-9, 9), to = turned(at) + shift + r.vec(-2, 2);
            const Ray<double> ray{to + from, -from};
            const Truth one = find_truth(ray, transformed), other = find_truth(ray, moved);
            REQUIRE(one.decision == other.decision);
            REQUIRE(one.touches == other.touches);
            if (!one.is_hit()) continue;
            ++hits;
            REQUIRE(compare(one.t, other.t) == 0);
            REQUIRE(compare(one.distance, other.distance) == 0);
        }
        const bool is_turned = row.shape != Shape::box && row.shape != Shape::ellipsoid;
        CHECK((hits > 30) == is_turned);
    }
}

TEST_CASE("the condition number of a transformed primitive counts the numbers of the matrix") {
    // A unit sphere doubled about (10, 0, 0), seen from the origin along x: t = 10 − 2·1 = 8, with derivatives −1 by
    // o.x, −t by d.x, 1 by τ.x, −1 by the entry of the scale (the centre is 0) and −2 by the radius.
    Primitive<double> primitive(Sphere<double>{{0, 0, 0}, 1});
    primitive.transform = Transform<double>{rows_of({2, 0, 0}, {0, 2, 0}, {0, 0, 2}, {10, 0, 0}), false, 1};
    const Ray<double> ray{{0, 0, 0}, {1, 0, 0}};
    CHECK(measure::truth::condition(ray, primitive) == Approx((8 + 10 + 2 + 2) / 8.0));
    const Truth truth = find_truth(ray, primitive);
    CHECK(truth.t.hi == 1);
    CHECK(truth.t.exponent == 3);
}

}  // namespace test_transformed
