// The reports of a check: JUnit XML, CSV and JSON.
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "measure/claim/claim.hpp"

namespace lostbits::output::claim {

/// `<failure>` for a claim that no longer measures as stated, `<error>` for a broken one, `<skipped>` for one
/// that this machine cannot measure. How many sentences hold, of a source and of our own, are properties of the suite.
/// A claim of severity `warn` is reported as passed, with its trouble in `<system-out>`, unless `strict`. `moved`: by
/// the id of a claim, what else there is to say of it, as the property `moved`.
void write_junit(const std::filesystem::path& path, const std::vector<scene::claim::Claim>& claims,
                 const std::vector<measure::claim::ClaimResult>& results, bool strict,
                 const std::map<std::string, std::string>& moved = {});

/// One row per claim: sentence, verdict, expectation, measurement, state, and the witness in hexadecimal floats.
void write_claims_csv(const std::filesystem::path& path, const std::vector<scene::claim::Claim>& claims,
                      const std::vector<measure::claim::ClaimResult>& results);

/// The same as an array; numbers that JSON cannot hold are strings.
void write_claims_json(const std::filesystem::path& path, const std::vector<scene::claim::Claim>& claims,
                       const std::vector<measure::claim::ClaimResult>& results);

/// How far the verdict reaches: the condition of a qualified one, or what it rests on, "no worse one found in N
/// evaluations; the worst is …"; empty where the sentence speaks of single numbers.
std::string evidence_text(const scene::claim::Claim& claim, const measure::claim::ClaimResult& result);

/// `agrees`, `disagrees`, `broken` or `skipped`.
constexpr const char* state_name(measure::claim::ClaimResult::State state) {
    using Became = measure::claim::ClaimResult::State;
    return state == Became::agrees      ? "agrees"
           : state == Became::disagrees ? "disagrees"
           : state == Became::broken    ? "broken"
                                        : "skipped";
}
/// What is measured: `lost_bits_p50`, `onset of false_hit count 1`, `culprit_fraction of c`.
std::string quantity(const scene::claim::Claim& claim);
/// `all 65537 floats` of a claim that rests on every float of a range; empty for the others.
std::string floats_text(const measure::claim::ClaimResult& result);
/// `the sentence says > 0`: its criterion; empty where it has none.
std::string says_text(const scene::claim::Claim& claim);
/// `expected to hold, does not`: of a claim that does not agree.
std::string changed_text(const scene::claim::Claim& claim, const measure::claim::ClaimResult& result);
/// Why a claim does not agree, in one line: what was expected, what was measured, and whether the verdict still
/// follows.
std::string explain(const scene::claim::Claim& claim, const measure::claim::ClaimResult& result);
/// The metric whose statistic or fraction a column of a summary is: lost_bits of `lost_bits_p99`; none of an outcome.
const measure::metric::Metric* metric_of_column(const std::string& column);
/// The worst ray of the measurement in hexadecimal floats; empty where there is none.
std::string witness_text(const measure::claim::ClaimResult& result);
/// The command that explains the witness, whose numbers it gives again; empty where there is none.
std::string explain_witness(const scene::claim::Claim& claim, const measure::claim::ClaimResult& result);

}  // namespace lostbits::output::claim
