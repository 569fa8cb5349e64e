#include "intersect/catalogue_second.hpp"
#include "intersect/table/append_forms.hpp"

namespace lostbits::intersect::table {

template void append_forms<SecondForms>(std::vector<Intersector>& forms);

}  // namespace lostbits::intersect::table
