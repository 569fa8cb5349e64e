// A part of the forms over packs; see packed_batch.hpp for what such a file may include.
#pragma once

#include "intersect/simd/packed_batch.hpp"
#include "number/width.hpp"

namespace lostbits::intersect::simd {

/// Fills the row of each form with its kernels; returns the place after the last.
template <class Forms, class Width>
RawFormKernels* fill_form_kernels(RawFormKernels* row) {
    Forms::for_each([&row]<class Form>() { *row++ = raw_form_kernels<Form, Width>(); });
    return row;
}

template <class Forms>
RawFormKernels* LOSTBITS_WITH_WIDTH_SUFFIX(fill_packed)(RawFormKernels* row) {
    return fill_form_kernels<Forms, BuildRegisters>(row);
}

}  // namespace lostbits::intersect::simd
