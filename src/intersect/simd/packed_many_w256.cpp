// One ray against many solids in 256-bit registers: AVX2 and FMA.
#include "intersect/simd/packed_many_kernels.hpp"

namespace lostbits::intersect::simd {
namespace {

struct Width : Registers<32> {};

}  // namespace

void fill_many_w256(RawManyRow* rows) { fill_many_raw<Width>(rows); }

}  // namespace lostbits::intersect::simd
