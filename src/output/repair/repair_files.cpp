#include "output/repair/repair_files.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "number/error.hpp"
#include "output/choice/choice_files.hpp"
#include "output/file/atomic_file.hpp"
#include "output/map/row_names.hpp"
#include "output/repair/form_code.hpp"
#include "output/speed/trade_files.hpp"
#include "output/table/shared_columns.hpp"

namespace lostbits::output::repair {

using measure::speed::ParetoPoint;
using table::or_missing;
using table::Table;
using table::when;

namespace {

/// Point of a row in the plane of bits and time, or of bits and number of wider operations.
ParetoPoint point_of(const FormRow& row) {
    return {row.price ? row.price->packed.median * 1e9 : static_cast<double>(row.wide), row.quality->wrong_fraction(),
            row.quality->kept_bits};
}

std::string bits_of(const RowQuality& quality, const measure::choice::Requirement& requirement) {
    return std::isnan(quality.kept_bits) ? "no" : choice::bits_text_near(quality.kept_bits, requirement);
}

int marker_of(const FormRow& row) {
    return row.kind == "catalogue" ? 0 : row.kind == "own" ? 3 : row.kind == "rewritten" ? 2 : 1;
}

}  // namespace

std::vector<FormRow> rows_of(const RepairSummary& r) {
    const auto& repair = r.repair;
    const auto& own_row = r.request.row;
    const std::string wider = name_of_wider(repair.wider);
    std::vector<FormRow> rows{{"own", std::string(own_row.form->info->name), own_row, repair.operations, 0,
                               &repair.own_quality, &repair.own_held_out, &repair.own_probed}};
    const auto add_proposal = [&](const Proposal& proposal) {
        if (proposal.rewritten)
            return rows.push_back({"rewritten", rules_of(*proposal.rewritten), own_row, proposal.rewritten->operations,
                                   proposal.rewritten->wider_set ? proposal.rewritten->wider_set->operations.size() : 0,
                                   proposal.quality, proposal.held_out, proposal.probed,
                                   rules_of(*proposal.rewritten)});
        const std::string name = fmt::format("{} of {} in {}", proposal.wider->size(), repair.operations, wider);
        rows.push_back({proposal.symmetric ? "symmetric" : "wider", proposal.symmetric ? name + ", symmetric" : name,
                        own_row, repair.operations, proposal.wider->size(), proposal.quality, proposal.held_out,
                        proposal.probed});
        rows.back().set = proposal.wider;
    };
    const auto proposals = proposals_of(r);
    const auto rewritten = std::ranges::find_if(proposals, [](const Proposal& p) { return p.rewritten != nullptr; });
    std::for_each(proposals.begin(), rewritten, add_proposal);
    rows.push_back({"all_wider", fmt::format("all {} in {}", repair.operations, wider), own_row, repair.operations,
                    repair.operations, &repair.all_wider_quality, repair.wider_set ? nullptr : &repair.set_held_out,
                    repair.wider_set ? nullptr : &repair.set_probed});
    std::for_each(rewritten, proposals.end(), add_proposal);
    for (FormRow& row : rows) row.wider = row.wide == 0 ? "" : wider;
    const std::size_t first_of_catalogue = rows.size();
    for (std::size_t k = 0; k < r.catalogue.size(); ++k)
        rows.push_back({.kind = "catalogue",
                        .name = std::string(r.catalogue[k].form->info->name),
                        .row = r.catalogue[k],
                        .quality = &r.catalogue_quality[k]});
    for (FormRow& row : rows) row.meets_requirement = row.quality->meets(r.request.requirement);
    std::vector<FormRow*> timed_rows;
    std::vector<ParetoPoint> points;
    for (FormRow& row : rows) {
        if (timed_rows.size() == r.prices.size() || row.kind == "all_wider") continue;
        row.price = &r.prices[timed_rows.size()];
        timed_rows.push_back(&row);
        points.push_back(point_of(row));
    }
    const auto is_dominated = dominated(points);
    for (std::size_t k = 0; k < timed_rows.size(); ++k) timed_rows[k]->front = !is_dominated[k];
    for (std::size_t k = first_of_catalogue; k < rows.size(); ++k)
        rows[k].is_shown = (rows[k].front || k == first_of_catalogue) && rows[k].row.form != own_row.form;
    return rows;
}

std::string change_text(const RepairSummary& r, const FormRow& row) {
    const RowQuality &old_quality = r.repair.own_quality, &new_quality = *row.quality;
    const auto& requirement = r.request.requirement;
    std::string text = fmt::format(
        "{}: {} → {} bits, {}",
        row.set ? fmt::format("{} in {}", names_of(r, *row.set), name_of_wider(r.repair.wider)) : row.name,
        bits_of(old_quality, requirement), bits_of(new_quality, requirement),
        new_quality.wrong == 0 ? "no wrong decision" : fmt::format("{} wrong decisions", new_quality.wrong));
    if (old_quality.wrong != new_quality.wrong) text += fmt::format(" instead of {}", old_quality.wrong);
    if (row.price)
        text += fmt::format(", {:+.2g} ns a ray", (row.price->packed.median - r.prices.front().packed.median) * 1e9);
    return text;
}

image::Canvas front_plot(const RepairSummary& r) {
    const auto& requirement = r.request.requirement;
    const bool is_timed = !r.prices.empty();
    plot::ScatterPlotSpec spec;
    spec.title = fmt::format("{} against kept bits: {} on {}", is_timed ? "Time" : "Wider operations",
                             r.request.row.form->info->name, r.request.id());
    spec.subtitle = {
        fmt::format("Required: {}.", choice::in_words(requirement)),
        "Named: the form, its repairs, and the Pareto front, on which fewer wrong decisions count before more bits." +
            (is_timed ? std::string() : " The catalogue: only forms in " + r.request.row.format.name + ".")};
    if (is_timed)
        spec.x = {"time per ray and primitive in packs, ns", plot::AxisSpec::Scale::log2, {}, {}, false, true};
    else spec.x = {"operations in " + name_of_wider(r.repair.wider), plot::AxisSpec::Scale::linear, 0.0, {}};
    spec.y = {"bits kept", plot::AxisSpec::Scale::linear, {}, {}};
    const std::vector<FormRow> rows = rows_of(r);
    std::vector<speed::FrontPoint> points;
    for (const FormRow& row : rows) {
        const bool is_own = row.kind != "catalogue";
        // The operations inside a form of the catalogue that are already wider are not counted.
        const bool can_be_drawn = is_timed
                                      ? row.price != nullptr
                                      : is_own || measure::choice::computes_in(row.row).name == row.row.format.name;
        if (!can_be_drawn || (!is_own && row.row.form == r.request.row.form)) continue;
        points.push_back({.row = row.row,
                          .quality = point_of(row),
                          .time = row.price ? std::optional(row.price->packed) : std::nullopt,
                          .marker = marker_of(row),
                          .named = is_own,
                          .hollow = !row.quality->decides(requirement),
                          .label = is_own ? row.name : map::short_name(*row.row.form->info)});
    }
    speed::add_front(spec, points);
    spec.keys = {{"the form", 3, plot::ink_colour},
                 {"operations in " + name_of_wider(r.repair.wider), 1, plot::ink_colour},
                 {"written another way", 2, plot::ink_colour},
                 {"catalogue", 0, plot::ink_colour},
                 {"decides more rays wrongly than allowed", 0, plot::ink_colour, false, true},
                 {"not on the Pareto front", 0, 0, true}};
    return plot::scatter_plot(spec);
}

Table<FormRow> form_table() {
    using R = FormRow;
    Table<R> table{
        {"kind",
         "own: the form; wider: with a minimal set of its operations wider; symmetric: with a set that treats x, y and "
         "z alike; all_wider: with all of them wider; rewritten: the form written another way; catalogue",
         &R::kind}};
    table.add(table::subject_columns("form", "of its inputs and answers"), &R::row);
    table.add({{"wider", "format of the wider operations; missing if there are none", &R::wider},
               {"wider_operations", "number of its operations that are done wider; missing for the catalogue",
                [](const R& r) { return when(r.operations != 0, r.wide); }},
               {"operations", "number of its rounding operations; missing for the catalogue",
                [](const R& r) { return when(r.operations != 0, r.operations); }},
               {"rules", "rules that rewrote it, in order; missing if it was not rewritten", &R::rules}});
    table.add(choice::quality_columns(), &R::quality);
    table.add({"meets", "true if it meets the requirement", &R::meets_requirement});
    table.add<RowQuality>(
        {{"apart_rays", "rays that the search did not use; missing if they were not measured", &RowQuality::rays},
         {"apart_wrong", "number of these that are decided wrongly", &RowQuality::wrong},
         {"apart_kept_bits", "bits", "bits kept on these", or_missing(&RowQuality::kept_bits)}},
        &R::held_out);
    using P = Price;
    table.add<P>(
        {{"isa", "registers of `time_ns`; missing, like the times, if nothing was compiled", &P::isa},
         {"time_ns", "ns", "per ray and primitive in packs, median", [](const P& p) { return p.packed.median * 1e9; }},
         {"single_time_ns", "ns", "per ray and primitive, one ray at a time, median",
          [](const P& p) { return p.single.median * 1e9; }}},
        &R::price);
    return table.add(
        {"front", "true if no other form is at least as accurate and as fast in packs, and better in one of the two",
         [](const R& r) { return when(r.price != nullptr, r.front); }});
}

Table<MinimalRow> minimal_table() {
    using R = MinimalRow;
    return {
        {"operation",
         "operation of the set with its name in the source; this row is for the form with this operation as it was and "
         "the others wider",
         &R::operation},
        {"step", "its index among the form's operations, from 1; operations on constants alone are not counted",
         &R::step},
        {"rays", "rays whose truth is known", [](const R& r) { return r.without->rays; }},
        {"wrong", "rays decided wrongly without it", [](const R& r) { return r.without->wrong; }},
        {"kept_bits", "bits", "bits kept without it", or_missing([](const R& r) { return r.without->kept_bits; })},
        {"meets", "true if the requirement is met without it: always 0, or the set would not be minimal",
         &R::meets_requirement}};
}

namespace {

/// For each node, the number of operations up to it on values that are not constant.
std::vector<int> steps_of(const Tape& tape) {
    std::vector<int> steps;
    std::vector<bool> is_constant;
    int step = 0;
    for (NodeId i = 0; i < tape.size(); ++i) {
        const TapeOp op = tape[i].op;
        const auto operands = tape.operands_of(i);
        is_constant.push_back(op == TapeOp::constant ||
                              (!operands.empty() && std::ranges::all_of(operands, [&](NodeId operand) {
                                  return static_cast<bool>(is_constant[static_cast<std::size_t>(operand)]);
                              })));
        step += !is_given(op) && !is_constant.back();
        steps.push_back(step);
    }
    return steps;
}

}  // namespace

std::vector<MinimalRow> minimal_rows(const RepairSummary& r) {
    std::vector<MinimalRow> rows;
    if (!r.has_set()) return rows;
    const auto& set = *r.repair.wider_set;
    const std::vector<int> steps = steps_of(r.repair.tape);
    for (std::size_t k = 0; k < set.operations.size(); ++k)
        rows.push_back({operation_text(r, set.operations[k]), steps[static_cast<std::size_t>(set.operations[k])],
                        &set.quality_without[k], set.quality_without[k].meets(r.request.requirement)});
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
    table.add<RowQuality>({{"rays", "rays whose truth is known", &RowQuality::rays},
                           {"wrong", "number of these that are decided wrongly", &RowQuality::wrong},
                           {"kept_bits", "bits", "bits kept", or_missing(&RowQuality::kept_bits)}},
                          &R::quality);
    return table.add({"meets", "true if it meets the requirement there", &R::meets_requirement});
}

std::vector<ProbeRow> probe_rows(const RepairSummary& r) {
    std::vector<ProbeRow> rows;
    for (const FormRow& form : rows_of(r))
        for (std::size_t k = 0; form.probed && k < form.probed->size(); ++k)
            rows.push_back(
                {form, r.repair.probes[k]->name, &(*form.probed)[k], (*form.probed)[k].meets(r.request.requirement)});
    return rows;
}

RepairFiles::RepairFiles(const std::filesystem::path& folder)
    : folder_(folder),
      forms_(folder, "mend.csv", "One row per form: the form, with wider operations, rewritten, or of the catalogue",
             form_table()),
      minimal_(folder, "minimal.csv", "One row per operation that is done wider", minimal_table()),
      probes_(folder, "probes.csv", "One row per form and probe: the scene with axes exchanged, mirrored or rotated",
              probe_table()) {}

void RepairFiles::finish(const RepairSummary& r) {
    forms_.add_all(rows_of(r));
    minimal_.add_all(minimal_rows(r));
    probes_.add_all(probe_rows(r));
    file::write_file(folder_ / "mend.txt", in_words(r));
    table::close_tables(folder_, fmt::format("Mended: {}", r.request.id()), forms_, minimal_, probes_);
}

namespace {

FormTexts texts_of(const RepairSummary& r, const Proposal& proposal, const std::string& name,
                   const std::string& command) {
    const auto& repair = r.repair;
    const std::string form_name(r.request.row.form->info->name), method = method_text(r, proposal);
    std::vector<std::string> head_lines{fmt::format("{}, {}:", form_name, method),
                                        fmt::format("{} on every {} of {}.", choice::in_words(r.request.requirement),
                                                    r.request.scene ? "pixel" : "ray kept", r.request.id()),
                                        "Made by " + command};
    if (r.request.row.form->is_placed)
        head_lines.emplace_back(are_matrices_inverse(r.request)
                                    ? "The matrix maps from the world to the primitive, row by row."
                                    : "The matrix maps from the primitive to the world, row by row.");
    return {.name = name,
            .title = form_name + ", " + method,
            .source = command,
            .head = std::move(head_lines),
            .two_words = repair.wider != binary64,
            .binary32_only = repair.wider == binary64 && (!proposal.rewritten || proposal.rewritten->wider_set)};
}

}  // namespace

measure::repair::RepairedSource written(const RepairSummary& r, const Proposal& proposal, const std::string& name,
                                        const std::string& command) {
    const FormTexts texts = texts_of(r, proposal, "mended." + name, command);
    return {&proposal.tape, form_header(proposal.tape, *r.request.row.form, texts),
            fmt::format("lostbits::intersect::{}::{}", row_of(r.request.row.form->shape).name, type_name(name)),
            r.request.row};
}

std::string emitted(const RepairSummary& r, const std::filesystem::path& file, const std::string& command) {
    const auto proposals = proposals_of(r);
    const Proposal* const best = best_of(proposals, r);
    if (!best)
        throw InputError(fmt::format(
            "--emit {}: no other form of {} was found that meets the requirement, so there is nothing to write; {}",
            file.string(), r.request.row.form->info->name,
            r.repair.wider_set ? "it meets the requirement as it is" : "it also fails with all operations wider"));
    if (file.extension() == ".patch") {
        if (r.patches.empty())
            throw InputError(fmt::format("--emit {}: {} is not a function of --function; write .hpp or .glsl",
                                         file.string(), r.request.row.form->info->name));
        const auto& patch = r.patches[static_cast<std::size_t>(best - proposals.data())];
        if (patch.diff.empty())
            throw InputError(fmt::format("--emit {}: there is no patch of {}: {}; write .hpp", file.string(),
                                         patch.file, patch.reason));
        return patch.diff;
    }
    const bool is_shader = file.extension() == ".glsl";
    const FormTexts texts = texts_of(r, *best, (is_shader ? "" : "mended.") + file.stem().string(), command);
    return is_shader ? shader_code(best->tape, *r.request.row.form, texts)
                     : form_header(best->tape, *r.request.row.form, texts);
}

}  // namespace lostbits::output::repair
