#include "intersect/table/fill_forms.hpp"

namespace lostbits::intersect::table {

void fill_batches(std::span<Intersector> forms) {
    std::size_t i = 0;
    for_each_form([&]<class Form>() {
        Intersector& form = forms[i++];
        form.info = &Form::info;
        form.shape = shape_of<Form>;
        form.native32 = intersect_native_batch<Form, float>;
        if constexpr (Form::info.formats == Formats::all) form.native64 = intersect_native_batch<Form, double>;
    });
}

}  // namespace lostbits::intersect::table
