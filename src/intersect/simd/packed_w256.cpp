// The forms in 256-bit registers: AVX2 and FMA.
#include "intersect/simd/packed_kernels.hpp"

namespace lostbits::intersect::simd {
namespace {

struct Width : Registers<32> {};

}  // namespace

void fill_packed_w256(RawRow* rows) { fill_raw<Width>(rows); }

}  // namespace lostbits::intersect::simd
