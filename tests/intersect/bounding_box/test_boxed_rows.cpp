// Rows behind boxes: the margin by which the end of a ray must exceed its hit, and their tapes.
#include <algorithm>
#include <cmath>
#include <map>

#include "catch.hpp"
#include "counts.hpp"
#include "intersect/bounding_box/behind.hpp"
#include "intersect/methods.hpp"
#include "intersect/transform/transformed_form.hpp"
#include "measure/answer/steps.hpp"
#include "measure/truth/box_distributions.hpp"
#include "scene/rays/rays.hpp"

namespace test_boxed_rows {

using namespace lostbits;
using intersect::bounding_box::boxed_form;
using intersect::table::Intersector;
using measure::answer::evaluate_one;
using scene::rays::round_primitive;
using test::box_method_named;
using test::Seeded;

namespace {

const Format f32 = *find_format("f32");

const Intersector& form(std::string_view name) { return test::row_named(intersect::table::catalogue(), name); }

}  // namespace

TEST_CASE("a hit is found from its margin on and not below it, and only padded ends have no margin", "[hull]") {
    Seeded r(77);
    std::map<std::string_view, double> most;
    for (int n = 0; n < test::draws(4000); ++n) {
        // Triangles that fill a face of a flat box: the hit lies on the plane through which the ray enters the box.
        const Vec<double> at = test::stored(r.vec(0.5, 2), binary32);
        const double x = at.x, y = at.y, z = at.z;
        const Primitive<double> primitive =
            round_primitive(Triangle<double>{{x, y, z}, {x, y + 4, z}, {x, y, z + 4}}, binary32);
        const Ray<double> ray{test::stored(r.vec(-8, -1), binary32), test::stored(r.vec(0.5, 1), binary32)};
        for (const char* box : {"box.signs", "box.pbrt_padded", "box.embree_robust", "box.tinybvh"}) {
            const Intersector& row =
                boxed_form(intersect::bounding_box::default_box_method(), form(box), form("triangle.filtered"));
            const auto t = evaluate_one(row, f32, ray, primitive, HUGE_VAL);
            const double margin = measure::answer::find_end_margin(row, f32, ray, primitive, {});
            CHECK(std::isnan(margin) == !t.has_value());
            if (!t) continue;
            const double ulp = std::ldexp(1, std::ilogb(*t) - 23);
            CHECK(evaluate_one(row, f32, ray, primitive, *t + margin * ulp).has_value());
            if (margin > 0) CHECK_FALSE(evaluate_one(row, f32, ray, primitive, *t + (margin - 1) * ulp).has_value());
            most[box] = std::max(most[box], margin);
        }
    }
    CHECK(most.at("box.signs") > 0);
    CHECK(most.at("box.pbrt_padded") > 0);  // their end is not padded
    CHECK(most.at("box.embree_robust") == 0);
    CHECK(most.at("box.signs") < 16);
}

TEST_CASE("the tape of a row behind a box answers as its kernel, and its inputs have names", "[hull]") {
    Seeded r(78);
    const auto& plain = test::transform_method_named("plain");
    int hits = 0, culled = 0;
    for (int n = 0; n < test::draws(2000); ++n) {
        Primitive<double> primitive = round_primitive(Sphere<double>{r.vec(-1, 1), r.uniform(0.5, 2)}, binary32);
        for (const bool has_transform : {false, true}) {
            if (has_transform) primitive.transform = Transform<double>{{2, 0, 0, 7, 0, 1, 0, 0, 0, 1, 1, -3}, false, 1};
            const Vec<double> middle =
                has_transform ? primitive.transform->map().point(primitive.point(0)) : primitive.point(0);
            const Vec<double> origin = test::stored(r.vec(-6, 6), binary32);
            const Ray<double> ray{origin, test::stored(Vec<double>(middle + r.vec(-2, 2) - origin), binary32)};
            const Intersector& inner =
                boxed_form(box_method_named("nearest"), form("box.signs"), form("sphere.unified"));
            const Intersector& row = has_transform ? boxed_form(box_method_named("pbrt"), form("box.pbrt_padded"),
                                                                intersect::transform::transformed_form(plain, inner))
                                                   : inner;
            Tape tape;
            row.record(f32, ray, intersect::Target<double>(primitive), HUGE_VAL, tape);
            const auto answer = evaluate_one(row, f32, ray, primitive, HUGE_VAL);
            REQUIRE((tape[tape.outputs.hit].value != 0) == answer.has_value());
            if (answer) REQUIRE(tape[tape.outputs.t].value == *answer);
            hits += answer.has_value();
            culled += !answer;
            const auto names = intersect::bounding_box::find_names_on_tape(row, intersect::Target<double>(primitive));
            const auto inputs = std::ranges::count(tape.nodes, TapeOp::input, &TapeNode::op);
            REQUIRE(names.size() == static_cast<std::size_t>(inputs));
            CHECK(names.back() == "box.hi.z");
            CHECK((std::ranges::find(names, "world_box.lo.x") != names.end()) == has_transform);
        }
    }
    CHECK(hits > 50);
    CHECK(culled > 50);
}

}  // namespace test_boxed_rows
