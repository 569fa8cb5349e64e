// A filter by the span of the ellipsoid: the interval in which the line is inside, from products of the radii.
#pragma once

#include "intersect/filter/by_span.hpp"
#include "intersect/info.hpp"
#include "shapes/ellipsoid/ellipsoid.hpp"

namespace lostbits::intersect::ellipsoid {

struct FilteredEllipsoid : filter::SpanFilter<FilteredEllipsoid, Ellipsoid> {
    static constexpr Info info{
        .name = "ellipsoid.filtered",
        .title = filter::title_by_span,
        .source = filter::source_by_span,
        .roots = Roots::first_only,
    };
};

}  // namespace lostbits::intersect::ellipsoid
