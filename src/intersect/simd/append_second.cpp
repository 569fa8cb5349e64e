#include "intersect/catalogue_second.hpp"
#include "intersect/simd/append_many_rows.hpp"

namespace lostbits::intersect::simd {

template void append_many_rows<SecondForms>(std::vector<ManyRow>& rows);

}  // namespace lostbits::intersect::simd
