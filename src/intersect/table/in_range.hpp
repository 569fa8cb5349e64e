// Limits the answers of forms to the range of a ray, as a caller does for forms that do not take the range themselves.
#pragma once

#include <cmath>
#include <limits>

#include "geometry/ray.hpp"
#include "intersect/table/table.hpp"
#include "number/concept.hpp"

namespace lostbits::intersect::table {

/// True if the form answers for the whole primitive, including its interior: from inside, t = 0.
constexpr bool is_met_inside(const Info& info, Shape shape) {
    return info.inside == Inside::zero || (info.inside == Inside::usual && inside_returns_zero(shape));
}

/// The range with which a form's answers are compared. It is all that lies ahead for a form that yields no t, and for
/// one that takes the range itself: if its t lies beyond, that is its error and is shown as one. A form that takes the
/// end of the ray has compared with it already, unless the end is open.
template <class S>
Range<S> range_to_ask(const Info& info, Shape shape, Range<S> range) {
    if (info.roots == Roots::none || info.ranged) return {};
    if (takes_tmax(shape) && !range.open.tmax && range.holds_any()) range.tmax = std::numeric_limits<S>::infinity();
    return range;
}

/// The answer of a form in the range of its ray, over any number, so that a tape has these decisions as operations.
/// `tmin` and `tmax` are the ends of `range`, which is not all that lies ahead.
///
/// - A form of surfaces that yields both roots: the first root in the range, which may be the far one.
/// - A form that yields one root: that root, or a miss if it is not in the range, as in a renderer that asks so.
/// - A form that answers for the interior and yields near and far: the later of tmin and near, if the range and
///   [near, far] have a t in common. Slabs that start with tmin in place of 0 give the same.
/// - If a touch is a miss by the contract, an entry at the end of the ray is a miss too. A form with roots = first is
///   excepted: it does not say whether its root is an entry.
/// - A hit at NaN stays a hit, so that it is shown as one.
template <class T, class S>
Hit<T> in_range(const Info& info, Shape shape, const Range<S>& range, const T& tmin, const T& tmax,
                const Hit<T>& said) {
    if (!range.holds_any()) {
        const bool both_closed = !range.open.tmin && !range.open.tmax && !std::isinf(range.tmin);
        const auto in_order = both_closed ? tmin <= tmax : tmin < tmax;
        return {said.hit && tmin >= T(0) && in_order, said.t, said.near, said.far};
    }
    const bool both = info.roots == Roots::both, inside_counts = is_met_inside(info, shape);
    const auto before = [&](const T& t) { return range.open.tmin ? t <= tmin : t < tmin; };
    const auto is_behind = before(said.t);
    auto counts = !is_behind;
    T t = said.t;
    if (both) {
        const bool joins = !range.open.tmin && info.touching == Touching::hit;
        counts = counts || (!inside_counts ? !before(said.far) : joins ? said.far >= tmin : said.far > tmin);
        t = named("t_in_range", select(is_behind, inside_counts ? tmin : said.far, said.t));
    }
    auto in = said.hit && counts;
    // A ray without an end also reaches a root that overflows to infinity.
    if (range.tmax == std::numeric_limits<S>::infinity()) return {in, t, said.near, said.far};
    in = in && !(range.open.tmax ? t >= tmax : t > tmax);
    const bool open_inside = info.touching == Touching::miss && has_inside(shape);
    if (open_inside && both) in = in && !(said.near <= tmax && said.near >= tmax && said.near < said.far);
    else if (open_inside && info.roots == Roots::near_only) in = in && !(said.near <= tmax && said.near >= tmax);
    return {in, t, said.near, said.far};
}

/// Limits the answers of a batch to the ranges of its rays. The comparisons are in the format.
template <class S>
void keep_in_range(const Info& info, Shape shape, const RayBatch<S>& rays, const HitBatch<S>& hits) {
    if (!rays.have_ranges()) return;
    for (std::size_t i = 0; i < rays.size(); ++i) {
        const Range<S> range = range_to_ask(info, shape, rays.range(i));
        if (hits.hit[i] == 0 || range.is_whole()) continue;
        const Hit<S> said{true, hits.t[i], hits.near[i], hits.far[i]};
        const Hit<S> kept = in_range(info, shape, range, range.tmin, range.tmax, said);
        hits.hit[i] = kept.hit;
        hits.t[i] = kept.t;
    }
}

}  // namespace lostbits::intersect::table
