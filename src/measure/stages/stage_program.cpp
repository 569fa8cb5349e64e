#include "measure/stages/stage_program.hpp"

#include "measure/stages/span_stages.hpp"

namespace lostbits::measure::stages {

namespace {

using number::wide::ColumnPlace;
using number::wide::ColumnRecorder;
using number::wide::RecordedWords;

/// The inputs as numbers: one word is exact, and two lie within `input_error` of it.
template <RecordedWords W>
struct InputsOfStage {
    using E = Running<W>;

    bool two_words;

    static RecordedWord word(std::size_t input) { return RecordedWord::at(static_cast<ColumnPlace>(input)); }
    [[nodiscard]] E number(std::size_t input, std::size_t low) const {
        using lostbits::abs;
        const RecordedWord x = word(input);
        if constexpr (!std::is_same_v<W, RecordedWord>)
            if (two_words) return E(W(x, word(low)), RecordedWord(input_error) * abs(x));
        return E(W(x));
    }
    [[nodiscard]] E of_ray(std::size_t k) const { return number(input_of_ray + k, input_of_ray_low + k); }
    [[nodiscard]] E of_solid(std::size_t k) const { return number(input_of_solid + k, input_of_solid_low + k); }
    [[nodiscard]] Ray<E> ray() const { return {{of_ray(0), of_ray(1), of_ray(2)}, {of_ray(3), of_ray(4), of_ray(5)}}; }
};

template <template <class> class Of, RecordedWords W>
number::wide::ColumnProgram record(const StageTerms& terms) {
    using E = Running<W>;
    using Shape = Of<E>;
    ColumnRecorder recorder(terms.words, stage_inputs);
    const InputsOfStage<W> inputs{terms.two_words};
    InSpace<Shape, E> in;
    in.ray = inputs.ray();
    in.d2 = square(in.ray.direction);
    for (std::size_t k = 0; k < numbers_of<Shape>; ++k) in.solid[k] = inputs.of_solid(k);
    if (terms.matrix.placed) {
        const auto map = Affine<E>::of([&](std::size_t k) { return inputs.of_solid(most_numbers + k); });
        const auto entrance = Entrance<Shape, E>::of(in.solid, map, terms.matrix);
        in = {entrance.ray(in.ray), entrance.solid, in.d2, entrance.proper};
    } else {
        in.proper = is_proper<Shape>(in.solid);
    }
    const auto range = [&](RecordedMask& proper) {
        return range_of<E>(inputs.word(input_of_tmin), inputs.word(input_of_tmax), terms.open, proper);
    };
    const Finding<RecordedWord> found = settle_shape(in, {terms.ranged, terms.t, terms.distance}, range);
    std::vector<ColumnPlace> outputs{found.settled.place(), found.hit.place()};
    for (const auto* const x : {&found.t, &found.distance})
        for (const RecordedWord& word : {x->middle.hi, x->middle.lo, x->bound}) outputs.push_back(word.place());
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
