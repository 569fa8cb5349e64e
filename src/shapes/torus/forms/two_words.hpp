// `bracketed` in two words of the format.
#pragma once

#include "geometry/quartic_chain.hpp"
#include "number/wide/two_words.hpp"
#include "shapes/torus/forms/parts.hpp"

namespace lostbits::intersect::torus {

struct TorusInTwoWords {
    static constexpr Info info{
        .name = "torus.two_words",
        .title = "closest approach, Sturm's chain, in two words",
        .source = "two words after Dekker 1971 and Joldes, Muller and Popescu 2017",
        .roots = Roots::first_only,
    };

    template <Number T>
    static Hit<T> intersect(const Ray<T>& ray, const Torus<T>& torus) {
        if constexpr (stands_for_exact<T>) {
            return met<T, T>(ray, torus, [](const T& x) { return x; });
        } else {
            using W = number::wide::TwoWords<T>;
            const auto wide = [](const Vec<T>& v) { return Vec<W>(W(v.x), W(v.y), W(v.z)); };
            return met<T, W>({wide(ray.origin), wide(ray.direction)},
                             {wide(torus.centre), wide(torus.axis), W(torus.major_radius), W(torus.minor_radius)},
                             [](const W& x) { return x.hi; });
        }
    }

private:
    template <Number T, class W, class Word>
    static Hit<T> met(const Ray<W>& ray, const Torus<W>& torus, const Word& first) {
        const QuarticSpan<W> s = torus.span(ray);
        const QuarticChain<W> chain(s.f);
        const T t = named("t", first(s.time(near_first_root<W>(chain, s.b, s.bound, 6))));
        return {sign_changes(chain.at(s.b)) > sign_changes(chain.at_infinity()), t, t, t};
    }
};

}  // namespace lostbits::intersect::torus
