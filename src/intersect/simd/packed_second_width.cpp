// Compiles forms in registers of one width; this file is compiled once for each width. The kernels for many rays and
// for many primitives are in one unit because they share code that is not inlined: the steps of the forms that filter.
#include "intersect/catalogue_second.hpp"
#include "intersect/simd/packed_kernels.hpp"
#include "intersect/simd/packed_many_kernels.hpp"

namespace lostbits::intersect::simd {

template RawFormKernels* LOSTBITS_WITH_WIDTH_SUFFIX(fill_packed)<SecondForms>(RawFormKernels* row);
template RawManyFormKernels* LOSTBITS_WITH_WIDTH_SUFFIX(fill_many)<SecondForms>(RawManyFormKernels* row);

}  // namespace lostbits::intersect::simd
