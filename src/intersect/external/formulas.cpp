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

/// One entry for each running formula of this thread, since a formula may call another.
thread_local std::deque<ForeignCodeScope> running_formulas;

constexpr FormulaWatch running_formula_watch{[](const char* who) { running_formulas.emplace_back(who); },
                                             [] { running_formulas.pop_back(); }};

Contract contract_of_formula(const Formula& formula) {
    const Info& info = *formula.intersector.info;
    return {.name = std::string(info.name),
            .title = std::string(info.title),
            .source = std::string(info.source),
            .shape = formula.intersector.shape,
            .direction = info.direction,
            .roots = info.roots,
            .touching = info.touching,
            .at_origin = info.at_origin,
            .inside = info.inside,
            .facing = info.facing};
}

}  // namespace

std::vector<Formula> load_formulas(const std::filesystem::path& library) {
    const std::string path = library.string();
    const char* const lasting_path = never_freed_copy(path);
    const Library loaded = load_library(library);
    const auto list_formulas = find_symbol<FormulasFunction>(loaded, "lostbits_formulas");
    if (list_formulas == nullptr) return {};
    // Formulas also run in arithmetics that prove and record, which need the standard state.
    if (const std::string changes = loaded.fp_state.differences(); !changes.empty())
        note_change(lasting_path, "changes how the processor computes (" + changes +
                                      ") when it is loaded; its formulas are still evaluated as IEEE 754 requires");

    const FormulaList* const list = call_foreign(lasting_path, [&] {
        const ForeignLoadScope loading(lasting_path);
        return list_formulas(&running_formula_watch);
    });

    // Tapes and enclosures hold only for forms of the same headers, rounded operation by operation.
    if (list == nullptr || list->build == nullptr)
        throw InputError(
            path + ": lostbits_formulas returns no list; define it by LOSTBITS_FORMULAS(...) of lostbits_form.hpp");
    if (std::string_view(list->build) != build_id)
        throw InputError(path + ": its forms were compiled with the headers of " + list->build +
                         ", but this program is " + build_id + "; compile it again with this program's headers");
    if (list->is_contracted)
        throw InputError(
            path +
            ": its forms were compiled so that a*b + c is rounded once, but lostbits analyses them with two "
            "roundings; compile it with -ffp-contract=off, as lostbits_add_formulas does");
    if (list->all == nullptr || list->count == 0 || list->count > 4096)
        throw InputError(path + ": states " + std::to_string(list->count) +
                         " forms; the number must be from 1 to 4096");

    std::vector<Formula> formulas(list->all, list->all + list->count);
    for (Formula& formula : formulas) {
        require_valid(contract_of_formula(formula), path);
        *formula.who = never_freed_copy(path + ": form \"" + std::string(formula.intersector.info->name) + "\"");
    }
    return formulas;
}

std::optional<ForeignForm> find_first_root_form(const std::vector<Formula>& formulas, const ForeignForm& form) {
    for (const Formula& formula : formulas) {
        const lb_form* const c_form =
            form.contract.bits == 64 ? formula.first_root_forms.f64 : formula.first_root_forms.f32;
        if (formula.intersector.info->name != form.contract.name || c_form == nullptr) continue;
        ForeignForm first_root_form =
            build_foreign_form(*c_form, form.provider, process::FloatingPointState::standard());
        first_root_form.contract = form.contract;
        first_root_form.contract.roots = Roots::first_only;
        first_root_form.contract.inside = formula.intersector.info->inside;
        return first_root_form;
    }
    return {};
}

void add_prefix(Formula& formula, const std::string& prefix) {
    Info* const info =
        new Info(*formula.intersector.info);  // never freed, like `never_freed_copy`: exit handlers may read it
    info->name = never_freed_copy(prefix + std::string(info->name));
    formula.intersector.info = info;
}

void register_formulas(const std::vector<Formula>& formulas) {
    std::vector<table::Intersector> forms;
    std::vector<simd::ExternalPacks> packs;
    for (const Formula& formula : formulas) {
        forms.push_back(formula.intersector);
        packs.push_back({formula.intersector.info, formula.packed});
    }
    table::register_intersectors(forms);
    simd::register_packs(packs);
}

}  // namespace lostbits::intersect::external
