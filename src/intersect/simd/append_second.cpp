#include "intersect/catalogue_second.hpp"
#include "intersect/simd/append_many_kernels.hpp"

namespace lostbits::intersect::simd {

template void append_many_kernels<SecondForms>(std::vector<ManyFormKernels>& rows);

}  // namespace lostbits::intersect::simd
