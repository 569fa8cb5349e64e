// Decides whether rays meet primitives of any shape, and encloses t*, the first t at which a ray meets its primitive.
#pragma once

#include <array>
#include <type_traits>
#include <utility>

#include "geometry/ray.hpp"
#include "measure/stages/problem.hpp"
#include "measure/stages/span_hits.hpp"
#include "number/wide/running_error.hpp"
#include "shapes/primitive.hpp"

namespace lostbits::measure::stages {

/// Tests if a length is known closely enough: to 2^-33 of itself in one word (`narrow_tightness`), to 2^-72 in two
/// (`wide_tightness`). The length must also lie in one binade and, in two words, satisfy `in_range`.
template <class P>
mask_t<P> is_close(const RunningError<P>& x) {
    return x.radius() <= P(narrow_tightness) * x.words() && in_one_binade(x.words(), x.radius());
}
template <class P>
mask_t<P> is_close(const RunningError<TwoWords<P>>& x) {
    return x.radius() <= P(wide_tightness) * x.first() && in_range(x.first()) && in_one_binade(x.words(), x.radius());
}
template <class P>
Enclosure<P> enclosure_of(const RunningError<P>& x) {
    return {{x.words(), P(0)}, x.radius()};
}
template <class P>
Enclosure<P> enclosure_of(const RunningError<TwoWords<P>>& x) {
    return {x.words(), x.radius()};
}

/// The index of the key that a number belongs to, and the index of the number within this key.
struct NumberIndex {
    std::size_t key, index_in_key;
};
/// Returns the index of a number of a primitive of type S.
template <class S>
constexpr NumberIndex index_of(std::size_t number) {
    std::size_t key = 0;
    for (; number >= S::keys[key].count(); ++key) number -= S::keys[key].count();
    return {key, number};
}

/// Tests if number k of a primitive is within the limit of its key.
template <class S, std::size_t k, class E>
mask_t<typename E::P> is_within_limit(const std::array<E, number_count<S>>& primitive) {
    using Limit = Key::Limit;
    constexpr NumberIndex index = index_of<S>(k);
    constexpr Key key = S::keys[index.key];
    const E zero(0);
    if constexpr (key.limit == Limit::not_zero && index.index_in_key == 0) {
        const E &x = primitive[k], &y = primitive[k + 1], &z = primitive[k + 2];
        return (x > zero).yes() || (x < zero).yes() || (y > zero).yes() || (y < zero).yes() || (z > zero).yes() ||
               (z < zero).yes();
    } else if constexpr (key.limit == Limit::positive) {
        return (primitive[k] > zero).yes();
    } else if constexpr (key.limit == Limit::not_negative) {
        return (primitive[k] >= zero).yes();
    } else if constexpr (key.limit == Limit::non_negative_below_previous) {
        return (primitive[k] >= zero).yes() && (primitive[k] < primitive[k - 1]).yes();
    } else if constexpr (key.limit == Limit::positive_below_previous) {
        return (primitive[k] > zero).yes() && (primitive[k] < primitive[k - 1]).yes();
    } else if constexpr (key.limit == Limit::at_least_previous) {
        return (primitive[k - key.count()] <= primitive[k]).yes();
    } else {
        return zero.first() <= zero.first();
    }
}

/// Tests if the numbers of a primitive are valid, by the limits of its keys. A triangle whose corners lie on one line
/// passes this test, but no ray is proved to cross it. `settle` finds origins and directions that are not finite.
template <class S, class E, std::size_t... k>
mask_t<typename E::P> is_within_limits(const std::array<E, number_count<S>>& primitive, std::index_sequence<k...>) {
    return (is_within_limit<S, k>(primitive) && ...);
}
template <class S, class E>
mask_t<typename E::P> is_proper(const std::array<E, number_count<S>>& primitive) {
    return is_within_limits<S>(primitive, std::make_index_sequence<number_count<S>>());
}

/// Returns the range from tmin to tmax. If it does not contain more than one t, `proper` becomes false, and nothing is
/// proved.
template <class E, class P = typename E::P>
SpanRange<E> range_of(const P& tmin, const P& tmax, OpenEnds open_ends, mask_t<P>& proper) {
    const auto is_endless = tmax >= P(HUGE_VAL);
    proper = proper && tmin >= P(0) && tmin < P(HUGE_VAL) && tmin < tmax;
    const auto exact_number = [](const P& x) { return E(std::remove_cvref_t<decltype(std::declval<E>().words())>(x)); };
    return {exact_number(tmin),
            {exact_number(select(is_endless, P(1), tmax)), exact_number(select(is_endless, P(0), P(1)))},
            open_ends};
}

/// Results that are requested for all problems. `has_ranges` is true if the rays have ranges; `t` and `distance` are
/// true for the lengths that are needed.
struct RequestedResults {
    bool has_ranges, t, distance;
};

/// A ray and a primitive in the space of the primitive, and d·d in the world. `proper` is true if the numbers of the
/// primitive are proved to be valid.
template <class S, class E>
struct ObjectSpaceProblem {
    Ray<E> ray;
    std::array<E, number_count<S>> primitive;
    E d2;
    mask_t<typename E::P> proper;
};

/// Does the work of `to_object_space` (shapes/transform.hpp) for rays at one primitive, in each lane. Everything that
/// depends only on the matrix and the primitive is computed once. If the determinant is not proved to differ from 0,
/// nothing is proved. `proper` is decided before the numbers are scaled, since zero times a number with an error bound
/// is not an exact zero.
template <class S, class E>
struct ObjectSpaceMap {
    MatrixKind matrix;
    Affine<E> map;
    std::array<Vec<E>, 3> adjugate;
    std::array<E, number_count<S>> primitive;
    mask_t<typename E::P> proper;

