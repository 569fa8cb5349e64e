// The forms in 512-bit registers: AVX-512 F, DQ and VL.
#include "intersect/simd/packed_kernels.hpp"

namespace lostbits::intersect::simd {
namespace {

struct Width : Registers<64> {};

}  // namespace

void fill_packed_w512(RawRow* rows) { fill_raw<Width>(rows); }

}  // namespace lostbits::intersect::simd
