// Predictions of errors: coins that fall as they should, and a bound that is the root of a sum of squares.
#include "measure/stability/stability.hpp"

#include <cmath>

#include "catch.hpp"
#include "measure/blame/recorded_rays.hpp"

namespace lostbits::test::test_prediction {

using measure::blame::attribute;
using measure::stability::RandomRuns;
using measure::stability::statistical_bound;

namespace {

/// a + b in floats.
Tape sum_of(double a, double b) {
    Tape tape;
    const NodeId x = tape.add_input(binary32, a), y = tape.add_input(binary32, b);
    tape.outputs.t = tape.add(TapeOp::add, binary32, static_cast<float>(a + b), {x, y});
    return tape;
}

}  // namespace

TEST_CASE("a result that rounds goes up and down, and one that does not stays", "[attribution]") {
    int down = 0, up = 0;
    for (int k = 1; k <= 64; ++k) {
        const double small = k * 0x1p-30;  // between two floats
        for (const double t : RandomRuns(sum_of(1, small)).t) {
            CHECK((t == 1 || t == 1 + 0x1p-23));
            ++(t == 1 ? down : up);
        }
        const RandomRuns exact(sum_of(1, k * 0x1p-23));
        CHECK(exact.t == std::array{1 + k * 0x1p-23, 1 + k * 0x1p-23, 1 + k * 0x1p-23});
        CHECK(exact.agree());
        CHECK(exact.correct_bits(24) == 24);
        CHECK(RandomRuns(sum_of(1, small)).t == RandomRuns(sum_of(1, small)).t);
    }
    CHECK(down > 60);
    CHECK(up > 60);
}

TEST_CASE("the bits of three runs are those of Student's interval", "[attribution]") {
    RandomRuns runs(sum_of(1, 1));
    runs.t = {1, 1, 1 + 0x1p-10};
    // mean 1 + 2^-10/3, s = 2^-10/sqrt(3): log2(sqrt(3) mean/(4.303 s)) = log2(3 mean/4.303) + 10
    CHECK(runs.correct_bits(24) == Approx(std::log2(3 * (1 + 0x1p-10 / 3) / 4.303) + 10));
    runs.hit = {true, false, true};
    CHECK_FALSE(runs.agree());
    CHECK(std::isnan(runs.correct_bits(24)));
    runs.hit = {true, true, true};
    runs.t = {1, -1, 0};
    CHECK(runs.correct_bits(24) == 0);
}

TEST_CASE("no error is more than the root of n times what n independent ones would be", "[attribution]") {
    int seen = 0;
    for (const char* name : {"f32", "f64", "p12"}) {
        const Format format = *find_format(name);
        for (const auto& form : intersect::table::catalogue()) {
            if (!form.exists_in(format) || form.shape == Shape::sdf) continue;
            Random random(2027);
            for (int i = 0; i < 6; ++i) {
                const Setting s = draw_setting(random, form, format, 4);
                Tape tape;
                form.record(format, s.ray, s.target(form), HUGE_VAL, tape);
                const auto found = attribute(tape);
                if (found.subject == no_node || found.subject != tape.outputs.t || !std::isfinite(found.explained))
                    continue;
                int n = 0;
                bool only_rounds = true;
                for (NodeId k = 0; k < tape.size(); ++k) {
                    const auto& e = found.of[static_cast<std::size_t>(k)];
                    if (!e.live || e.rounding == 0) continue;
                    const bool rounds = kind_of(tape[k].op) == OperationKind::rounded || tape[k].op == TapeOp::convert;
                    only_rounds &= rounds;
                    n += rounds;
                }
                if (!only_rounds) continue;
                INFO(form.info->name << " in " << name << ", ray " << i);
                CHECK(std::fabs(found.explained) <= std::sqrt(n) * statistical_bound(tape, found) * (1 + 0x1p-20));
                ++seen;
            }
        }
    }
    CHECK(seen > 200);
}

}  // namespace lostbits::test::test_prediction
