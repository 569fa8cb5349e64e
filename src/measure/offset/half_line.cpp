#include "measure/offset/half_line.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "measure/truth/enclose.hpp"
#include "measure/truth/side.hpp"
#include "number/error.hpp"
#include "number/wide/running.hpp"

namespace lostbits::measure::offset {

using truth::sign;

namespace {

template <class E>
std::optional<Meeting> enclosed(const QuadraticSpan<E>& s) {
    const auto c = sign(s.c);
    if (!c) return std::nullopt;
    if (*c < 0) return Meeting{.inside = true, .outside = false, .meets = true};
    Meeting met{.inside = false, .outside = *c > 0, .meets = false};
    const auto h = sign(s.h);
    if (!h) return std::nullopt;
    if (*h >= 0) return met;
    const auto through = sign(s.q);
    if (!through) return std::nullopt;
    met.meets = *through > 0;
    return met;
}

template <class E>
std::optional<Meeting> enclosed(const SlabSpan<E>& s) {
    Tri inside = s.open, outside = !s.closed;
    for (std::size_t i = 0; i < s.entry.size(); ++i) {
        inside = inside && s.entry[i].n < E(0) && s.exit[i].n > E(0);
        outside = outside || s.entry[i].n > E(0) || s.exit[i].n < E(0);
    }
    const Tri meets = truth::enclose<E>(s, nullptr, intersect::Touching::miss).hit;
    if (inside.is_unknown() || outside.is_unknown() || meets.is_unknown()) return std::nullopt;
    return Meeting{.inside = inside.is_yes(), .outside = outside.is_yes(), .meets = meets.is_yes()};
}

template <class E, ComparableSpan<E> S>
std::optional<Meeting> enclosed(const S& s) {
    const Fraction<E> begin{E(0), E(1)};
    const auto enters = s.enters_to(begin), leaves = s.leaves_to(begin);
    const Tri through = s.is_open(), met = s.is_hit();
    const Tri inside = through && enters.less && !leaves.at_most;
    const Tri outside = !met || !enters.at_most || leaves.less;
    const Tri meets = through && !leaves.at_most;
    if (inside.is_unknown() || outside.is_unknown() || meets.is_unknown()) return std::nullopt;
    return Meeting{.inside = inside.is_yes(), .outside = outside.is_yes(), .meets = meets.is_yes()};
}

/// A surface has no inside. A line that crosses its rim does not meet the open surface.
template <class E, SurfaceSpan<E> S>
std::optional<Meeting> enclosed(const S& s) {
    Tri on = Tri::no, meets = Tri::no;
    for (int i = 0; i < S::crossings; ++i) {
        const auto at = s.crossing(i);
        const auto to_begin = s.order_to(i, {E(0), E(1)});
        on = on || (at.closed && to_begin.at_most && !to_begin.less);
        meets = meets || (at.open && !to_begin.at_most);
    }
    if (on.is_unknown() || meets.is_unknown()) return std::nullopt;
    return Meeting{.inside = false, .outside = on.is_no(), .meets = meets.is_yes()};
}

/// True if the line is inside of a quartic anywhere between x = b and `end`, or anywhere beyond b if `end` is null: in
/// a stretch from one root that it crosses to the next. Running errors cannot find roots, so they decide nothing here.
template <class E>
std::optional<bool> is_inside_between(const QuarticSpan<E>& s, const E* end) {
    if constexpr (std::same_as<E, number::wide::Running<double>>) {
        return std::nullopt;
    } else {
        const auto roots = enclosed_roots(s.f, s.bound);
        if (!roots) return std::nullopt;
        for (int i = 0, entry = -1; i < roots->count; ++i) {
            if (!(*roots)[i].crosses) continue;
            const int from = std::exchange(entry, entry < 0 ? i : -1);
            if (from < 0) continue;
            const auto ends = roots->order(i, s.b), begins = end ? roots->order(from, *end) : std::optional(-1);
            if (!ends || !begins) return std::nullopt;
            if (*ends > 0 && *begins < 0) return true;
        }
        return false;
    }
}

template <class E>
std::optional<Meeting> enclosed(const QuarticSpan<E>& s) {
    const auto at = known_sign(s.f.at(s.b));
    const auto meets = is_inside_between<E>(s, nullptr);
    if (!at || !meets) return std::nullopt;
    return Meeting{.inside = *at<0, .outside = *at> 0, .meets = *meets};
}

/// Ray that starts where the half-line does.
template <class E>
Ray<E> begun(const HalfLine& line) {
    Ray<E> from = lift_ray<E>(line.ray);
    if (line.from > 0) from.origin = from.origin + E(line.from) * from.direction;
    return from;
}

template <class E>
std::optional<Meeting> enclosed(const HalfLine& line, const Primitive<double>& primitive) {
    return with_span(begun<E>(line), lift_primitive<E>(primitive), [](const auto& span) { return enclosed<E>(span); });
}

/// Result of `find` at the first precision that decides. Running errors decide most signs, and enough bits decide every
/// one.
template <class Find>
auto escalate(const Find& find) {
    if (const auto quick = find.template operator()<number::wide::Running<double>>()) return *quick;
    if (const auto found = truth::by_rising_precision(find)) return *found;
    throw Error(Exit::internal, "no precision was enough to decide how a ray meets a primitive");
}

/// Decides whether the segment a + s(b − a), 0 ≤ s ≤ 1, meets the open primitive. A quadratic is tested at both ends,
/// or at the point in between that is nearest to its middle. For slabs, the ray ends at s = 1.
template <class E>
std::optional<bool> passes(const QuadraticSpan<E>& s) {
    for (const auto& c : {sign(s.c), sign<E>(s.a + s.h + s.h + s.c)}) {
        if (!c) return std::nullopt;
        if (*c < 0) return true;
    }
    const auto from = sign(s.h), to = sign<E>(s.a + s.h), through = sign(s.q);
    if (!from || !to || !through) return std::nullopt;
    return *from < 0 && *to > 0 && *through > 0;
}

template <class E>
std::optional<bool> passes(const SlabSpan<E>& s) {
    const RangeOfSpan<E> way{E(0), {E(1), E(1)}, {}};
    const Tri hit = truth::enclose<E>(s, &way, intersect::Touching::miss).hit;
    return hit.is_unknown() ? std::nullopt : std::optional(hit.is_yes());
}

template <class E>
std::optional<bool> passes(const QuarticSpan<E>& s) {
    const E end = s.a + s.b;
    return is_inside_between(s, &end);
}

template <class E, ComparableSpan<E> S>
std::optional<bool> passes(const S& s) {
    const Fraction<E> from{E(0), E(1)}, to{E(1), E(1)};
    const Tri hit = s.is_open() && !s.leaves_to(from).at_most && s.enters_to(to).less;
    return hit.is_unknown() ? std::nullopt : std::optional(hit.is_yes());
}

template <class E, SurfaceSpan<E> S>
std::optional<bool> passes(const S& s) {
    Tri hit = Tri::no;
    for (int i = 0; i < S::crossings; ++i)
        hit = hit || (s.crossing(i).open && !s.order_to(i, {E(0), E(1)}).at_most && s.order_to(i, {E(1), E(1)}).less);
    return hit.is_unknown() ? std::nullopt : std::optional(hit.is_yes());
}

/// True for shapes that a ray may meet again after it has touched them: those that are neither convex nor flat.
template <template <class> class Of>
constexpr bool hit_again = decltype(std::declval<Of<double>>().span(Ray<double>{}))::may_hit_behind_touch;

/// For a ray from a point of the surface. If it goes towards the axis, the point is the near root. The far root is the
/// far wall if it lies between the rims.
FarSide far_side_of(const WallSpan<double>& s) {
    const auto& side = s.primitive.side;
    if (!(side.h < 0)) return {};
    FarSide far{.from = -side.h / side.a};
    if (s.crossing(1).closed) far.wall = ends_of(side)->far;
    return far;
}
/// f has two dips, one for either side of the ring, or only one. The turn between two of them is a largest value, which
/// lies outside where the line leaves the ring in between. All turns lie within the bound: for |x| ≥ 2√a (R + r) on a
/// line that meets the ball of R + r, |p| ≤ 1.12|x|/√a, so that the slope of f has the sign of x.
FarSide far_side_of(const QuarticSpan<double>& s) {
    const NearRoots<double> turns = near_roots(s.f.slope(), s.bound);
    if (turns.count < 3) return {};
    const double turn = turns.x[1];
    if (!(turn > s.b) || !(s.f.at(turn) > 0)) return {};
    FarSide far{.from = s.time(turn)};
    const NearRoots<double> roots = near_roots(s.f, s.bound);
    const auto wall = std::find_if(roots.x.begin(), roots.x.begin() + roots.count, [&](double x) { return x > turn; });
    if (wall != roots.x.begin() + roots.count) far.wall = s.time(*wall);
    return far;
}

}  // namespace

bool HalfLine::is_proper() const { return truth::is_proper(ray) && std::isfinite(from) && from >= 0; }

Meeting find_meeting(const HalfLine& line, const Primitive<double>& primitive) {
    return escalate([&]<class E>() { return enclosed<E>(line, primitive); });
}

bool meets_before(const HalfLine& line, double end, const Primitive<double>& primitive) {
    if (std::isinf(end)) return find_meeting(line, primitive).meets;
    if (!(line.from < end)) return false;
    return escalate([&]<class E>() {
        const Ray<E> from = begun<E>(line);
        return with_span(Ray<E>{from.origin, (E(end) - E(line.from)) * from.direction}, lift_primitive<E>(primitive),
                         [](const auto& span) { return passes<E>(span); });
    });
}

FarSide far_side(const Ray<double>& leaving, const Primitive<double>& primitive) {
    return visit_shape(primitive, [&]<template <class> class Of>() {
        if constexpr (!hit_again<Of>) return FarSide{};
        else
            return in_object_space<Of>(leaving, primitive, [](const Of<double>& shape, const Ray<double>& its) {
                return far_side_of(shape.span({shape.projected(its, its.origin), its.direction}));
            });
    });
}

bool is_hit_again(const Primitive<double>& primitive) {
    return visit_shape(primitive, []<template <class> class Of>() { return hit_again<Of>; });
}

bool passes_through(const Vec<double>& a, const Vec<double>& b, const Primitive<double>& primitive) {
    if (a == b) return find_meeting({{a, {1, 0, 0}}, 0}, primitive).inside;
    return escalate([&]<class E>() {
        const Vec<E> from = lift_vec<E>(a), to = lift_vec<E>(b);
        return with_span(Ray<E>{from, to - from}, lift_primitive<E>(primitive),
                         [](const auto& span) { return passes<E>(span); });
    });
}

}  // namespace lostbits::measure::offset
