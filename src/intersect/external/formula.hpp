// Forms in every arithmetic, as exported by a library that was compiled with lostbits_form.hpp.
#pragma once

#include <array>
#include <cstddef>

#include <lostbits_plugin.h>
#include "intersect/simd/packed_raw.hpp"
#include "intersect/table/table.hpp"

namespace lostbits::intersect::external {

/// Functions of the program by which a library reports that a form begins and ends, so that a crash or a hang can be
/// attributed to the form.
struct FormulaWatch {
    void (*enter)(const char* who);  ///< `who` is the name of the form for messages
    void (*leave)();
};

/// Forms of the C interface that yield the t of the hits as their root, in float and in double; the C interface has no
/// field for t beside near and far. Null if the form yields only t.
struct FirstRootForms {
    const lb_form* f32 = nullptr;
    const lb_form* f64 = nullptr;
};

/// A form as the library compiled it.
struct Formula {
    table::Intersector intersector;
    std::array<simd::RawFormKernels, 3> packed;  ///< registers of 128, 256 and 512 bits; null where not compiled
    const char** who;                            ///< the name passed to `FormulaWatch::enter`, set by the program
    FirstRootForms first_root_forms;
};

/// The list that `lostbits_formulas` returns. `build` comes first and is compared before anything else is read, since
/// the layout of all other members depends on the build of the headers.
struct FormulaList {
    const char* build;
    const Formula* all;
    std::size_t count;
    bool is_contracted;  ///< true if the library was compiled so that a·b + c is rounded once
};

using FormulasFunction = const FormulaList* (*)(const FormulaWatch*);

}  // namespace lostbits::intersect::external
