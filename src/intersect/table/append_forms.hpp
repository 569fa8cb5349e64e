// Defines `append_forms`, which compiles the forms over batches of floats and doubles.
#pragma once

#include "intersect/table/fill_forms.hpp"
#include "intersect/table/kernels.hpp"

namespace lostbits::intersect::table {

template <class Forms>
void append_forms(std::vector<Intersector>& forms) {
    Forms::for_each([&forms]<class Form>() {
        Intersector& form = forms.emplace_back();
        form.info = &Form::info;
        form.shape = shape_of<Form>;
        form.native32 = intersect_native_batch<Form, float>;
        if constexpr (Form::info.formats == Formats::all) form.native64 = intersect_native_batch<Form, double>;
    });
}

}  // namespace lostbits::intersect::table
