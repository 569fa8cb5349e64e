// The quartic of the closest approach. The signs of Sturm's chain isolate its first root ahead, so the form needs no
// cube root and never confuses two roots.
#pragma once

#include "geometry/quartic_chain.hpp"
#include "shapes/torus/forms/parts.hpp"

namespace lostbits::intersect::torus {

struct Bracketed {
    static constexpr Info info{
        .name = "torus.bracketed",
        .title = "quartic from the closest approach, Sturm's chain",
        .source = "this project: see Torus::span and QuarticChain",
        .roots = Roots::first_only,
    };

    template <Number T>
    static Hit<T> intersect(const Ray<T>& ray, const Torus<T>& torus) {
        const QuarticSpan<T> s = torus.span(ray);
        const QuarticChain<T> chain(s.f);
        const T t = named("t", s.t_at(approximate_first_root<T>(chain, s.b, s.bound, 6)));
        return {count_sign_changes(chain.at(s.b)) > count_sign_changes(chain.at_infinity()), t, t, t};
    }
};

}  // namespace lostbits::intersect::torus
