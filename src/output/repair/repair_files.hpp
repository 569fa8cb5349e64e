// Text and files of a repaired form. The repair either does some operations in wider arithmetic (the wider set, from
// which no operation can be left out) or rewrites the formula. The files are mend.csv (the form, its repairs and the
// catalogue), minimal.csv (each operation of the wider set, and the accuracy without it), probes.csv (the forms on
// rays with axes exchanged, mirrored and rotated), mend.txt and datapackage.json.
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

using measure::choose::GrowthMargin;
using measure::repair::FormQuality;
using measure::repair::Price;

/// All results of a repair.
struct RepairSummary {
    const measure::repair::RepairRequest& request;
    const measure::repair::RepairResult& repair;
    /// Forms of the catalogue for the same primitives in the same format, most accurate first, and their accuracy.
    std::vector<measure::evaluate::TestedForm> catalogue;
    std::vector<FormQuality> catalogue_quality;
    std::vector<GrowthMargin> margins = {};  ///< margins of the form with its wider set
    /// Margins of each rewriting of the form. The list of a rewriting that fails the requirement is empty.
    std::vector<std::vector<GrowthMargin>> rewritten_margins = {};
    std::vector<GrowthMargin> symmetric_margins = {};  ///< margins of the form with its symmetric set
    /// Times of the form, the wider set if there is one, the symmetric set if there is one, each rewriting, and the
    /// catalogue. Empty if nothing was timed.
    std::vector<Price> prices = {};
    std::string no_price_reason = {};  ///< reason why nothing was timed although times were requested
    /// Patch of each proposal (see `list_proposals`) for a function of a user's file. The patch of a proposal that
    /// fails the requirement is empty.
    std::vector<measure::repair::Patch> patches = {};

    /// True if a wider set was found and is not empty. An empty set means that the form meets the requirement as it is.
    [[nodiscard]] bool has_wider_set() const { return repair.wider_set && !repair.wider_set->operations.empty(); }
};

/// Collects the results. Measures the catalogue and all margins, and makes the patches, but measures no times.
RepairSummary summarise_repair(const measure::repair::RepairRequest& request,
                               const measure::repair::RepairResult& repair);

/// A proposed repair: the form with the wider set, with the symmetric set, or rewritten. The symmetric set treats x, y
/// and z alike.
struct Proposal {
    Tape tape;
    const FormQuality* quality;                                 ///< accuracy on the rays of the search
    const FormQuality* held_out_quality;                        ///< accuracy on rays that the search did not use
    const std::vector<FormQuality>* probe_qualities;            ///< accuracy on each probe
    const measure::repair::RewrittenForm* rewritten = nullptr;  ///< null for the two sets
    const std::vector<NodeId>* wider_operations = nullptr;      ///< operations of the set; null for a rewriting
    bool is_symmetric_set = false;
    const Price* price = nullptr;  ///< null: not timed

    /// True if the proposal meets the requirement on every exact probe, that is, with axes permuted or mirrored.
    [[nodiscard]] bool meets_on_exact_probes(const RepairSummary& summary) const;
};
/// Lists all proposals: the wider set if there is one, the symmetric set if there is one, then the rewritings.
std::vector<Proposal> list_proposals(const RepairSummary& summary);
/// The recommended proposal among those that meet the requirement; null if none does. Proposals that also meet it on
/// every exact probe come first, then the fastest in packs. If nothing was timed, the rewriting with the fewest
/// operations comes before the sets.
const Proposal* best_proposal(const std::vector<Proposal>& proposals, const RepairSummary& summary);
/// Names of the rules that made a rewriting: `cross products, stable roots`.
std::string rule_names(const measure::repair::RewrittenForm& rewritten);
/// How a proposal was made: `3 of its 15 operations in double`, `written another way: cross products`.
std::string method_text(const RepairSummary& summary, const Proposal& proposal);
/// Names of the statements that operations belong to: `c, disc`.
std::string statement_names(const RepairSummary& summary, const std::vector<NodeId>& operations);

/// Name of a wider format: `double`, `two floats`, `two doubles`.
std::string wider_format_name(const FloatFormat& wider);
/// `c = dot(o - centre, o - centre) - radius*radius`: an operation of the form's tape with the names of the source.
std::string operation_text(const RepairSummary& summary, NodeId operation);
/// Statements of the form that `changed` changes, as a diff.
std::vector<std::string> changed_lines(const RepairSummary& summary, const Tape& changed);
/// Text that `lostbits mend` prints about the repair, in several lines.
std::string repair_text(const RepairSummary& summary);

