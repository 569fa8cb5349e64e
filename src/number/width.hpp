// Registers and names for a source that is compiled once per register width (cmake/isa.cmake). The names contain the
// width, so those of different widths do not collide.
#pragma once

#include "number/pack.hpp"

namespace lostbits {
namespace {

/// This type has internal linkage, and so does every template that is instantiated over it (see `Registers`).
struct BuildRegisters : Registers<LOSTBITS_REGISTER_BYTES> {};

}  // namespace
}  // namespace lostbits

/// `fill_packed` becomes `fill_packed_w256`.
#define LOSTBITS_WITH_WIDTH_SUFFIX(name) LOSTBITS_JOIN_NAMES(name, LOSTBITS_ISA)
#define LOSTBITS_JOIN_NAMES(name, isa) LOSTBITS_JOIN_EXPANDED(name, isa)
#define LOSTBITS_JOIN_EXPANDED(name, isa) name##_##isa
