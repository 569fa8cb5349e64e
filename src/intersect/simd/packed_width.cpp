// Compiles the forms in registers of one width; this file is compiled once for each width. The kernels for many rays
// and for many primitives are in one unit because they share code that is not inlined: the steps of the forms that
// filter.
#include "intersect/simd/packed_kernels.hpp"
#include "intersect/simd/packed_many_kernels.hpp"
#include "number/width.hpp"

namespace lostbits::intersect::simd {

void LOSTBITS_WITH_WIDTH_SUFFIX(fill_packed)(RawFormKernels* rows) { fill_raw<BuildRegisters>(rows); }

void LOSTBITS_WITH_WIDTH_SUFFIX(fill_many)(RawManyFormKernels* rows) { fill_many_raw<BuildRegisters>(rows); }

}  // namespace lostbits::intersect::simd