/// A row of mend.csv, of the plot and of the text: the form as it is, a repaired form, or a form of the catalogue.
struct FormRow {
    std::string_view kind;  ///< own, wider, symmetric, all_wider, rewritten, catalogue
    std::string name;       ///< `sphere.half_b`, `3 of 20 in double`, `cross products, stable roots`
    measure::evaluate::TestedForm tested_form;  ///< the form of the catalogue; otherwise the form that was repaired
    std::size_t rounding_operation_count = 0;   ///< number of rounding operations; 0 for the catalogue
    std::size_t wider_operations = 0;           ///< number of operations that are done wider
    const FormQuality* quality = nullptr;
    /// Accuracy on rays that the search did not use; null: not measured.
    const FormQuality* held_out_quality = nullptr;
    const std::vector<FormQuality>* probe_qualities = nullptr;  ///< accuracy on each probe; null: not measured
    std::string rules = {};                                     ///< rules that rewrote the form
    std::string wider_format = {};                              ///< format of the wider operations
    bool meets_requirement = false;
    const Price* price = nullptr;  ///< null: not timed
    /// True if the form was timed, and no other is at least as accurate and as fast, and better in one of the two.
    bool is_on_pareto_front = false;
    const std::vector<NodeId>* wider_set = nullptr;  ///< operations of the wider or symmetric set; null for other rows
    /// True if the text shows the row. Of the catalogue, the text shows only the most accurate form and the forms on
    /// the Pareto front, and never the form that was repaired.
    bool is_shown = true;

    [[nodiscard]] bool is_proposal() const { return kind == "wider" || kind == "symmetric" || kind == "rewritten"; }
};

/// Rows of the form, the wider set and the symmetric set if they exist, all operations wider, each rewriting, and the
/// catalogue.
std::vector<FormRow> make_form_rows(const RepairSummary& summary);

/// Summary of what a row changes: `c, disc in double: 12.0 → 22.1 bits, no wrong decision, +0.3 ns a ray`.
std::string change_text(const RepairSummary& summary, const FormRow& row);

/// Plots the kept bits of all rows against their time in packs, or against the number of wider operations if nothing
/// was timed.
image::Canvas draw_pareto_plot(const RepairSummary& summary);

/// A row of minimal.csv: the form with one operation of the wider set left as it was.
struct MinimalRow {
    std::string operation;
    int step;                            ///< index among the operations that do not depend only on constants, from 1
    const FormQuality* quality_without;  ///< accuracy with this operation as it was and the others wider
    bool meets_requirement;
};
/// A row of probes.csv: a form on the rays of a probe.
struct ProbeRow {
    FormRow form;
    std::string_view probe;
    const FormQuality* quality;
    bool meets_requirement;
};
table::Table<ProbeRow> probe_table();
std::vector<ProbeRow> probe_rows(const RepairSummary& summary);
table::Table<FormRow> make_form_table();
table::Table<MinimalRow> make_minimal_table();
std::vector<MinimalRow> make_minimal_rows(const RepairSummary& summary);

/// Opens the files before the work and gives them their final names when they are complete.
class RepairWriter {
public:
    explicit RepairWriter(const std::filesystem::path& folder);
    void finish(const RepairSummary& summary);
    [[nodiscard]] const std::filesystem::path& folder() const { return folder_; }

private:
    std::filesystem::path folder_;
    table::TableFile<FormRow> forms_;
    table::TableFile<MinimalRow> minimal_;
    table::TableFile<ProbeRow> probes_;
};

/// Writes a proposal as a C++ header with the form `mended.NAME`, for the compiler. `command` is the command line that
/// made the proposal.
measure::repair::RepairedSource make_repaired_source(const RepairSummary& summary, const Proposal& proposal,
                                                     const std::string& name, const std::string& command);

/// Text of the file that --emit writes for the best proposal: `NAME.hpp` holds the form `mended.NAME`, `NAME.glsl` the
/// function NAME, and `NAME.patch` the patch. Throws InputError if no proposal meets the requirement or there is no
/// patch, and the errors of `shader_code`.
std::string emitted_file_text(const RepairSummary& summary, const std::filesystem::path& file,
                              const std::string& command);

}  // namespace lostbits::output::repair
