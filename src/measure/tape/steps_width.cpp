// Runs the steps of a tape in registers of one width. This file is compiled once for each width.
#include "measure/tape/step_kernels.hpp"
#include "number/width.hpp"

namespace lostbits::measure::tape {

void LOSTBITS_WITH_WIDTH_SUFFIX(run_steps)(const TapeStep* steps, std::size_t count, const StepColumns& columns) {
    run_steps<BuildRegisters>(steps, count, columns);
}

}  // namespace lostbits::measure::tape
