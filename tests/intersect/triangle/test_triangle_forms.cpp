// Triangle forms on the rim, their culling, and the weights that they name.
#include <map>
#include <set>
#include <string_view>

#include "catch.hpp"
#include "counts.hpp"
#include "intersect/ask_row.hpp"
#include "intersect/triangle/triangle_rays.hpp"
#include "number/real.hpp"
#include "shapes/lift.hpp"
#include "shapes/triangle/forms/baldwin_weber.hpp"
#include "shapes/triangle/forms/havel_herout.hpp"

namespace lostbits::test::test_triangle_forms {

using intersect::Info, intersect::table::Intersector;

namespace {

std::span<const Intersector> forms() { return intersect::table::intersectors(Shape::triangle); }

bool hits_in_float(const Intersector& form, const TriangleSample& sample) {
    return ask_row<float>(form, lift_ray<float>(sample.ray), lift_primitive<float>(Primitive<double>(sample.triangle)))
        .hit;
}

/// Without rounding; unknown if the form divides by a number that may be 0.
Tri hits_exactly(const Intersector& form, const TriangleSample& sample) {
    const Interval::Precision precision(400);
    return form.interval(lift_ray<Interval>(sample.ray), lift_primitive<Interval>(Primitive<double>(sample.triangle)))
        .hit;
}

}  // namespace

TEST_CASE("forms of triangles that divide last decide on the rim as they declare", "[intersect][triangle][formula]") {
    const std::set<std::string_view> exact{"triangle.undivided", "triangle.signed_volumes", "triangle.plucker",
                                           "triangle.filtered", "triangle.plucker_band"};
    std::map<std::string_view, int> wrong;
    int rims = 0;
    for_each_triangle(static_cast<int>(draws(2000)), [&](const TriangleDistribution&, const TriangleSample& sample) {
        const TriangleAnswer right = answer_of(sample);
        if (!right.meets() || !right.on_rim() || right.t == 0) return;
        ++rims;
        for (const Intersector& form : forms())
            if (exact.contains(form.info->name)) wrong[form.info->name] += !hits_exactly(form, sample).is_yes();
        const auto leaves_out = [&]<class Form>() {
            const Ray<Real> ray = lift_ray<Real>(sample.ray);
            wrong[Form::info.name] +=
                !Form::intersect(ray, lift_primitive<Real>(Primitive<double>(sample.triangle)).triangle()).hit;
        };
        leaves_out.operator()<intersect::triangle::BaldwinWeber>();
        leaves_out.operator()<intersect::triangle::HavelHerout>();
    });
    CHECK(rims > 200);
    for (const auto& [name, count] : wrong) {
        INFO(name << " misses " << count << " of " << rims);
        if (exact.contains(name)) CHECK(count == 0);
    }
    // They exclude edges, as they declare.
    CHECK(wrong["triangle.baldwin_weber"] > 0);
    CHECK(wrong["triangle.havel_herout"] > 0);
}

TEST_CASE("an epsilon on the determinant hides a small triangle", "[intersect][triangle]") {
    const std::set<std::string_view> hidden{"triangle.moller_trumbore", "triangle.moller_trumbore_culling"};
    const TriangleSample s{{{0.0001, 0.0001, 1}, {0, 0, -1}}, {{0, 0, 0}, {0x1p-12, 0, 0}, {0, 0x1p-12, 0}}};
    CHECK(answer_of(s).meets());
    for (const Intersector& form : forms()) {
        INFO(form.info->name);
        CHECK(hits_exactly(form, s) == Tri(!hidden.contains(form.info->name)));
        CHECK(hits_in_float(form, s) != hidden.contains(form.info->name));
    }
}

TEST_CASE("a form that culls back faces misses them, and declares it", "[intersect][triangle]") {
    const Vec<double> a{0, 0, 0}, b{4, 0, 0}, c{0, 4, 0};
    const Ray<double> down{{1, 1, 3}, {0, 0, -1}};
    std::set<std::string_view> culls;
    for (const Intersector& form : forms()) {
        INFO(form.info->name);
        CHECK(hits_in_float(form, {down, {a, b, c}}) == (form.info->facing != intersect::Facing::back));
        CHECK(hits_in_float(form, {down, {a, c, b}}) == (form.info->facing != intersect::Facing::front));
        if (form.info->facing != intersect::Facing::both) culls.insert(form.info->name);
    }
    CHECK(culls == std::set<std::string_view>{"triangle.moller_trumbore_culling"});
}

TEST_CASE("the weights that a form returns belong to the declared corners a, b and c", "[intersect][triangle]") {
    std::map<std::string_view, int> decided_counts, wrong;
    for_each_triangle(
        static_cast<int>(draws(3000)), [&](const TriangleDistribution& distribution, const TriangleSample& sample) {
            const TriangleAnswer right = answer_of(sample);
            if (!right.meets() || distribution.name != std::string_view("random")) return;
            const std::array<Rational, 3> weights{right.u, right.v, right.w};
            for (const Intersector& form : forms()) {
                const Info& info = *form.info;
                const char* const format = info.formats == intersect::Formats::all ? "f64" : "f32";
                Tape tape;
                form.record(*find_format(format), sample.ray, Primitive<double>(sample.triangle), HUGE_VAL, tape);
                for (std::size_t k = 0; k < weights.size(); ++k) {
                    const std::string_view name = info.weights[k];
                    if (name.empty()) continue;
                    const auto node = std::ranges::find(tape.nodes, name, &TapeNode::label);
                    const bool found = node != tape.nodes.end();
                    ++decided_counts[info.name];
                    wrong[info.name] += !found || abs(Rational(node->value) - weights[k]) > Rational(1, 1 << 20);
                }
            }
        });
    for (const Intersector& form : forms()) {
        INFO(form.info->name);
        CHECK((decided_counts[form.info->name] > 100) == (form.info->name != "triangle.filtered"));
        CHECK(wrong[form.info->name] == 0);
    }
}

}  // namespace lostbits::test::test_triangle_forms
