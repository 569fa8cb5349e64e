// The forms as other people's compiler flags make them, to be measured beside the forms as they are written: same
// source, same registers, other bits.
#pragma once

#include <span>
#include <string_view>

#include "intersect/simd/packed.hpp"

namespace lostbits::intersect::simd {

/// `contract` is -ffp-contract=fast with FMA, `fastmath` is -ffast-math with FMA.
struct Variant {
    std::string_view name;
    Isa isa;  ///< the registers that it is compiled for
    std::span<const table::Intersector>
        rows;  ///< in the order of `catalogue()`, as `sphere.unified+contract`; native kernels alone
};

/// Those that this build contains and this processor runs. Their rows are in no other table, so they are used only
/// where they are asked for by name.
std::span<const Variant> variants();

}  // namespace lostbits::intersect::simd
