#include "output/image/exr_parts.hpp"

namespace lostbits::output::image {

std::pair<std::string, std::string> compiler_attribute() { return {"lostbits:compiler", LOSTBITS_COMPILER}; }

std::pair<std::string, std::string> primitives_attribute() {
    return {"lostbits:objects",
            "0 none, otherwise 1 + the index of the primitive in the scene, from 0: 1 is primitive 0"};
}

}  // namespace lostbits::output::image
