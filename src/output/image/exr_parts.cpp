#include "output/image/exr_parts.hpp"

namespace lostbits::output::image {

std::pair<std::string, std::string> compiler_attribute() { return {"lostbits:compiler", LOSTBITS_COMPILER}; }

}  // namespace lostbits::output::image
