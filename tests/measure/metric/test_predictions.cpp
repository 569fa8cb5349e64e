// Predictions of errors: random roundings with the right probabilities, a bound that is the root of a sum of squares,
// and the metrics by their definitions.
#include <cmath>
#include <string_view>

#include "catch.hpp"
#include "measure/attribution/recorded_rays.hpp"
#include "measure/metric/metrics.hpp"
#include "measure/stability/stability.hpp"

namespace lostbits::test::test_predictions {

using measure::answer::Outcome;
using measure::attribution::attribute;
using measure::attribution::Attribution;
using measure::attribution::RayAttribution;
using measure::stability::compute_statistical_bound;
using measure::stability::RandomRuns;

namespace {

/// A tape and its data, as the metrics receive them.
struct ExplainedRay {
    Tape tape;
    Format format;
    Attribution attribution;
    RayAttribution blame;
    Outcome outcome = Outcome::agree_hit;

    ExplainedRay(Tape of, const Format& in)
        : tape(std::move(of)), format(in), attribution(measure::attribution::attribute(tape)) {
        const double exact = attribution.errors[tape.outputs.t].exact;
        blame = {.tape = &tape,
                 .attribution = &attribution,
                 .ulp = std::ldexp(1.0, std::ilogb(exact) - in.parameters.precision + 1)};
    }
    ExplainedRay(const ExplainedRay&) = delete;
    ExplainedRay& operator=(const ExplainedRay&) = delete;

