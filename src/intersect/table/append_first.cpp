#include "intersect/catalogue_first.hpp"
#include "intersect/table/append_forms.hpp"

namespace lostbits::intersect::table {

template void append_forms<FirstForms>(std::vector<Intersector>& forms);

}  // namespace lostbits::intersect::table
