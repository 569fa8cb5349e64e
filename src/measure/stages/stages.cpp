#include "measure/stages/stages.hpp"

#include <array>

#include "measure/stages/stage_loops.hpp"

namespace lostbits::measure::stages {

using intersect::simd::Isa;

namespace {

using OfShapes = std::array<Stages, 2>;

OfShapes stages_at(Isa isa) {
    RawStages raw[2] = {};
    std::size_t lanes = 1;
    switch (isa) {
        case Isa::scalar: fill_stages<double>(raw); break;
        case Isa::w128: fill_stages_w128(raw), lanes = 2; break;
#if defined(LOSTBITS_PACKED_X86)
        case Isa::w256: fill_stages_w256(raw), lanes = 4; break;
        case Isa::w512: fill_stages_w512(raw), lanes = 8; break;
#else
        default: break;
#endif
    }
    return {Stages{raw[0], lanes}, Stages{raw[1], lanes}};
}

}  // namespace

const Stages& stages_of(Shape shape, Isa isa) {
    static const std::array all{stages_at(Isa::scalar), stages_at(Isa::w128), stages_at(Isa::w256),
                                stages_at(Isa::w512)};
    return all[static_cast<std::size_t>(isa)][shape == Shape::box ? 1 : 0];
}

}  // namespace lostbits::measure::stages
