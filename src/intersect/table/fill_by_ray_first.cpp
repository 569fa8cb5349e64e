#include "intersect/catalogue_first.hpp"
#include "intersect/table/fill_by_ray.hpp"

namespace lostbits::intersect::table {

template std::span<Intersector> fill_by_ray<FirstForms>(std::span<Intersector> forms);

}  // namespace lostbits::intersect::table
