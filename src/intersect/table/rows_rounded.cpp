#include "intersect/table/arithmetics.hpp"
#include "intersect/table/rows.hpp"

namespace lostbits::intersect::table {

void fill_rounded(std::span<Intersector> rows) {
    std::size_t i = 0;
    for_each_form([&]<class Form>() {
        if constexpr (Form::info.formats == Formats::all) rows[i].rounded = rounded_batch<Form>;
        ++i;
    });
}

}  // namespace lostbits::intersect::table
