#include "intersect/doors/formulas.hpp"

#include <dlfcn.h>

#include <optional>
#include <string>

#include "intersect/doors/build_words.hpp"
#include "intersect/doors/contract.hpp"
#include "intersect/doors/guard.hpp"
#include "intersect/doors/plugin.hpp"
#include "number/error.hpp"

namespace lostbits::intersect::doors {
namespace {

thread_local std::optional<InForeignCode> inside_formula;

constexpr FormulaWatch name_of_running{[](const char* who) { inside_formula.emplace(who); },
                                       [] { inside_formula.reset(); }};

Contract stated_by(const Formula& formula) {
    const Info& info = *formula.row.info;
    return {.name = std::string(info.name),
            .title = std::string(info.title),
            .source = std::string(info.source),
            .shape = formula.row.shape,
            .direction = info.direction,
            .roots = info.roots,
            .touching = info.touching,
            .at_origin = info.at_origin};
}

}  // namespace

std::vector<Formula> load_formulas(const std::filesystem::path& library) {
    const std::string from = library.string();
    const auto ask = reinterpret_cast<AskForFormulas>(dlsym(load_library(library), "lostbits_formulas"));
    if (ask == nullptr) return {};
    const FormulaList* const list = [&] {
        const LoadsForeignCode here(lasting_text(from));
        return ask(&name_of_running);
    }();
    if (std::string_view(list->build) != build_words)
        throw InputError(from + ": its forms were compiled with the headers of " + list->build + "; this program is " +
                         build_words + "; compile it again with this program's headers");
    if (list->contracts)
        throw InputError(from +
                         ": its forms were compiled so that a*b + c is rounded once, and their tapes say twice; "
                         "compile it with -ffp-contract=off, as lostbits_add_formulas does");
    std::vector<Formula> formulas(list->all, list->all + list->count);
    for (Formula& formula : formulas) {
        require_sense(stated_by(formula), from);
        *formula.who = lasting_text(from + ": form \"" + std::string(formula.row.info->name) + "\"");
    }
    return formulas;
}

void enroll_formulas(const std::vector<Formula>& formulas) {
    std::vector<table::Intersector> rows;
    std::vector<simd::OwnPacks> packs;
    for (const Formula& formula : formulas) {
        rows.push_back(formula.row);
        packs.push_back({formula.row.info, formula.packed});
    }
    table::enroll(rows);
    simd::enroll_packs(packs);
}

}  // namespace lostbits::intersect::doors