    [[nodiscard]] double metric(std::string_view name) const {
        return measure::metric::find_metric(name)->value(
            {.t = tape[tape.outputs.t].value, .format = &format, .attribution = &blame, .outcome = outcome});
    }
    [[nodiscard]] std::string_view decision(Outcome of) {
        outcome = of;
        const auto names = measure::metric::find_metric("cestac_decision")->categories;
        return names[static_cast<std::size_t>(metric("cestac_decision"))];
    }
};

/// t = a + b in floats, and a hit where that is above `threshold`.
Tape sum_of(double a, double b, double threshold = 0) {
    Tape tape;
    const NodeId x = tape.add_input(binary32, a), y = tape.add_input(binary32, b),
                 z = tape.add_input(binary32, threshold);
    const double t = static_cast<float>(a + b);
    tape.outputs.t = tape.add(TapeOp::add, binary32, t, {x, y});
    tape.outputs.hit = tape.add(TapeOp::less, binary32, threshold < t ? 1 : 0, {z, tape.outputs.t});
    return tape;
}

const Format floats = *find_format("f32");
constexpr double ulp = 0x1p-23;

/// Number of runs above 1.
int ups_of(const Tape& tape) {
    int ups = 0;
    for (const double t : RandomRuns(tape).t) {
        CHECK((t == 1 || t == 1 + ulp));
        ups += t > 1;
    }
    return ups;
}

}  // namespace

TEST_CASE("the bits of three runs agree with Student's interval", "[attribution]") {
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

TEST_CASE("an error is at most the root of n times what n independent errors would give", "[attribution]") {
    int seen = 0;
    const auto see = [&](const auto& form, const Format&, const Setting&, const Tape& tape) {
        const auto found = attribute(tape);
        if (form.shape == Shape::sdf || found.subject == no_node || found.subject != tape.outputs.t ||
            !std::isfinite(found.contribution_sum))
            return;
        int n = 0;
        for (NodeId k = 0; k < tape.size(); ++k) {
            const auto& e = found.errors[k];
            if (!e.is_live || e.rounding == 0) continue;
            if (kind_of(tape[k].op) != OperationKind::rounded && tape[k].op != TapeOp::convert) return;
            ++n;
        }
        CHECK(std::fabs(found.contribution_sum) <=
              std::sqrt(n) * compute_statistical_bound(tape, found) * (1 + 0x1p-20));
        ++seen;
    };
    on_recorded_rays({{"f32", "f64", "p12"}, 6, 4, 2027, intersect::table::catalogue()}, see);
    CHECK(seen > 200);
}

TEST_CASE("three runs of a sum promise the bits of Student's factor, compared with those of their mean", "[metric]") {
    int seen[4] = {};
    for (int k = 1; k < 64; ++k) {
        // 1 + k/128 ulp: rounded at random to 1 or 1 + ulp.
        const ExplainedRay sum(sum_of(1, k * ulp / 128), floats);
        const int ups = ups_of(sum.tape);
        CHECK(ups_of(sum.tape) == ups);
        ++seen[ups];
        INFO(k << ": " << ups << " of three runs went up");
        if (ups == 0 || ups == 3) {
            CHECK(sum.metric("cestac_bits") == 24);
        } else {
            // If one of three differs, s = ulp/√3: log2(√3 mean/(4.303 s)) = log2(3/4.303) + 23, and mean = 1 to 2^-24.
            CHECK(sum.metric("cestac_bits") == Approx(std::log2(3 / 4.303) + 23).margin(1e-6));
        }
        // The mean is off by ups/3 − k/128 ulp; up to half of one it has all 24 bits.
        const double off = std::fabs(ups / 3.0 - k / 128.0);
        const double bits = off <= 0.5 ? 24 : 24 - std::log2(2 * off);
        CHECK(sum.metric("cestac_error") == Approx(sum.metric("cestac_bits") - bits).margin(1e-6));
        CHECK(sum.metric("cestac_digit") == 0);
        // If all three runs go up, it promises 24 bits and has fewer.
        if (ups == 3) CHECK(sum.metric("cestac_error") > 0);
    }
    for (const int count : seen) CHECK(count > 0);
    const RandomRuns exact(sum_of(1, ulp));
    CHECK(exact.t == std::array{1 + ulp, 1 + ulp, 1 + ulp});
    CHECK((exact.agree() && exact.correct_bits(24) == 24));
    CHECK(ExplainedRay(sum_of(1, ulp), floats).metric("cestac_error") == 0);
}

TEST_CASE("significant digits are overestimated where all runs lose them alike", "[metric]") {
    // (1 + k/128 ulp) - 1 is 0 or an ulp in all three runs: 24 bits are promised, and none or one is there. If the runs
    // differ, fewer than two bits are promised.
    int overrated = 0;
    for (int k = 1; k < 64; ++k) {
        Tape tape = sum_of(1, k * ulp / 128, -1);
        const NodeId one = tape.add_input(binary32, 1);
        tape.outputs.t = tape.add(TapeOp::sub, binary32, 0, {tape.outputs.t, one});
        const ExplainedRay sum(std::move(tape), floats);
        const auto t = RandomRuns(sum.tape).t;
        const bool alike = t[0] == t[1] && t[1] == t[2];
        INFO(k << ": " << t[0] / ulp << ' ' << t[1] / ulp << ' ' << t[2] / ulp);
        CHECK(sum.metric("cestac_digit") == (alike ? 1 : 0));
        overrated += alike;
    }
    CHECK(overrated > 5);
    CHECK(overrated < 40);
}

TEST_CASE("stable and right decisions of three runs are told apart", "[metric]") {
    int split = 0, together = 0;
    for (int k = 65; k < 128; ++k) {
        // Rounding to nearest gives 1 + ulp, a hit above 1, which is right; a run that rounds down misses.
        ExplainedRay sum(sum_of(1, k * ulp / 128, 1), floats);
        const int ups = ups_of(sum.tape);
        const bool is_split = ups == 1 || ups == 2;
        split += is_split, together += !is_split;
        CHECK(sum.decision(Outcome::agree_hit) == (is_split ? "unstable_right" : "stable_right"));
        CHECK(sum.decision(Outcome::false_hit) == (is_split ? "unstable_wrong" : "stable_wrong"));
        // No bits are promised where a run misses.
        CHECK(std::isnan(sum.metric("cestac_bits")) == (ups != 3));
    }
    CHECK(split > 10);
    CHECK(together > 5);
    // Rounding to nearest gives 1, a miss, but the ray truly hits: the decision is explained, and t has no prediction.
    ExplainedRay miss(sum_of(1, ulp / 128, 1), floats);
    CHECK(std::isnan(miss.metric("cestac_bits")));
    CHECK(std::isnan(miss.metric("cestac_error")));
    CHECK(std::isnan(miss.metric("statistical_ratio")));
    CHECK(miss.decision(Outcome::false_miss).ends_with("_wrong"));
}

TEST_CASE("an error is compared with the root of the sum of squares", "[metric]") {
    for (const int k : {1, 7, 63}) {
        // One operation: k/128 ulp over half an ulp.
        CHECK(ExplainedRay(sum_of(1, k * ulp / 128), floats).metric("statistical_ratio") == Approx(k / 64.0));
        // Two: (1 + k/128 ulp) + 1, half an ulp of 1 and one of 2, though the second rounds nothing.
        Tape tape = sum_of(1, k * ulp / 128);
        const NodeId one = tape.add_input(binary32, 1);
        tape.outputs.t = tape.add(TapeOp::add, binary32, 2, {tape.outputs.t, one});
        CHECK(ExplainedRay(std::move(tape), floats).metric("statistical_ratio") == Approx(k / 64.0 / std::sqrt(5)));
    }
    CHECK(ExplainedRay(sum_of(1, ulp), floats).metric("statistical_ratio") == 0);
}

TEST_CASE("predictions are undefined without a recorded tape", "[metric]") {
    CHECK(std::isnan(measure::metric::find_metric("cestac_decision")->value({.format = &floats})));
    CHECK(std::isnan(measure::metric::find_metric("statistical_ratio")->value({.format = &floats})));
}

}  // namespace lostbits::test::test_predictions
