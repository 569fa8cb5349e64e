// Loops over columns of numbers with SIMD registers of one width. This file is compiled once for each width.
#include "measure/columns/kernels.hpp"
#include "number/width.hpp"

namespace lostbits::measure::columns {

RawKernels LOSTBITS_NAME_OF_WIDTH(raw_kernels)() {
    RawKernels kernels{.errors = errors_of<Width>,
                       .residuals = {},
                       .sizes = add_sizes<Width>,
                       .hits32 = keep_nearest<float, Width>,
                       .hits64 = keep_nearest<double, Width>};
    fill_residuals<Width>(kernels);
    return kernels;
}

}  // namespace lostbits::measure::columns
