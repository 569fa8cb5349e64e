#include "intersect/catalogue_first.hpp"
#include "intersect/simd/append_many_kernels.hpp"

namespace lostbits::intersect::simd {

template void append_many_kernels<FirstForms>(std::vector<ManyFormKernels>& rows);

}  // namespace lostbits::intersect::simd
