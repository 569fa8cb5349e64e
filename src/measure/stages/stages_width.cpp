// The stages in registers of one width; compiled once for each.
#include "measure/stages/stage_loops.hpp"
#include "number/width.hpp"

namespace lostbits::measure::stages {

void LOSTBITS_NAME_OF_WIDTH(fill_stages)(RawStages* of_shape) { fill_stages<Pack<double, Width>>(of_shape); }

}  // namespace lostbits::measure::stages
