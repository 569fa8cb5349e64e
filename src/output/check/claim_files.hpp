// Reports of `lostbits check` as JUnit XML, CSV, JSON and a document with pictures, and the texts that they share.
#pragma once

#include <array>
#include <filesystem>
#include <string>
#include <vector>

#include "measure/check/claim.hpp"

namespace lostbits::output::check {

using measure::check::ClaimRequest;
using measure::check::ClaimResult;
using measure::metric::Metric;
using scene::check::Claim;

/// Writes a suite of test cases: a claim that no longer measures as stated is a `<failure>`, a broken claim an
/// `<error>`, and a claim that this machine cannot measure is `<skipped>`. Properties of the suite count the verdicts
/// of the statements from a source and of our own. A claim of severity `warn` is reported as passed, with its message
/// in `<system-out>`, unless `strict`.
void write_junit(const std::filesystem::path& path, const std::vector<Claim>& claims,
                 const std::vector<ClaimResult>& results, bool strict);

/// Writes one row per claim: statement, verdict, expectation, measurement, state, and the witness in hexadecimal
/// floats.
void write_claims_csv(const std::filesystem::path& path, const std::vector<Claim>& claims,
                      const std::vector<ClaimResult>& results);

/// Writes the facts of `write_claims_csv` about each claim, and more, as a JSON array. Numbers that JSON cannot hold
/// are strings.
void write_claims_json(const std::filesystem::path& path, const std::vector<Claim>& claims,
                       const std::vector<ClaimResult>& results);

/// Scope of the verdict: its condition if it is qualified, otherwise its evidence, such as "no worse case found in N
/// evaluations; the worst is …". Empty if the statement is only about single numbers.
std::string evidence_text(const Claim& claim, const ClaimResult& result);

/// Names of the states, in the order of `ClaimResult::State`.
inline constexpr std::array state_names{"agrees", "disagrees", "broken", "skipped"};
constexpr const char* state_name(measure::check::ClaimResult::State state) {
    return state_names[static_cast<std::size_t>(state)];
}
/// Name of the measured quantity: `lost_bits_p50`, `onset of false_hit count 1`, `culprit_fraction of c`.
std::string quantity_text(const Claim& claim);
/// `all 65537 floats` for a claim that rests on every float of a range; empty for other claims.
std::string floats_text(const ClaimResult& result);
/// The criterion as a clause: `the statement says > 0`; empty if the claim has no criterion.
std::string criterion_text(const Claim& claim);
/// How a claim fails to agree: `expected to hold, but does not`, or `refuted, but the number has changed`.
std::string disagreement_text(const Claim& claim, const ClaimResult& result);
/// One line for a claim that does not agree: the expected value, the measured one, and whether the verdict still
/// follows.
std::string explanation_text(const Claim& claim, const ClaimResult& result);
/// The metric behind a column of a summary: lost_bits for `lost_bits_p99`; null for an outcome.
const Metric* metric_of_column(const std::string& column);
/// The worst ray of the measurement in hexadecimal floats; empty if no ray was kept.
std::string witness_text(const ClaimResult& result);
/// The command that explains the witness and prints its numbers again; empty if no ray was kept.
std::string witness_command(const Claim& claim, const ClaimResult& result);

/// Texts that name what a claim is measured on.
struct SubjectTexts {
    std::string heading;  ///< heading of all claims about the subject: `near-benign, rendered`
    std::string subject;  ///< scene, sweep or table with the position in it: `near-benign, rendered to stage phong`
    /// Only the position in the scene, sweep or table, for texts below the heading: `stage phong`.
    std::string position;
    std::string command;  ///< command that measures the subject again with all files
};

/// Texts of the subject of a claim.
[[nodiscard]] SubjectTexts subject_texts(const Claim& claim);

/// Numbers of claims by verdict; a claim that does not agree counts by its state instead.
struct VerdictCounts {
    std::size_t held = 0, qualified = 0, refuted = 0, differing = 0, broken = 0, skipped = 0;
    std::size_t with_criterion = 0;  ///< confirmed verdicts that follow from a criterion

    void add(const Claim& claim, const ClaimResult& result);
    [[nodiscard]] std::size_t agreeing_count() const { return held + qualified + refuted; }
    /// `4 hold, 1 is qualified, 2 are refuted`; `none` if none is confirmed.
    [[nodiscard]] std::string text() const;
};

/// Verdict counts of all claims, of the claims from a source, and of our own.
struct CountsBySource {
    VerdictCounts all, sourced, own;
    /// `from a source: 1 holds, 1 is refuted; our own: 2 hold`; a part without claims is left out.
    [[nodiscard]] std::string text() const;
};
[[nodiscard]] CountsBySource count_verdicts(const std::vector<Claim>& claims, const std::vector<ClaimResult>& results);

/// The claims about one scene, sweep or table.
struct ClaimSubject {
    std::string name;
    std::vector<std::size_t> claims;  ///< indices of the claims
};
/// Groups claims by subject. Subjects are in the order of the first claim about each.
[[nodiscard]] std::vector<ClaimSubject> group_by_subject(const std::vector<Claim>& claims);

/// Writes `README.md`, `claims.csv` and `pictures/` into a folder. The same claims and results give the same bytes. A
/// scene is shown as a contact sheet, a sweep as its plots, cases as their matrix, each for the forms that the claims
/// name.
void write_claim_report(const std::filesystem::path& folder, const std::vector<Claim>& claims,
                        const std::vector<ClaimResult>& results, const ClaimRequest& request);

/// The claims about a subject, whose pictures are drawn.
struct ShownSubject {
    const std::filesystem::path& folder;  ///< folder of the report
    std::vector<const Claim*> claims;
    const ClaimRequest& request;
};

/// Draws the pictures into `folder`/pictures and returns the Markdown that shows them; empty for a subject without a
/// picture.
std::string draw_subject_pictures(const ShownSubject& shown);

}  // namespace lostbits::output::check
