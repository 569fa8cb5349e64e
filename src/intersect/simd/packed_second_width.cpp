// Compiles forms in registers of one width; this file is compiled once for each width. The kernels for many rays and
// for many primitives are in one unit because they share code that is not inlined: the steps of the forms that filter.
#include "intersect/catalogue_second.hpp"
#include "intersect/simd/packed_kernels.hpp"
#include "intersect/simd/packed_many_kernels.hpp"

namespace lostbits::intersect::simd {

template RawRow* LOSTBITS_WITH_WIDTH_SUFFIX(fill_packed)<SecondForms>(RawRow* row);
template RawManyRow* LOSTBITS_WITH_WIDTH_SUFFIX(fill_many)<SecondForms>(RawManyRow* row);

}  // namespace lostbits::intersect::simd
