// Where a ray meets a surface of degree four first, of many rays at once. Included by met_spans.hpp.
#pragma once

#include "geometry/first_root.hpp"
#include "geometry/quartic_span.hpp"
#include "measure/stages/met_spans.hpp"

namespace lostbits::measure::stages {

/// As `truth::enclose` has it for the usual convention: the first root ahead is an entry or an exit, where every root
/// is known to be simple.
template <class W>
Met<Running<W>> first_met(const QuarticSpan<Running<W>>& s) {
    using P = typename Running<W>::P;
    const FirstRoot<Running<W>> root = first_root(s.f, s.b, s.bound);
    return {root.found, root.none, P(0) < P(0), s.time(root.x)};
}

/// The same of a ray with a range.
template <class W>
Met<Running<W>> first_met(const QuarticSpan<Running<W>>& s, const RangeOfSpan<Running<W>>& range) {
    using P = typename Running<W>::P;
    const FirstRoot<Running<W>> root = first_root(s.f, s.place(range.begin), s.bound);
    const Running<W> end = s.a * range.end.n + s.b * range.end.m;
    const auto in_time = (root.high * range.end.m < end).yes(), late = (root.low * range.end.m > end).yes();
    return {root.found && in_time, root.none || (root.found && late), P(0) < P(0), s.time(root.x)};
}

}  // namespace lostbits::measure::stages
