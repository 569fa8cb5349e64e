#include "intersect/table/rows.hpp"

namespace lostbits::intersect::table {

void fill_native(std::span<Intersector> rows) {
    std::size_t i = 0;
    for_each_form([&]<class Form>() {
        rows[i].info = &Form::info;
        rows[i].shape = shape_of<Form>;
        rows[i].native32 = native_batch<Form, float>;
        if constexpr (Form::info.formats == Formats::all) rows[i].native64 = native_batch<Form, double>;
        ++i;
    });
}

}  // namespace lostbits::intersect::table
