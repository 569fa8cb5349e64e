// The stages in registers of one width; compiled once for each width.
#include "measure/stages/stage_loops.hpp"
#include "number/width.hpp"

namespace lostbits::measure::stages {

void LOSTBITS_WITH_WIDTH_SUFFIX(fill_stages)(RawStages& kernels) { fill_stages<Pack<double, BuildRegisters>>(kernels); }

}  // namespace lostbits::measure::stages
