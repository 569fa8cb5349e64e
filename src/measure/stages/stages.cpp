#include "measure/stages/stages.hpp"

#include <array>

namespace lostbits::measure::stages {

using intersect::simd::Isa;

namespace {

using OfShapes = std::array<Stages, shape_rows.size()>;

/// The function that fills the table was compiled for the width too, so a width that the machine has not is not filled.
/// Registers of 512 bits have the functions of 256: their own took half as long again to compile, and gave maps that
/// took 3 to 4 % less of the processor.
OfShapes filled_by(void (*fill)(RawStages*), std::size_t lanes) {
    RawStages raw[shape_rows.size()] = {};
    fill(raw);
    OfShapes all;
    for (std::size_t k = 0; k < all.size(); ++k) all[k] = {raw[k], lanes};
    return all;
}

const OfShapes& stages_at(Isa isa) {
#if defined(__x86_64__)
    if (isa == Isa::w256 || isa == Isa::w512) {
        static const OfShapes w256 = filled_by(fill_stages_w256, 4);
        return w256;
    }
#endif
    static const OfShapes w128 = filled_by(fill_stages_w128, 2);
    return w128;
}

}  // namespace

const Stages& stages_of(Shape shape, Isa isa) { return stages_at(isa)[static_cast<std::size_t>(shape)]; }

}  // namespace lostbits::measure::stages
