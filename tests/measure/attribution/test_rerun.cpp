// A tape that runs again: if everything rounds it gives the tape, and if nothing rounds it is exact.
#include "measure/attribution/rerun.hpp"

#include <cmath>
#include <utility>
#include <vector>

#include "catch.hpp"
#include "counts.hpp"
#include "measure/attribution/attribution.hpp"
#include "measure/attribution/recorded_rays.hpp"
#include "number/oracle.hpp"

namespace lostbits::test::test_rerun {

using measure::attribution::Rerun;

namespace {

template <class See>
void on_every_form(std::vector<const char*> formats, int rays, const See& see) {
    on_recorded_rays({std::move(formats), rays, 4, 2027, intersect::table::catalogue()},
                     [&](const auto&, const Format&, const Setting&, const Tape& tape) { see(tape); });
}

}  // namespace

TEST_CASE("a tape rerun with every rounding has the values of the format", "[attribution]") {
    std::size_t nodes = 0;
    on_every_form({"f32", "f64", "bf16", "p30"}, 6, [&nodes](const Tape& tape) {
        const Rerun again(tape, [](NodeId) { return true; });
        for (NodeId i = 0; i < tape.size(); ++i) REQUIRE(same_number(again[i], tape[i].value));
        nodes += tape.nodes.size();
    });
    CHECK(nodes > 10'000);
}

TEST_CASE("a tape rerun without rounding has the exact values of the attribution", "[attribution]") {
    on_every_form({"f32", "f64", "bf16", "p30"}, is_long() ? 6 : 2, [](const Tape& tape) {
        const auto found = measure::attribution::attribute(tape, {.full = true});
        const Rerun again(tape, [](NodeId) { return false; });
        for (NodeId i = 0; i < tape.size(); ++i) {
            if (tape[i].op == TapeOp::input) continue;
            REQUIRE(same_number(again[i], found[i].exact));
        }
    });
}

TEST_CASE("the counterfactuals of every operation agree with whole reruns", "[attribution]") {
    const auto near = [](double x, double y, double size) {
        return same_number(x, y) || std::fabs(x - y) <= 0x1p-51 * size;
    };
    std::size_t hits = 0;
    NodeId tapes = 0;
    on_every_form({"f32", "bf16"}, is_long() ? 6 : 2, [&](const Tape& tape) {
        const auto [hit, t, near_root, far_root] = tape.outputs;
        const Rerun exact(tape, [](NodeId) { return false; });
        const NodeId apart = 1 + tape.size() / (is_long() ? 16 : 6);
        for (NodeId i = tapes++ % apart; i < tape.size(); i += apart) {
            const OperationKind kind = kind_of(tape[i].op);
            if (kind == OperationKind::sign || kind == OperationKind::choice || is_decision(tape[i].op)) continue;
            const auto found = measure::attribution::run_counterfactuals(tape, i);
            const Rerun mended(tape, [i](NodeId k) { return k != i; }), alone(tape, [i](NodeId k) { return k == i; });
            REQUIRE(found.only_exact.hit == (mended[hit] != 0));
            REQUIRE(found.only_rounded.hit == (alone[hit] != 0));
            const auto size = [&](double x) { return std::fmax(std::fabs(x), std::fabs(exact[t])); };
            REQUIRE(near(found.only_exact.error, mended[t] - exact[t], size(mended[t])));
            REQUIRE(near(found.only_rounded.error, alone[t] - exact[t], size(alone[t])));
            hits += found.only_exact.hit && found.only_rounded.hit;
        }
    });
    CHECK(hits > 500);
}

TEST_CASE("a choice changed by rounding is corrected by the side that exact values choose", "[attribution]") {
    // 1 + 2^-24 rounds to 1, so that it seems to be no more than 1.
    Tape tape;
    const auto input = [&tape](double x) { return tape.add_input(binary32, x); };
    const NodeId one = input(1), small = input(0x1p-24), two = input(2), five = input(5);
    const NodeId sum = tape.add(TapeOp::add, binary32, 1, {one, small});
    const NodeId is_less = tape.add(TapeOp::less_equal, binary32, 1, {sum, one});
    const NodeId t = tape.add(TapeOp::select, binary32, 2, {is_less, two, five});
    tape.outputs = {no_node, t, t, t};
    REQUIRE(measure::attribution::attribute(tape, t).culprit == t);
    for (const NodeId operation : {t, sum}) {
        const auto found = measure::attribution::run_counterfactuals(tape, operation);
        CHECK(found.only_exact.error == 0);
        CHECK(found.only_rounded.error == -3);
    }
}

TEST_CASE("each counterfactual of a sum of two roundings leaves the other rounding", "[attribution]") {
    // (1 + 2^-24) + (1 + 3·2^-24): the first rounds down by 2^-24, the second up by it.
    Tape tape;
    const auto input = [&tape](double x) { return tape.add_input(binary32, x); };
    const NodeId one = input(1), small = input(0x1p-24), less = input(0x3p-24);
    const NodeId a = tape.add(TapeOp::add, binary32, 1, {one, small});
    const NodeId b = tape.add(TapeOp::add, binary32, 1 + 0x1p-22, {one, less});
    const NodeId t = tape.add(TapeOp::add, binary32, 2 + 0x1p-22, {a, b});
    tape.outputs = {no_node, t, t, t};
    const auto of_a = measure::attribution::run_counterfactuals(tape, a),
               of_b = measure::attribution::run_counterfactuals(tape, b);
    CHECK(of_a.only_rounded.error == -0x1p-24);
    CHECK(of_b.only_rounded.error == 0x1p-24);
    CHECK(of_a.only_exact.error == of_b.only_rounded.error - 0x1p-24);  // and the last sum rounds to even
    CHECK(of_a.only_rounded.hit);
}

}  // namespace lostbits::test::test_rerun
