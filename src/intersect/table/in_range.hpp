// Answers of forms that are not told the range of a ray, as whoever asks them takes what lies in it.
#pragma once

#include "intersect/table/table.hpp"

namespace lostbits::intersect::table {

/// Whether a form answers for all of a solid, its points inside too: 0 from there.
constexpr bool is_met_inside(const Info& info, Shape shape) {
    return info.inside == Inside::zero || (info.inside == Inside::usual && zero_inside(shape));
}

/// Takes away the answers beyond the ranges of the rays, compared in the format. A form of surfaces that tells both
/// roots has the first that lies in the range, which may be the far one; of a form that tells one root that one counts
/// or none does, as in a renderer that asks so. A form of solids that tells near and far is met where the range and
/// [near, far] both begin, if they have a t in common: as slabs that start with tmin in place of 0 have it. Told the
/// end of a ray a form has looked at that itself, but for an end that is open. By the word of a form to which a touch
/// is a miss so is an entry where the ray ends; one that tells the first root alone does not say whether it is an
/// entry. What tells no t answers for the whole ray, and a hit at NaN stays one, to be shown as that. What is told the
/// range itself answers for it: a t beyond is its mistake, and is shown as one.
template <class S>
void keep_in_range(const Info& info, Shape shape, const RayBatch<S>& rays, const HitBatch<S>& hits) {
    if (!rays.have_ranges() || info.roots == Roots::none || info.ranged) return;
    const bool both = info.roots == Roots::both, solid = is_met_inside(info, shape);
    const bool near_alone = info.roots == Roots::near_only;
    const bool open_inside = info.touching == Touching::miss && has_inside(shape);
    const bool looks_at_end = told_end(shape) && !rays.open.tmax;
    if (looks_at_end && rays.tmin.empty() && !rays.open.tmin) return;
    for (std::size_t i = 0; i < rays.size(); ++i) {
        Range<S> range = rays.range(i);
        if (hits.hit[i] == 0 || range.is_whole()) continue;
        if (!range.holds_any()) {
            hits.hit[i] = 0;
            continue;
        }
        if (looks_at_end) range.tmax = std::numeric_limits<S>::infinity();
        S& t = hits.t[i];
        const S far = hits.far[i];
        bool in = true;
        if (range.is_before(t)) {
            const bool joins = solid && far == range.tmin && !range.open.tmin && info.touching == Touching::hit;
            in = both && (solid ? far > range.tmin || joins : !range.is_before(far));
            t = solid ? range.tmin : far;
        }
        // At infinity, where a root beyond every number stands, no ray ends.
        const bool ends = range.tmax < std::numeric_limits<S>::infinity();
        const bool at_entry = hits.near[i] == range.tmax && (both ? hits.near[i] < far : near_alone);
        hits.hit[i] = in && !range.is_after(t) && !(ends && at_entry && open_inside);
    }
}

}  // namespace lostbits::intersect::table
