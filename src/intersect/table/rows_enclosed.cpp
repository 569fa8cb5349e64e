#include "intersect/table/arithmetics.hpp"
#include "intersect/table/rows.hpp"

namespace lostbits::intersect::table {

void fill_enclosed(std::span<Intersector> rows) {
    std::size_t i = 0;
    for_each_form([&]<class Form>() {
        rows[i].ball = enclosed<Form, Ball>;
        rows[i].interval = enclosed<Form, Interval>;
        ++i;
    });
}

}  // namespace lostbits::intersect::table
