#include "intersect/table/arithmetics.hpp"
#include "intersect/table/rows.hpp"

namespace lostbits::intersect::table {

void fill_counted(std::span<Intersector> rows) {
    std::size_t i = 0;
    for_each_form([&]<class Form>() { rows[i++].count = count_of<Form>; });
}

}  // namespace lostbits::intersect::table
