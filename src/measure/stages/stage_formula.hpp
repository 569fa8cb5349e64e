// The stage of a shape as one formula of its inputs, over any words. Recorded, it becomes a program.
#pragma once

#include "measure/stages/span_stages.hpp"
#include "measure/stages/stage_program.hpp"

namespace lostbits::measure::stages {

/// Findings that the inputs `word(k)` prove. An input of one word is exact; an input of two words is within
/// `input_error` of their sum.
template <template <class> class Of, class W, class Word>
auto settle_inputs(const StageTerms& terms, const Word& word) {
    using E = Running<W>;
    using P = typename E::P;
    using Shape = Of<E>;
    const auto number = [&](std::size_t input, std::size_t low) {
        using lostbits::abs;
        const P x = word(input);
        if constexpr (!std::is_same_v<W, P>)
            if (terms.two_words) return E(W(x, word(low)), P(input_error) * abs(x));
        return E(W(x));
    };
    const auto of_ray = [&](std::size_t k) { return number(input_of_ray + k, input_of_ray_low + k); };
    const auto of_primitive = [&](std::size_t k) { return number(input_of_primitive + k, input_of_primitive_low + k); };
    InSpace<Shape, E> in;
    in.ray = {{of_ray(0), of_ray(1), of_ray(2)}, {of_ray(3), of_ray(4), of_ray(5)}};
    in.d2 = square(in.ray.direction);
    for (std::size_t k = 0; k < numbers_of<Shape>; ++k) in.primitive[k] = of_primitive(k);
    if (terms.matrix.placed) {
        const auto map = Affine<E>::of([&](std::size_t k) { return of_primitive(most_numbers + k); });
        const auto object_map = ObjectSpaceMap<Shape, E>::of(in.primitive, map, terms.matrix);
        in = {object_map.ray(in.ray), object_map.primitive, in.d2, object_map.proper};
    } else {
        in.proper = is_proper<Shape>(in.primitive);
    }
    const auto range = [&](mask_t<P>& proper) {
        return range_of<E>(word(input_of_tmin), word(input_of_tmax), terms.open, proper);
    };
    return settle_shape(in, {terms.ranged, terms.t, terms.distance}, range);
}

}  // namespace lostbits::measure::stages
