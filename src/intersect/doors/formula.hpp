// Forms in every arithmetic, as a library that was compiled with lostbits_form.hpp exports them.
#pragma once

#include <array>
#include <cstddef>

#include <lostbits_plugin.h>
#include "intersect/simd/packed_raw.hpp"
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

/// The list that `lostbits_formulas` returns. `build` stands first and is compared before the rest is looked at: all
/// that follows is laid out as one build of the headers lays it out.
struct FormulaList {
    const char* build;
    const Formula* all;
    std::size_t count;
    bool contracts;  ///< it was compiled so that a·b + c is rounded once
};

using AskForFormulas = const FormulaList* (*)(const FormulaWatch*);

}  // namespace lostbits::intersect::doors
