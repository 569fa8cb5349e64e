// The forms in registers of one width; compiled once for each.
#include "intersect/simd/packed_kernels.hpp"
#include "number/width.hpp"

namespace lostbits::intersect::simd {

void LOSTBITS_NAME_OF_WIDTH(fill_packed)(RawRow* rows) { fill_raw<Width>(rows); }

}  // namespace lostbits::intersect::simd
