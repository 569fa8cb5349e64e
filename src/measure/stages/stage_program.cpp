#include "measure/stages/stage_program.hpp"

#include "measure/stages/stage_formula.hpp"

namespace lostbits::measure::stages {

namespace {

using number::wide::ColumnIndex;
using number::wide::ColumnRecorder;
using number::wide::ColumnWords;

template <template <class> class ShapeOver, ColumnWords W>
number::wide::ColumnProgram record(const StageKey& key) {
    ColumnRecorder recorder(key.words, stage_input_count);
    const auto word = [](std::size_t input) { return ColumnWord::at(static_cast<ColumnIndex>(input)); };
    const Finding<ColumnWord> found = settle_inputs<ShapeOver, W>(key, word);
    std::vector<ColumnIndex> outputs{found.settled.index(), found.hit.index()};
    for (const auto* const x : {&found.t, &found.distance})
        for (const ColumnWord& part : {x->middle.hi, x->middle.lo, x->bound}) outputs.push_back(part.index());
    return recorder.finish(std::move(outputs));
}

}  // namespace

number::wide::ColumnProgram record_stage(const StageKey& key) {
    number::wide::ColumnProgram program;
    Primitives::each([&]<template <class> class ShapeOver>() {
        if (shape_as<ShapeOver> != key.shape) return;
        program = key.words == 1 ? record<ShapeOver, ColumnWord>(key) : record<ShapeOver, TwoWords<ColumnWord>>(key);
    });
    return program;
}

}  // namespace lostbits::measure::stages
