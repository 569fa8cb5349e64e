// The part of the table that readers need: the names of the forms, without kernels.
#include "intersect/catalogue.hpp"
#include "intersect/table/table.hpp"

namespace lostbits::intersect::table {
namespace {

template <class... Form>
std::vector<Intersector> list_forms(FormList<Form...> /*list*/) {
    return {Intersector{.info = &Form::info, .shape = Shape::sphere}...};
}

}  // namespace

std::span<const Intersector> intersectors() {
    static const std::vector<Intersector> rows = list_forms(sphere::SphereForms());
    return rows;
}

}  // namespace lostbits::intersect::table
