#include "output/repair/repair_files.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "number/error.hpp"
#include "output/choose/choice_files.hpp"
#include "output/file/atomic_file.hpp"
#include "output/map/form_names.hpp"
#include "output/repair/form_code.hpp"
#include "output/table/shared_columns.hpp"
#include "output/trade/trade_files.hpp"

namespace lostbits::output::repair {

using measure::trade::ParetoPoint;
using table::or_missing;
using table::Table;
using table::when;

namespace {

/// Point of a row in the plot: its kept bits against its time or, without a time, its number of wider operations.
ParetoPoint point_of(const FormRow& row) {
    return {row.price ? row.price->packed.median * 1e9 : static_cast<double>(row.wider_operations),
            row.quality->wrong_fraction(), row.quality->kept_bits};
}

std::string kept_bits_text(const FormQuality& quality, const measure::choose::Requirement& requirement) {
    return std::isnan(quality.kept_bits) ? "no" : choose::kept_bits_text(quality.kept_bits, requirement);
}

/// Kinds of markers in the plot, for `draw_marker`.
constexpr int catalogue_marker = 0, wider_marker = 1, rewritten_marker = 2, own_marker = 3;

int marker_of(const FormRow& row) {
    return row.kind == "catalogue"   ? catalogue_marker
           : row.kind == "own"       ? own_marker
           : row.kind == "rewritten" ? rewritten_marker
                                     : wider_marker;
}

FormRow make_proposal_row(const RepairSummary& summary, const Proposal& proposal) {
    const auto& repair = summary.repair;
    const auto& original_row = summary.request.tested_form;
    if (proposal.rewritten)
        return {"rewritten",
                rule_names(*proposal.rewritten),
                original_row,
                proposal.rewritten->rounding_operation_count,
                proposal.rewritten->wider_set ? proposal.rewritten->wider_set->operations.size() : 0,
                proposal.quality,
                proposal.held_out_quality,
                proposal.probe_qualities,
                rule_names(*proposal.rewritten)};

    const std::string name = fmt::format("{} of {} in {}", proposal.wider_operations->size(),
                                         repair.rounding_operation_count, wider_format_name(repair.wider));
    FormRow row{proposal.is_symmetric_set ? "symmetric" : "wider",
                proposal.is_symmetric_set ? name + ", symmetric" : name,
                original_row,
                repair.rounding_operation_count,
                proposal.wider_operations->size(),
                proposal.quality,
                proposal.held_out_quality,
                proposal.probe_qualities};
    row.wider_set = proposal.wider_operations;
    return row;
}

/// Row of the form with all of its operations wider.
FormRow make_all_wider_row(const RepairSummary& summary) {
    const auto& repair = summary.repair;
    return {"all_wider",
            fmt::format("all {} in {}", repair.rounding_operation_count, wider_format_name(repair.wider)),
            summary.request.tested_form,
            repair.rounding_operation_count,
            repair.rounding_operation_count,
            &repair.all_wider_quality,
            repair.wider_set ? nullptr : &repair.set_held_out_quality,
            repair.wider_set ? nullptr : &repair.set_probe_qualities};
}

/// Gives the rows their times, in the order of `RepairSummary::prices`, and marks the rows on the Pareto front.
void set_prices(std::vector<FormRow>& rows, const RepairSummary& summary) {
    std::vector<FormRow*> timed_forms;
    std::vector<ParetoPoint> points;
    for (FormRow& row : rows) {
        if (timed_forms.size() == summary.prices.size() || row.kind == "all_wider") continue;
        row.price = &summary.prices[timed_forms.size()];
        timed_forms.push_back(&row);
        points.push_back(point_of(row));
    }
    const auto is_dominated = find_dominated(points);
    for (std::size_t k = 0; k < timed_forms.size(); ++k) timed_forms[k]->is_on_pareto_front = !is_dominated[k];
}

}  // namespace

std::vector<FormRow> make_form_rows(const RepairSummary& summary) {
    const auto& repair = summary.repair;
    const auto& original_row = summary.request.tested_form;
    std::vector<FormRow> rows{{"own", std::string(original_row.form->info->name), original_row,
                               repair.rounding_operation_count, 0, &repair.own_quality, &repair.own_held_out_quality,
                               &repair.own_probe_qualities}};

    // All operations wider come after the sets and before the rewritings.
    const auto add_proposal = [&](const Proposal& proposal) { rows.push_back(make_proposal_row(summary, proposal)); };
    const auto proposals = list_proposals(summary);
    const auto rewritten =
        std::ranges::find_if(proposals, [](const Proposal& proposal) { return proposal.rewritten != nullptr; });
    std::for_each(proposals.begin(), rewritten, add_proposal);
    rows.push_back(make_all_wider_row(summary));
    std::for_each(rewritten, proposals.end(), add_proposal);
    for (FormRow& row : rows) row.wider_format = row.wider_operations == 0 ? "" : wider_format_name(repair.wider);

    const std::size_t first_of_catalogue = rows.size();
    for (std::size_t k = 0; k < summary.catalogue.size(); ++k)
        rows.push_back({.kind = "catalogue",
                        .name = std::string(summary.catalogue[k].form->info->name),
                        .tested_form = summary.catalogue[k],
                        .quality = &summary.catalogue_quality[k]});

    // Compare the rows with the requirement and with each other.
    for (FormRow& row : rows) row.meets_requirement = row.quality->meets(summary.request.requirement);
    set_prices(rows, summary);
    for (std::size_t k = first_of_catalogue; k < rows.size(); ++k)
        rows[k].is_shown =
            (rows[k].is_on_pareto_front || k == first_of_catalogue) && rows[k].tested_form.form != original_row.form;
    return rows;
}

std::string change_text(const RepairSummary& summary, const FormRow& row) {
    const FormQuality &old_quality = summary.repair.own_quality, &new_quality = *row.quality;
    const auto& requirement = summary.request.requirement;
    std::string text = fmt::format(
        "{}: {} → {} bits, {}",
        row.wider_set
            ? fmt::format("{} in {}", statement_names(summary, *row.wider_set), wider_format_name(summary.repair.wider))
            : row.name,
        kept_bits_text(old_quality, requirement), kept_bits_text(new_quality, requirement),
        new_quality.wrong_count == 0 ? "no wrong decision"
                                     : fmt::format("{} wrong decisions", new_quality.wrong_count));
    if (old_quality.wrong_count != new_quality.wrong_count)
        text += fmt::format(" instead of {}", old_quality.wrong_count);
    if (row.price)
        text +=
            fmt::format(", {:+.2g} ns a ray", (row.price->packed.median - summary.prices.front().packed.median) * 1e9);
    return text;
}

namespace {

/// Points of the plot: the form, its repairs, and the forms of the catalogue that can be compared with them.
std::vector<trade::KernelPoint> repair_points(const RepairSummary& summary, const std::vector<FormRow>& rows) {
    const bool is_timed = !summary.prices.empty();
    std::vector<trade::KernelPoint> points;
    for (const FormRow& row : rows) {
        const bool is_of_repair = row.kind != "catalogue";
        // Forms of the catalogue that compute in a wider format have no count of wider operations.
        const bool can_be_drawn = is_timed ? row.price != nullptr
                                           : is_of_repair || measure::choose::computing_format(row.tested_form).name ==
                                                                 row.tested_form.format.name;
        if (!can_be_drawn || (!is_of_repair && row.tested_form.form == summary.request.tested_form.form)) continue;

        points.push_back({.tested_form = row.tested_form,
                          .quality = point_of(row),
                          .time = row.price ? std::optional(row.price->packed) : std::nullopt,
                          .marker = marker_of(row),
                          .is_named = is_of_repair,
                          .is_hollow = !row.quality->decides_as_required(summary.request.requirement),
                          .label = is_of_repair ? row.name : map::short_name(*row.tested_form.form->info)});
    }
    return points;
}

}  // namespace

image::Canvas draw_pareto_plot(const RepairSummary& summary) {
    const auto& requirement = summary.request.requirement;
    const bool is_timed = !summary.prices.empty();
    plot::ScatterPlotSpec spec;
    spec.title = fmt::format("{} against kept bits: {} on {}", is_timed ? "Time" : "Wider operations",
                             summary.request.tested_form.form->info->name, summary.request.id());
    spec.subtitle = {
        fmt::format("Required: {}.", choose::requirement_text(requirement)),
        "Named: the form, its repairs, and the Pareto front, on which fewer wrong decisions count before more bits." +
            (is_timed ? std::string()
                      : " The catalogue: only forms in " + summary.request.tested_form.format.name + ".")};
    if (is_timed)
        spec.x = {.title = "time per ray and primitive in packs, ns",
                  .scale = plot::AxisSpec::Scale::log2,
                  .has_decimal_ticks = true};
    else spec.x = {.title = "operations in " + wider_format_name(summary.repair.wider), .low = 0.0};
    spec.y = {.title = "bits kept"};

    // The points refer to the rows.
    const std::vector<FormRow> rows = make_form_rows(summary);
    trade::add_kernel_points(spec, repair_points(summary, rows));
    spec.legend = {{"the form", own_marker, plot::ink_colour},
                   {"operations in " + wider_format_name(summary.repair.wider), wider_marker, plot::ink_colour},
                   {"written another way", rewritten_marker, plot::ink_colour},
                   {"catalogue", catalogue_marker, plot::ink_colour},
                   {.label = "decides more rays wrongly than allowed",
                    .marker = catalogue_marker,
                    .colour = plot::ink_colour,
                    .is_hollow = true},
                   {.label = "not on the Pareto front", .marker = catalogue_marker, .colour = 0, .is_faint = true}};
    return plot::draw_scatter_plot(spec);
}

Table<FormRow> make_form_table() {
    using R = FormRow;
    Table<R> table{
        {"kind",
         "own: the form; wider: with a minimal set of its operations wider; symmetric: with a set that treats x, y and "
         "z alike; all_wider: with all of them wider; rewritten: the form written another way; catalogue",
         &R::kind}};

    // The form, and what was changed in it.
    table.add(table::make_subject_columns("form", "of its inputs and answers"), &R::tested_form);
    table.add({{"wider", "format of the wider operations; missing if no operation is wider", &R::wider_format},
               {"wider_operations", "number of its operations that are done wider; missing for the catalogue",
                [](const R& r) { return when(r.rounding_operation_count != 0, r.wider_operations); }},
               {"operations", "number of its rounding operations; missing for the catalogue",
                [](const R& r) { return when(r.rounding_operation_count != 0, r.rounding_operation_count); }},
               {"rules", "rules that rewrote it, in order; missing if it was not rewritten", &R::rules}});

    // Accuracy on the rays of the search, and on others.
    table.add(choose::make_quality_columns(), &R::quality);
    table.add({"meets", "true if it meets the requirement", &R::meets_requirement});
    table.add<FormQuality>(
        {{"apart_rays", "rays that the search did not use; missing if they were not measured", &FormQuality::ray_count},
         {"apart_wrong", "number of these that are decided wrongly", &FormQuality::wrong_count},
         {"apart_kept_bits", "bits", "bits kept on these", or_missing(&FormQuality::kept_bits)}},
        &R::held_out_quality);

    // Times.
    using P = Price;
    table.add<P>(
        {{"isa", "registers of `time_ns`; missing, like the times, if nothing was compiled", &P::isa},
         {"time_ns", "ns", "per ray and primitive in packs, median", [](const P& p) { return p.packed.median * 1e9; }},
         {"single_time_ns", "ns", "per ray and primitive, one ray at a time, median",
          [](const P& p) { return p.single.median * 1e9; }}},
        &R::price);
    return table.add(
        {"front", "true if no other form is at least as accurate and as fast in packs, and better in one of the two",
         [](const R& r) { return when(r.price != nullptr, r.is_on_pareto_front); }});
}

Table<MinimalRow> make_minimal_table() {
    using R = MinimalRow;
    return {
        {"operation",
         "operation of the set with its name in the source; this row is for the form with this operation as it was and "
         "the others wider",
         &R::operation},
        {"step", "its index among the form's operations, from 1; operations on constants alone are not counted",
         &R::step},
        {"rays", "rays whose truth is known", [](const R& r) { return r.quality_without->ray_count; }},
        {"wrong", "rays decided wrongly without it", [](const R& r) { return r.quality_without->wrong_count; }},
        {"kept_bits", "bits", "bits kept without it",
         or_missing([](const R& r) { return r.quality_without->kept_bits; })},
        {"meets", "true if the requirement is met without it: always 0, or the set would not be minimal",
         &R::meets_requirement}};
}

namespace {

/// For each node, the number of operations up to it that do not depend only on constants.
std::vector<int> count_steps(const Tape& tape) {
    std::vector<int> steps;
    std::vector<bool> is_constant;
    int step = 0;
    for (NodeId i = 0; i < tape.size(); ++i) {
        const TapeOp op = tape[i].op;
        const auto operands = tape.operands_of(i);
        is_constant.push_back(op == TapeOp::constant ||
                              (!operands.empty() && std::ranges::all_of(operands, [&](NodeId operand) {
                                  return static_cast<bool>(is_constant[operand]);
                              })));
        step += !is_given(op) && !is_constant.back();
        steps.push_back(step);
    }
    return steps;
}

}  // namespace

std::vector<MinimalRow> make_minimal_rows(const RepairSummary& summary) {
    std::vector<MinimalRow> rows;
    if (!summary.has_wider_set()) return rows;
    const measure::repair::WiderSet& wider_set = *summary.repair.wider_set;
    const std::vector<int> steps = count_steps(summary.repair.tape);
    for (std::size_t k = 0; k < wider_set.operations.size(); ++k)
        rows.push_back({operation_text(summary, wider_set.operations[k]), steps[wider_set.operations[k]],
                        &wider_set.quality_without[k],
                        wider_set.quality_without[k].meets(summary.request.requirement)});
    return rows;
}

Table<ProbeRow> probe_table() {
    using R = ProbeRow;
    Table<R> table{
        {"kind", "the form on these rays, as in mend.csv", [](const R& r) { return r.form.kind; }},
        {"name", "the set or the rules; the form's own name for own", [](const R& r) { return r.form.name; }},
        {"probe",
         "rays and primitives moved together: yzx, zxy, yxz: axes in that order; mirrored: in x, y and z; "
         "quarter_turn: about z; rotated: by 147 degrees about (1, 2, 3)",
         &R::probe}};
    table.add<FormQuality>({{"rays", "rays whose truth is known", &FormQuality::ray_count},
                            {"wrong", "number of these that are decided wrongly", &FormQuality::wrong_count},
                            {"kept_bits", "bits", "bits kept", or_missing(&FormQuality::kept_bits)}},
                           &R::quality);
    return table.add({"meets", "true if it meets the requirement there", &R::meets_requirement});
}

std::vector<ProbeRow> probe_rows(const RepairSummary& summary) {
    std::vector<ProbeRow> rows;
    for (const FormRow& form : make_form_rows(summary))
        for (std::size_t k = 0; form.probe_qualities && k < form.probe_qualities->size(); ++k)
            rows.push_back({form, summary.repair.probes[k]->name, &(*form.probe_qualities)[k],
                            (*form.probe_qualities)[k].meets(summary.request.requirement)});
    return rows;
}

RepairWriter::RepairWriter(const std::filesystem::path& folder)
    : folder_(folder),
      forms_(folder, "mend.csv", "One row per form: the form, with wider operations, rewritten, or of the catalogue",
             make_form_table()),
      minimal_(folder, "minimal.csv", "One row per operation that is done wider", make_minimal_table()),
      probes_(folder, "probes.csv", "One row per form and probe: the scene with axes exchanged, mirrored or rotated",
              probe_table()) {}

void RepairWriter::finish(const RepairSummary& summary) {
    forms_.add_all(make_form_rows(summary));
    minimal_.add_all(make_minimal_rows(summary));
    probes_.add_all(probe_rows(summary));
    file::write_file(folder_ / "mend.txt", repair_text(summary));
    table::close_tables(folder_, fmt::format("Mended: {}", summary.request.id()), forms_, minimal_, probes_);
}

namespace {

FormTexts make_texts(const RepairSummary& summary, const Proposal& proposal, const std::string& name,
                     const std::string& command) {
    const auto& repair = summary.repair;
    const std::string form_name(summary.request.tested_form.form->info->name);
    const std::string method = method_text(summary, proposal);

    // Lines of the comment at the top.
    std::vector<std::string> head_lines{
        fmt::format("{}, {}:", form_name, method),
        fmt::format("{} on every {} of {}.", choose::requirement_text(summary.request.requirement),
                    summary.request.scene ? "pixel" : "ray kept", summary.request.id()),
        "Made by " + command};
    if (summary.request.tested_form.form->has_transform_method)
        head_lines.emplace_back(are_matrices_inverse(summary.request)
                                    ? "The matrix maps from the world to the primitive, row by row."
                                    : "The matrix maps from the primitive to the world, row by row.");

    return {.name = name,
            .title = form_name + ", " + method,
            .source = command,
            .head_lines = std::move(head_lines),
            .uses_two_words = repair.wider != binary64,
            .is_binary32_only = repair.wider == binary64 && (!proposal.rewritten || proposal.rewritten->wider_set)};
}

/// The patch of proposal `k` for --emit. Throws InputError if no patch can be written.
std::string emitted_patch(const RepairSummary& summary, std::size_t k, const std::filesystem::path& file) {
    if (summary.patches.empty())
        throw InputError(fmt::format("--emit {}: {} is not a function of --function; write .hpp or .glsl",
                                     file.string(), summary.request.tested_form.form->info->name));
    const auto& patch = summary.patches[k];
    if (patch.diff.empty())
        throw InputError(fmt::format("--emit {}: cannot write a patch of {}: {}; write .hpp", file.string(), patch.file,
                                     patch.reason));
    return patch.diff;
}

}  // namespace

measure::repair::RepairedSource make_repaired_source(const RepairSummary& summary, const Proposal& proposal,
                                                     const std::string& name, const std::string& command) {
    const FormTexts texts = make_texts(summary, proposal, "mended." + name, command);
    return {&proposal.tape, form_header(proposal.tape, *summary.request.tested_form.form, texts),
            fmt::format("lostbits::intersect::{}::{}", row_of(summary.request.tested_form.form->shape).name,
                        type_name(name)),
            summary.request.tested_form};
}

std::string emitted_file_text(const RepairSummary& summary, const std::filesystem::path& file,
                              const std::string& command) {
    const auto proposals = list_proposals(summary);
    const Proposal* const best = best_proposal(proposals, summary);
    if (!best)
        throw InputError(fmt::format(
            "--emit {}: no other form of {} was found that meets the requirement, so there is nothing to write; {}",
            file.string(), summary.request.tested_form.form->info->name,
            summary.repair.wider_set ? "it meets the requirement as it is"
                                     : "it also fails with all operations wider"));
    if (file.extension() == ".patch")
        return emitted_patch(summary, static_cast<std::size_t>(best - proposals.data()), file);

    const bool is_shader = file.extension() == ".glsl";
    const FormTexts texts = make_texts(summary, *best, (is_shader ? "" : "mended.") + file.stem().string(), command);
    return is_shader ? shader_code(best->tape, *summary.request.tested_form.form, texts)
                     : form_header(best->tape, *summary.request.tested_form.form, texts);
}

}  // namespace lostbits::output::repair
