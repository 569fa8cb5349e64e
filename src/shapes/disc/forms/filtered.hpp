// A filter by the span of the disc: the t at which the line crosses the plane, and both rims.
#pragma once

#include "intersect/filter/by_span.hpp"
#include "intersect/info.hpp"
#include "shapes/disc/disc.hpp"

namespace lostbits::intersect::disc {

struct FilteredDisc : filter::SpanFilter<FilteredDisc, Disc> {
    static constexpr Info info{
        .name = "disc.filtered",
        .title = filter::title_by_span,
        .source = filter::source_by_span,
        .roots = Roots::first_only,
    };
};

}  // namespace lostbits::intersect::disc
