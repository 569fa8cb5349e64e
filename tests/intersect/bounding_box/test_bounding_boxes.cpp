// The box around a primitive, compared with fractions: rounded outward it is the smallest in its format, and computed
// in the format it is off by the roundings. Rays that truly hit the primitive truly hit the box.
#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "catch.hpp"
#include "counts.hpp"
#include "intersect/box/box_exact.hpp"
#include "intersect/methods.hpp"
#include "measure/seeded.hpp"
#include "measure/truth/truth.hpp"
#include "number/rounded.hpp"
#include "scene/rays/rays.hpp"

namespace test_bounding_boxes {

using namespace lostbits;
using intersect::bounding_box::box_methods;
using intersect::bounding_box::BoxMethod;
using scene::rays::round_primitive;
using test::box_method_named;
using test::Rational;
using test::Seeded;
using Point = std::array<Rational, 3>;

namespace {

const Format f32 = *find_format("f32"), f64 = *find_format("f64"), p9 = *find_format("p9");

/// The box of a primitive in fractions, as its keys have it and without them: c ± r of a sphere, and so on.
struct ExactBox {
    Point lo, hi;

    void take(const Point& p, const Point& reach, bool first) {
        for (std::size_t i = 0; i < 3; ++i) {
            const Rational low = p[i] - reach[i], high = p[i] + reach[i];
            lo[i] = first || low < lo[i] ? low : lo[i];
            hi[i] = first || high > hi[i] ? high : hi[i];
        }
    }
};
Point point(const Primitive<double>& primitive, std::size_t k) {
    return {Rational(primitive.numbers[k]), Rational(primitive.numbers[k + 1]), Rational(primitive.numbers[k + 2])};
}
Point same(const Rational& r) { return {r, r, r}; }

ExactBox exact_box(const Primitive<double>& primitive) {
    ExactBox box;
    const std::string_view name = name_of(primitive.shape);
    if (name == "sphere") box.take(point(primitive, 0), same(primitive.numbers[3]), true);
    if (name == "ellipsoid") box.take(point(primitive, 0), point(primitive, 3), true);
    if (name == "triangle")
        for (std::size_t k = 0; k < 9; k += 3) box.take(point(primitive, k), same(0), k == 0);
    if (name == "capsule")
        for (std::size_t k = 0; k < 6; k += 3) box.take(point(primitive, k), same(primitive.numbers[6]), k == 0);
    if (name == "box")
        for (std::size_t k = 0; k < 6; k += 3) box.take(point(primitive, k), same(0), k == 0);
    return box;
}

/// The bounding box of its corners, each transformed to the world.
ExactBox exact_box_in_world(const ExactBox& own, const std::array<double, 12>& m) {
    ExactBox box;
    for (std::size_t corner = 0; corner < 8; ++corner) {
        Point p;
        for (std::size_t i = 0; i < 3; ++i) {
            p[i] = m[4 * i + 3];
            for (std::size_t k = 0; k < 3; ++k)
                p[i] += Rational(m[4 * i + k]) * ((corner >> k & 1) != 0 ? own.hi[k] : own.lo[k]);
        }
        box.take(p, same(0), corner == 0);
    }
    return box;
}

Primitive<double> random_primitive(Seeded& r, Shape shape, const Format& format) {
    Primitive<double> primitive(shape);
    std::size_t k = 0;
    for (const Key& key : row_of(shape).keys)
        for (const std::size_t end = k + key.count(); k < end; ++k)
            primitive.numbers[k] = key.is_length() ? r.uniform(0.1, 2) : r.uniform(-100, 100);
    if (shape == bounding_box_shape)
        for (std::size_t i = 0; i < 3; ++i) primitive.numbers[i + 3] = primitive.numbers[i] + r.uniform(0, 2);
    return round_primitive(primitive, format.parameters);
}

constexpr std::array<std::string_view, 5> with_least_box{"sphere", "ellipsoid", "triangle", "capsule", "box"};

}  // namespace

TEST_CASE("the box rounded outward is the smallest one, and other boxes differ by one rounding", "[hull]") {
    for (const Format& format : {f32, f64, p9}) {
        for (const std::string_view name : with_least_box) {
            Seeded r(17);
            for (int n = 0; n < test::draws(2000); ++n) {
                CAPTURE(format.name, name, n);
                Primitive<double> primitive = random_primitive(r, *shape_named(name), format);
                const ExactBox own = exact_box(primitive);
                std::array<double, 12> m{};
                for (double& x : m) x = rounding::to_format(r.uniform(-2, 2), 0, format.parameters);
                const bool has_transform = n % 2 == 1;
                if (has_transform) primitive.transform = Transform<double>{m, false, orientation_of(m)};
                const ExactBox exact = has_transform ? exact_box_in_world(own, m) : own;
                const BoundingBox<double> least = box_method_named("outward").compute_box(format, primitive);
                const BoundingBox<double> near = box_method_named("nearest").compute_box(format, primitive);
                const BoundingBox<double> next = box_method_named("next").compute_box(format, primitive);
                for (int i = 0; i < 3; ++i) {
                    const auto k = static_cast<std::size_t>(i);
                    const auto up = [&](double x) { return Rational(rounding::next_up(x, format.parameters)); };
                    const auto down = [&](double x) { return Rational(-rounding::next_up(-x, format.parameters)); };
                    REQUIRE(Rational(least.lo[i]) <= exact.lo[k]);
                    REQUIRE(up(least.lo[i]) > exact.lo[k]);
                    REQUIRE(Rational(least.hi[i]) >= exact.hi[k]);
                    REQUIRE(down(least.hi[i]) < exact.hi[k]);
                    if (has_transform) continue;
                    // c − r rounds once, to one of the two numbers around it, and the next number outward encloses it.
                    REQUIRE((near.lo[i] == least.lo[i] || Rational(near.lo[i]) == up(least.lo[i])));
                    REQUIRE((near.hi[i] == least.hi[i] || Rational(near.hi[i]) == down(least.hi[i])));
                    REQUIRE(Rational(next.lo[i]) <= exact.lo[k]);
                    REQUIRE(Rational(next.hi[i]) >= exact.hi[k]);
                }
            }
        }
    }
}

TEST_CASE("corners transformed to world space in the format leave part of the primitive outside its box", "[hull]") {
    // A box moved 12 km: x + 7401 rounds by up to 2^-12, and products that cancel are off by many places.
    Seeded r(5);
    std::map<std::string_view, double> worst;
    for (int n = 0; n < 2000; ++n) {
        Primitive<double> primitive = random_primitive(r, bounding_box_shape, f32);
        std::array<double, 12> m{};
        for (double& x : m) x = static_cast<float>(r.uniform(-2, 2));
        primitive.transform = Transform<double>{m, false, orientation_of(m)};
        const BoundingBox<double> least = box_method_named("outward").compute_box(f32, primitive);
        for (const BoxMethod& method : box_methods()) {
            const BoundingBox<double> box = method.compute_box(f32, primitive);
            for (int i = 0; i < 3; ++i) {
                const double ulp = std::ldexp(1.0, static_cast<int>(ulp_exponent(binary32, std::ilogb(least.lo[i]))));
                double& most = worst[method.info->name];
                most = std::max(most, (box.lo[i] - least.lo[i]) / ulp);
            }
        }
    }
    CHECK(worst.at("outward") == 0);
    for (const char* name : {"nearest", "next", "pbrt", "embree"}) CHECK(worst.at(name) > 2);
}

TEST_CASE("rays that truly hit a primitive truly hit its bounding box, at the same t or earlier", "[hull]") {
    std::set<Shape> seen_shapes;
    for (const ShapeRow& row : shape_rows) {
        if (!has_bounding_box(row.shape)) continue;
        Seeded r(23);
        for (int n = 0; n < 300; ++n) {
            const Primitive<double> primitive =
                round_primitive(primitive_around<double>(row.shape, r.vec(-3, 3), r.uniform(0.2, 1)), binary32);
            const Vec<double> aim = r.vec(-4, 4), from = r.vec(-9, 9);
            const Ray<double> ray{test::stored(from, binary32), test::stored(aim - from, binary32)};
            const auto truth = measure::truth::find_truth(ray, primitive);
            if (!truth.is_hit()) continue;
            const BoundingBox<double> box = box_method_named("outward").compute_box(f32, primitive);
            const test::Span span = test::ray_in_box(test::exactly(ray, box, HUGE_VAL), true);
            REQUIRE_FALSE(span.is_empty());
            const Rational unit = truth.t.exponent < 0
                                      ? Rational(1) / Rational(std::ldexp(1.0, -static_cast<int>(truth.t.exponent)))
                                      : Rational(std::ldexp(1.0, static_cast<int>(truth.t.exponent)));
            CHECK(span.start() <= (Rational(truth.t.hi) + Rational(truth.t.lo) + Rational(truth.t.bound)) * unit);
            seen_shapes.insert(row.shape);
        }
    }
    CHECK(seen_shapes.size() == shape_rows.size() - 1);  // planes have no box
}

}  // namespace test_bounding_boxes
