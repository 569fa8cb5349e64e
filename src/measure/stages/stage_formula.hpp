// Stage of a shape as one formula of its inputs, over any words. A program records this formula.
#pragma once

#include "measure/stages/span_stages.hpp"
#include "measure/stages/stage_program.hpp"

namespace lostbits::measure::stages {

/// Findings that the inputs `word(k)` prove. An input of one word is exact; an input of two words is within
/// `input_error` of their sum.
template <template <class> class ShapeOver, class W, class Word>
auto settle_inputs(const StageKey& key, const Word& word) {
    using E = RunningError<W>;
    using P = typename E::P;
    using Shape = ShapeOver<E>;
    const auto number = [&](std::size_t input, std::size_t low) {
        using lostbits::abs;
        const P x = word(input);
        if constexpr (!std::is_same_v<W, P>)
            if (key.two_words) return E(W(x, word(low)), P(input_error) * abs(x));
        return E(W(x));
    };

    // Reads the problem as it is stored.
    const auto ray_number = [&](std::size_t k) { return number(input_of_ray + k, input_of_ray_low + k); };
    const auto primitive_number = [&](std::size_t k) {
        return number(input_of_primitive + k, input_of_primitive_low + k);
    };
    ObjectSpaceProblem<Shape, E> problem;
    problem.ray = {{ray_number(0), ray_number(1), ray_number(2)}, {ray_number(3), ray_number(4), ray_number(5)}};
    problem.d2 = square(problem.ray.direction);
    for (std::size_t k = 0; k < number_count<Shape>; ++k) problem.primitive[k] = primitive_number(k);

    // Takes it to the object space of a matrix.
    if (key.matrix.exists) {
        const auto map = Affine<E>::of([&](std::size_t k) { return primitive_number(max_number_count + k); });
        const auto object_map = ObjectSpaceMap<Shape, E>::of(problem.primitive, map, key.matrix);
        problem = {object_map.ray(problem.ray), object_map.primitive, problem.d2, object_map.proper};
    } else {
        problem.proper = is_proper<Shape>(problem.primitive);
    }

    const auto range = [&](mask_t<P>& proper) {
        return range_of<E>(word(input_of_tmin), word(input_of_tmax), key.open_ends, proper);
    };
    return settle_shape(problem, {key.has_ranges, key.wants_t, key.wants_distance}, range);
}

}  // namespace lostbits::measure::stages
