#include "intersect/table/rows.hpp"

namespace lostbits::intersect::table {

void fill_batches(std::span<Intersector> rows) {
    std::size_t i = 0;
    for_each_form([&]<class Form>() {
        Intersector& form = rows[i++];
        form.info = &Form::info;
        form.shape = shape_of<Form>;
        form.native32 = native_batch<Form, float>;
        if constexpr (Form::info.formats == Formats::all) form.native64 = native_batch<Form, double>;
    });
}

}  // namespace lostbits::intersect::table
