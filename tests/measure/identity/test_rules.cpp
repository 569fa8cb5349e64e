// Rules of rewriting: without rounding they keep the value of a formula, for every form and ray that is tried.
#include "measure/identity/rules.hpp"

#include <algorithm>
#include <cmath>
#include <map>

#include "catch.hpp"
#include "intersect/table/recording.hpp"
#include "measure/repair/repair.hpp"
#include "measure/rows.hpp"
#include "scene/file/scene.hpp"

namespace lostbits::test::test_rules {

using namespace lostbits::measure::identity;
using intersect::table::Intersector;
using measure::repair::divides_by_zero;
using measure::repair::RaySample;
using measure::repair::run_with_inputs;
namespace tape = measure::tape;

namespace {

/// A small generator, so that a failure can be reproduced from a number.
class Numbers {
public:
    explicit Numbers(std::uint64_t seed) : state_(seed) {}
    /// From −4 to 4, of 20 bits.
    double next() {
        state_ = state_ * 6364136223846793005U + 1442695040888963407U;
        return std::ldexp(static_cast<double>(state_ >> 44U), -17) - 4;
    }

private:
    std::uint64_t state_;
};

std::vector<double> inputs_of(const Intersector& form, Numbers& numbers, std::size_t axis) {
    const Primitive<double> primitive(form.shape);
    std::vector<double> all;
    for (std::size_t k = 0; k < intersect::table::input_names(form, intersect::Target<double>(primitive)).size(); ++k)
        all.push_back(numbers.next());
    if (form.info->direction == intersect::Direction::unit)
        for (std::size_t k = 0; k < 3; ++k) all[3 + k] = k == axis ? 1 : 0;
    all.back() = HUGE_VAL;  // where the ray ends
    return all;
}

bool is_near(double a, double b) {
    return (std::isnan(a) && std::isnan(b)) || a == b || std::fabs(a - b) <= 0x1p-45 * std::fabs(a);
}

/// Compares the answers of both without rounding; a ray for which no rule's condition holds decides nothing. Returns
/// the number of these rays that hit.
int check_same(const Tape& before, const Tape& after, const Intersector& form, std::uint64_t seed) {
    Numbers numbers(seed);
    int hits = 0;
    for (std::size_t ray = 0; ray < 12; ++ray) {
        const auto inputs = inputs_of(form, numbers, ray % 3);
        const Tape a = run_with_inputs(before, inputs, false), b = run_with_inputs(after, inputs, false);
        if (divides_by_zero(a) || divides_by_zero(b)) continue;
        INFO("ray " << ray);
        REQUIRE(a[a.outputs.hit].value == b[b.outputs.hit].value);
        if (a[a.outputs.hit].value == 0) continue;
        REQUIRE(is_near(a[a.outputs.t].value, b[b.outputs.t].value));
        ++hits;
    }
    return hits;
}

std::optional<Triple> unit_of(const Intersector& form, const Terms& terms) {
    if (form.info->direction != intersect::Direction::unit) return std::nullopt;
    return direction_of(terms);
}

/// True if `of` is computed from node i.
bool computes(const Tape& tape, NodeId i, NodeId of) {
    return i == of || (!is_given(tape[of].op) && std::ranges::any_of(tape[of].operands, [&](NodeId operand) {
               return operand != no_node && computes(tape, i, operand);
           }));
}

const Tape& tape_named(const char* name, Tape& kept) {
    return kept = tape::record_tape(test::form_named(name), *find_format("f32"));
}

}  // namespace

TEST_CASE("no identity changes the unrounded answer of a form of the catalogue", "[mend]") {
    std::map<std::string_view, int> applied, hits;
    for (const Intersector& form : intersect::table::catalogue()) {
        if (!is_primitive(form.shape) || !form.record || form.deciding_arithmetic ||
            !form.exists_in(*find_format("f32")))
            continue;
        const Tape before = tape::record_tape(form, *find_format("f32"));
        if (before.formats.size() > 1 || before.nodes.size() > 400) continue;
        Terms terms(before);
        for (const Rewrite& rewrite : find_rewrites(terms, terms.outputs(), unit_of(form, terms))) {
            INFO(form.info->name << ", " << rewrite.rule->name);
            const Tape after = terms.tape(terms.replace_nodes(terms.outputs(), rewrite.replacements));
            const int seed = ++applied[rewrite.rule->name];
            hits[rewrite.rule->name] += check_same(before, after, form, static_cast<std::uint64_t>(seed));
        }
    }
    for (const Rule& rule : rules) {
        INFO(rule.name);
        CHECK(applied[rule.name] > 0);
        CHECK(hits[rule.name] > 0);
    }
}

TEST_CASE("a formula keeps its value when converted to terms and back", "[mend]") {
    Tape kept;
    const Tape& before = tape_named("sphere.schoolbook", kept);
    const Terms terms(before);
    const Tape after = terms.tape(terms.outputs());
    CHECK(tape::find_widenable_operations(after).size() <= tape::find_widenable_operations(before).size());
    Numbers numbers(7);
    int hits = 0;
    for (int ray = 0; ray < 40; ++ray) {
        const auto inputs = inputs_of(test::form_named("sphere.schoolbook"), numbers, 0);
        const Tape a = run_with_inputs(before, inputs, true), b = run_with_inputs(after, inputs, true);
        CHECK(a[a.outputs.hit].value == b[b.outputs.hit].value);
        if (a[a.outputs.hit].value == 0) continue;
        ++hits;
        CHECK(a[a.outputs.near].value == b[b.outputs.near].value);
        CHECK(a[a.outputs.far].value == b[b.outputs.far].value);
    }
    CHECK(hits > 5);
}

TEST_CASE("a wrong identity is detected on a sample of rays", "[mend]") {
    const auto scene = test::scene_named("near-benign", std::pair{16, 16});
    Tape kept;
    const Tape& before = tape_named("sphere.schoolbook", kept);
    const RaySample sample({.scene = &scene, .tested_form = test::row("sphere.schoolbook", "f32")});
    CHECK(sample.have_same_answers(before, before));
    for (NodeId i = 0; i < before.size(); ++i) {
        Tape wrong = before;
        if (wrong[i].op == TapeOp::add) wrong[i].op = TapeOp::sub;
        else if (wrong[i].op == TapeOp::mul && wrong[i].operands[0] != wrong[i].operands[1]) wrong[i].op = TapeOp::add;
        else continue;
        INFO("operation " << i << ", " << name_of(before[i].op) << " " << before[i].label);
        // The far root is not an answer if every ray starts outside.
        if (computes(before, i, before.outputs.near)) CHECK_FALSE(sample.have_same_answers(before, wrong));
    }
}

TEST_CASE("products of sums are expanded, however the brackets are written", "[mend]") {
    Tape kept;
    Terms terms(tape_named("sphere.schoolbook", kept));
    const auto named = [&](std::string_view label) {
        for (NodeId i = 0; i < terms.size(); ++i)
            if (terms[i].label == label) return i;
        return no_node;
    };
    const Sum disc = multiply_out(terms, named("disc")).value();
    CHECK(disc.size() == 3);  // 4 (f·d)² − 4 a f·f + 4 a r²
    const Sum a = multiply_out(terms, named("a")).value(), b = multiply_out(terms, named("b")).value(),
              c = multiply_out(terms, named("c")).value();
    const Sum minus_four_ac = times(times(a, c), Sum{{{}, Ratio(-4, 1)}});
    CHECK(plus(times(b, b), minus_four_ac) == disc);
    CHECK(factor_out_common(disc).factor == Ratio(4, 1));
}

// For x < 0 the two differ: the root is not a number, as its condition says.
TEST_CASE("the square of a root is its radicand, where the radicand is not negative", "[mend]") {
    Tape before;
    const NodeId x = before.add_input(binary32, 2);
    const NodeId root = before.add(TapeOp::sqrt, binary32, 0, {x});
    const NodeId square = before.add(TapeOp::mul, binary32, 0, {root, root});
    const NodeId hit = before.add(TapeOp::less, binary32, 1, {x, square});
    before.outputs = {.hit = hit, .t = square, .near = square, .far = square};
    Terms terms(before);
    const auto rewrites = find_rewrites(terms, terms.outputs(), std::nullopt);
    const auto found = std::ranges::find(rewrites, "square of a root", [](const Rewrite& r) { return r.rule->name; });
    REQUIRE(found != rewrites.end());
    CHECK(found->rule->condition == "x >= 0");
    const Tape after = terms.tape(terms.replace_nodes(terms.outputs(), found->replacements));
    CHECK(std::ranges::count(after.nodes, TapeOp::sqrt, &TapeNode::op) == 0);
    for (int k = 0; k <= 200; ++k) {
        const double value = std::ldexp(k, -3);
        const Tape a = run_with_inputs(before, {value}, false), b = run_with_inputs(after, {value}, false);
        CHECK(b[b.outputs.t].value == value);
        CHECK(is_near(a[a.outputs.t].value, value));
    }
    // Rounded, √x·√x is not x for x = 2.
    const Tape rounded = run_with_inputs(before, {2}, true);
    CHECK(rounded[rounded.outputs.t].value != 2);
    const Tape negative = run_with_inputs(before, {-1}, false);
    CHECK(std::isnan(negative[negative.outputs.t].value));
}

}  // namespace lostbits::test::test_rules
