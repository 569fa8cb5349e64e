// Rays and solids of any shape: decisions, and t* with its bound, from where the ray meets the solid first.
#pragma once

#include <type_traits>
#include <utility>

#include "geometry/ray.hpp"
#include "measure/stages/met_spans.hpp"
#include "measure/stages/problem.hpp"
#include "number/wide/running.hpp"
#include "shapes/solid.hpp"

namespace lostbits::measure::stages {

/// Whether a length is known closely enough: to 2^-33 of itself in one word, as `narrow_tightness` has it, to 2^-72 in
/// two; and in one binade, in range of what follows.
template <class P>
mask_t<P> is_close(const Running<P>& x) {
    return x.radius() <= P(narrow_tightness) * x.words() && in_one_binade(x.words(), x.radius());
}
template <class P>
mask_t<P> is_close(const Running<TwoWords<P>>& x) {
    return x.radius() <= P(wide_tightness) * x.first() && in_range(x.first()) && in_one_binade(x.words(), x.radius());
}
template <class P>
Enclosure<P> enclosure_of(const Running<P>& x) {
    return {{x.words(), P(0)}, x.radius()};
}
template <class P>
Enclosure<P> enclosure_of(const Running<TwoWords<P>>& x) {
    return {x.words(), x.radius()};
}

/// Whether a solid is one, by the limits of its keys: but for points on one line, which no line is proved to cross;
/// origins and directions that are not finite are found by `settle`.
template <class S, class E>
mask_t<typename E::P> is_proper(const std::array<E, most_stored>& solid) {
    using P = typename E::P;
    auto proper = P(0) <= P(0);
    const E zero(0);
    std::size_t k = 0;
    for (const Key& key : S::keys) {
        const auto is_there = [&](std::size_t i) { return (solid[i] > zero).yes() || (solid[i] < zero).yes(); };
        if (key.limit == Key::Limit::not_zero) proper = proper && (is_there(k) || is_there(k + 1) || is_there(k + 2));
        for (const std::size_t end = k + key.count(); k < end; ++k) {
            if (key.limit == Key::Limit::positive) proper = proper && (solid[k] > zero).yes();
            if (key.limit == Key::Limit::not_negative) proper = proper && (solid[k] >= zero).yes();
            if (key.limit == Key::Limit::below_before)
                proper = proper && (solid[k] >= zero).yes() && (solid[k] < solid[k - 1]).yes();
            if (key.limit == Key::Limit::within_before)
                proper = proper && (solid[k] > zero).yes() && (solid[k] < solid[k - 1]).yes();
            if (key.limit == Key::Limit::at_least_before) proper = proper && (solid[k - key.count()] <= solid[k]).yes();
        }
    }
    return proper;
}

/// A range of these numbers, where it holds more than one t: else, by `proper`, nothing is said.
template <class E, class P = typename E::P>
RangeOfSpan<E> range_of(const P& tmin, const P& tmax, OpenEnds open, mask_t<P>& proper) {
    const auto endless = tmax >= P(HUGE_VAL);
    proper = proper && tmin >= P(0) && tmin < P(HUGE_VAL) && tmin < tmax;
    const auto exactly = [](const P& x) { return E(std::remove_cvref_t<decltype(std::declval<E>().words())>(x)); };
    return {exactly(tmin), {exactly(select(endless, P(1), tmax)), exactly(select(endless, P(0), P(1)))}, open};
}

/// What is asked of all problems alike.
struct Asked {
    bool ranged, t, distance;
    OpenEnds open;
};

/// A ray and a solid as they stand in the space of the solid, d·d in the world, and whether the solid is proved to be
/// one.
template <class E>
struct InSpace {
    Ray<E> ray;
    std::array<E, most_stored> solid;
    E d2;
    mask_t<typename E::P> proper;
};

/// `in_object` of rays at one solid, in each lane: what the matrix makes of that is found once. Of a solid whose
/// determinant is not proved to differ from 0 nothing is proved. It is proper or not by the numbers before they are
/// scaled: a zero times what is known within bounds is no exact zero.
template <class E>
struct Entrance {
    UnderMatrix matrix;
    Affine<E> map;
    std::array<Vec<E>, 3> adjugate;
    std::array<E, most_stored> solid;
    mask_t<typename E::P> proper;

    template <class S>
    static Entrance of(const std::array<E, most_stored>& numbers, const UnderMatrix& matrix) {
        using P = typename E::P;
        const Affine<E> map = Affine<E>::of([&numbers](std::size_t k) { return numbers[most_numbers + k]; });
        Entrance all{matrix, map, map.adjugate(), numbers, is_proper<S>(numbers)};
        if (matrix.orientation == 0) all.proper = P(0) < P(0);
        if (matrix.is_inverse) return all;
        const E scale = E(matrix.orientation) * map.determinant();
        std::size_t k = 0;
        for (const Key& key : S::keys)
            for (const std::size_t end = k + key.count(); k < end; ++k)
                if (key.kind != Key::Kind::direction) all.solid[k] = scale * numbers[k];
        all.proper = all.proper && (scale > E(0)).yes();
        return all;
    }
    [[nodiscard]] Ray<E> ray(const Ray<E>& world) const {
        if (matrix.is_inverse) return {map.point(world.origin), map.linear(world.direction)};
        const E sign(matrix.orientation);
        return {sign * times(adjugate, world.origin - map.shift), sign * times(adjugate, world.direction)};
    }
};

/// S is the shape over `Running` words. The ends of the range are not looked at where there is none.
template <class S, class E, class P = typename E::P>
Finding<P> settle_shape(const InSpace<E>& in, const P& tmin, const P& tmax, const Asked& asked) {
    const Ray<E>& ray = in.ray;
    const auto span = S::of([&in](std::size_t k) { return in.solid[k]; }).span(ray);
    auto proper = in.proper && (in.d2 > E(0)).yes() &&
                  sum_of_sizes(ray.origin.x.first(), ray.origin.y.first(), ray.origin.z.first()) < P(HUGE_VAL);
    const auto met = [&] {
        if (asked.ranged) return first_met(span, range_of<E>(tmin, tmax, asked.open, proper));
        return first_met(span);
    }();
    const auto missed = proper && met.missed;
    auto hit = proper && met.hit;
    const P zero(0);
    Finding<P> found{missed, hit, {{zero, zero}, zero}, {{zero, zero}, zero}};
    if (!any_of(hit)) return found;
    const auto take = [&](const E& length, Enclosure<P>& to) {
        hit = hit && (met.at_origin || is_close(length));
        to = enclosure_of(length);
        to.middle = select<P>(met.at_origin, {zero, zero}, to.middle);
        to.bound = select(met.at_origin, zero, to.bound);
    };
    if (asked.t) take(met.t, found.t);
    if (asked.distance) take(met.t * sqrt(in.d2), found.distance);
    found.settled = hit || missed;
    found.hit = hit;
    return found;
}

}  // namespace lostbits::measure::stages
