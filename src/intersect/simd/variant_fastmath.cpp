// The forms in 256-bit registers, compiled with -ffast-math: sums in any order, reciprocals for quotients, no NaN, no
// infinity and no signed zero. Its results are never a reference. Only this unit may compute them.
#define LOSTBITS_MEASURES_FAST_MATH
#include "intersect/simd/packed_kernels.hpp"
#include "intersect/simd/variant_raw.hpp"
#include "number/width.hpp"

namespace lostbits::intersect::simd {

void fill_variant_fastmath(RawRow* rows) { fill_raw<Width>(rows); }

}  // namespace lostbits::intersect::simd
