#include "measure/stages/stage_program.hpp"

#include "measure/stages/stage_formula.hpp"

namespace lostbits::measure::stages {

namespace {

using number::wide::ColumnPlace;
using number::wide::ColumnRecorder;
using number::wide::RecordedWords;

template <template <class> class Of, RecordedWords W>
number::wide::ColumnProgram record(const StageTerms& terms) {
    ColumnRecorder recorder(terms.words, stage_inputs);
    const auto word = [](std::size_t input) { return RecordedWord::at(static_cast<ColumnPlace>(input)); };
    const Finding<RecordedWord> found = settle_inputs<Of, W>(terms, word);
    std::vector<ColumnPlace> outputs{found.settled.place(), found.hit.place()};
    for (const auto* const x : {&found.t, &found.distance})
        for (const RecordedWord& part : {x->middle.hi, x->middle.lo, x->bound}) outputs.push_back(part.place());
    return recorder.finish(std::move(outputs));
}

}  // namespace

number::wide::ColumnProgram record_stage(const StageTerms& terms) {
    number::wide::ColumnProgram program;
    Solids::each([&]<template <class> class Of>() {
        if (shape_as<Of> != terms.shape) return;
        program = terms.words == 1 ? record<Of, RecordedWord>(terms) : record<Of, TwoWords<RecordedWord>>(terms);
    });
    return program;
}

}  // namespace lostbits::measure::stages
