// A repaired form in words: which operations are done wider, which accuracy that keeps, that no operation can be
// spared, and how far the repair holds. Also its files: mend.csv (the form, the form with wider operations, the
// catalogue), minimal.csv (each wider operation, and the accuracy without it), probes.csv (the forms with axes
// exchanged, mirrored and rotated), mend.txt and datapackage.json.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "measure/repair/patch.hpp"
#include "measure/repair/price.hpp"
#include "measure/repair/repair.hpp"
#include "output/image/canvas.hpp"
#include "output/table/table.hpp"

namespace lostbits::output::repair {

using measure::choice::GrowthMargin;
using measure::repair::Price;
using measure::repair::RowQuality;

/// All results of a repair.
struct RepairSummary {
    const measure::repair::RepairRequest& request;
    const measure::repair::RepairResult& repair;
    /// Forms of the catalogue for the same primitives in the same format, most accurate first, and their accuracy.
    std::vector<measure::evaluate::TestedForm> catalogue;
    std::vector<RowQuality> catalogue_quality;
    std::vector<GrowthMargin> margins = {};  ///< margins of the form with its set
    /// Margins of each rewriting of the form; empty for one that fails the requirement.
    std::vector<std::vector<GrowthMargin>> rewritten_margins = {};
    std::vector<GrowthMargin> symmetric_margins = {};  ///< margins of the form with its symmetric set
    /// Times of the form, the set if there is one, the symmetric set if there is one, each rewriting, and the
    /// catalogue; empty if nothing was timed.
    std::vector<Price> prices = {};
    std::string no_price = {};  ///< reason why nothing was timed although times were requested
    /// For a function of a user's file: the patch of each proposal (`proposals_of`); empty for one that fails the
    /// requirement.
    std::vector<measure::repair::Patch> patches = {};

    [[nodiscard]] bool has_set() const { return repair.wider_set && !repair.wider_set->operations.empty(); }
};

/// Collects the results, with the catalogue, all margins and patches, but without times.
RepairSummary result_of(const measure::repair::RepairRequest& request, const measure::repair::RepairResult& repair);

/// A resulting form: the set, the symmetric set, or a rewriting of the form.
struct Proposal {
    Tape tape;
    const RowQuality *quality, *held_out;
    const std::vector<RowQuality>* probed;        ///< accuracy on each probe of the result
    const measure::repair::Rewritten* rewritten;  ///< null for the two sets
    const std::vector<NodeId>* wider;             ///< operations of the set; null for a rewriting
    bool symmetric = false;                       ///< true for the symmetric set
    const Price* price = nullptr;                 ///< null: not timed

