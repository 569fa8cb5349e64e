#include "intersect/table/rows.hpp"

namespace lostbits::intersect::table {

void fill_batches(std::span<Intersector> rows) {
    std::size_t i = 0;
    for_each_form([&]<class Form>() {
        Intersector& catalogue_row = rows[i++];
        catalogue_row.info = &Form::info;
        catalogue_row.shape = shape_of<Form>;
        catalogue_row.native32 = native_batch<Form, float>;
        if constexpr (Form::info.formats == Formats::all) catalogue_row.native64 = native_batch<Form, double>;
    });
}

}  // namespace lostbits::intersect::table
