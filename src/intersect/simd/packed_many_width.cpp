// One ray against many solids in registers of one width; compiled once for each.
#include "intersect/simd/packed_many_kernels.hpp"
#include "number/width.hpp"

namespace lostbits::intersect::simd {

void LOSTBITS_NAME_OF_WIDTH(fill_many)(RawManyRow* rows) { fill_many_raw<Width>(rows); }

}  // namespace lostbits::intersect::simd
