// Stages, which prove the answers of many rays at once, at the width of the machine's registers.
#pragma once

#include "intersect/simd/packed.hpp"
#include "measure/stages/raw_stages.hpp"
#include "shapes/primitive.hpp"

namespace lostbits::measure::stages {

/// Stage that proves answers for one shape, in numbers of one or two words. With `Arithmetic::none` there is no stage.
template <class S>
struct ShapeStage {
    enum class Arithmetic : std::uint8_t { none, one_word, two_words, exact_sums };

    Shape shape{};
    Arithmetic arithmetic = Arithmetic::none;
    const RawStages* kernels = nullptr;

    explicit operator bool() const { return arithmetic != Arithmetic::none; }
    void operator()(const RawProblems<S>& problems) const;
    friend bool operator==(const ShapeStage&, const ShapeStage&) = default;
};
extern template void ShapeStage<float>::operator()(const RawProblems<float>&) const;
extern template void ShapeStage<double>::operator()(const RawProblems<double>&) const;

/// Stages of one shape at one instruction set, and the number of problems in a pack (`lanes`). The findings of a stage
/// have the same bits at every register width.
struct Stages {
    ShapeStage<float> binary64;        ///< binary32 inputs
    ShapeStage<double> double_double;  ///< inputs of one word or two
    /// Also settles rays that touch a flat shape, or that begin near a surface of degree four. Each number has one
    /// word, and there is no matrix and no range.
    ShapeStage<double> ties;
    bool ties_first;                                ///< true if `ties` takes less time than `double_double`
    void (*unit_directions)(const RawDirections&);  ///< the same for every shape
    std::size_t lanes;
};

/// Stages at an available instruction set. Single numbers have no stages: the narrowest packs are used for them.
Stages stages_of(Shape shape, intersect::simd::Isa isa);

}  // namespace lostbits::measure::stages
