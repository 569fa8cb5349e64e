// Measures claims. No result is stored: each run measures all of them anew.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "intersect/process/stop_token.hpp"
#include "measure/metric/statistics.hpp"
#include "measure/sweep/sweep.hpp"
#include "scene/check/claims_file.hpp"

namespace lostbits::measure::check {

/// Result of a claim.
struct ClaimResult {
    /// - `disagrees`: the measurement lies outside the expectation.
    /// - `unmeasurable`: there was nothing to measure (no sample, no onset, a truth that was not proved). This never
    ///   counts as agreeing.
    /// - `skipped`: this machine does not meet a requirement of the claim.
    enum class State { agrees, disagrees, unmeasurable, skipped };
    State state = State::unmeasurable;
    double measured = 0;
    std::string reason;  ///< text: why the claim is unmeasurable or skipped
    /// The worst ray of the measurement, if there is one. For a claim about a kind of wrong decision, the first ray
    /// with it; for a claim about all kinds together, the first ray of the most frequent kind.
    evaluate::WorstRay witness;
    /// Number of independent draws of rays (or numbers) behind `measured`; 0: nothing is random.
    std::uint64_t sample_count = 0;
    /// Number of floats if every float of a range was tested; 0: the claim is of another kind.
    std::uint64_t float_count = 0;
    std::uint64_t evaluation_count = 0;  ///< number of rays that a search tested; 0: the claim is not about a search
    std::vector<double> further_measured = {};  ///< values on further draws, one for each seed; NaN: no value
    /// For a claim about the 99th percentile of independent random rays (one ray per view): an interval that contains
    /// the 99th percentile of the whole ray distribution with 95 % confidence.
    std::optional<metric::Bounds> bounds = {};
    double seconds = 0;  ///< time of the measurement; claims that share a map or a sweep divide its time equally

    [[nodiscard]] bool is_random() const { return sample_count > 0; }
    [[nodiscard]] metric::Spread spread() const { return metric::spread_of(measured, further_measured); }
};

/// Interval that a claim should expect, derived from its draws. If the draws lie in [low, high], the interval is
///
///     [low − (high − low)/2, high + (high − low)/2],   its lower end cut at 0 if low ≥ 0,
///
/// or, for an onset and for a fraction with low > 0,
///
///     [low/f, f·high],   f = √(high/low); for an onset, f is at least 1 + 2^-9.
///
/// The upper end of a fraction is cut at 1. A further draw leaves the range of N draws with probability 2/(N + 1), and
/// the wider interval far more rarely.
metric::Spread expected_interval(const scene::check::Claim& claim, const ClaimResult& result);

/// Form and format of a claim. Throws InputError, with the claim's position, for names that do not exist.
evaluate::TestedForm tested_form_of(const scene::check::Claim& claim);

class ClaimStudies;

struct ClaimRequest {
    std::filesystem::path data_dir;
    intersect::process::StopToken stop = {};
    int further_draw_count = 0;             ///< number of further seeds for each claim about random rays
    const ClaimStudies* studies = nullptr;  ///< not null if a claim is about a study
};

/// Measures every claim. A scene or sweep that several claims share is run once for the default metrics, and once for
/// each other metric, with only the forms whose claims name it. A claim agrees if each of its draws agrees. Throws
/// InputError, with the claim's position, for names that do not exist.
std::vector<ClaimResult> measure_claims(const std::vector<scene::check::Claim>& claims, const ClaimRequest& request);

}  // namespace lostbits::measure::check
