// Claims: sentences with a citation, a measurement and an expectation.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "intersect/info.hpp"
#include "scene/claim/subject.hpp"
#include "scene/toml/toml_reader.hpp"

namespace lostbits::scene::claim {

/// The numbers of which a sentence is true: "no ray is missed" says = 0 of a share of misses.
struct Criterion {
    double low, high;  ///< both count; a bound that is not met itself (`> 0`) is the next double beyond it
    std::string text;  ///< as tables show it: `>= 10`, `[0.4, 0.6]`

    /// True of all numbers from `from` to `to`.
    [[nodiscard]] bool is_met_by(double from, double to) const { return low <= from && to <= high; }
    /// True of none of them.
    [[nodiscard]] bool is_failed_by(double from, double to) const { return to < low || high < from; }
    /// A verdict follows from what the sentence says of every number that the interval from `from` to `to` admits, so
    /// whatever is measured in it confirms the verdict too. InputError at the criterion where it does not.
    void demand(const toml::TableReader& table, std::string_view verdict, double from, double to) const;
};

struct Claim {
    /// `qualified`: true with a condition that the source does not state, as `condition` does.
    enum class Verdict { holds, qualified, refuted };
    enum class Severity { error, warn };
    /// What `lostbits check` is asked for: results, which are the same everywhere and always, or times, which are
    /// neither.
    /// `libraries`: of intersectors that are not part of lostbits, and may not be loaded.
    enum class Profile { results, timing, libraries };

    /// What the verdict rests on. `proof`: an inequality, in `lemma`. `exhaustive`: everything that the sentence speaks
    /// of was measured. `search`: an adversarial search for the worst case, or the worst that one found.
    /// `counterexample`: what was measured contradicts the sentence. `sample`: the rays that were measured, and no
    /// others. A sentence with a word of all cases ("never", "at most") must say.
    enum class Evidence { none, proof, exhaustive, search, counterexample, sample };

    std::string id, statement, source, note;
    Verdict verdict = Verdict::holds;  ///< what was found; either way the measurement must lie in `low`..`high`
    std::string condition;             ///< of a `qualified` one: `where touching is a miss`
    Severity severity = Severity::error;
    Profile profile = Profile::results;
    Evidence evidence = Evidence::none;
    std::string lemma;  ///< the inequality of a proof, or where it stands
    toml::Where where;  ///< of the claim, for messages
    /// The command line named its file; else it is one of the data folder.
    bool named = false;

    // given
    Subject subject;
    std::string form, format;                       ///< no form where a table's row stands in its place
    std::optional<intersect::Touching> convention;  ///< judged as closed or open solids; absent: by the form's own word
    /// What the machine must have, or the claim is skipped: `isa-256`, `processors-2`.
    std::vector<std::string> requirements;

    /// Whether somebody else said it: `source` is not "-".
    [[nodiscard]] bool is_sourced() const { return source != "-"; }
    /// The scene, sweep or table, or the work that is timed.
    [[nodiscard]] const std::string& subject_name() const;
    /// The form, or the row of a table.
    [[nodiscard]] const std::string& tested() const;
    /// What it is measured on, where that is of this kind; else null.
    template <class Kind>
    [[nodiscard]] const Kind* on() const {
        return std::get_if<Kind>(&subject);
    }

    // expect: a column of the summary, or an onset along the sweep
    std::string metric;
    std::vector<std::string> operations;  ///< of `culprit_fraction`: the operations whose shares are summed
    toml::Where quantity;                 ///< of the metric, or of its operations, for messages
    std::string onset, statistic;         ///< event and statistic of `onsets.csv`
    double threshold = 0;
    double low = 0, high = 0;  ///< both ends count: a guard against drift, fitted to what was measured
    /// What the sentence says. True of all of `low`..`high` where it holds, of none of it where it is refuted, and
    /// one of the two where it is qualified. Without one the sentence describes the number, and the interval is what it
    /// says.
    std::optional<Criterion> criterion;
    /// The interval was derived from so many draws (see `interval_of` in measure/claim); 0: it is not about anything
    /// random, or comes from elsewhere.
    int draws = 0;
};

std::string_view name_of(Claim::Verdict verdict);
std::string_view name_of(Claim::Profile profile);
std::string_view name_of(Claim::Evidence evidence);

/// All claims of a file. InputError with a position for anything that is not a claim; an id given twice is one.
std::vector<Claim> read_claims(const std::filesystem::path& path);

/// All `*.toml` of a folder, sorted, or the file itself.
std::vector<std::filesystem::path> claim_files(const std::filesystem::path& file_or_folder);

}  // namespace lostbits::scene::claim
