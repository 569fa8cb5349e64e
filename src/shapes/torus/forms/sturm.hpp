// Isolates the roots by the signs of Sturm's chain, as POV-Ray does if a scene says `sturm`. The origin is moved to the
// bounding sphere. Bisection and then Newton's steps find the root.
#pragma once

#include "geometry/quartic_chain.hpp"
#include "shapes/torus/forms/parts.hpp"

namespace lostbits::intersect::torus {

struct SturmTorus {
    static constexpr Info info{
        .name = "torus.sturm",
        .title = "origin moved to the bounding sphere, Sturm's chain",
        .source = "POV-Ray, source/core/shape/torus.cpp with the keyword sturm (there by regula falsi)",
        .direction = Direction::unit,
        .roots = Roots::first_only,
    };

    template <Number T>
    static Hit<T> intersect(const Ray<T>& ray, const Torus<T>& torus) {
        const TorusRay<T> relative(ray, torus);
        const T distance = length(relative.p), bound = torus.major_radius + torus.minor_radius + torus.minor_radius;
        const T shift = named("closer", select(distance > bound, distance - bound, T(0)));
        const Quartic<T> f = quartic_in_t<T>(relative.p + shift * relative.d, relative.d,
                                             relative.pz + shift * relative.dz, relative.dz, torus);
        const T a2 = square(f.a), quarter = f.a / T(4);
        const QuarticChain<T> chain(T(1), T(-3) * a2 / T(8) + f.b, a2 * f.a / T(8) - f.a * f.b / T(2) + f.c,
                                    T(-3) * square(a2) / T(256) + a2 * f.b / T(16) - f.a * f.c / T(4) + f.d);
        const T begin = quarter - shift, t = named("t", approximate_first_root<T>(chain, begin, bound, 6) - begin);
        return {count_sign_changes(chain.at(begin)) > count_sign_changes(chain.at_infinity()), t, t, t};
    }
};

}  // namespace lostbits::intersect::torus
