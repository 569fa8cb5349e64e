// A filter by the span of the plane: the t at which the line crosses it, from two dot products.
#pragma once

#include "intersect/filter/by_span.hpp"
#include "intersect/info.hpp"
#include "shapes/plane/plane.hpp"

namespace lostbits::intersect::plane {

struct FilteredPlane : filter::SpanFilter<FilteredPlane, Plane> {
    static constexpr Info info{
        .name = "plane.filtered",
        .title = filter::title_by_span,
        .source = filter::source_by_span,
        .roots = Roots::first_only,
    };
};

}  // namespace lostbits::intersect::plane
