// The loops over columns in registers of one width; compiled once for each.
#include "measure/columns/kernels.hpp"
#include "measure/columns/residual_kernels.hpp"
#include "number/width.hpp"

namespace lostbits::measure::columns {

RawKernels LOSTBITS_NAME_OF_WIDTH(column_kernels)() {
    return {.errors = errors_of<Width>,
            .sphere_residuals = sphere_residuals<Width>,
            .box_residuals = box_residuals<Width>,
            .sizes = add_sizes<Width>,
            .hits32 = keep_nearest<float, Width>,
            .hits64 = keep_nearest<double, Width>};
}

}  // namespace lostbits::measure::columns
