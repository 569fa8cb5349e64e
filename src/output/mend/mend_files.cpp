#include "output/mend/mend_files.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "number/error.hpp"
#include "output/choice/choice_files.hpp"
#include "output/file/atomic_file.hpp"
#include "output/mend/form_code.hpp"
#include "output/mend/shader_code.hpp"
#include "output/table/shared_columns.hpp"

namespace lostbits::output::mend {

using file::number_or_missing;
using measure::mend::Worth;
using table::Table;
using table::when;

Table<FormRow> form_table() {
    using R = FormRow;
    Table<R> table{
        {"kind", "string", "",
         "own: the form; wider: the smallest set of its operations wider; all_wider: all of them; rewritten: the form "
         "written another way; catalogue",
         &R::kind}};
    table.add(table::subject_columns("form", "of its inputs and answers"), &R::row);
    table.add(
        {{"wider", "string", "", "what wider operations are done in; missing where none is", &R::wider},
         {"wider_operations", "integer", "", "so many of its operations are done wider; missing for the catalogue",
          [](const R& r) { return when(r.operations != 0, r.wide); }},
         {"operations", "integer", "", "that round; missing for the catalogue",
          [](const R& r) { return when(r.operations != 0, r.operations); }},
         {"rules", "string", "", "that made it, in order; missing where it was not rewritten", &R::rules}});
    table.add(choice::worth_columns(), &R::worth);
    table.add({"meets", "boolean", "", "whether it meets the wish", &R::meets});
    table.add<Worth>({{"apart_rays", "integer", "",
                       "rays on which nothing was searched; missing where they were not asked", &Worth::rays},
                      {"apart_wrong", "integer", "", "of these, decided wrongly", &Worth::wrong},
                      {"apart_kept_bits", "number", "bits", "kept on these",
                       [](const Worth& w) { return number_or_missing(w.kept_bits); }}},
                     &R::apart);
    using P = measure::mend::Price;
    table.add<P>(
        {{"isa", "string", "", "registers of `time_ns`; missing, as times are, where nothing was compiled", &P::isa},
         {"time_ns", "number", "ns", "a ray and solid in packs, median",
          [](const P& p) { return p.packed.median * 1e9; }},
         {"single_time_ns", "number", "ns", "a ray and solid, one by one, median",
          [](const P& p) { return p.single.median * 1e9; }}},
        &R::price);
    return table.add({"front", "boolean", "",
                      "whether nothing here is at least as accurate and as fast in packs, and better in one",
                      [](const R& r) { return when(r.price != nullptr, r.front); }});
}

Table<MinimalRow> minimal_table() {
    using R = MinimalRow;
    return {
        {"operation", "string", "", "of the set, as the source names it; it alone is done as it was, the others wider",
         &R::operation},
        {"step", "integer", "",
         "its place among the form's operations, from 1; those of constants alone are not counted", &R::step},
        {"rays", "integer", "", "whose truth is known", [](const R& r) { return r.without->rays; }},
        {"wrong", "integer", "", "decided wrongly without it", [](const R& r) { return r.without->wrong; }},
        {"kept_bits", "number", "bits", "kept without it",
         [](const R& r) { return number_or_missing(r.without->kept_bits); }},
        {"meets", "boolean", "", "whether the wish is met without it: 0, or the set would not be minimal", &R::meets}};
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

std::vector<MinimalRow> minimal_rows(const MendResult& r) {
    std::vector<MinimalRow> rows;
    if (!r.has_set()) return rows;
    const auto& set = *r.mended.set;
    const std::vector<int> steps = steps_of(r.mended.tape);
    for (std::size_t k = 0; k < set.operations.size(); ++k)
        rows.push_back({operation_in_words(r, set.operations[k]), steps[static_cast<std::size_t>(set.operations[k])],
                        &set.without[k], set.without[k].meets(r.request.wish)});
    return rows;
}

MendFiles::MendFiles(const std::filesystem::path& folder)
    : folder_(folder),
      forms_(folder, "mend.csv", "a form, the same with wider operations, or one of the catalogue", form_table()),
      minimal_(folder, "minimal.csv", "an operation that is done wider", minimal_table()) {}

void MendFiles::finish(const MendResult& r) {
    forms_.add_all(rows_of(r));
    minimal_.add_all(minimal_rows(r));
    file::AtomicFile text(folder_ / "mend.txt");
    text.write(in_words(r));
    text.commit();
    table::close_tables(folder_, fmt::format("Mended: {}", r.request.id()), forms_, minimal_);
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
