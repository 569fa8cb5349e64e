// Claims are measured anew every time.
#pragma once

#include <string>
#include <vector>

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
    /// The worst ray of the measurement, where there is one; of a claim about a wrong decision the first of those.
    map::WorstRay witness;
};

/// The form and format that a claim is about. InputError, with the claim's position, for names that do not exist.
map::MapRow claim_row(const scene::claim::Claim& claim);

/// Measures every claim; scenes and sweeps that several claims share are run once. `done` is called after each subject.
/// InputError, with the claim's position, for names that do not exist.
std::vector<ClaimResult> measure_claims(
    const std::vector<scene::claim::Claim>& claims, const std::filesystem::path& data_dir,
    const std::function<void()>& done = [] {});

}  // namespace lostbits::measure::claim
