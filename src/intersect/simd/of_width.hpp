// The choice among functions that are compiled once for each register width.
#pragma once

#include <lostbits_widths.hpp>  // generated: the widths of this build
#include "intersect/simd/packed.hpp"

namespace lostbits::intersect::simd {

/// Returns a width with registers: `isa`, or the narrowest available width if `isa` is `scalar`. Throws
/// EnvironmentError if this processor runs no width of this build.
Isa register_isa(Isa isa);

/// A function for each width; null for the widths that this build does not have.
template <class F>
struct FunctionOfWidth {
    F* w128;
    F* w256;
    F* w512;

    /// Returns the function for an available width with registers.
    [[nodiscard]] constexpr F* at(Isa isa) const { return isa == Isa::w512 ? w512 : isa == Isa::w256 ? w256 : w128; }
};

/// Calls `use.operator()<width>()`, where `width` is `isa`, which has registers. A static variable of such a function
/// exists once for each width.
template <class Use>
decltype(auto) with_width(Isa isa, const Use& use) {
    switch (isa) {
        case Isa::w512: return use.template operator()<Isa::w512>();
        case Isa::w256: return use.template operator()<Isa::w256>();
        default: return use.template operator()<Isa::w128>();
    }
}

}  // namespace lostbits::intersect::simd

/// Initialises a `FunctionOfWidth`: `LOSTBITS_OF_EACH_WIDTH(raw_kernels)` holds `raw_kernels_w128`, `raw_kernels_w256`
/// and `raw_kernels_w512`. Template arguments follow the name.
#define LOSTBITS_OF_EACH_WIDTH(name, ...) \
    { LOSTBITS_W128(name, __VA_ARGS__), LOSTBITS_W256(name, __VA_ARGS__), LOSTBITS_W512(name, __VA_ARGS__) }
