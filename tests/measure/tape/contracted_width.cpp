// The forms in 256-bit registers as a compiler makes them that may round a product together with the sum it is added
// to.
#include "measure/tape/contracted_width.hpp"
#include "intersect/simd/packed_kernels.hpp"
#include "number/width.hpp"

namespace lostbits::test::test_contraction {

void fill_contracted(intersect::simd::RawRow* rows) { intersect::simd::fill_raw<Width>(rows); }

}  // namespace lostbits::test::test_contraction
