#include "measure/stages/stage_program.hpp"

#include "measure/stages/stage_formula.hpp"

namespace lostbits::measure::stages {

namespace {

using number::wide::ColumnIndex;
using number::wide::ColumnRecorder;
using number::wide::ColumnWords;

template <template <class> class ShapeOver, ColumnWords W>
number::wide::ColumnProgram record(const StageTerms& terms) {
    ColumnRecorder recorder(terms.words, stage_inputs);
    const auto word = [](std::size_t input) { return ColumnWord::at(static_cast<ColumnIndex>(input)); };
    const Finding<ColumnWord> found = settle_inputs<ShapeOver, W>(terms, word);
    std::vector<ColumnIndex> outputs{found.settled.index(), found.hit.index()};
    for (const auto* const x : {&found.t, &found.distance})
        for (const ColumnWord& part : {x->middle.hi, x->middle.lo, x->bound}) outputs.push_back(part.index());
    return recorder.finish(std::move(outputs));
}

}  // namespace

number::wide::ColumnProgram record_stage(const StageTerms& terms) {
    number::wide::ColumnProgram program;
    Primitives::each([&]<template <class> class ShapeOver>() {
        if (shape_as<ShapeOver> != terms.shape) return;
        program =
            terms.words == 1 ? record<ShapeOver, ColumnWord>(terms) : record<ShapeOver, TwoWords<ColumnWord>>(terms);
    });
    return program;
}

}  // namespace lostbits::measure::stages
