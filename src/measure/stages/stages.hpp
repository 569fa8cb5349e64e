// The stages that prove the answers of many rays at once, at the width of the machine's registers.
#pragma once

#include "intersect/simd/packed.hpp"
#include "measure/stages/raw_stages.hpp"
#include "shapes/solid.hpp"

namespace lostbits::measure::stages {

/// The stages of one shape at `isa`, and how many problems they take at a time. What they say is the same to the bit
/// at every width.
struct Stages {
    RawStages kernels;
    std::size_t lanes;
};

/// At an instruction set that is available. Those of single numbers, which a test compares, take as long to compile as
/// a width and are in no program: the narrowest packs stand for them.
const Stages& stages_of(Shape shape, intersect::simd::Isa isa);

}  // namespace lostbits::measure::stages
