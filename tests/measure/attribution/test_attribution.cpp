// Errors attributed to operations: the recording has the bits of the machine, exact values are exact, and the
// contributions sum to the error.
#include "measure/attribution/attribution.hpp"

#include "catch.hpp"
#include "counts.hpp"
#include "measure/answer/without_rounding.hpp"
#include "measure/attribution/operation_error.hpp"
#include "measure/attribution/recorded_rays.hpp"
#include "measure/stability/stability.hpp"
#include "number/oracle.hpp"
#include "number/recorded.hpp"
#include "number/recorders/tape_recorder.hpp"

namespace lostbits::test::test_attribution {

using intersect::table::Intersector;
using measure::attribution::Attribution;

namespace {

double sum_of_sizes(const Attribution& a) {
    double sum = 0;
    for (const measure::attribution::OperationError& error : a.errors)
        sum += error.is_live ? std::fabs(error.contribution) : 0;
    return sum;
}

}  // namespace

TEST_CASE("a recorded form gives the bits of the plain form", "[attribution]") {
    int hits = 0;
    on_recorded_rays({{"f32", "f64", "bf16", "fp16", "p30"}, 60},
                     [&](const Intersector& form, const Format& format, const Setting& setting, const Tape& tape) {
                         const Hit<double> want = plain(form, format, setting);
                         REQUIRE((tape[tape.outputs.hit].value != 0) == want.hit);
                         REQUIRE(same_number(tape[tape.outputs.t].value, want.t));
                         REQUIRE(same_number(tape[tape.outputs.near].value, want.near));
                         REQUIRE(same_number(tape[tape.outputs.far].value, want.far));
                         hits += want.hit;
                     });
    CHECK(hits > 3000);
}

TEST_CASE("every operation on a tape is that of the format on its operands", "[attribution]") {
    on_recorded_rays({{"f32", "p12"}, 3}, [](const Intersector&, const Format&, const Setting&, const Tape& tape) {
        for (NodeId i = 0; i < tape.size(); ++i) {
            const TapeNode& n = tape[i];
            if (!is_operation(n.op) || n.op == TapeOp::call) continue;
            if (const NodeId side = measure::attribution::chosen_side(tape, i); side != no_node) {
                REQUIRE(same_number(n.value, tape[side].value));
                continue;
            }
            std::array<double, 3> x{};
            for (std::size_t k = 0; k < 3; ++k) x[k] = n.operands[k] == no_node ? 0 : tape[n.operands[k]].value;
            REQUIRE(same_number(n.value, measure::attribution::result_of(n.op, x, tape.format_of(i))));
        }
    });
}

TEST_CASE("the exact value of an answer is the result of the form without rounding", "[attribution]") {
    int compared = 0;
    const int rays = is_long() ? 25 : 8;
    on_recorded_rays({{"f32", "f64"}, rays, 10},
                     [&](const Intersector& form, const Format&, const Setting& setting, const Tape& tape) {
                         const Attribution a = measure::attribution::attribute(tape, tape.outputs.t);
                         const auto self = measure::answer::evaluate_exactly(form, setting.ray, setting.target(form));
                         if (!self || a.loop_was_cut_short) return;
                         REQUIRE(a.is_exact_hit);
                         const double exact = a[tape.outputs.t].exact;
                         REQUIRE(std::fabs(measure::truth::scaled_difference(measure::truth::as_certified(exact), *self,
                                                                             self->exponent)) <= 0x1p-50);
                         ++compared;
                     });
    CHECK(compared > 40 * rays);
}

TEST_CASE("contributions sum to the error, derivatives to first order, and fast and deep arithmetic agree",
          "[attribution]") {
    // Adjoints cancel far away: for a torus, a sum was off by 2^-35.9.
    constexpr double near_by = 0x1p-36, far_away = 0x1p-30;
    int seen = 0, first_order = 0;
    const auto sums_up = [&](const Attribution& a, double rest) {
        if (a.loop_was_cut_short || !std::isfinite(a.error)) return false;
        if (rest == far_away && !std::isfinite(sum_of_sizes(a))) return false;  // adjoints beyond binary64
        // Difference quotients leave no remainder. The difference is the rounding of these sums, in binary64, and of
        // the adjoints, which are sums of the same kind.
        REQUIRE(std::fabs(a.contribution_sum - a.error) <= rest * (sum_of_sizes(a) + std::fabs(a.error)) + 1e-300);
        ++seen;
        return true;
    };
    const auto derives = [&](const Intersector& form, const Tape& tape, const Attribution& a) {
        if (a[tape.outputs.t].decision_changed || form.shape == Shape::sdf) return;
        // Second order: each derivative is off by the relative errors of the values at which it is evaluated, a few of
        // them in a row.
        double worst = 0;
        bool turned = false;
        for (const measure::attribution::OperationError& error : a.errors) {
            if (!error.is_live) continue;
            turned |= error.decision_changed;
            if (error.exact != 0) worst = std::max(worst, std::fabs(error.error / error.exact));
        }
        if (turned || worst > 0x1p-10) return;
        REQUIRE(std::fabs(a.first_order_sum - a.error) <= 64 * worst * sum_of_sizes(a) + 0x1p-36 * std::fabs(a.error));
        first_order += a.error != 0;
    };
    // The quick exact arithmetic and the deep one must agree.
    int quick = 0;
    const auto ask = [&](const Intersector& form, const Tape& tape, double rest, const auto&... subject) {
        const Attribution a = measure::attribution::attribute(tape, subject...),
                          b = measure::attribution::attribute(tape, subject..., {.full = true});
        REQUIRE(b.exact_bits == 2048);
        quick += a.exact_bits == 106;
        REQUIRE(a.subject == b.subject);
        REQUIRE(a.is_exact_hit == b.is_exact_hit);
        sums_up(a, rest);
        if (!sums_up(b, rest)) return;
        derives(form, tape, b);
        REQUIRE(std::fabs(a.error - b.error) <= 0x1p-40 * std::fabs(b.error));
        for (std::size_t i = 0; i < a.errors.size(); ++i)
            REQUIRE(std::fabs(a.errors[i].contribution - b.errors[i].contribution) <= 0x1p-30 * sum_of_sizes(b));
    };
    const int rays = is_long() ? 25 : 3;
    on_recorded_rays({{"f32", "f64", "bf16", "p18"}, rays},
                     [&](const Intersector& form, const Format&, const Setting&, const Tape& tape) {
                         ask(form, tape, near_by, tape.outputs.t);
                     });
    // Far away, rounding changes decisions, and the attribution is then about these.
    on_recorded_rays({{"f32", "f64"}, rays, 100}, [&](const Intersector& form, const Format&, const Setting&,
                                                      const Tape& tape) { ask(form, tape, far_away); });
    CHECK(seen > 1000 * rays);
    CHECK(first_order > 300 * rays);
    CHECK(quick > 400 * rays);
}

TEST_CASE("derivatives by inputs agree with forward differentiation", "[attribution]") {
    int compared = 0;
    const auto see = [&](const Intersector& form, const Format&, const Setting&, const Tape& tape) {
        if (form.shape != Shape::sphere || form.info->formats != intersect::Formats::all ||
            tape[tape.outputs.hit].value == 0)
            return;
        const Attribution a = measure::attribution::attribute(tape, tape.outputs.t, {.full = true});
        const std::vector<double> forward = measure::stability::compute_forward_derivatives(tape);
        std::size_t input = 0;
        for (NodeId i = 0; i < tape.size() && input < 10; ++i) {
            if (tape[i].op != TapeOp::input) continue;
            const double want = forward.at(input++);
            if (std::isnan(want)) continue;  // of a call
            REQUIRE(std::fabs(a[i].derivative - want) <= 1e-6 * (std::fabs(want) + 1));
            ++compared;
        }
    };
    on_recorded_rays({{"f64"}, 20, 1, 7}, see);
    CHECK(compared > 2000);
}

TEST_CASE("one ray worked out by hand has two roundings and one cancellation", "[attribution]") {
    // x = 1 + 2^-12 in binary32. x² = 1 + 2^-11 + 2^-24, which ties to 1 + 2^-11: rounding −2^-24. x² − 1 = 2^-11 is
    // exact and cancels 11 bits; the difference then carries −2^-24 of 2^-11 + 2^-24. y = (x² − 1)·3 = 3·2^-11, exact.
    Tape tape;
    const number::recorders::TapeRecorder recorder(tape, binary32);
    using T = Recorded;
    const T x(1 + 0x1p-12f);
    const T square = named("square", x * x);
    const T rest = named("rest", square - T(1));
    const T y = rest * T(3);
    const Attribution a = measure::attribution::attribute(tape, y.node(), {.full = true});
    const auto of = [&](const T& v) { return a[v.node()]; };
    CHECK(of(square).rounding == -0x1p-24);
    CHECK(of(square).adjoint == 3);
    CHECK(of(square).contribution == -3 * 0x1p-24);
    CHECK(of(rest).cancelled_bits == 11);
    CHECK(of(rest).operands_have_error);
    CHECK(of(rest).rounding == 0);
    CHECK(of(rest).exact == 0x1p-11 + 0x1p-24);
    // On exact operands, each rounded: RN(x²) − 1 = 2^-11, off by 2^-24 where an ulp is 2^-34: 2^10 ulp, 11 bits.
    CHECK(of(rest).local_bits == 11);
    CHECK(of(square).local_bits == 0);
    CHECK(a.error == -3 * 0x1p-24);
    CHECK(a.contribution_sum == a.error);
    CHECK(a.culprit == square.node());
    CHECK_FALSE(of(x).operands_have_error);
    CHECK_FALSE(of(square).operands_have_error);
}

TEST_CASE("a decision changed by rounding is attributed to the operands of the comparison", "[attribution]") {
    // (1 + 2^-12)² − (1 + 2^-11) is 2^-24 > 0 but computes as 0: `< tiny` changes.
    Tape tape;
    const number::recorders::TapeRecorder recorder(tape, binary32);
    using T = Recorded;
    const T x(1 + 0x1p-12f), y(1 + 0x1p-11f), tiny(0x1p-25f);
    const T square = x * x;
    const T disc = named("disc", square - y);
    const RecordedMask missed = disc < tiny;
    const RecordedMask hit = !(missed || disc < T(0));
    const T t = select(hit, disc, tiny);
    tape.outputs = {hit.node(), t.node(), t.node(), t.node()};
    const Attribution a = measure::attribution::attribute(tape);
    CHECK(a.subject == missed.node());
    CHECK(a.is_exact_hit);
    CHECK(a.error == -0x1p-24);
    CHECK(a.contribution_sum == -0x1p-24);
    CHECK(a.culprit == square.node());
    const Attribution of_t = measure::attribution::attribute(tape, t.node());
    CHECK(of_t.culprit == t.node());  // the choice of the wrong side is an error of its own: 2^-25 in place of 2^-24
    CHECK(of_t.error == -0x1p-25);
    CHECK(of_t.contribution_sum == of_t.error);
}

TEST_CASE("the root of a difference that vanished is attributed without remainder", "[attribution]") {
    // √((1 + 2^-12)² − (1 + 2^-11)) = 2^-12, computed 0: the derivative is infinite, the difference quotient 1/(0 +
    // 2^-12).
    Tape tape;
    const number::recorders::TapeRecorder recorder(tape, binary32);
    using T = Recorded;
    const T x(1 + 0x1p-12f), y(1 + 0x1p-11f);
    const T root = sqrt(x * x - y);
    const Attribution a = measure::attribution::attribute(tape, root.node(), {.full = true});
    CHECK(a.error == -0x1p-12);
    CHECK(a.contribution_sum == -0x1p-12);
    CHECK(std::isinf(a.first_order_sum));
}

TEST_CASE("a value that is zero without rounding gets no sign from truncation noise", "[attribution]") {
    // k/7 and similar numbers are cut at 2048 bits, and (1/k)k − 1 is then some 2^-2050 of either sign.
    for (int k = 3; k < 60; k += 2) {
        Tape tape;
        const number::recorders::TapeRecorder recorder(tape, Rounded<8>::format());
        using T = Recorded;
        const T nothing = T(1) / T(k) * T(k) - T(1);
        const RecordedMask below = nothing<T(0), above = nothing> T(0);
        const T t = select(below || above, nothing, T(1));
        const Attribution a = measure::attribution::attribute(tape, t.node(), {.full = true});
        INFO("k = " << k);
        CHECK(a[below.node()].exact == 0);
        CHECK(a[above.node()].exact == 0);
    }
}

TEST_CASE("an input is exact, also an infinite one", "[attribution]") {
    Tape tape;
    const number::recorders::TapeRecorder recorder(tape, binary32);
    using T = Recorded;
    const T x(0.1f), end(HUGE_VALF);
    const T t = min(x * x, end);
    for (const bool full : {false, true}) {
        const Attribution a = measure::attribution::attribute(tape, t.node(), {.full = full});
        CHECK(a[x.node()].exact == 0.1f);
        CHECK(a[end.node()].exact == HUGE_VAL);
        CHECK(a[x.node()].error == 0);
    }
}

TEST_CASE("operations of the branch not taken contribute nothing", "[attribution]") {
    Tape tape;
    const number::recorders::TapeRecorder recorder(tape, binary32);
    using T = Recorded;
    const T a(0.1f), b(0.3f), c(7);
    const T dead = a * b, live = a / b;
    const T smaller = min(c, live);
    const T t = select(a < b, smaller, dead);
    const Attribution found = measure::attribution::attribute(tape, t.node());
    CHECK_FALSE(found[dead.node()].is_live);
    CHECK(found[live.node()].is_live);
    CHECK_FALSE(found[c.node()].is_live);
    CHECK(found.culprit == live.node());
}

TEST_CASE("an answer that is NaN is attributed to the operation that produced the NaN", "[attribution]") {
    Tape tape;
    const number::recorders::TapeRecorder recorder(tape, binary32);
    using T = Recorded;
    const T zero = T(1.5f) - T(1.5f);
    const T quotient = zero / zero;
    const T t = quotient + T(1);
    CHECK(measure::attribution::attribute(tape, t.node()).culprit == quotient.node());
}

}  // namespace lostbits::test::test_attribution