    static ObjectSpaceMap of(const std::array<E, number_count<S>>& numbers, const Affine<E>& map,
                             const MatrixKind& matrix) {
        using P = typename E::P;
        ObjectSpaceMap result{matrix, map, map.adjugate(), numbers, is_proper<S>(numbers)};
        if (matrix.orientation == 0) result.proper = P(0) < P(0);
        if (matrix.is_inverse) return result;
        const E scale = E(matrix.orientation) * map.determinant();
        for (std::size_t k = 0; k < number_count<S>; ++k)
            if (S::keys[index_of<S>(k).key].kind != Key::Kind::direction) result.primitive[k] = scale * numbers[k];
        result.proper = result.proper && (scale > E(0)).yes();
        return result;
    }
    [[nodiscard]] Ray<E> ray(const Ray<E>& world) const {
        if (matrix.is_inverse) return {map.point(world.origin), map.linear(world.direction)};
        const E orientation_sign(matrix.orientation);
        return {orientation_sign * times(adjugate, world.origin - map.shift),
                orientation_sign * times(adjugate, world.direction)};
    }
};

/// Returns the enclosure of a length, and clears `hit` in the lanes in which the length is neither `exact` nor known
/// closely enough. The length is 0 in lanes in which `at_origin` is set.
template <class E, class P = typename E::P>
Enclosure<P> accept_length(const E& length, const mask_t<P>& at_origin, const mask_t<P>& exact, mask_t<P>& hit) {
    const P zero(0);
    const Enclosure<P> x = enclosure_of(length);
    hit = hit && (exact || is_close(length));
    return {select<P>(at_origin, {zero, zero}, x.middle), select(at_origin, zero, x.bound)};
}

/// Settles rays at a shape; S is the shape over `RunningError` words. The lambda copies the numbers: since no pointer
/// refers to them, the compiler keeps them in registers and does not forget what it knows about them. `range(proper)`
/// is called only if the rays have ranges.
template <template <class> class S, class E, class Range, class P = typename E::P>
Finding<P> settle_shape(const ObjectSpaceProblem<S<E>, E>& problem, const RequestedResults& requested,
                        const Range& range) {
    const Ray<E>& ray = problem.ray;
    const auto span =
        primitive_from<S, E>([primitive = problem.primitive](std::size_t k) { return primitive[k]; }).span(ray);
    auto proper = problem.proper && (problem.d2 > E(0)).yes() &&
                  sum_of_sizes(ray.origin.x.first(), ray.origin.y.first(), ray.origin.z.first()) < P(HUGE_VAL);
    const SpanHit<E> span_hit = requested.has_ranges ? first_span_hit(span, range(proper)) : first_span_hit(span);
    const auto missed = proper && span_hit.missed;
    auto hit = proper && span_hit.hit;
    const Enclosure<P> no_length{{P(0), P(0)}, P(0)};
    Finding<P> found{missed, hit, no_length, no_length};
    if (is_unset(hit)) return found;
    if (requested.t) found.t = accept_length(span_hit.t, span_hit.at_origin, span_hit.at_origin, hit);
    if (requested.distance)
        found.distance = accept_length(span_hit.t * sqrt(problem.d2), span_hit.at_origin, span_hit.at_origin, hit);
    found.settled = hit || missed;
    found.hit = hit;
    return found;
}

}  // namespace lostbits::measure::stages
