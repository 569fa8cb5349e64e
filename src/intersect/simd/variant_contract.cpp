// The forms in 256-bit registers, compiled so that a·b + c may be contracted into one rounding, as gcc does
// unless told otherwise.
#include "intersect/simd/packed_kernels.hpp"
#include "intersect/simd/variant_raw.hpp"

namespace lostbits::intersect::simd {
namespace {

struct Width : Registers<32> {};

}  // namespace

void fill_variant_contract(RawRow* rows) { fill_raw<Width>(rows); }

}  // namespace lostbits::intersect::simd
