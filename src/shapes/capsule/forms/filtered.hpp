// A filter by the span of the capsule: the interval in which the line is inside the side and the balls at its ends.
#pragma once

#include "intersect/filter/by_span.hpp"
#include "intersect/info.hpp"
#include "shapes/capsule/capsule.hpp"

namespace lostbits::intersect::capsule {

struct FilteredCapsule : filter::SpanFilter<FilteredCapsule, Capsule> {
    static constexpr Info info{
        .name = "capsule.filtered",
        .title = filter::title_by_span,
        .source = filter::source_by_span,
        .roots = Roots::first_only,
    };
};

}  // namespace lostbits::intersect::capsule
