#include "measure/offset/half_line.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "measure/truth/compare_hit.hpp"
#include "measure/truth/enclose.hpp"
#include "number/error.hpp"
#include "number/wide/running_error.hpp"

namespace lostbits::measure::offset {

using truth::sign;

namespace {

template <class E>
std::optional<Meeting> try_meeting(const QuadraticSpan<E>& span) {
    const auto c = sign(span.c);
    if (!c) return std::nullopt;
    if (*c < 0) return Meeting{.inside = true, .outside = false, .meets = true};
    Meeting meeting{.inside = false, .outside = *c > 0, .meets = false};
    const auto h = sign(span.h);
    if (!h) return std::nullopt;
    if (*h >= 0) return meeting;
    const auto q = sign(span.q);
    if (!q) return std::nullopt;
    meeting.meets = *q > 0;
    return meeting;
}

template <class E>
std::optional<Meeting> try_meeting(const SlabSpan<E>& span) {
    Tri inside = span.open, outside = !span.closed;
    for (std::size_t i = 0; i < span.entry.size(); ++i) {
        inside = inside && span.entry[i].n < E(0) && span.exit[i].n > E(0);
        outside = outside || span.entry[i].n > E(0) || span.exit[i].n < E(0);
    }
    const Tri meets = truth::enclose<E>(span, nullptr, intersect::Touching::miss).hit;
    if (inside.is_unknown() || outside.is_unknown() || meets.is_unknown()) return std::nullopt;
    return Meeting{.inside = inside.is_yes(), .outside = outside.is_yes(), .meets = meets.is_yes()};
}

template <class E, ComparableSpan<E> S>
std::optional<Meeting> try_meeting(const S& s) {
    const Fraction<E> start{E(0), E(1)};
    const auto enters = s.compare_entry(start), leaves = s.compare_exit(start);
    const Tri open = s.meets_open(), closed = s.meets_closed();
    const Tri inside = open && enters.less && !leaves.at_most;
    const Tri outside = !closed || !enters.at_most || leaves.less;
    const Tri meets = open && !leaves.at_most;
    if (inside.is_unknown() || outside.is_unknown() || meets.is_unknown()) return std::nullopt;
    return Meeting{.inside = inside.is_yes(), .outside = outside.is_yes(), .meets = meets.is_yes()};
}

/// A surface has no inside. A line through its rim does not meet the open surface.
template <class E, SurfaceSpan<E> S>
std::optional<Meeting> try_meeting(const S& s) {
    Tri on_surface = Tri::no, meets = Tri::no;
    for (int i = 0; i < S::crossing_count; ++i) {
        const auto crossing = s.crossing(i);
        const auto order = s.compare_crossing(i, {E(0), E(1)});
        on_surface = on_surface || (crossing.closed && order.at_most && !order.less);
        meets = meets || (crossing.open && !order.at_most);
    }
    if (on_surface.is_unknown() || meets.is_unknown()) return std::nullopt;
    return Meeting{.inside = false, .outside = on_surface.is_no(), .meets = meets.is_yes()};
}

/// True if the line is inside a quartic anywhere between x = b and `end`, or anywhere beyond b if `end` is null. It is
/// inside between two successive roots at which the quartic changes its sign. Numbers with a running error bound cannot
/// find roots, so they decide nothing here.
template <class E>
std::optional<bool> is_inside_between(const QuarticSpan<E>& span, const E* end) {
    if constexpr (std::same_as<E, number::wide::RunningError<double>>) {
        return std::nullopt;
    } else {
        const auto roots = enclose_roots(span.f, span.bound);
        if (!roots) return std::nullopt;
        for (int i = 0, entry = -1; i < roots->count; ++i) {
            if (!(*roots)[i].changes_sign) continue;
            const int previous_entry = std::exchange(entry, entry < 0 ? i : -1);
            if (previous_entry < 0) continue;
            const auto exit_order = roots->order(i, span.b),
                       entry_order = end ? roots->order(previous_entry, *end) : std::optional(-1);
            if (!exit_order || !entry_order) return std::nullopt;
            if (*exit_order > 0 && *entry_order < 0) return true;
        }
        return false;
    }
}

template <class E>
std::optional<Meeting> try_meeting(const QuarticSpan<E>& span) {
    const auto sign_at_start = known_sign(span.f.at(span.b));
    const auto meets = is_inside_between<E>(span, nullptr);
    if (!sign_at_start || !meets) return std::nullopt;
    return Meeting{.inside = *sign_at_start<0, .outside = *sign_at_start> 0, .meets = *meets};
}

/// Returns a ray that starts where the half-line does.
template <class E>
Ray<E> ray_from_start(const HalfLine& line) {
    Ray<E> ray = lift_ray<E>(line.ray);
    if (line.tmin > 0) ray.origin = ray.origin + E(line.tmin) * ray.direction;
    return ray;
}

template <class E>
std::optional<Meeting> try_meeting(const HalfLine& line, const Primitive<double>& primitive) {
    return with_span(ray_from_start<E>(line), lift_primitive<E>(primitive),
                     [](const auto& span) { return try_meeting<E>(span); });
}

/// Returns the result of `find` at the first precision that decides. Numbers with a running error bound decide most
/// signs, and intervals of enough bits decide every sign.
template <class Find>
auto escalate(const Find& find) {
    if (const auto by_running_errors = find.template operator()<number::wide::RunningError<double>>())
        return *by_running_errors;
    if (const auto by_intervals = truth::find_at_rising_precision(find)) return *by_intervals;
    throw Error(ExitStatus::internal, "no precision was enough to decide how a ray meets a primitive");
}

/// True if the segment a + s(b − a), 0 ≤ s ≤ 1, meets the open primitive; nothing if this precision does not decide. A
/// quadratic is tested at both ends, and at its minimum if that lies between them. For slabs, the ray ends at s = 1.
template <class E>
std::optional<bool> segment_meets(const QuadraticSpan<E>& span) {
    for (const auto& c : {sign(span.c), sign<E>(span.a + span.h + span.h + span.c)}) {
        if (!c) return std::nullopt;
        if (*c < 0) return true;
    }
    const auto h_start = sign(span.h), h_end = sign<E>(span.a + span.h), q = sign(span.q);
    if (!h_start || !h_end || !q) return std::nullopt;
    return *h_start < 0 && *h_end > 0 && *q > 0;
}

template <class E>
std::optional<bool> segment_meets(const SlabSpan<E>& span) {
    const SpanRange<E> segment{E(0), {E(1), E(1)}, {}};
    const Tri hit = truth::enclose<E>(span, &segment, intersect::Touching::miss).hit;
    return hit.is_unknown() ? std::nullopt : std::optional(hit.is_yes());
}

template <class E>
std::optional<bool> segment_meets(const QuarticSpan<E>& span) {
    const E end = span.a + span.b;
    return is_inside_between(span, &end);
}

template <class E, ComparableSpan<E> S>
std::optional<bool> segment_meets(const S& s) {
    const Fraction<E> start{E(0), E(1)}, end{E(1), E(1)};
    const Tri hit = s.meets_open() && !s.compare_exit(start).at_most && s.compare_entry(end).less;
    return hit.is_unknown() ? std::nullopt : std::optional(hit.is_yes());
}

template <class E, SurfaceSpan<E> S>
std::optional<bool> segment_meets(const S& s) {
    Tri hit = Tri::no;
    for (int i = 0; i < S::crossing_count; ++i)
        hit = hit || (s.crossing(i).open && !s.compare_crossing(i, {E(0), E(1)}).at_most &&
                      s.compare_crossing(i, {E(1), E(1)}).less);
    return hit.is_unknown() ? std::nullopt : std::optional(hit.is_yes());
}

/// True for shapes that a ray may meet again after it has touched them: those that are neither convex nor flat.
template <template <class> class Of>
constexpr bool may_be_hit_again = decltype(std::declval<Of<double>>().span(Ray<double>{}))::may_hit_beyond_touch;

/// The ray starts at a point of the surface. If it goes towards the axis, its start is the near root, and the far root
/// is the far wall if it lies between the rims.
FarSide find_far_side(const WallSpan<double>& span) {
    const auto& side = span.primitive.side;
    if (!(side.h < 0)) return {};
    FarSide far{.t_begin = -side.h / side.a};
    if (span.crossing(1).closed) far.t_wall = ends_of(side)->far;
    return far;
}
/// Along the line, f has two local minima, one for each side of the ring, or only one. Between two minima lies a local
/// maximum, and f > 0 there if the line leaves the ring in between. All turning points lie within the bound: for |x| ≥
/// 2√a (R + r) on a line that meets the ball of radius R + r, |p| ≤ 1.12|x|/√a, so that the slope of f has the sign of
/// x.
FarSide find_far_side(const QuarticSpan<double>& span) {
    const ApproximateRoots<double> turns = approximate_roots(span.f.derivative(), span.bound);
    if (turns.count < 3) return {};
    const double turn = turns.x[1];
    if (!(turn > span.b) || !(span.f.at(turn) > 0)) return {};
    FarSide far{.t_begin = span.t_at(turn)};
    const ApproximateRoots<double> roots = approximate_roots(span.f, span.bound);
    const auto wall = std::find_if(roots.x.begin(), roots.x.begin() + roots.count, [&](double x) { return x > turn; });
    if (wall != roots.x.begin() + roots.count) far.t_wall = span.t_at(*wall);
    return far;
}

}  // namespace

bool HalfLine::is_proper() const { return truth::is_valid(ray) && std::isfinite(tmin) && tmin >= 0; }

Meeting find_meeting(const HalfLine& line, const Primitive<double>& primitive) {
    return escalate([&]<class E>() { return try_meeting<E>(line, primitive); });
}

bool meets_before(const HalfLine& line, double end, const Primitive<double>& primitive) {
    if (std::isinf(end)) return find_meeting(line, primitive).meets;
    if (!(line.tmin < end)) return false;
    return escalate([&]<class E>() {
        const Ray<E> ray = ray_from_start<E>(line);
        return with_span(Ray<E>{ray.origin, (E(end) - E(line.tmin)) * ray.direction}, lift_primitive<E>(primitive),
                         [](const auto& span) { return segment_meets<E>(span); });
    });
}

FarSide find_far_side(const Ray<double>& ray, const Primitive<double>& primitive) {
    return visit_shape(primitive, [&]<template <class> class Of>() {
        if constexpr (!may_be_hit_again<Of>) return FarSide{};
        else
            return visit_in_object_space<Of>(
                ray, primitive, [](const Of<double>& shape, const Ray<double>& object_ray) {
                    return find_far_side(
                        shape.span({shape.project_onto_surface(object_ray, object_ray.origin), object_ray.direction}));
                });
    });
}

bool is_hit_again(const Primitive<double>& primitive) {
    return visit_shape(primitive, []<template <class> class Of>() { return may_be_hit_again<Of>; });
}

bool passes_through(const Vec<double>& a, const Vec<double>& b, const Primitive<double>& primitive) {
    if (a == b) return find_meeting({{a, {1, 0, 0}}, 0}, primitive).inside;
    return escalate([&]<class E>() {
        const Vec<E> start = lift_vec<E>(a), end = lift_vec<E>(b);
        return with_span(Ray<E>{start, end - start}, lift_primitive<E>(primitive),
                         [](const auto& span) { return segment_meets<E>(span); });
    });
}

}  // namespace lostbits::measure::offset
