// Every form over packs; see packed_batch.hpp for what such a file may include.
#pragma once

#include "intersect/catalogue.hpp"
#include "intersect/simd/packed_batch.hpp"

namespace lostbits::intersect::simd {

template <class Width>
void fill_raw(RawFormKernels* row) {
    for_each_form([&row]<class Form>() { *row++ = raw_form_kernels<Form, Width>(); });
}

}  // namespace lostbits::intersect::simd
