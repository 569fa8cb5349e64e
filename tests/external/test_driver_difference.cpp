// Programs that a driver has rewritten: the rewriting is found by the answers alone, and it is the same formula.
#include <cmath>
#include <numeric>
#include <string>

#include "catch.hpp"
#include "measure/attribution/rerun.hpp"
#include "measure/tape/driver_difference.hpp"
#include "measure/tape/tape_form.hpp"

namespace test_driver_difference {

using namespace lostbits;
using namespace lostbits::measure::tape;
using intersect::table::Intersector;

namespace {

const Intersector& form(const std::string& name) {
    for (const auto& row : intersect::table::catalogue())
        if (row.info->name == name) return row;
    throw std::logic_error(name + " is not a form");
}

DerivedTape whole(const Tape& tape) {
    DerivedTape all{tape, std::vector<NodeId>(tape.nodes.size())};
    std::iota(all.origins.begin(), all.origins.end(), 0);
    return all;
}

/// The values of a tape for a ray past a sphere, without rounding.
double exact_t(Tape tape) {
    const std::vector<double> inputs{3, -2, 5, -0.625, 0.3125, -1.125, 0.25, -0.5, 0.75, 1.5};
    for (TapeNode& node : tape.nodes)
        if (node.op == TapeOp::input && static_cast<std::size_t>(node.operands[0]) < inputs.size())
            node.value = inputs[node.operands[0]];
    return measure::attribution::Rerun(tape, [](NodeId) { return false; })[tape.outputs.t];
}

}  // namespace

TEST_CASE("drivers: every rewriting is the same formula without rounding", "[external]") {
    std::size_t tried = 0;
    for (const char* const name : {"sphere.schoolbook", "sphere.half_b", "sphere.press", "sphere.unit_half_b"}) {
        const Tape tape = record_tape(form(name), *find_format("f32"));
        for (std::size_t k = 0; k < driver_rewriting_names().size(); ++k) {
            std::vector<NodeId> changed;
            const DerivedTape made = rewrite_as_driver(whole(tape), k, nullptr, changed);
            CAPTURE(name, driver_rewriting_names()[k]);
            REQUIRE(made.origins.size() == made.tape.nodes.size());
            CHECK(std::fabs(exact_t(made.tape) - exact_t(tape)) <= 1e-14 * std::fabs(exact_t(tape)));
            tried += changed.empty() ? 0 : 1;
        }
    }
    CHECK(tried >= 6);
}

TEST_CASE("drivers: the rewriting and its first operation are found by the answers", "[external]") {
    const Intersector& program = form("sphere.schoolbook");
    const Format& f32 = *find_format("f32");
    const Tape tape = record_tape(program, f32);
    CHECK(find_driver_difference(program, program).differing_ray_count == 0);
    for (std::size_t k = 0; k < driver_rewriting_names().size(); ++k) {
        std::vector<NodeId> all;
        rewrite_as_driver(whole(tape), k, nullptr, all);
        for (const NodeId site : all) {
            std::vector<NodeId> changed;
            const std::vector<NodeId> one{site};
            Tape made = rewrite_as_driver(whole(tape), k, &one, changed).tape;
            for (TapeNode& node : made.nodes)  // a tape without values; a program needs those of constants
                if (node.op == TapeOp::constant) node.value = node.operands[0];
            const TapeForm driver(program, f32, made, "driver", "");
            const DriverDifference found = find_driver_difference(driver.form(), program);
            CAPTURE(driver_rewriting_names()[k], site);
            if (found.differing_ray_count == 0) continue;  // it rounds the same on all rays
            REQUIRE(found.rewritings.size() == 1);
            CHECK(found.rewritings[0].name == driver_rewriting_names()[k]);
            CHECK(found.first_changed() == site);
        }
    }
    // A driver that answers another question is not explained.
    CHECK_FALSE(find_driver_difference(form("sphere.pythagoras"), program).is_explained());
}

}  // namespace test_driver_difference
