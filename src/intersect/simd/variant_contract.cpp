// The forms in 256-bit registers, compiled so that a·b + c may be contracted into one rounding, as gcc does
// unless told otherwise.
#include "intersect/simd/packed_kernels.hpp"
#include "intersect/simd/variant_raw.hpp"
#include "number/width.hpp"

namespace lostbits::intersect::simd {

void fill_variant_contract(RawRow* rows) { fill_raw<Width>(rows); }

}  // namespace lostbits::intersect::simd
