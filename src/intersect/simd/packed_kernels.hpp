// Every form over packs; see packed_batch.hpp for what such a file may include.
#pragma once

#include "intersect/catalogue.hpp"
#include "intersect/simd/packed_batch.hpp"

namespace lostbits::intersect::simd {

/// A null pointer where the form does not exist in binary64.
template <class Width>
void fill_raw(RawRow* row) {
    for_each_form([&row]<class Form>() {
        row->f32 = packed_batch<Form, float, Width>;
        if constexpr (Form::info.formats == Formats::all) row->f64 = packed_batch<Form, double, Width>;
        ++row;
    });
}

}  // namespace lostbits::intersect::simd
