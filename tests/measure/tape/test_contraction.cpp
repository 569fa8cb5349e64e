// A contracted form has the bits of compiled code that may contract, and is the form where nothing is rounded.
#include "measure/tape/contraction.hpp"

#include <cmath>
#include <limits>
#include <map>
#include <set>

#include "catch.hpp"
#include "intersect/catalogue.hpp"
#include "intersect/simd/packed.hpp"
#include "measure/attribution/recorded_rays.hpp"
#include "measure/rows.hpp"
#include "measure/tape/contracted_width.hpp"
#include "measure/tape/tape_form.hpp"
#include "number/oracle.hpp"
#include "number/recorded.hpp"
#include "number/recorders/tape_recorder.hpp"

namespace lostbits::test::test_contraction {

using namespace lostbits::measure::tape;
using intersect::table::Intersector;

namespace {

/// Four inputs, and the answer f(a, b, c, d).
template <class F>
Tape tape_of_four(const F& f) {
    using T = Recorded;
    Tape tape;
    const number::recorders::TapeRecorder recorder(tape, binary32);
    const T a(2.0F), b(3.0F), c(5.0F), d(7.0F);
    const T t = f(a, b, c, d);
    tape.outputs = {(t > T(0)).node(), t.node(), t.node(), t.node()};
    return tape;
}

/// Number of occurrences of an operation on the remaining tape.
template <class F>
std::map<TapeOp, int> operations_of(const F& f) {
    const Tape tape = contract_tape(tape_of_four(f));
    std::map<TapeOp, int> counts;
    for (const TapeNode& node : tape.nodes) ++counts[node.op];
    return counts;
}

bool same_answer(const Hit<double>& a, const Hit<double>& b) {
    return a.hit == b.hit && (!a.hit || (same_number(a.t, b.t) && same_number(a.near, b.near)));
}

}  // namespace

TEST_CASE("a product that is only added is fused, and one that is used elsewhere is not", "[tape][contraction]") {
    const auto sum = [](auto a, auto b, auto c, auto) { return a * b + c; };
    CHECK(operations_of(sum)[TapeOp::fma] == 1);
    CHECK(operations_of(sum)[TapeOp::mul] == 0);
    CHECK(operations_of(sum)[TapeOp::add] == 0);
    // In a sum of two products, the left one is fused and the right one is its addend. In a sum of three, the third is
    // fused too.
    const auto two = [](auto a, auto b, auto c, auto d) { return a * b + c * d; };
    CHECK(operations_of(two)[TapeOp::fma] == 1);
    CHECK(operations_of(two)[TapeOp::mul] == 1);
    const Tape tape = contract_tape(tape_of_four(two));
    for (const TapeNode& node : tape.nodes) {
        if (node.op != TapeOp::mul) continue;
        CHECK(node.operands[0] == 2);  // c: a b, which stands on the left, is within the sum
    }
    const auto three = [](auto a, auto b, auto c, auto d) { return (a * b + c * d) + a * d; };
    CHECK(operations_of(three)[TapeOp::fma] == 2);
    CHECK(operations_of(three)[TapeOp::mul] == 1);
    // c − a b is fma(−a, b, c), and a b − c is fma(a, b, −c).
    CHECK(operations_of([](auto a, auto b, auto c, auto) { return c - a * b; })[TapeOp::fma] == 1);
    CHECK(operations_of([](auto a, auto b, auto c, auto) { return a * b - c; })[TapeOp::fma] == 1);
    CHECK(operations_of([](auto a, auto b, auto c, auto) { return -(a * b) + c; })[TapeOp::fma] == 1);
    // The same product used twice is one node, which both sums fuse.
    const auto again = [](auto a, auto b, auto c, auto d) { return (a * b + c) * (b * a + d); };
    CHECK(operations_of(again)[TapeOp::fma] == 2);
    CHECK(operations_of(again)[TapeOp::mul] == 1);
    const auto compared = [](auto a, auto b, auto c, auto) {
        const auto p = a * b;
        return select(p < c, p + c, c);
    };
    CHECK(operations_of(compared)[TapeOp::fma] == 0);
    CHECK(operations_of([](auto a, auto b, auto, auto) { return a * b + a * b; })[TapeOp::fma] == 0);
    CHECK(operations_of([](auto a, auto b, auto c, auto) { return (a * b) * c; })[TapeOp::fma] == 0);
}

#ifdef LOSTBITS_HAS_CONTRACTED
namespace {

/// Answer of compiled code for one ray.
template <class F>
Hit<double> evaluate_compiled(EvaluatePlain<F> ask, const Setting& setting) {
    const auto &o = setting.ray.origin, &d = setting.ray.direction;
    std::vector<F> in;
    for (const double x : {o.x, o.y, o.z, d.x, d.y, d.z}) in.push_back(static_cast<F>(x));
    for (const double x : setting.primitives.front().shape_numbers()) in.push_back(static_cast<F>(x));
    F t, near, far;
    unsigned char hit = 0;
    ask(in.data(), &t, &near, &far, &hit);
    return {hit != 0, t, near, far};
}

/// Number of rays, of `count` rays of a form, on which compiled code and the contracted tape differ.
template <class F>
int differing(const Intersector& form, const Format& format, EvaluatePlain<F> ask, int count) {
    const Intersector& row = contract_form(form);
    Random random(7);
    int apart = 0;
    for (int i = 0; i < count; ++i) {
        const Setting s = draw_setting(random, form, format, i % 3 == 0 ? 1000 : 2);
        apart += !same_answer(plain(row, format, s), evaluate_compiled(ask, s));
    }
    return apart;
}

}  // namespace

// If a formula computes an unnamed product in an earlier statement, the compiler fuses that one first, and a tape no
// longer shows which came first.
TEST_CASE("a contracted form has the bits of code that the compiler contracts", "[tape][contraction]") {
    const auto isas = intersect::simd::available_isas();
    if (std::ranges::find(isas, intersect::simd::Isa::w256) == isas.end()) return;
    const std::set<std::string_view> in_another_order{
        "sphere.two_step", "sphere.newton_refined", "triangle.woop_double",  "triangle.projection",
        "capsule.quilez",  "cone.moment",           "torus.graphics_gems",   "torus.quilez",
        "torus.pov_ray",   "torus.brl_cad",         "torus.closest_approach"};
    std::vector<PlainFormKernels> rows(intersect::form_count);
    fill_contracted(rows.data());
    int forms = 0, changed = 0;
    for (std::size_t i = 0; i < intersect::form_count; ++i) {
        const Intersector& form = intersect::table::catalogue()[i];
        if (!has_tape(form) || in_another_order.contains(form.info->name)) continue;
        INFO(form.info->name);
        const Format f32 = *find_format("f32"), f64 = *find_format("f64");
        CHECK(differing(form, f32, rows[i].f32, 300) == 0);
        if (form.native64) CHECK(differing(form, f64, rows[i].f64, 300) == 0);
        ++forms;
        changed += std::ranges::any_of(contract_tape(record_tape(form, f32)).nodes,
                                       [](const TapeNode& node) { return node.op == TapeOp::fma; });
    }
    CHECK(forms > 80);
    CHECK(changed > 75);
}
#endif

TEST_CASE("a contracted form equals its tape in every arithmetic", "[tape][contraction]") {
    const Format f32 = *find_format("f32"), f64 = *find_format("f64"), p24{"p24", binary32, Format::Engine::rounded};
    for (const char* const name : {"sphere.schoolbook", "box.embree_fma", "triangle.undivided", "torus.sturm"}) {
        const Intersector &form = form_named(name), &row = contract_form(form);
        CHECK(row.info->name == std::string(name) + "+fma");
        CHECK(&contract_form(form) == &row);
        CHECK(is_contracted(row));
        CHECK_FALSE(is_contracted(form));
        Random random(3);
        for (int i = 0; i < 40; ++i) {
            const Setting s = draw_setting(random, form, f32, 2);
            INFO(name << ", ray " << i);
            const Hit<double> answer = plain(row, f32, s);
            CHECK(same_answer(plain(row, p24, s), answer));
            for (const Format& format : {f32, f64}) {
                Tape tape;
                row.record(format, s.ray, s.target(row), HUGE_VAL, tape);
                const Hit<double> there = plain(row, format, s);
                REQUIRE((tape[tape.outputs.hit].value != 0) == there.hit);
                if (there.hit) CHECK(same_number(tape[tape.outputs.t].value, there.t));
            }
        }
    }
    CHECK_THROWS_WITH(contract_form(form_named("sphere.filtered")), Catch::Contains("it filters"));
    CHECK_THROWS_WITH(contract_form(contract_form(form_named("sphere.press"))), Catch::Contains("contracted already"));
}

}  // namespace lostbits::test::test_contraction
