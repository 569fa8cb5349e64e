// Answers of forms that are not told the range of a ray, as whoever asks them takes what lies in it.
#pragma once

#include <cmath>
#include <limits>

#include "geometry/ray.hpp"
#include "intersect/table/table.hpp"
#include "number/concept.hpp"

namespace lostbits::intersect::table {

/// True if a form answers for the whole primitive, its interior too: 0 from there.
constexpr bool is_met_inside(const Info& info, Shape shape) {
    return info.inside == Inside::zero || (info.inside == Inside::usual && zero_inside(shape));
}

/// The part of a range that is held against a form's answers. Told the end of a ray a form has looked at that itself,
/// but for an end that is open. All that lies ahead where nothing is asked: of what tells no t, of what is told the
/// range itself, whose t beyond is its mistake and is shown as one.
template <class S>
Range<S> range_to_ask(const Info& info, Shape shape, Range<S> range) {
    if (info.roots == Roots::none || info.ranged) return {};
    if (told_end(shape) && !range.open.tmax && range.holds_any()) range.tmax = std::numeric_limits<S>::infinity();
    return range;
}

/// The answer of a form in the range of its ray: over any number, so that a tape has these decisions as operations.
/// `tmin` and `tmax` are the ends of `range`, which is not all that lies ahead.
///
/// A form of surfaces that tells both roots has the first that lies in the range, which may be the far one; of a form
/// that tells one root that one counts or none does, as in a renderer that asks so. A form of solids that tells near
/// and far is met where the range and [near, far] both begin, if they have a t in common: as slabs that start with tmin
/// in place of 0 have it. By the property of a form to which a touch is a miss so is an entry where the ray ends; one
/// that tells the first root alone does not say whether it is an entry. A hit at NaN stays one, to be shown as that.
template <class T, class S>
Hit<T> in_range(const Info& info, Shape shape, const Range<S>& range, const T& tmin, const T& tmax,
                const Hit<T>& said) {
    if (!range.holds_any()) {
        const bool both_closed = !range.open.tmin && !range.open.tmax && !std::isinf(range.tmin);
        const auto in_order = both_closed ? tmin <= tmax : tmin < tmax;
        return {said.hit && tmin >= T(0) && in_order, said.t, said.near, said.far};
    }
    const bool both = info.roots == Roots::both, solid = is_met_inside(info, shape);
    const auto before = [&](const T& t) { return range.open.tmin ? t <= tmin : t < tmin; };
    const auto is_behind = before(said.t);
    auto counts = !is_behind;
    T t = said.t;
    if (both) {
        const bool joins = !range.open.tmin && info.touching == Touching::hit;
        counts = counts || (!solid ? !before(said.far) : joins ? said.far >= tmin : said.far > tmin);
        t = named("t_in_range", select(is_behind, solid ? tmin : said.far, said.t));
    }
    auto in = said.hit && counts;
    // At infinity, where a root beyond every number stands, no ray ends.
    if (range.tmax == std::numeric_limits<S>::infinity()) return {in, t, said.near, said.far};
    in = in && !(range.open.tmax ? t >= tmax : t > tmax);
    const bool open_inside = info.touching == Touching::miss && has_inside(shape);
    if (open_inside && both) in = in && !(said.near <= tmax && said.near >= tmax && said.near < said.far);
    else if (open_inside && info.roots == Roots::near_only) in = in && !(said.near <= tmax && said.near >= tmax);
    return {in, t, said.near, said.far};
}

/// Takes away the answers beyond the ranges of the rays, compared in the format.
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
