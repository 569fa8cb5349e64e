// The reports of a check: JUnit XML, CSV, JSON and a document with pictures; and the words of all of them.
#pragma once

#include <array>
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

/// In the order of `ClaimResult::State`.
inline constexpr std::array state_names{"agrees", "disagrees", "broken", "skipped"};
constexpr const char* state_name(measure::claim::ClaimResult::State state) {
    return state_names[static_cast<std::size_t>(state)];
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

/// How texts speak of what a claim is measured on.
struct SubjectWords {
    std::string heading;  ///< of all claims about it: `near-benign, rendered`
    std::string where;    ///< scene, sweep or table, and the place in it: `near-benign, rendered to stage phong`
    std::string place;    ///< that place under the heading: `stage phong`
    std::string command;  ///< what measures it again with every file
};

[[nodiscard]] SubjectWords words_of(const scene::claim::Claim& claim);

/// How many sentences hold, and how many do not.
struct VerdictCounts {
    std::size_t held = 0, qualified = 0, refuted = 0, differing = 0, broken = 0, skipped = 0;
    std::size_t with_criterion = 0;  ///< of the verdicts that are confirmed, those that follow from a criterion

    void add(const scene::claim::Claim& claim, const measure::claim::ClaimResult& result);
    [[nodiscard]] std::size_t confirmed() const { return held + qualified + refuted; }
    /// `4 hold, 1 is qualified, 2 are refuted`; `none` where none is confirmed.
    [[nodiscard]] std::string text() const;
};

/// Those of a source apart from our own.
struct CountsBySource {
    VerdictCounts all, sourced, own;
    /// `from a source 1 holds, 1 is refuted; of our own 2 hold`, without that of which there is none
    [[nodiscard]] std::string text() const;
};
[[nodiscard]] CountsBySource count_verdicts(const std::vector<scene::claim::Claim>& claims,
                                            const std::vector<measure::claim::ClaimResult>& results);

/// The claims about one scene, sweep or table.
struct ClaimSubject {
    std::string name;
    std::vector<std::size_t> claims;  ///< their places
};
/// Each subject once, in the order of the first claim about it.
[[nodiscard]] std::vector<ClaimSubject> subjects_of(const std::vector<scene::claim::Claim>& claims);

/// Writes `README.md`, `claims.csv` and `pictures/` into a folder; the same claims and results give the same bytes. A
/// scene is shown as a contact sheet, a sweep as its plots, cases as their matrix: of the forms that are claimed about.
void write_claim_report(const std::filesystem::path& folder, const std::vector<scene::claim::Claim>& claims,
                        const std::vector<measure::claim::ClaimResult>& results,
                        const measure::claim::ClaimRequest& run);

/// What is shown of a subject, and of which claims about it.
struct ShownSubject {
    const std::filesystem::path& folder;
    std::vector<const scene::claim::Claim*> claims;
    const measure::claim::ClaimRequest& run;
};

/// Drawn into `folder`/pictures; the Markdown that shows it, empty for what has no picture.
std::string pictures_of(const ShownSubject& shown);

}  // namespace lostbits::output::claim
