// Claims are measured anew every time.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "intersect/process/stop_token.hpp"
#include "measure/metric/statistics.hpp"
#include "measure/sweep/sweep.hpp"
#include "scene/claim/claims_file.hpp"

namespace lostbits::measure::claim {

/// What became of a claim.
struct ClaimResult {
    /// `disagrees`: the measurement lies outside the expectation. `broken`: there was nothing to measure (no sample, no
    /// onset, a truth that was not proved), which never counts as agreeing. `skipped`: this machine lacks what it
    /// needs.
    enum class State { agrees, disagrees, broken, skipped };
    State state = State::broken;
    double measured = 0;
    std::string trouble;  ///< why it is broken or skipped
    /// The worst ray of the measurement, where there is one; of a claim about wrong decisions the first of those, of
    /// all kinds together the first of the most frequent.
    evaluate::WorstRay witness;
    /// On how many independent draws of rays (or numbers) `measured` rests; 0: on none, nothing is random.
    std::uint64_t samples = 0;
    /// Every float of a range was tried, so many; 0: the claim is about nothing of the kind.
    std::uint64_t floats = 0;
    std::uint64_t evaluations = 0;     ///< of a search: how many rays it tried; 0: the claim is about none
    std::vector<double> further = {};  ///< the same measured on further draws, one a seed; NaN where it does not exist
    /// Of a 99th percentile of random rays, each a view of its own: where that of all such rays lies, with 95 %.
    std::optional<metric::Bounds> bounds = {};
    double seconds = 0;  ///< that measuring took; where claims share a map or a sweep, each has an equal part of it

    [[nodiscard]] bool is_drawn() const { return samples > 0; }
    [[nodiscard]] metric::Spread spread() const { return metric::spread_of(measured, further); }
};

/// The interval that draws give a claim: their range, widened on either side by half its width, by powers of two where
/// it is an onset (to whose 2^-9 at least) or a fraction that is never 0; cut at 0 and, of a fraction, at 1. A further
/// draw leaves the range of N with probability 2/(N + 1), and the wider interval far more rarely. Draws that are all
/// equal give that number.
metric::Spread interval_of(const scene::claim::Claim& claim, const ClaimResult& result);

/// The form and format that a claim is about. InputError, with the claim's position, for names that do not exist.
evaluate::TestedForm claim_row(const scene::claim::Claim& claim);

struct ClaimRequest {
    std::filesystem::path data_dir;
    intersect::process::StopToken stop = {};
    int further_draws = 0;  ///< of every claim whose subject is random: with so many seeds after its own
};

/// Measures every claim; scenes and sweeps that several claims share are run once for the default metrics, and once for
/// each other metric, with the forms that a claim names for it. A claim agrees if each of its draws does. InputError,
/// with the claim's position, for names that do not exist.
std::vector<ClaimResult> measure_claims(const std::vector<scene::claim::Claim>& claims, const ClaimRequest& request);

}  // namespace lostbits::measure::claim
