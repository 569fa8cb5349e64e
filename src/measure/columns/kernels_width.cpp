// Loops over columns of numbers with SIMD registers of one width. This file is compiled once for each width.
#include "measure/columns/kernels.hpp"
#include "number/width.hpp"

namespace lostbits::measure::columns {

RawKernels LOSTBITS_WITH_WIDTH_SUFFIX(raw_kernels)() {
    RawKernels kernels{.errors = compute_errors<BuildRegisters>,
                       .residuals = {},
                       .absolute_sums = add_absolute_values<BuildRegisters>,
                       .hits32 = keep_nearest<float, BuildRegisters>,
                       .hits64 = keep_nearest<double, BuildRegisters>};
    fill_residuals<BuildRegisters>(kernels);
    return kernels;
}

}  // namespace lostbits::measure::columns
