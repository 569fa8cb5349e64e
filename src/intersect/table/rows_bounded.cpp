#include "intersect/table/arithmetics.hpp"
#include "intersect/table/rows.hpp"

namespace lostbits::intersect::table {

void fill_bounded(std::span<Intersector> rows) {
    std::size_t i = 0;
    for_each_form([&]<class Form>() {
        rows[i].bounded = bounded_of<Form>;
        if constexpr (filters<Form>) rows[i].way = way_of<Form>;
        ++i;
    });
}

}  // namespace lostbits::intersect::table
