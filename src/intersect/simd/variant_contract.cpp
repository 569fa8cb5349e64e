// The forms in 256-bit registers, compiled with leave to contract a·b + c into one rounding: what happens to them where
// nobody switches that off.
#include "intersect/simd/packed_kernels.hpp"
#include "intersect/simd/variant_raw.hpp"
#include "number/width.hpp"

namespace lostbits::intersect::simd {

void fill_variant_contract(RawRow* rows) { fill_raw<Width>(rows); }

}  // namespace lostbits::intersect::simd
