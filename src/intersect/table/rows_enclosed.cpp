#include "intersect/table/rows.hpp"

namespace lostbits::intersect::table {
namespace {

/// "Nowhere", for enclosures, whose arithmetic has no infinity: beyond every t that double precision can name.
constexpr double unlimited = 0x1p1000;

template <class Form, class E>
Hit<E> enclosed(const Ray<E>& ray, const Target<E>& target) {
    sdf::Unwatched unwatched;
    return intersect_target<Form>(ray, target, E(unlimited), unwatched);
}

}  // namespace

void fill_enclosed(std::span<Intersector> rows) {
    std::size_t i = 0;
    for_each_form([&]<class Form>() {
        rows[i].ball = enclosed<Form, Ball>;
        rows[i].interval = enclosed<Form, Interval>;
        ++i;
    });
}

}  // namespace lostbits::intersect::table
