#include "intersect/rows.hpp"

namespace lostbits {

void fill_enclosed(std::span<Intersector> rows) {
    std::size_t i = 0;
    SphereForms::for_each([&]<class Form>() {
        rows[i].ball = Form::template intersect<Ball>;
        rows[i].interval = Form::template intersect<Interval>;
        ++i;
    });
}

}  // namespace lostbits
