// Measures claims. No result is stored: each run measures all of them anew.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "intersect/process/stop_token.hpp"
#include "measure/metric/statistics.hpp"
#include "measure/sweep/sweep.hpp"
#include "scene/claim/claims_file.hpp"

namespace lostbits::measure::claim {

/// Result of a claim.
struct ClaimResult {
    /// `disagrees`: the measurement lies outside the expectation. `broken`: there was nothing to measure (no sample, no
    /// onset, a truth that was not proved); it never counts as agreeing. `skipped`: this machine does not meet a
    /// requirement of the claim.
    enum class State { agrees, disagrees, broken, skipped };
    State state = State::broken;
    double measured = 0;
    std::string trouble;  ///< reason if it is broken or skipped
    /// The worst ray of the measurement, if there is one. For a claim about a kind of wrong decision, the first ray
    /// with it; for a claim about all kinds together, the first ray of the most frequent kind.
    evaluate::WorstRay witness;
    /// Number of independent draws of rays (or numbers) behind `measured`; 0: nothing is random.
    std::uint64_t samples = 0;
    /// Number of floats if every float of a range was tested; 0: the claim is of another kind.
    std::uint64_t floats = 0;
    std::uint64_t evaluations = 0;     ///< number of rays that a search tested; 0: the claim is not about a search
    std::vector<double> further = {};  ///< values on further draws, one for each seed; NaN where there is none
    /// For a 99th percentile of random rays, each one view: interval of the percentile of all such rays, at 95 %
    /// confidence.
    std::optional<metric::Bounds> bounds = {};
    double seconds = 0;  ///< time of the measurement; claims that share a map or a sweep divide its time equally

    [[nodiscard]] bool is_drawn() const { return samples > 0; }
    [[nodiscard]] metric::Spread spread() const { return metric::spread_of(measured, further); }
};

/// Expected interval of a claim from its draws: their range, widened on either side by half its width. For an onset, or
/// a fraction that is never 0, the width is measured in powers of two: the ends move by the factor √(high/low), for an
/// onset by at least 1 + 2^-9. The interval is cut at 0 and, for a fraction, at 1. A further draw leaves the range of N
/// draws with probability 2/(N + 1), and the wider interval far more rarely. If all draws are equal, the interval is
/// that number (for an onset, widened by the factor 1 + 2^-9).
metric::Spread interval_of(const scene::claim::Claim& claim, const ClaimResult& result);

/// Form and format of a claim. Throws InputError, with the claim's position, for names that do not exist.
evaluate::TestedForm claim_row(const scene::claim::Claim& claim);

class ClaimStudies;

struct ClaimRequest {
    std::filesystem::path data_dir;
    intersect::process::StopToken stop = {};
    int further_draws = 0;  ///< for every claim about random rays: number of further seeds after its own
    const ClaimStudies* studies = nullptr;  ///< must not be null if a claim is about a study
};

/// Measures every claim. A scene or sweep that several claims share is run once for the default metrics, and once for
/// each other metric, with only the forms whose claims name it. A claim agrees if each of its draws agrees. Throws
/// InputError, with the claim's position, for names that do not exist.
std::vector<ClaimResult> measure_claims(const std::vector<scene::claim::Claim>& claims, const ClaimRequest& request);

}  // namespace lostbits::measure::claim
