// Rows behind boxes compared with their parts, rays that are aimed so that a hit is lost, and the level that loses a
// hit.
#include <algorithm>
#include <cmath>
#include <map>
#include <vector>

#include "catch.hpp"
#include "counts.hpp"
#include "intersect/bounding_box/behind.hpp"
#include "intersect/box/box_exact.hpp"
#include "intersect/methods.hpp"
#include "intersect/transform/transformed_form.hpp"
#include "measure/answer/steps.hpp"
#include "measure/truth/box_distributions.hpp"
#include "measure/truth/truth.hpp"
#include "number/error.hpp"
#include "scene/rays/rays.hpp"

namespace test_behind {

using namespace lostbits;
using intersect::bounding_box::boxed_form;
using intersect::table::Intersector;
using measure::answer::evaluate_one;
using measure::answer::find_lost_level;
using measure::answer::Level;
using scene::rays::round_primitive;
using test::box_method_named;
using test::BoxSample;
using test::Rational;
using test::Seeded;
using Point = std::array<Rational, 3>;

namespace {

const Format f32 = *find_format("f32"), f64 = *find_format("f64"), p9 = *find_format("p9");

const Intersector& form(std::string_view name) { return test::row_named(intersect::table::catalogue(), name); }

Point point(const Primitive<double>& primitive, std::size_t k) {
    return {Rational(primitive.numbers[k]), Rational(primitive.numbers[k + 1]), Rational(primitive.numbers[k + 2])};
}

}  // namespace

TEST_CASE("a row behind a box is named after form, box and method, and shapes without a box are refused", "[hull]") {
    const Intersector &sphere = form("sphere.unified"), &box = form("box.signs");
    const Intersector& row = boxed_form(intersect::bounding_box::default_box_method(), box, sphere);
    CHECK(row.info->name == "sphere.unified^box.signs");
    CHECK(&boxed_form(intersect::bounding_box::default_box_method(), box, sphere) == &row);
    CHECK(boxed_form(box_method_named("nearest"), box, sphere).info->name == "sphere.unified^box.signs~nearest");
    CHECK(intersect::bounding_box::find_boxed_parts(row).form == &sphere);
    CHECK(intersect::bounding_box::find_boxed_parts(row).box == &box);
    CHECK(intersect::bounding_box::find_boxed_parts(sphere).form == nullptr);
    CHECK(intersect::bounding_box::has_box(row));
    CHECK_FALSE(intersect::bounding_box::has_box(sphere));

    const Intersector& two =
        boxed_form(box_method_named("pbrt"), form("box.pbrt_padded"),
                   intersect::transform::transformed_form(test::transform_method_named("pbrt"), row));
    CHECK(two.info->name == "sphere.unified^box.signs@pbrt^box.pbrt_padded~pbrt");
    CHECK(two.shapes() == Shapes(Shape::sphere).with_transform());
    CHECK(&intersect::bounding_box::innermost_form(two) == &sphere);
    CHECK(intersect::bounding_box::with_other_form(two, form("sphere.schoolbook")).info->name ==
          "sphere.schoolbook^box.signs@pbrt^box.pbrt_padded~pbrt");
    CHECK(&intersect::bounding_box::with_other_form(sphere, form("sphere.schoolbook")) == &form("sphere.schoolbook"));

    CHECK_THROWS_AS(boxed_form(intersect::bounding_box::default_box_method(), sphere, sphere), InputError);
    CHECK_THROWS_AS(boxed_form(intersect::bounding_box::default_box_method(),
                               boxed_form(intersect::bounding_box::default_box_method(), box, box), sphere),
                    InputError);
    for (const char* none : {"plane.two_step", "sdf.sphere_trace"}) {
        const auto all = intersect::table::catalogue();
        const auto of = std::ranges::find_if(all, [&](const Intersector& form) {
            return form.info->name.starts_with(std::string_view(none).substr(0, 4));
        });
        REQUIRE(of != all.end());
        CHECK_THROWS_AS(boxed_form(intersect::bounding_box::default_box_method(), box, *of), InputError);
    }
}

namespace {

/// A triangle that reaches from an edge of a box to the opposite corner: the box is its bounding box.
Primitive<double> triangle_in(Seeded& r, const Box<double>& box) {
    const int along = r.index(3);
    const bool first = r.coin(), second = r.coin(), end = r.coin();
    std::array<Vec<double>, 3> p;
    for (int v = 0; v < 3; ++v) {
        for (int i = 0; i < 3; ++i) {
            const bool high =
                i == along ? (v == 2 ? end : v == 1) : ((i == (along + 1) % 3) ? first : second) != (v == 2);
            p[v][i] = high ? box.hi[i] : box.lo[i];
        }
    }
    return Triangle<double>{p[0], p[1], p[2]};
}

/// True if a ray meets a closed triangle in its range, by its point in the plane, in fractions.
bool truly_meets(const Ray<double>& ray, const Primitive<double>& triangle, double tmax) {
    const auto minus = [](const Point& a, const Point& b) { return Point{a[0] - b[0], a[1] - b[1], a[2] - b[2]}; };
    const auto cross = [](const Point& x, const Point& y) {
        return Point{x[1] * y[2] - x[2] * y[1], x[2] * y[0] - x[0] * y[2], x[0] * y[1] - x[1] * y[0]};
    };
    const auto dot = [](const Point& x, const Point& y) { return Rational(x[0] * y[0] + x[1] * y[1] + x[2] * y[2]); };
    const std::array<Point, 3> v{point(triangle, 0), point(triangle, 3), point(triangle, 6)};
    const Point o{ray.origin.x, ray.origin.y, ray.origin.z}, d{ray.direction.x, ray.direction.y, ray.direction.z};
    const Point n = cross(minus(v[1], v[0]), minus(v[2], v[0]));
    const Rational m = dot(d, n);
    if (m == 0) return false;
    const Rational t = dot(minus(v[0], o), n) / m;
    if (t < 0 || (!std::isinf(tmax) && t > Rational(tmax))) return false;
    const Point p{o[0] + t * d[0], o[1] + t * d[1], o[2] + t * d[2]};
    for (std::size_t k = 0; k < 3; ++k)
        if (dot(cross(minus(v[(k + 1) % 3], v[k]), minus(p, v[k])), n) < 0) return false;
    return true;
}

struct Culls {
    long hits = 0;
    std::map<std::string, long> lost, lost_at_end;  ///< of rays that go on, and of rays that end
};

/// No component is near 0.
bool is_oblique(const Vec<double>& d) { return std::min({std::fabs(d.x), std::fabs(d.y), std::fabs(d.z)}) > 0x1p-39; }

bool is_along_an_axis(const Vec<double>& d) { return (d.x == 0) + (d.y == 0) + (d.z == 0) == 2; }

bool is_any(const Vec<double>&) { return true; }

/// Counts adversarial rays at a box, in the directions that `counts` accepts, that truly meet a triangle in it, and how
/// many of them each box test loses.
Culls culls_in(const std::vector<std::string_view>& distributions, const std::vector<const char*>& boxes, int rays,
               bool (*counts)(const Vec<double>&)) {
    Culls found;
    for (const test::BoxDistribution& distribution : test::box_distributions) {
        if (std::ranges::find(distributions, distribution.name) == distributions.end()) continue;
        Seeded r(0x41);
        for (int n = 0; n < rays; ++n) {
            const BoxSample s = distribution.draw(r, binary32);
            const Primitive<double> triangle = triangle_in(r, s.box);
            if (!counts(s.ray.direction)) continue;
            if (measure::truth::is_valid(triangle) && truly_meets(s.ray, triangle, s.tmax)) {
                ++found.hits;
                for (const char* box : boxes) {
                    const Intersector& row =
                        boxed_form(intersect::bounding_box::default_box_method(), form(box), form("triangle.filtered"));
                    const bool hit = evaluate_one(row, f32, s.ray, triangle, s.tmax).has_value();
                    const bool by_box =
                        evaluate_one(form(box), f32, s.ray, Primitive<double>(s.box), s.tmax).has_value();
                    REQUIRE(hit == by_box);
                    (std::isinf(s.tmax) ? found.lost : found.lost_at_end)[box] += !hit;
                    const Level level = find_lost_level(row, f32, s.ray, triangle, {0, s.tmax}).lost_to;
                    REQUIRE(level == (hit ? Level::nothing : Level::box));
                }
            }
        }
    }
    return found;
}

}  // namespace

TEST_CASE("rays at edges of triangles' boxes are lost without padding and with 4u, never with 6u", "[hull]") {
    const std::vector<const char*> boxes{"box.signs",         "box.max_mult",      "box.bvh_robust", "box.tinybvh",
                                         "box.embree_robust", "box.embree_padded", "box.pbrt_padded"};
    const Culls found =
        culls_in({"at edge", "across edge", "across corner", "beside edge", "by a hair", "power of two"}, boxes,
                 test::draws(40000), is_oblique);
    CHECK(found.hits > test::draws(10000));
    for (const char* sound : {"box.embree_robust", "box.embree_padded", "box.pbrt_padded"}) {
        CAPTURE(sound);
        CHECK(found.lost.at(sound) == 0);
    }
    // The end of a ray is not padded by pbrt: a box that is entered at the very end is lost to three roundings.
    CHECK(found.lost_at_end.at("box.embree_robust") == 0);
    CHECK(found.lost_at_end.at("box.embree_padded") == 0);
    CHECK(found.lost_at_end.at("box.pbrt_padded") > 0);
    CHECK(found.lost.at("box.signs") > found.hits / 100);
    CHECK(found.lost.at("box.tinybvh") > found.hits / 100);
}

TEST_CASE("the paddings of Ize and of bvh each lose a triangle on one ray", "[hull]") {
    // The first ray separates the slabs further than any other. The second leaves where 1/d has a significand near 2,
    // and two last places of it are 2u.
    const Vec<double> origin(0x1.fffffep-25, -0x1.fffffep-25, 0);
    const Ray<double> most{origin, {0x1.ff6018p+0, 0x1.ffe004p+0, 0}};
    const Ray<double> other{origin, {0x1.ff95e8p-1, 0x1.000afp+0, 0}};
    const Primitive<double> triangle =
        Triangle<double>{{0x1.000ffep+0, 0x1.00500ap+0, -1}, {0x1.000ffep+0, 0x1.00500ap+0, 1}, {8, -8, 1}};
    REQUIRE(truly_meets(most, triangle, HUGE_VAL));
    REQUIRE(truly_meets(other, triangle, HUGE_VAL));
    struct KeptForm {
        const char* box;
        bool most, other;
    };
    for (const KeptForm& kept : {KeptForm{"box.signs", false, false}, KeptForm{"box.tinybvh", false, false},
                                 KeptForm{"box.max_mult", false, true}, KeptForm{"box.bvh_robust", true, false},
                                 KeptForm{"box.pbrt_padded", true, true}, KeptForm{"box.embree_robust", true, true},
                                 KeptForm{"box.embree_padded", true, true}}) {
        CAPTURE(kept.box);
        const Intersector& row =
            boxed_form(intersect::bounding_box::default_box_method(), form(kept.box), form("triangle.filtered"));
        for (const auto& [ray, keeps] : {std::pair(most, kept.most), std::pair(other, kept.other)}) {
            CHECK(evaluate_one(row, f32, ray, triangle, HUGE_VAL).has_value() == keeps);
            CHECK(find_lost_level(row, f32, ray, triangle, {}).lost_to == (keeps ? Level::nothing : Level::box));
        }
    }
}

TEST_CASE("rays parallel to an axis keep all hits only if reciprocals are not replaced", "[hull]") {
    const std::vector<const char*> boxes{"box.signs",   "box.inclusive",     "box.pbrt_padded", "box.bvh_robust",
                                         "box.tinybvh", "box.embree_padded", "box.embree_fma",  "box.embree_robust"};
    const Culls found = culls_in({"axis parallel", "along face"}, boxes, test::draws(20000), is_any);
    CHECK(found.hits > test::draws(3000));
    for (const char* padded : {"box.pbrt_padded", "box.bvh_robust", "box.embree_robust"}) {
        CAPTURE(padded);
        CHECK(found.lost.at(padded) == 0);
    }
    for (const char* made_up : {"box.tinybvh", "box.embree_padded", "box.embree_fma"})
        CHECK(found.lost.at(made_up) > 0);
    // Without padding, the two other slabs are rounded as before (all draws have 8 rays at edges that are lost). A ray
    // along an axis has one slab, and x - o and its product with 1/d are monotone in x.
    const Culls along = culls_in({"axis parallel"}, boxes, test::draws(20000), is_along_an_axis);
    CHECK(along.hits > test::draws(1000));
    for (const char* unpadded : {"box.signs", "box.inclusive"}) CHECK(along.lost.at(unpadded) == 0);
}

TEST_CASE("each level that can lose a hit is reported separately", "[hull]") {
    const auto& plain = test::transform_method_named("plain");
    const auto row = [&](std::string_view inner, const char* object_box, const char* world_box,
                         const char* box_method) {
        const Intersector& in =
            boxed_form(intersect::bounding_box::default_box_method(), form(object_box), form(inner));
        return &boxed_form(box_method_named(box_method), form(world_box),
                           intersect::transform::transformed_form(plain, in));
    };
    const auto moved_by = [](const Primitive<double>& bare, double x) {
        Primitive<double> primitive = bare;
        primitive.transform = Transform<double>{{1, 0, 0, static_cast<float>(x), 0, 1, 0, 0, 0, 0, 1, 0}, false, 1};
        return primitive;
    };
    // A box moved by 7401.1: in float x + 7401.1 rounds by up to 2^-12. Rays that begin in the plane of a rounded face
    // and lean outward meet the part that is outside the rounded box. (Rays along the face cannot: rounding keeps the
    // order of floats.)
    std::map<Level, int> seen;
    for (const char* box_method : {"nearest", "outward"}) {
        const Intersector& intersector = *row("box.filtered", "box.signs", "box.signs", box_method);
        for (int j = 0; j < 16; ++j) {
            const Primitive<double> primitive = moved_by(
                round_primitive(Box<double>{{0.25 + j / 999.0, 0.25, 0.25}, Vec<double>(0.75)}, binary32), 7401.1);
            const BoundingBox<double> box = box_method_named(box_method).compute_box(f32, primitive);
            for (int k = -16; k <= 16; ++k) {
                const Ray<double> ray{{box.lo.x, 0.5, -4}, {k * 0x1p-17, 0, 1}};
                if (!measure::truth::find_truth(ray, primitive).is_hit()) continue;
                const Level level = find_lost_level(intersector, f32, ray, primitive, {}).lost_to;
                const bool in_world =
                    evaluate_one(form("box.signs"), f32, ray, Primitive<double>(box), HUGE_VAL).has_value();
                CHECK((level == Level::world_box) == !in_world);
                if (std::string_view(box_method) == "outward") CHECK(level != Level::world_box);
                CHECK((level == Level::nothing) ==
                      evaluate_one(intersector, f32, ray, primitive, HUGE_VAL).has_value());
                ++seen[level];
            }
        }
    }
    CHECK(seen[Level::world_box] > 0);
    CHECK(seen[Level::nothing] > 0);

    // Rotated and moved by 8 km, with rays at its edges: M^-1 o is off by more than the rounding of the faces.
    Seeded r(31);
    int by_space = 0;
    for (int n = 0; n < 3000; ++n) {
        Primitive<double> primitive = round_primitive(Box<double>{Vec<double>(-0.5), Vec<double>(0.5)}, binary32);
        const double turn = r.uniform(0, 6), c = std::cos(turn), sn = std::sin(turn), x = r.uniform(7000, 9000);
        primitive.transform = convert_numbers(Transform<double>{{c, -sn, 0, x, sn, c, 0, 0, 0, 0, 1, 0}, false, 1},
                                              [](double m) { return rounding::to_format(m, 0, binary32); });
        const Vec<double> edge = primitive.transform->map().point({0.5, 0.5, r.uniform(-0.4, 0.4)}), d = r.vec(-1, 1);
        const Ray<double> ray{test::stored(Vec<double>(edge - 4.0 * d), binary32), test::stored(d, binary32)};
        if (!measure::truth::find_truth(ray, primitive).is_hit()) continue;
        const Intersector& intersector = *row("box.filtered", "box.signs", "box.signs", "outward");
        const auto levels = find_lost_level(intersector, f32, ray, primitive, {});
        REQUIRE(levels.boxes.size() == 2);
        if (levels.lost_to != Level::space) continue;
        ++by_space;
        // The ray in the space of the primitive truly misses it, by fractions.
        const auto& inside = levels.boxes[1];
        CHECK(test::ray_in_box(test::exactly(inside.ray, inside.box, HUGE_VAL), true).is_empty());
    }
    CHECK(by_space > 0);

    // Along a face, which ieee_minmax misses in every space.
    const Primitive<double> bare = round_primitive(Box<double>{Vec<double>(0.25), Vec<double>(0.75)}, binary32);
    const Primitive<double> touched = moved_by(bare, 0);
    const Ray<double> along{{0.25, 0.5, -4}, {0, 0, 1}};
    CHECK(find_lost_level(*row("box.ieee_minmax", "box.signs", "box.signs", "outward"), f32, along, touched, {})
              .lost_to == Level::form);
    CHECK(find_lost_level(*row("box.signs", "box.ieee_minmax", "box.signs", "outward"), f32, along, touched, {})
              .lost_to == Level::box);
    CHECK(find_lost_level(*row("box.signs", "box.signs", "box.ieee_minmax", "outward"), f32, along, touched, {})
              .lost_to == Level::world_box);
}

TEST_CASE("one primitive for all rays and one for each ray give the same answers in every format", "[hull]") {
    Seeded r(9);
    const Intersector& row = boxed_form(box_method_named("nearest"), form("box.pbrt_padded"), form("sphere.unified"));
    std::vector<Primitive<float>> each;
    std::array<std::vector<float>, 6> x;
    for (int n = 0; n < 100; ++n) {
        each.emplace_back(Sphere<float>{Vec<float>(Vec<double>(r.vec(-1, 1))), 0.5f});
        const Vec<double> o = r.vec(-3, 3), d = r.vec(-1, 1) - 0.5 * o;
        for (int i = 0; i < 3; ++i) {
            x[i].push_back(static_cast<float>(o[i]));
            x[i + 3].push_back(static_cast<float>(d[i]));
        }
    }
    const intersect::table::RayBatch<float> rays{x[0], x[1], x[2], x[3], x[4], x[5]};
    std::vector<float> t(100), near(100), far(100);
    std::vector<std::uint8_t> hit(100);
    row.native32(rays, intersect::Target<float>(std::span<const Primitive<float>>(each)), {t, near, far, hit});
    int hits = 0;
    for (std::size_t i = 0; i < each.size(); ++i) {
        const Ray<double> ray{{x[0][i], x[1][i], x[2][i]}, {x[3][i], x[4][i], x[5][i]}};
        const auto primitive = convert_numbers(each[i], [](float n) { return double{n}; });
        const auto alone = evaluate_one(row, f32, ray, primitive, HUGE_VAL);
        REQUIRE(alone.has_value() == (hit[i] != 0));
        if (alone) REQUIRE(static_cast<float>(*alone) == t[i]);
        hits += hit[i];
        for (const Format& format : {f64, p9}) {
            const BoundingBox<double> box = box_method_named("nearest").compute_box(format, primitive);
            const bool both = evaluate_one(form("sphere.unified"), format, ray, primitive, HUGE_VAL) &&
                              evaluate_one(form("box.pbrt_padded"), format, ray, Primitive<double>(box), HUGE_VAL);
            REQUIRE(evaluate_one(row, format, ray, primitive, HUGE_VAL).has_value() == both);
        }
    }
    CHECK(hits > 5);
    CHECK(hits < 95);
}

}  // namespace test_behind
