#include "intersect/external/formulas.hpp"

#include <deque>
#include <string>

#include "intersect/external/build_id.hpp"
#include "intersect/external/contract.hpp"
#include "intersect/external/guard.hpp"
#include "intersect/external/plugin.hpp"
#include "intersect/simd/packed.hpp"
#include "number/error.hpp"

namespace lostbits::intersect::external {
namespace {

/// One entry for each running formula of this thread: a formula may call another.
thread_local std::deque<InForeignCode> inside_formulas;

constexpr FormulaWatch name_of_running{[](const char* who) { inside_formulas.emplace_back(who); },
                                       [] { inside_formulas.pop_back(); }};

Contract stated_by(const Formula& formula) {
    const Info& info = *formula.row.info;
    return {.name = std::string(info.name),
            .title = std::string(info.title),
            .source = std::string(info.source),
            .shape = formula.row.shape,
            .direction = info.direction,
            .roots = info.roots,
            .touching = info.touching,
            .at_origin = info.at_origin,
            .inside = info.inside,
            .facing = info.facing};
}

}  // namespace

std::vector<Formula> load_formulas(const std::filesystem::path& library) {
    const std::string from = library.string();
    const char* const who = lasting_text(from);
    const Library loaded = load_library(library);
    const auto ask = entry_of<AskForFormulas>(loaded, "lostbits_formulas");
    if (ask == nullptr) return {};
    // Formulas also run in arithmetics that prove and record, which need the standard state.
    if (const std::string words = loaded.fp_state.differences(); !words.empty())
        note_change(who, "changes how the processor computes (" + words +
                             ") when it is loaded; its formulas are still evaluated as IEEE 754 requires");
    const FormulaList* const list = call_of(who, [&] {
        const LoadsForeignCode here(who);
        return ask(&name_of_running);
    });
    if (list == nullptr || list->build == nullptr)
        throw InputError(
            from + ": lostbits_formulas returns no list; define it by LOSTBITS_FORMULAS(...) of lostbits_form.hpp");
    if (std::string_view(list->build) != build_id)
        throw InputError(from + ": its forms were compiled with the headers of " + list->build +
                         ", but this program is " + build_id + "; compile it again with this program's headers");
    if (list->contracts)
        throw InputError(from +
                         ": its forms were compiled so that a*b + c is rounded once, but their tapes round twice; "
                         "compile it with -ffp-contract=off, as lostbits_add_formulas does");
    if (list->all == nullptr || list->count == 0 || list->count > 4096)
        throw InputError(from + ": states " + std::to_string(list->count) +
                         " forms; the number must be from 1 to 4096");
    std::vector<Formula> formulas(list->all, list->all + list->count);
    for (Formula& formula : formulas) {
        require_sense(stated_by(formula), from);
        *formula.who = lasting_text(from + ": form \"" + std::string(formula.row.info->name) + "\"");
    }
    return formulas;
}

std::optional<ForeignForm> first_of(const std::vector<Formula>& formulas, const ForeignForm& form) {
    for (const Formula& formula : formulas) {
        const lb_form* const first = formula.first[form.contract.bits == 64 ? 1 : 0];
        if (formula.row.info->name != form.contract.name || first == nullptr) continue;
        ForeignForm made = foreign(*first, form.from, process::FloatingPoint::standard());
        made.contract = form.contract;
        made.contract.roots = Roots::first_only;
        made.contract.inside = formula.row.info->inside;
        return made;
    }
    return {};
}

void rename(Formula& formula, const std::string& prefix) {
    Info* const info = new Info(*formula.row.info);  // never freed, like `lasting_text`: exit handlers may ask for it
    info->name = lasting_text(prefix + std::string(info->name));
    formula.row.info = info;
}

void register_formulas(const std::vector<Formula>& formulas) {
    std::vector<table::Intersector> rows;
    std::vector<simd::OwnPacks> packs;
    for (const Formula& formula : formulas) {
        rows.push_back(formula.row);
        packs.push_back({formula.row.info, formula.packed});
    }
    table::register_rows(rows);
    simd::register_packs(packs);
}

}  // namespace lostbits::intersect::external
