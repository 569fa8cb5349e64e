// One ray against many solids in 128-bit registers: the baseline: SSE2 on x86-64, NEON on AArch64. No FMA is assumed.
#include "intersect/simd/packed_many_kernels.hpp"

namespace lostbits::intersect::simd {
namespace {

struct Width : Registers<16> {};

}  // namespace

void fill_many_w128(RawManyRow* rows) { fill_many_raw<Width>(rows); }

}  // namespace lostbits::intersect::simd
