// Limits the answers of forms to the range of a ray, as a caller does for forms that do not take the range themselves.
#pragma once

#include <cmath>
#include <limits>

#include "geometry/ray.hpp"
#include "intersect/table/table.hpp"
#include "number/concept.hpp"

namespace lostbits::intersect::table {

/// True if the interior belongs to the primitive as the form sees it: t = 0 for a ray from inside.
constexpr bool counts_interior(const Info& info, Shape shape) {
    return info.inside == Inside::zero || (info.inside == Inside::usual && inside_returns_zero(shape));
}

/// The range with which a form's answers are compared. It is the whole ray for a form that yields no t, and for a form
/// that takes the range itself: if the t of such a form lies outside the range, that is an error of the form and must
/// be shown. A form that takes the end of the ray has already compared its t with that end, unless the end is open.
template <class S>
Range<S> compared_range(const Info& info, Shape shape, Range<S> range) {
    if (info.roots == Roots::none || info.ranged) return {};
    if (takes_tmax(shape) && !range.open_ends.tmax && range.holds_any())
        range.tmax = std::numeric_limits<S>::infinity();
    return range;
}

/// Limits the answer of a form to the range of its ray, over any number type, so that a tape has these decisions as
/// operations. `tmin` and `tmax` are the ends of `range`, which is not the whole ray.
///
/// - A form of surfaces that yields both roots: the answer is the first root in the range, which may be the far one.
/// - A form that yields one root: the answer is that root, or a miss if it is not in the range, as in a renderer that
/// uses such a form.
/// - A form that counts the interior and yields near and far: the answer is the later of tmin and near, if the range
/// and [near, far] have a t in common. Slabs that start with tmin in place of 0 give the same answer.
/// - If a touch is a miss by the contract, an entry at the end of the ray is a miss too. A form with roots = first is
/// an exception, because it does not say whether its root is an entry.
/// - A hit at NaN stays a hit, so that the NaN is visible.
template <class T, class S>
Hit<T> limit_to_range(const Info& info, Shape shape, const Range<S>& range, const T& tmin, const T& tmax,
                      const Hit<T>& answer) {
    if (!range.holds_any()) {
        const bool are_both_closed = !range.open_ends.tmin && !range.open_ends.tmax && !std::isinf(range.tmin);
        const auto in_order = are_both_closed ? tmin <= tmax : tmin < tmax;
        return {answer.hit && tmin >= T(0) && in_order, answer.t, answer.near, answer.far};
    }

    const bool has_both_roots = info.roots == Roots::both, inside_counts = counts_interior(info, shape);
    const auto precedes_range = [&](const T& t) { return range.open_ends.tmin ? t <= tmin : t < tmin; };
    const auto is_t_before_range = precedes_range(answer.t);
    auto is_in_range = !is_t_before_range;
    T t = answer.t;

    // Takes the far root, or the beginning of the range from inside, if the first root lies before it.
    if (has_both_roots) {
        const bool is_tmin_closed = !range.open_ends.tmin && info.touching == Touching::hit;
        is_in_range = is_in_range || (!inside_counts   ? !precedes_range(answer.far)
                                      : is_tmin_closed ? answer.far >= tmin
                                                       : answer.far > tmin);
        t = named("t_in_range", select(is_t_before_range, inside_counts ? tmin : answer.far, answer.t));
    }

    auto is_hit = answer.hit && is_in_range;
    // The range of a ray without an end includes a root that overflows to infinity.
    if (range.tmax == std::numeric_limits<S>::infinity()) return {is_hit, t, answer.near, answer.far};
    is_hit = is_hit && !(range.open_ends.tmax ? t >= tmax : t > tmax);

    // An entry at the end of the ray only touches the primitive.
    const bool has_open_inside = info.touching == Touching::miss && has_inside(shape);
    if (has_open_inside && has_both_roots)
        is_hit = is_hit && !(answer.near <= tmax && answer.near >= tmax && answer.near < answer.far);
    else if (has_open_inside && info.roots == Roots::near_only)
        is_hit = is_hit && !(answer.near <= tmax && answer.near >= tmax);
    return {is_hit, t, answer.near, answer.far};
}

/// Limits the answers of a batch to the ranges of its rays, with comparisons in the format.
template <class S>
void limit_batch_to_range(const Info& info, Shape shape, const RayBatch<S>& rays, const HitBatch<S>& hits) {
    if (!rays.have_ranges()) return;
    for (std::size_t i = 0; i < rays.size(); ++i) {
        const Range<S> range = compared_range(info, shape, rays.range(i));
        if (hits.hit[i] == 0 || range.is_whole()) continue;
        const Hit<S> answer{true, hits.t[i], hits.near[i], hits.far[i]};
        const Hit<S> limited = limit_to_range(info, shape, range, range.tmin, range.tmax, answer);
        hits.hit[i] = limited.hit;
        hits.t[i] = limited.t;
    }
}

}  // namespace lostbits::intersect::table
