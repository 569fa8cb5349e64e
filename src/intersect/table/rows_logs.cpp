#include "intersect/table/arithmetics.hpp"
#include "intersect/table/rows.hpp"

namespace lostbits::intersect::table {

void fill_logs(std::span<Intersector> rows) {
    std::size_t i = 0;
    for_each_form([&]<class Form>() {
        if constexpr (marches<Form>) rows[i].log = log_of<Form>;
        ++i;
    });
}

}  // namespace lostbits::intersect::table
