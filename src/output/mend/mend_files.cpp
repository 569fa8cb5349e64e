#include "output/mend/mend_files.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "number/error.hpp"
#include "output/choice/choice_text.hpp"
#include "output/file/atomic_file.hpp"
#include "output/file/datapackage.hpp"
#include "output/mend/form_code.hpp"
#include "output/mend/mend_rows.hpp"
#include "output/mend/shader_code.hpp"

namespace lostbits::output::mend {

using file::Cell;
using file::Column;
using file::number_or_missing;
using measure::mend::Worth;

std::vector<Column> form_columns() {
    return {
        {"kind", "string", "",
         "own: the form; wider: the smallest set of its operations wider; all_wider: all of them; rewritten: the form "
         "written another way; catalogue"},
        {"form", "string", "", "form"},
        {"format", "string", "", "of its inputs and answers"},
        {"wider", "string", "", "what wider operations are done in; missing where none is"},
        {"wider_operations", "integer", "", "so many of its operations are done wider; missing for the catalogue"},
        {"operations", "integer", "", "that round; missing for the catalogue"},
        {"rules", "string", "", "that made it, in order; missing where it was not rewritten"},
        {"rays", "integer", "", "whose truth is known"},
        {"true_hits", "integer", "", "rays that truly hit"},
        {"wrong", "integer", "", "false hits, false misses, NaNs and hits of another solid"},
        {"wrong_fraction", "number", "1", "wrong/rays"},
        {"kept_bits", "number", "bits", "significand bits less what is lost, at the wish's share of the agreed hits"},
        {"meets", "boolean", "", "whether it meets the wish"},
        {"apart_rays", "integer", "", "rays on which nothing was searched; missing where they were not asked"},
        {"apart_wrong", "integer", "", "of these, decided wrongly"},
        {"apart_kept_bits", "number", "bits", "kept on these"},
        {"isa", "string", "", "registers of `time_ns`; missing, as times are, where nothing was compiled"},
        {"time_ns", "number", "ns", "a ray and solid in packs, median"},
        {"single_time_ns", "number", "ns", "a ray and solid, one by one, median"},
        {"front", "boolean", "",
         "whether nothing here is at least as accurate and as fast in packs, and better in one"}};
}

std::vector<Column> minimal_columns() {
    return {
        {"operation", "string", "", "of the set, as the source names it; it alone is done as it was, the others wider"},
        {"step", "integer", "",
         "its place among the form's operations, from 1; those of constants alone are not counted"},
        {"rays", "integer", "", "whose truth is known"},
        {"wrong", "integer", "", "decided wrongly without it"},
        {"kept_bits", "number", "bits", "kept without it"},
        {"meets", "boolean", "", "whether the wish is met without it: 0, or the set would not be minimal"}};
}

namespace {

/// Of each node, its place among the operations on what is not constant.
std::vector<int> steps_of(const Tape& tape) {
    std::vector<int> steps;
    std::vector<bool> constant;
    int step = 0;
    for (NodeId i = 0; i < tape.size(); ++i) {
        const TapeOp op = tape[i].op;
        const auto operands = tape.operands_of(i);
        constant.push_back(op == TapeOp::constant ||
                           (!operands.empty() && std::ranges::all_of(operands, [&](NodeId operand) {
                               return static_cast<bool>(constant[static_cast<std::size_t>(operand)]);
                           })));
        step += !is_given(op) && !constant.back();
        steps.push_back(step);
    }
    return steps;
}

}  // namespace

void add_forms(file::CsvWriter& csv, const MendResult& r) {
    for (const FormRow& row : rows_of(r)) {
        const Worth& w = *row.worth;
        csv.add(row.kind).add(row.row.form->info->name).add(row.row.format.name);
        csv.add(row.wide == 0 ? Cell() : Cell(name_of_wider(r.mended.wider)));
        csv.add(row.operations == 0 ? Cell() : Cell(row.wide));
        csv.add(row.operations == 0 ? Cell() : Cell(row.operations));
        csv.add(row.rules.empty() ? Cell() : Cell(row.rules));
        csv.add(w.rays).add(w.hits).add(w.wrong).add(w.wrong_fraction()).add(number_or_missing(w.kept_bits));
        csv.add(w.meets(r.request.wish));
        csv.add(row.apart ? Cell(row.apart->rays) : Cell()).add(row.apart ? Cell(row.apart->wrong) : Cell());
        csv.add(row.apart ? number_or_missing(row.apart->kept_bits) : Cell());
        csv.add(row.price ? Cell(row.price->isa) : Cell());
        csv.add(row.price ? Cell(row.price->packed.median * 1e9) : Cell());
        csv.add(row.price ? Cell(row.price->single.median * 1e9) : Cell());
        csv.add(row.price ? Cell(row.front) : Cell()).end_row();
    }
}

void add_minimal(file::CsvWriter& csv, const MendResult& r) {
    if (!r.has_set()) return;
    const auto& set = *r.mended.set;
    const std::vector<int> steps = steps_of(r.mended.tape);
    for (std::size_t k = 0; k < set.operations.size(); ++k) {
        const Worth& w = set.without[k];
        csv.row({operation_in_words(r, set.operations[k]), steps[static_cast<std::size_t>(set.operations[k])], w.rays,
                 w.wrong, number_or_missing(w.kept_bits), w.meets(r.request.wish)});
    }
}

MendFiles::MendFiles(const std::filesystem::path& folder)
    : folder_(folder),
      forms_(folder / "mend.csv", form_columns()),
      minimal_(folder / "minimal.csv", minimal_columns()) {}

void MendFiles::finish(const MendResult& r) {
    add_forms(forms_, r);
    add_minimal(minimal_, r);
    forms_.close();
    minimal_.close();
    file::AtomicFile text(folder_ / "mend.txt");
    text.write(in_words(r));
    text.commit();
    file::write_datapackage(
        folder_ / "datapackage.json", fmt::format("Mended: {}", r.request.id()),
        {{"mend.csv", "a form, the same with wider operations, or one of the catalogue", form_columns()},
         {"minimal.csv", "an operation that is done wider", minimal_columns()}});
}

namespace {

FormWords words_of(const MendResult& r, const Proposal& proposal, const std::string& name, const std::string& command) {
    const auto& m = r.mended;
    const std::string own(r.request.row.form->info->name), how = how_in_words(r, proposal);
    const char* const matrix = !r.request.row.form->is_placed ? ""
                               : are_inverses(r.request)
                                   ? "// The matrix leads from the world to the solid, row by row.\n"
                                   : "// The matrix leads from the solid to the world, row by row.\n";
    return {.name = name,
            .title = own + ", " + how,
            .source = command,
            .comment = fmt::format("// {}, {}:\n// {} on every {} of {}.\n// Made by {}\n{}", own, how,
                                   choice::in_words(r.request.wish), r.request.scene ? "pixel" : "ray kept",
                                   r.request.id(), command, matrix),
            .two_words = m.wider != binary64,
            .binary32_only = m.wider == binary64 && (!proposal.rewritten || proposal.rewritten->set)};
}

}  // namespace

measure::mend::Written written(const MendResult& r, const Proposal& proposal, const std::string& name,
                               const std::string& command) {
    const FormWords words = words_of(r, proposal, "mended." + name, command);
    return {&proposal.tape, form_header(proposal.tape, *r.request.row.form, words),
            fmt::format("lostbits::intersect::{}::{}", row_of(r.request.row.form->shape).name, type_name(name)),
            r.request.row};
}

std::string emitted(const MendResult& r, const std::filesystem::path& file, const std::string& command) {
    const auto proposals = proposals_of(r);
    const Proposal* const best = best_of(proposals, r.request.wish);
    if (!best)
        throw InputError(
            fmt::format("--emit {}: no other form of {} was found that meets the wish, so there is none to write; {}",
                        file.string(), r.request.row.form->info->name,
                        r.mended.set ? "it meets the wish as it is" : "with all operations wider it fails it, too"));
    const bool shader = file.extension() == ".glsl";
    const FormWords words = words_of(r, *best, (shader ? "" : "mended.") + file.stem().string(), command);
    return shader ? shader_code(best->tape, *r.request.row.form, words)
                  : form_header(best->tape, *r.request.row.form, words);
}

}  // namespace lostbits::output::mend
