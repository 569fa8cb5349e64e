// A tape run again: where everything rounds it is the tape, where nothing does it is exact.
#include "measure/blame/rerun.hpp"

#include "catch.hpp"
#include "measure/blame/attribution.hpp"
#include "measure/blame/recorded_rays.hpp"

namespace lostbits::test::test_rerun {

using intersect::table::Intersector;
using measure::blame::Rerun;

namespace {

Tape tape_of(const Intersector& form, const Format& format, Random& random) {
    const Setting s = draw_setting(random, form, format, 4);
    Tape tape;
    form.record(format, s.ray, s.target(form), HUGE_VAL, tape);
    return tape;
}

template <class See>
void on_every_form(const See& see) {
    for (const char* name : {"f32", "f64", "bf16", "p30"}) {
        const Format format = *find_format(name);
        for (const Intersector& form : intersect::table::catalogue()) {
            if (!form.exists_in(format)) continue;
            Random random(2027);
            for (int i = 0; i < 6; ++i) {
                INFO(form.info->name << " in " << name << ", ray " << i);
                see(tape_of(form, format, random));
            }
        }
    }
}

}  // namespace

TEST_CASE("a tape run again with every rounding has the values of the format", "[attribution]") {
    std::size_t nodes = 0;
    on_every_form([&nodes](const Tape& tape) {
        const Rerun again(tape, [](NodeId) { return true; });
        for (NodeId i = 0; i < tape.size(); ++i) REQUIRE(same_number(again[i], tape[i].value));
        nodes += tape.nodes.size();
    });
    CHECK(nodes > 10'000);
}

TEST_CASE("a tape run again without rounding has the exact values of the attribution", "[attribution]") {
    on_every_form([](const Tape& tape) {
        const auto found = measure::blame::attribute(tape, {.full = true});
        const Rerun again(tape, [](NodeId) { return false; });
        for (NodeId i = 0; i < tape.size(); ++i) {
            if (tape[i].op == TapeOp::input) continue;
            REQUIRE(same_number(again[i], found.of[static_cast<std::size_t>(i)].exact));
        }
    });
}

TEST_CASE("of a sum of two roundings each counterfactual has the other one", "[attribution]") {
    // (1 + 2^-24) + (1 + 3·2^-24): the first rounds down by 2^-24, the second up by it.
    Tape tape;
    const auto input = [&tape](double x) { return tape.add_input(binary32, x); };
    const NodeId one = input(1), small = input(0x1p-24), less = input(0x3p-24);
    const NodeId a = tape.add(TapeOp::add, binary32, 1, {one, small});
    const NodeId b = tape.add(TapeOp::add, binary32, 1 + 0x1p-22, {one, less});
    const NodeId t = tape.add(TapeOp::add, binary32, 2 + 0x1p-22, {a, b});
    tape.outputs = {no_node, t, t, t};
    const auto of_a = measure::blame::counterfactuals(tape, a), of_b = measure::blame::counterfactuals(tape, b);
    CHECK(of_a.alone.error == -0x1p-24);
    CHECK(of_b.alone.error == 0x1p-24);
    CHECK(of_a.mended.error == of_b.alone.error - 0x1p-24);  // and the last sum rounds to even
    CHECK(of_a.alone.hit);
}

}  // namespace lostbits::test::test_rerun
