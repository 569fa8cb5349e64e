// One ray against many solids in 512-bit registers: AVX-512 F, DQ and VL.
#include "intersect/simd/packed_many_kernels.hpp"

namespace lostbits::intersect::simd {
namespace {

struct Width : Registers<64> {};

}  // namespace

void fill_many_w512(RawManyRow* rows) { fill_many_raw<Width>(rows); }

}  // namespace lostbits::intersect::simd
