// Reads claims: sentences with a citation, a measurement and an expectation.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "intersect/info.hpp"
#include "scene/check/subject.hpp"
#include "scene/toml/toml_reader.hpp"

namespace lostbits::scene::check {

/// The numbers for which the sentence of a claim is true. "No ray is missed" means = 0 for a share of misses.
struct Criterion {
    double low, high;  ///< both included; an excluded bound (`> 0`) is stored as the next double beyond it
    std::string text;  ///< as in tables: `>= 10`, `[0.4, 0.6]`

    /// True if the criterion is true of all numbers from `from` to `to`.
    [[nodiscard]] bool is_met_by(double from, double to) const { return low <= from && to <= high; }
    /// True if the criterion is true of no number from `from` to `to`.
    [[nodiscard]] bool is_failed_by(double from, double to) const { return to < low || high < from; }
    /// Checks that the verdict follows if the criterion is applied to every number from `from` to `to`. Every
    /// measurement in this interval then confirms the verdict too. Throws InputError at the criterion if the verdict
    /// does not follow.
    void require_verdict(const toml::TableReader& table, std::string_view verdict, double from, double to) const;
};

/// A sentence with its citation, the measurement that tests it, and the expected result.
struct Claim {
    /// `qualified`: true under a condition that the source does not state; it is in `condition`.
    enum class Verdict { holds, qualified, refuted };
    enum class Severity { error, warn };
    /// Kind of `lostbits check` run that measures the claim. `results` are the same everywhere and always; `timing` is
    /// not. `libraries` are claims about intersectors that are not part of lostbits and may not be loaded.
    enum class Profile { results, timing, libraries };

    /// Evidence for the verdict. `proof`: an inequality, in `lemma`. `exhaustive`: everything that the sentence covers
    /// was measured. `search`: an adversarial search for the worst case, or the worst case that such a search found.
    /// `counterexample`: the measurement contradicts the sentence. `sample`: only the measured rays. A sentence about
    /// all cases ("never", "at most") must state its evidence.
    enum class Evidence { none, proof, exhaustive, search, counterexample, sample };

    std::string id, statement, source, note;
    std::string quotation;             ///< words of the source that state the claim; empty if not looked up
    Verdict verdict = Verdict::holds;  ///< the finding; for every verdict the measurement must be in `low`..`high`
    std::string condition;             ///< of a `qualified` claim: `where touching is a miss`
    Severity severity = Severity::error;
    Profile profile = Profile::results;
    Evidence evidence = Evidence::none;
    std::string lemma;           ///< the inequality of a proof, or where to find it
    toml::SourcePosition where;  ///< position of the claim, for messages
    /// True if the command line named its file; otherwise the file is in the data folder.
    bool named = false;

    // given
    Subject subject;
    std::string form, format;  ///< no form if a row of a table takes its place
    /// Convention by which the form is judged, closed or open; absent: the form's own.
    std::optional<intersect::Touching> convention;
    /// Requirements on the machine: `isa-256`, `processors-2`. If one is not met, the claim is skipped.
    std::vector<std::string> requirements;

    /// True if the claim cites somebody: `source` is not "-".
    [[nodiscard]] bool is_sourced() const { return source != "-"; }
    /// The name of the scene, sweep or table, or of the work that is timed.
    [[nodiscard]] const std::string& subject_name() const;
    /// The name of the form, or of the row of a table.
    [[nodiscard]] const std::string& tested_name() const;
    /// The subject if it is of the kind `Kind`; else null.
    template <class Kind>
    [[nodiscard]] const Kind* subject_if() const {
        return std::get_if<Kind>(&subject);
    }

    // expect: a column of the summary, or an onset along the sweep
    std::string metric;
    std::vector<std::string> operations;  ///< for `culprit_fraction`: the operations whose shares are summed
    toml::SourcePosition quantity;        ///< position of the metric, or of its operations, for messages
    std::string onset, statistic;         ///< event and statistic, as in `onsets.csv`
    double threshold = 0;
    double low = 0, high = 0;  ///< both ends included; they guard against drift, and are fitted to the measurement
    /// Criterion that the statement sets for the number. The criterion is true of all numbers in `low`..`high` if the
    /// claim holds, of none of them if it is refuted, and of all or none if it is qualified. Without a criterion the
    /// statement describes the number, and the interval is what it says.
    std::optional<Criterion> criterion;
    /// Number of draws from which the interval was derived (see `expected_interval` in measure/check). 0: the claim has
    /// no random numbers, or the interval has another origin.
    int draws = 0;
};

std::string_view name_of(Claim::Verdict verdict);
std::string_view name_of(Claim::Profile profile);
std::string_view name_of(Claim::Evidence evidence);

/// Reads all claims of a file. Throws InputError with a position for anything that is not a claim, and for an id that
/// is given twice.
std::vector<Claim> read_claims(const std::filesystem::path& path);

/// Returns all `*.toml` of a folder, sorted, or the file itself.
std::vector<std::filesystem::path> list_claim_files(const std::filesystem::path& file_or_folder);

}  // namespace lostbits::scene::check
