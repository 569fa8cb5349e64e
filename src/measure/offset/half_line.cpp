#include "measure/offset/half_line.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "measure/truth/enclose.hpp"
#include "measure/truth/side.hpp"
#include "number/error.hpp"

namespace lostbits::measure::offset {

using truth::sign;

namespace {

constexpr double u = 0x1p-53;
/// Products of four lengths below this size may lose bits to underflow; the filter leaves those alone.
constexpr double least_filtered = 0x1p-200, most_filtered = 0x1p+200;

double sum_of_sizes(const Vec<double>& v) { return std::fabs(v.x) + std::fabs(v.y) + std::fabs(v.z); }

/// The sign of x where |x| exceeds a bound on its error; nothing elsewhere.
std::optional<int> proved(double x, double error) {
    if (std::fabs(x) <= error) return std::nullopt;
    return x > 0 ? 1 : -1;
}

/// With s and S the sums of |f| and |w| over their components, and δ the error of each component of f, every step below
/// rounds by at most u of itself: c is off by at most 2·(2sδ) + 4u(s² + r²), h by Sδ + 4usS, and aΔ by
/// 2·(2sS²)(2δ + 3us) + 8uS²(s² + r²). Twice each of these is taken.
std::optional<Meeting> filtered(const HalfLine& line, const Sphere<double>& sphere) {
    const Vec<double>&o = line.ray.origin, &w = line.ray.direction;
    const Vec<double> f(o.x - sphere.centre.x + line.from * w.x, o.y - sphere.centre.y + line.from * w.y,
                        o.z - sphere.centre.z + line.from * w.z);
    const double r = sphere.radius, s = sum_of_sizes(f), size_w = sum_of_sizes(w);
    for (const double size : {s + r, r, size_w}) {
        if (!(size > least_filtered && size < most_filtered)) return std::nullopt;
    }
    // o − G rounds by u|o − G| ≤ u(s + from·S), the product and the sum by as much again.
    const double delta = line.from > 0 ? 4 * u * (s + 2 * line.from * size_w) : u * s;
    const double squares = s * s + r * r, c = (f.x * f.x + f.y * f.y + f.z * f.z) - r * r;
    const auto outside = proved(c, 8 * s * delta + 16 * u * squares);
    if (!outside) return std::nullopt;
    if (*outside < 0) return Meeting{.inside = true, .outside = false, .meets = true};
    const auto leaving = proved(dot(f, w), 2 * size_w * (delta + 4 * u * s));
    if (!leaving) return std::nullopt;
    if (*leaving > 0) return Meeting{.inside = false, .outside = true, .meets = false};
    const Vec<double> m = cross(f, w);
    const double discriminant = square(w) * (r * r) - square(m);
    const auto through = proved(discriminant, size_w * size_w * (8 * s * (2 * delta + 3 * u * s) + 16 * u * squares));
    if (!through) return std::nullopt;
    return Meeting{.inside = false, .outside = true, .meets = *through > 0};
}

/// Comparisons of stored numbers are exact; where t_min moves the start, only the enclosures know it.
std::optional<Meeting> filtered(const HalfLine& line, const Box<double>& box) {
    if (line.from > 0) return std::nullopt;
    bool inside = true, outside = false;
    for (int i = 0; i < 3; ++i) {
        const double o = line.ray.origin[i], w = line.ray.direction[i];
        inside = inside && o > box.lo[i] && o < box.hi[i];
        outside = outside || o < box.lo[i] || o > box.hi[i];
        if ((o >= box.hi[i] && w >= 0) || (o <= box.lo[i] && w <= 0)) {
            for (int k = i + 1; k < 3; ++k)
                outside = outside || line.ray.origin[k] < box.lo[k] || line.ray.origin[k] > box.hi[k];
            return Meeting{.inside = false, .outside = outside, .meets = false};
        }
    }
    if (inside) return Meeting{.inside = true, .outside = false, .meets = true};
    return std::nullopt;
}

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
        if (!s.entry[i]) continue;
        inside = inside && s.entry[i]->n < E(0) && s.exit[i]->n > E(0);
        outside = outside || s.entry[i]->n > E(0) || s.exit[i]->n < E(0);
    }
    const Tri meets = truth::enclose<E>(s, nullptr, intersect::Touching::miss).hit;
    if (inside.is_unknown() || outside.is_unknown() || meets.is_unknown()) return std::nullopt;
    return Meeting{.inside = inside.is_yes(), .outside = outside.is_yes(), .meets = meets.is_yes()};
}

template <class E>
std::optional<Meeting> enclosed(const HalfLine& line, const Solid<double>& solid) {
    Ray<E> from = truth::lift_ray<E>(line.ray);
    if (line.from > 0) from.origin = from.origin + E(line.from) * from.direction;
    const Solid<E> exact = truth::lift_solid<E>(solid);
    return visit(exact, [&from](const auto& shape) -> std::optional<Meeting> {
        const auto span = shape.span(from);
        return span ? enclosed<E>(*span) : std::nullopt;
    });
}

/// What `find` finds: every sign is told by some precision.
template <class Find>
auto escalate(const Find& find) {
    if (const auto found = truth::by_rising_precision(find)) return *found;
    throw Error(Exit::internal, "no precision was enough to tell on which side of a solid a ray starts");
}

/// The way a + s(b − a), 0 ≤ s ≤ 1, against the open solid: both ends of it, or the place in between that is nearest to
/// the middle of a quadratic; of slabs with s ≤ 1 as the end of the ray.
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
    const E end(1);
    const Tri hit = truth::enclose<E>(s, &end, intersect::Touching::miss).hit;
    return hit.is_unknown() ? std::nullopt : std::optional(hit.is_yes());
}

}  // namespace

bool HalfLine::is_proper() const { return truth::is_proper(ray) && std::isfinite(from) && from >= 0; }

Meeting find_meeting_by_enclosure(const HalfLine& line, const Solid<double>& solid) {
    return escalate([&]<class E>() { return enclosed<E>(line, solid); });
}

Meeting find_meeting(const HalfLine& line, const Solid<double>& solid) {
    const auto quick = visit(solid, [&line](const auto& shape) { return filtered(line, shape); });
    return quick ? *quick : find_meeting_by_enclosure(line, solid);
}

bool passes_through(const Vec<double>& a, const Vec<double>& b, const Solid<double>& solid) {
    if (a == b) return find_meeting({{a, {1, 0, 0}}, 0}, solid).inside;
    return escalate([&]<class E>() {
        const Vec<E> from = truth::lift_vec<E>(a), to = truth::lift_vec<E>(b);
        const Solid<E> exact = truth::lift_solid<E>(solid);
        return visit(exact, [&](const auto& shape) -> std::optional<bool> {
            const auto span = shape.span({from, to - from});
            return span ? passes<E>(*span) : std::nullopt;
        });
    });
}

}  // namespace lostbits::measure::offset
