#include "intersect/catalogue_first.hpp"
#include "intersect/simd/append_many_rows.hpp"

namespace lostbits::intersect::simd {

template void append_many_rows<FirstForms>(std::vector<ManyRow>& rows);

}  // namespace lostbits::intersect::simd
