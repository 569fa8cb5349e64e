// Triangle forms on the rim, where they cull, and what they name.
#include <map>
#include <set>
#include <string_view>

#include "catch.hpp"
#include "counts.hpp"
#include "intersect/catalogue.hpp"
#include "intersect/triangle/triangle_rays.hpp"
#include "number/recorded.hpp"

namespace lostbits::test::test_triangle_forms {

using intersect::triangle::TriangleForms;

namespace {

template <class Form, class T>
Hit<T> ask(const TriangleSample& s) {
    const auto lift = [](const Vec<double>& v) {
        return Vec<T>(static_cast<T>(v.x), static_cast<T>(v.y), static_cast<T>(v.z));
    };
    return Form::intersect(Ray<T>{lift(s.ray.origin), lift(s.ray.direction)},
                           Triangle<T>{lift(s.triangle.a), lift(s.triangle.b), lift(s.triangle.c)});
}

}  // namespace

TEST_CASE("on the rim the forms that divide last say what their words say", "[intersect][triangle][formula]") {
    const std::set<std::string_view> exact{"triangle.undivided", "triangle.signed_volumes", "triangle.plucker",
                                           "triangle.filtered", "triangle.plucker_band"};
    std::map<std::string_view, int> wrong;
    int rims = 0;
    for_each_triangle(static_cast<int>(draws(2000)), [&](const TriangleFamily&, const TriangleSample& s) {
        const TriangleAnswer right = answer_of(s);
        if (!right.meets() || !right.on_rim() || right.t == 0) return;
        ++rims;
        TriangleForms::for_each([&]<class Form>() { wrong[Form::info.name] += !ask<Form, Real>(s).hit; });
    });
    CHECK(rims > 200);
    for (const auto& [name, count] : wrong) {
        INFO(name << " misses " << count << " of " << rims);
        if (exact.contains(name)) CHECK(count == 0);
    }
    // They leave edges out, and say so.
    CHECK(wrong["triangle.baldwin_weber"] > 0);
    CHECK(wrong["triangle.havel_herout"] > 0);
}

TEST_CASE("an epsilon on the determinant hides a small triangle", "[intersect][triangle]") {
    const std::set<std::string_view> hidden{"triangle.moller_trumbore", "triangle.moller_trumbore_culling"};
    const TriangleSample s{{{0.0001, 0.0001, 1}, {0, 0, -1}}, {{0, 0, 0}, {0x1p-12, 0, 0}, {0, 0x1p-12, 0}}};
    CHECK(answer_of(s).meets());
    TriangleForms::for_each([&]<class Form>() {
        INFO(Form::info.name);
        CHECK(ask<Form, Real>(s).hit != hidden.contains(Form::info.name));
        CHECK(ask<Form, float>(s).hit != hidden.contains(Form::info.name));
    });
}

TEST_CASE("a form that culls misses what shows its back, and says so", "[intersect][triangle]") {
    const Vec<double> a{0, 0, 0}, b{4, 0, 0}, c{0, 4, 0};
    const Ray<double> down{{1, 1, 3}, {0, 0, -1}};
    std::set<std::string_view> culls;
    TriangleForms::for_each([&]<class Form>() {
        INFO(Form::info.name);
        CHECK(ask<Form, float>({down, {a, b, c}}).hit == (Form::info.facing != intersect::Facing::back));
        CHECK(ask<Form, float>({down, {a, c, b}}).hit == (Form::info.facing != intersect::Facing::front));
        if (Form::info.facing != intersect::Facing::both) culls.insert(Form::info.name);
    });
    CHECK(culls == std::set<std::string_view>{"triangle.moller_trumbore_culling"});
}

TEST_CASE("the weights that a form names are those of a, b and c", "[intersect][triangle]") {
    std::map<std::string_view, int> told, wrong;
    for_each_triangle(static_cast<int>(draws(3000)), [&](const TriangleFamily& family, const TriangleSample& s) {
        const TriangleAnswer right = answer_of(s);
        if (!right.meets() || family.name != std::string_view("random")) return;
        const std::array<Rational, 3> weights{right.u, right.v, right.w};
        TriangleForms::for_each([&]<class Form>() {
            Tape tape;
            const Tape::Scope recording(tape);
            static_cast<void>(ask<Form, Recorded<double>>(s));
            for (std::size_t k = 0; k < weights.size(); ++k) {
                const std::string_view name = Form::info.weights[k];
                if (name.empty()) continue;
                const auto node = std::ranges::find(tape.nodes, name, &TapeNode::label);
                const bool found = node != tape.nodes.end();
                ++told[Form::info.name];
                wrong[Form::info.name] += !found || abs(Rational(node->value) - weights[k]) > Rational(1, 1 << 20);
            }
        });
    });
    TriangleForms::for_each([&]<class Form>() {
        INFO(Form::info.name);
        CHECK((told[Form::info.name] > 100) == (Form::info.name != "triangle.filtered"));
        CHECK(wrong[Form::info.name] == 0);
    });
}

}  // namespace lostbits::test::test_triangle_forms
