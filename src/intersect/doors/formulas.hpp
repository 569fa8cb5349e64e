// Formulas from outside: libraries compiled with lostbits_form.hpp, whose forms come in every arithmetic, as those of
// the catalogue do.
#pragma once

#include <array>
#include <cstddef>
#include <filesystem>
#include <optional>
#include <vector>

#include "intersect/doors/contract.hpp"
#include "intersect/simd/packed.hpp"
#include "intersect/table/table.hpp"

namespace lostbits::intersect::doors {

/// How a library says that a form begins and ends, so that a crash or a hang in it has a name.
struct FormulaWatch {
    void (*enter)(const char* who);
    void (*leave)();
};

/// A form as the library compiled it.
struct Formula {
    table::Intersector row;
    std::array<simd::RawRow, 3> packed;  ///< registers of 128, 256 and 512 bits; null: not compiled
    const char** who;                    ///< what `FormulaWatch::enter` is told, for the program to set
    /// In float and in double: the t of its hits, which the C interface has no place for beside near and far. Null
    /// where it tells t alone.
    std::array<const lb_form*, 2> first;
};

/// What `lostbits_formulas` returns. `build` stands first and is compared before the rest is looked at: all that
/// follows is laid out as one build of the headers lays it out.
struct FormulaList {
    const char* build;
    const Formula* all;
    std::size_t count;
    bool contracts;  ///< it was compiled so that a·b + c is rounded once
};

using AskForFormulas = const FormulaList* (*)(const FormulaWatch*);

/// The formulas of a library, which is loaded and stays so; none where it exports no `lostbits_formulas`. InputError
/// where it was compiled with other headers than this program, or says what makes no sense of a form.
std::vector<Formula> load_formulas(const std::filesystem::path& library);

/// The t of the formula that `form` is the C interface of, as a form of the first root; nothing where near is t.
std::optional<ForeignForm> first_of(const std::vector<Formula>& formulas, const ForeignForm& form);

/// The formula under a name that begins so, see `prefix_of_plugin`.
void rename(Formula& formula, const std::string& prefix);

/// As rows of the table, and of the packs. InputError for a name that is taken.
void enroll_formulas(const std::vector<Formula>& formulas);

}  // namespace lostbits::intersect::doors
