// Sweep: measures the numbers of a map along a parameter, and finds where a form first goes wrong. Also measures named
// cases at the extremes and gives a verdict on each.
#pragma once

#include <algorithm>
#include <functional>
#include <limits>
#include <string>
#include <string_view>
#include <vector>

#include "measure/evaluate/evaluate.hpp"
#include "measure/metric/statistics.hpp"
#include "measure/shard/share.hpp"
#include "scene/sweep/case_file.hpp"
#include "scene/sweep/sweep_file.hpp"

namespace lostbits::measure::sweep {

/// Results of the tested forms at one step.
struct SweepStep {
    std::vector<double> values;  ///< one for each axis
    std::vector<evaluate::FormSummary> summaries;
};

/// Value of the first axis at which a form first crosses a threshold.
struct Onset {
    std::size_t form_index;
    std::string event;             ///< `lost_bits`, a step of a transform, an outcome, or why a march stopped
    std::string statistic;         ///< `p50`, `p99`, `max`; `count` for the outcomes
    double threshold;              ///< in bits, in ulps of a step, or 1 for a count
    bool reads_backwards = false;  ///< the steps are read backwards; `first`, `last` and `after` mean this order
    bool found = false;
    bool happens_at_start = false;  ///< the event happens at the first step already, so there is no last good value
    double last_good = 0, first_bad = 0;
    double value_at_first_bad = 0;  ///< value of the statistic
    /// Recovery after the first bad step. `recovers`: a later step is good; the last good step and the point from which
    /// the form stays bad are recorded. `is_good_at_end`: the last step is good, and neither is recorded.
    bool recovers = false, is_good_at_end = false;
    double last_good_after = 0, bad_again = 0;
    std::uint64_t ray_count = 0, view_count = 0;  ///< of every step; with fewer rays, a first failure is found later
    /// `first_bad` of further draws, one for each seed; NaN if the event does not happen.
    std::vector<double> further_first_bad = {};

    /// True if both are the same event of one row, read from the same end.
    [[nodiscard]] bool is_same_event(const Onset& other) const {
        return form_index == other.form_index && event == other.event && statistic == other.statistic &&
               threshold == other.threshold && reads_backwards == other.reads_backwards;
    }
    /// Spread of first_bad over all draws.
    [[nodiscard]] metric::Spread spread() const {
        return metric::spread_of(found ? first_bad : std::numeric_limits<double>::quiet_NaN(), further_first_bad);
    }
};

/// All results of a sweep.
struct SweepFindings {
    std::vector<SweepStep> steps;
    std::vector<Onset> onsets;

    /// Appends the results of the next share.
    void append(SweepFindings&& next_share);
};

struct SweepRequest {
    const scene::sweep::SweepFile& sweep;
    std::vector<evaluate::TestedForm> tested_forms;
    std::vector<const metric::Metric*> metrics;
    int further_draw_count = 0;  ///< number of further draws of random rays, for the spread of onsets
    shard::Share share = {};     ///< share of the steps, and of the forms whose onsets are found
    bool recoveries = false;     ///< also find where a form is good again after its first failure
    bool both_ends = false;      ///< also find onsets from the last step backwards, for failures at small values
    std::vector<Onset> wanted_onsets = {};  ///< if not empty, only onsets of these events are looked for
    truth::ProofLimit limit{};
    std::function<void(std::uint64_t)> progress = [](std::uint64_t) {};

    [[nodiscard]] bool wants_onset(const Onset& onset) const {
        return wanted_onsets.empty() ||
               std::ranges::any_of(wanted_onsets, [&onset](const Onset& event) { return event.is_same_event(onset); });
    }
};

/// Runs every step of one axis, or of the product of two (the second runs fastest), in order; parallel over steps. A
/// divided run covers only the steps of the request's share.
std::vector<SweepStep> run_sweep(const SweepRequest& request);

/// Measures the forms at any values of the sweep's axes, on its steps or between them.
std::vector<evaluate::FormSummary> measure_at(const SweepRequest& request, const std::vector<double>& values);

/// Finds the first crossings of these thresholds along the axis of a sweep with one axis: 1, 4, 8, p/2 and p bits for
/// the median, the 99th percentile and the largest of the lost bits; one ulp for the median of each measured transform
/// step; one ray for each of the `wrong_decisions`; and one march that ends at max_dist, at max_steps, or stagnated.
/// Each bracket [last good, first bad] is narrowed by bisection until it is 2^-9 of its value wide, or holds no number
/// of the axis. A crossing is the first in the order of the steps: a dip between two steps stays unseen. A form may be
/// good again later: the last good point, and the point from which it stays bad, are found the same way. Then come the
/// first crossings on further draws, if the request asks for them. With `both_ends`, each onset that is read from the
/// first step is followed by the onset of the same event, read from the last.
std::vector<Onset> find_onsets(const SweepRequest& request, const std::vector<SweepStep>& steps);

/// Runs the steps and finds the onsets. In a divided run, each share measures all steps of the forms whose onsets it
/// finds.
SweepFindings measure_sweep(const SweepRequest& request);

/// Largest number of units of progress that `run_sweep` and `find_onsets` report together.
std::uint64_t count_sweep_units(const SweepRequest& request);

/// Verdict on a case. Wrong decisions come before wrong values; among several kinds of wrong decisions the most
/// frequent counts.
enum class Verdict : std::uint8_t {
    right,
    within_inputs,
    wrong_value,
    false_hit,
    false_miss,
    not_a_number,
    unresolved,
    wrong_primitive
};

inline constexpr std::array<std::string_view, 8> verdict_names{"right",      "within_inputs",  "wrong_value",
                                                               "false_hit",  "false_miss",     "not_a_number",
                                                               "unresolved", "wrong_primitive"};

struct CaseRequest {
    const scene::sweep::CaseFile& file;
    std::vector<evaluate::TestedForm> tested_forms;
    std::vector<const metric::Metric*> metrics;  ///< include lost_bits and excess_bits
    truth::ProofLimit limit{};
    shard::Share share = {};  ///< share of the cases
    std::function<void(std::uint64_t)> progress = [](std::uint64_t) {};
};

/// Runs every row on every case of the share, in the file's order, in parallel over the cases. Each format gets the
/// case's rays in its own numbers, and has its own truth.
std::vector<std::vector<evaluate::FormSummary>> run_cases(const CaseRequest& request);
/// Runs one row over several cases as if they were one.
evaluate::FormSummary run_cases_together(const CaseRequest& request, std::size_t form_index,
                                         const std::vector<std::size_t>& case_indices);

/// Verdict on a summary. `right`: every decision is right, and no answer loses more than `max_bits` bits.
/// `within_inputs`: every decision is right, and an answer loses at most `max_bits` bits beyond the envelope of half an
/// ulp in each input.
Verdict verdict_of(const evaluate::FormSummary& summary, const std::vector<const metric::Metric*>& metrics,
                   double max_bits);

}  // namespace lostbits::measure::sweep
