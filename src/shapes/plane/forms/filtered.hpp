// Where the line is inside, the two dot products: a filter by its span.
#pragma once

#include "intersect/filter/by_span.hpp"
#include "intersect/info.hpp"
#include "shapes/plane/plane.hpp"

namespace lostbits::intersect::plane {

struct FilteredPlane : filter::FiltersBySpan<FilteredPlane, Plane> {
    static constexpr Info info{
        .name = "plane.filtered",
        .title = filter::title_by_span,
        .source = filter::source_by_span,
        .roots = Roots::first_only,
    };
};

}  // namespace lostbits::intersect::plane
