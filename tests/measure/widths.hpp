// Checks that are repeated at every register width.
#pragma once

#include "catch.hpp"
#include "intersect/simd/packed.hpp"

namespace lostbits::test {

/// Calls `run(isa)` once for each available register width, scalar first, while that width is set.
template <class Run>
void at_every_width(const Run& run) {
    const auto before = intersect::simd::current_isa();
    for (const intersect::simd::Isa isa : intersect::simd::available_isas()) {
        intersect::simd::set_isa(isa);
        INFO("--isa " << name_of(isa));
        run(isa);
    }
    intersect::simd::set_isa(before);
}

}  // namespace lostbits::test
