// Stages, which prove the answers of many rays at once, at the width of the machine's registers.
//
// A *problem* is one ray and one primitive, with the range in which t counts. A *stage* is code that tries to settle
// many problems at once in one arithmetic: double or double-double with error bounds, or exact sums. A *finding* is
// what a stage has proved about one problem: whether the problem is settled and, if it is, whether the ray hits, and
// enclosures of t* and of the distance t* |d|. A problem that a stage cannot settle stays open. measure/truth then
// passes it to another stage, or computes with more bits (`find_truth`).
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