    /// True if the proposal meets the requirement on every exact probe of the result.
    [[nodiscard]] bool is_symmetric(const RepairSummary& result) const;
};
/// All proposals; the set comes first if there is one, then the symmetric set.
std::vector<Proposal> proposals_of(const RepairSummary& result);
/// The recommended proposal among those that meet the requirement. Proposals that also meet it with axes exchanged and
/// mirrored come first, then the fastest in packs. If nothing was timed, the rewriting with the fewest operations comes
/// first, then the set. Null if none meets the requirement.
const Proposal* best_of(const std::vector<Proposal>& proposals, const RepairSummary& result);
/// Names of the rules: `cross products, stable roots`
std::string rules_of(const measure::repair::Rewritten& rewritten);
/// How a proposal was made: `3 of its 15 operations in double`, `written another way: cross products`.
std::string method_text(const RepairSummary& result, const Proposal& proposal);
/// Names of operations that are done wider: `c, disc`.
std::string names_of(const RepairSummary& result, const std::vector<NodeId>& operations);

/// Name of a wider format: `double`, `two floats`, `two doubles`.
std::string name_of_wider(const FloatFormat& wider);
/// `c = dot(o - centre, o - centre) - radius*radius`: an operation of the form's tape with the names of the source.
std::string operation_text(const RepairSummary& result, NodeId operation);
/// Statements of the form that `changed` changes, as a diff.
std::vector<std::string> changed_lines(const RepairSummary& result, const Tape& changed);
/// All that the command prints about the result, in several lines.
std::string in_words(const RepairSummary& result);

/// A row of mend.csv, of the plot and of the text: the form, a result, or a form of the catalogue.
struct FormRow {
    std::string_view kind;              ///< own, wider, symmetric, all_wider, rewritten, catalogue
    std::string name;                   ///< `sphere.half_b`, `3 of 20 in double`, `cross products, stable roots`
    measure::evaluate::TestedForm row;  ///< the row of the catalogue, or else that of the form
    std::size_t operations = 0;         ///< rounding operations; 0 for the catalogue
    std::size_t wide = 0;               ///< number of operations that are done wider
    const RowQuality* quality = nullptr;
    const RowQuality* held_out = nullptr;  ///< accuracy on rays that the search did not use; null: not measured
    const std::vector<RowQuality>* probed = nullptr;  ///< accuracy on each probe; null: not measured
    std::string rules = {};                           ///< rules that rewrote the form
    std::string wider = {};                           ///< format of the wider operations
    bool meets_requirement = false;                   ///< meets the requirement
    const Price* price = nullptr;                     ///< null: not timed
    bool front = false;  ///< the form was timed, and no other is at least as accurate and as fast, and better in one
    const std::vector<NodeId>* set = nullptr;  ///< operations of a set that are done wider; null if it is not a set
    /// Shown in the text. Of the catalogue, only the most accurate form and the front are shown, without the form
    /// itself.
    bool is_shown = true;

    [[nodiscard]] bool is_proposal() const { return kind == "wider" || kind == "symmetric" || kind == "rewritten"; }
};

/// The form, the set and the symmetric set if they exist, all operations wider, each rewriting, and the catalogue.
std::vector<FormRow> rows_of(const RepairSummary& result);

/// Summary of what a row changes: `c, disc in double: 12.0 → 22.1 bits, no wrong decision, +0.3 ns a ray`.
std::string change_text(const RepairSummary& result, const FormRow& row);

/// Plots kept bits of all rows against their time in packs, or against the number of wider operations if nothing was
/// timed.
image::Canvas front_plot(const RepairSummary& result);

/// A row of minimal.csv: the form without one of the wider operations.
struct MinimalRow {
    std::string operation;
    int step;  ///< index among the operations that do not depend only on constants
    const RowQuality* without;
    bool meets_requirement;
};
/// A row of probes.csv: a form on the rays of a probe.
struct ProbeRow {
    FormRow form;
    std::string_view probe;
    const RowQuality* quality;
    bool meets_requirement;
};
table::Table<ProbeRow> probe_table();
std::vector<ProbeRow> probe_rows(const RepairSummary& result);
table::Table<FormRow> form_table();
table::Table<MinimalRow> minimal_table();
std::vector<MinimalRow> minimal_rows(const RepairSummary& result);

/// Opens the files before the work and gives them their final names when they are complete.
class RepairFiles {
public:
    explicit RepairFiles(const std::filesystem::path& folder);
    void finish(const RepairSummary& result);
    [[nodiscard]] const std::filesystem::path& folder() const { return folder_; }

private:
    std::filesystem::path folder_;
    table::TableFile<FormRow> forms_;
    table::TableFile<MinimalRow> minimal_;
    table::TableFile<ProbeRow> probes_;
};

/// A proposal as a header that holds `mended.NAME`, for the compiler. `command` is the command that made it.
measure::repair::RepairedSource written(const RepairSummary& result, const Proposal& proposal, const std::string& name,
                                        const std::string& command);

/// The text of a file with the best proposal: `NAME.hpp` holds `mended.NAME`, `NAME.glsl` the function NAME, and
/// `NAME.patch` is its patch. Throws InputError if no proposal meets the requirement or there is no patch, and the
/// errors of `shader_code`.
std::string emitted(const RepairSummary& result, const std::filesystem::path& file, const std::string& command);

}  // namespace lostbits::output::repair
