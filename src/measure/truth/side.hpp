// Tells on which side of a number an exact length lies, by signs of dyadic polynomials, without the length itself. Also
// finds the root of a surface of degree four that a ray meets, for `enclose`.
#pragma once

#include <optional>

#include "measure/truth/enclose.hpp"
#include "measure/truth/truth.hpp"
#include "number/dual.hpp"

namespace lostbits::measure::truth {

/// Result of `find.operator()<E>()` with balls, or else with intervals of rising precision. It is an optional that is
/// empty if no precision decides.
template <class Find>
auto by_rising_precision(const Find& find) {
    auto found = find.template operator()<Ball>();
    for (int bits = 192; !found && bits <= TruthLimit{}.bits; bits *= 2) {
        const Interval::Precision precision(bits);
        found = find.template operator()<Interval>();
    }
    return found;
}

/// −1, 0 or +1; empty if this precision does not decide.
template <class E>
std::optional<int> sign(const E& x) {
    const E zero(0);
    if ((x < zero).is_yes()) return -1;
    if ((x > zero).is_yes()) return 1;
    if ((x <= zero && x >= zero).is_yes()) return 0;
    return std::nullopt;
}

/// Sign of u + v/√a for a > 0. If u and v differ in sign, it is the sign of the one with the larger of u² a and v².
template <class E>
std::optional<int> sign_of_sum(const E& u, const E& v, const E& a) {
    const auto of_u = sign(u), of_v = sign(v);
    if (!of_u || !of_v) return std::nullopt;
    if (*of_u == 0 || *of_v == 0 || *of_u == *of_v) return *of_u != 0 ? *of_u : *of_v;
    const auto larger = sign<E>(square(u) * a - square(v));
    if (!larger) return std::nullopt;
    return *of_u * *larger;
}

/// Compares n/d with m > 0, or n² d·d with (m d)².
template <class E>
std::optional<int> side_of_fraction(const Fraction<E>& f, const E& d2, const E& m, Length length) {
    const E there = m * f.m;
    if (length == Length::parameter) return sign<E>(f.n - there);
    return sign<E>(square(f.n) * d2 - square(there));
}

/// Tells if a root of a quadratic lies above m > 0, at it or below. With P(t) = a t² + 2 h t + c, the near root is
/// above m if P(m) > 0 and a m + h < 0. The far root is above m if P(m) < 0 or a m + h < 0. For a distance m, put m/√b
/// in place of m, b = d·d, and multiply by b or √b: the signs are those of (a m² + b c) + 2 b h m/√b and a m + b h/√b.
/// If a < 0 (a line steeper than a cone), the line enters at the larger root, where P falls: it is the far root of −P.
template <class E>
std::optional<int> side_of_root(const QuadraticSpan<E>& s, Crossing at, const E& m, Length length) {
    const auto bends = sign<E>(s.a);
    if (!bends) return std::nullopt;
    if (*bends < 0)
        return side_of_root<E>({-s.h, -s.c, -s.a, s.q, s.d2}, at == Crossing::near ? Crossing::far : Crossing::near, m,
                               length);
    const bool parameter = length == Length::parameter;
    const auto p = parameter ? sign<E>((s.a * m + s.h + s.h) * m + s.c)
                             : sign_of_sum<E>(s.a * square(m) + s.d2 * s.c, (s.h + s.h) * m * s.d2, s.d2);
    if (!p) return std::nullopt;
    if (*p < 0) return at == Crossing::near ? -1 : 1;
    // Here P(m) ≥ 0, so m lies at or outside the roots. Before the middle of the roots m comes before the far root, and
    // after the middle it comes after the near root.
    const auto past = parameter ? sign<E>(s.a * m + s.h) : sign_of_sum<E>(s.a * m, s.d2 * s.h, s.d2);
    if (!past) return std::nullopt;
    if (at == Crossing::near) return *past > 0 ? -1 : *p;
    return *past < 0 ? 1 : -*p;
}

/// Side for a ray that hits the surface, and m > 0. Without a range, the answer is the near root from outside, and the
/// far root from inside, where no m > 0 comes before the near root.
template <class E>
std::optional<int> side_of(const QuadraticSpan<E>& s, const E& m, Length length, const RangeOfSpan<E>* range,
                           intersect::Convention convention) {
    Crossing at = Crossing::far;
    if (range) {
        const Enclosed<E> found = enclose(s, range, convention);
        if (!found.hit.is_yes()) return std::nullopt;
        at = found.at;
    } else {
        const auto outside = sign(s.c);
        if (!outside) return std::nullopt;
        if (*outside > 0) at = Crossing::near;
    }
    if (at == Crossing::begin) return side_of_fraction<E>({begin_of(range), E(1)}, s.d2, m, length);
    return side_of_root(s, at, m, length);
}

/// Side of the point at which the line enters or leaves.
template <class E>
std::optional<int> side_at(const CappedSpan<E>& s, Crossing at, const E& m, Length length) {
    const bool near = at == Crossing::near;
    if ((near ? s.enters_by_cap() : s.leaves_by_cap()).is_yes())
        return side_of_fraction(near ? s.entry : s.exit, s.d2, m, length);
    return side_of_root(s.side, at, m, length);
}
template <class E>
std::optional<int> side_at(const JoinedSpan<E>& s, Crossing at, const E& m, Length length) {
    return side_of_root(at == Crossing::near ? s.enter : s.leave, at, m, length);
}

template <class E>
std::optional<int> side_at(const FlatSpan<E>& s, Crossing, const E& m, Length length) {
    return side_of_fraction(s.at, s.d2, m, length);
}
template <class E>
std::optional<int> side_at(const WallSpan<E>& s, Crossing at, const E& m, Length length) {
    return side_of_root(s.primitive.side, at, m, length);
}

/// Side for a ray that hits, and m > 0.
template <class E, class S>
requires(ComparableSpan<S, E> || SurfaceSpan<S, E>) std::optional<int> side_of(const S& s, const E& m, Length length,
                                                                               const RangeOfSpan<E>* range,
                                                                               intersect::Convention convention) {
    const Enclosed<E> found = enclose<E>(s, range, convention);
    if (!found.hit.is_yes()) return std::nullopt;
    if (found.at == Crossing::begin) return side_of_fraction<E>({begin_of(range), E(1)}, s.d2, m, length);
    return side_at<E>(s, found.at, m, length);
}

/// Side for a ray that hits, and m > 0. t* is the start of the range, the first entry, or the exit if that is the
/// answer from inside.
template <class E>
std::optional<int> side_of(const SlabSpan<E>& s, const E& m, Length length, const RangeOfSpan<E>* range,
                           intersect::Convention convention) {
    Fraction<E> first = range ? first_entry(s, *range) : first_entry(s);
    if (range) {
        const Enclosed<E> found = enclose(s, range, convention);
        if (!found.hit.is_yes()) return std::nullopt;
        if (found.at == Crossing::far) first = first_exit(s);
    } else if (convention.inside == intersect::Inside::exit && (first.n <= E(0)).is_yes()) {
        first = first_exit(s);
    }
    return side_of_fraction(first, s.d2, m, length);
}

/// Quartic over plain enclosures; for numbers with a gradient, of their values.
template <class E>
struct EnclosingPart {
    using type = E;
    static const E& of(const E& x) { return x; }
};
template <class F, std::size_t N>
struct EnclosingPart<Dual<F, N>> {
    using type = F;
    static const F& of(const Dual<F, N>& x) { return x.value(); }
};
template <class E, class F = typename EnclosingPart<E>::type>
QuarticSpan<F> enclosing_part(const QuarticSpan<E>& s) {
    const auto of = [](const E& x) { return EnclosingPart<E>::of(x); };
    QuarticSpan<F> part{{{}, s.f.degree}, of(s.a), of(s.b), of(s.bound), of(s.d2)};
    for (std::size_t i = 0; i < s.f.c.size(); ++i) part.f.c[i] = of(s.f.c[i]);
    return part;
}

/// Root of a quartic that a ray meets: −1 for the start of the ray.
template <class F>
struct RootHit {
    Tri hit;
    int root = -1;
    bool touching = false, on_surface = false;
    Crossing at = Crossing::begin;
    EnclosedRoots<F> roots = {};
};

/// Goes from root to root of an enclosing quartic. If f does not change its sign at a root, the line touches there,
/// from outside or from inside. The convention decides whether that is a hit, whatever lies behind it. The answer is
/// the next root that counts, from outside and from inside alike. A ray that ends at a root by which it enters touches
/// there.
template <class F>
class QuarticWalk {
public:
    QuarticWalk(const QuarticSpan<F>& s, const RangeOfSpan<F>* range, intersect::Convention asked)
        : span_(s), range_(range), asked_(asked), begin_(range ? s.place(range->begin) : s.b) {}

    [[nodiscard]] RootHit<F> find() {
        auto roots = enclosed_roots(span_.f, span_.bound);
        if (!roots) return {Tri::unknown};
        met_.roots = *std::move(roots);
        const auto side = known_sign(span_.f.at(begin_));
        if (!side) return {Tri::unknown};
        int next = 0;
        for (; next < met_.roots.count; ++next) {
            const auto order = met_.roots.order(next, begin_);
            if (!order) return {Tri::unknown};
            if (*order == 0) return from_surface(next);
            if (*order > 0) break;
        }
        return *side > 0 ? on_from(next) : from_inside(next);
    }

private:
    [[nodiscard]] RootHit<F> end(Tri hit) {
        met_.hit = hit;
        return std::move(met_);
    }
    [[nodiscard]] RootHit<F> begun() {
        met_.root = -1, met_.at = Crossing::begin;
        return end(Tri::yes);
    }
    [[nodiscard]] RootHit<F> from_inside(int next) {
        if (asked_.inside == intersect::Inside::miss) return end(Tri::no);
        if (asked_.inside == intersect::Inside::zero && !met_.on_surface) return begun();
        return on_from(next, Crossing::far);
    }
    /// Does the same as `enclose_from_inside` for convex primitives, but another surface may lie behind the one that
    /// the ray leaves.
    [[nodiscard]] RootHit<F> from_surface(int root) {
        using intersect::AtOrigin, intersect::Inside, intersect::Touching;
        const bool leaving = met_.roots[root].behind > 0;
        const auto to_end = order_to_end(root);
        if (!to_end) return {Tri::unknown};
        const bool touching = !met_.roots[root].crosses || (!leaving && *to_end == 0);
        met_.on_surface = true;
        if (!touching || asked_.touching == Touching::hit) {
            const bool no_exits = asked_.inside == Inside::miss && !touching;
            const bool counts = asked_.at_origin == AtOrigin::hit || (asked_.at_origin == AtOrigin::exit && leaving);
            if (counts && !(no_exits && leaving)) {
                met_.touching = touching;
                if (known_sign(begin_of(range_)) == 0) return begun();
                met_.root = root, met_.at = leaving ? Crossing::far : Crossing::near;
                return end(Tri::yes);
            }
        }
        return leaving ? on_from(root + 1) : from_inside(root + 1);
    }
    /// Order of a root relative to the end of the range.
    [[nodiscard]] std::optional<int> order_to_end(int root) const {
        if (!range_ || known_sign(range_->end.m) == 0) return -1;
        return met_.roots.order(root, span_.place(range_->end.n));
    }
    /// Next root that counts, if it comes before the end of the range.
    [[nodiscard]] RootHit<F> on_from(int root, Crossing at = Crossing::near) {
        const auto counts = [this](int i) {
            return met_.roots[i].crosses || asked_.touching == intersect::Touching::hit;
        };
        while (root < met_.roots.count && !counts(root)) ++root;
        if (root == met_.roots.count) return end(Tri::no);
        const auto to_end = order_to_end(root);
        if (!to_end) return {Tri::unknown};
        if (*to_end > 0 || (*to_end == 0 && range_->open.tmax)) return end(Tri::no);
        const bool touching = !met_.roots[root].crosses || (*to_end == 0 && at == Crossing::near);
        if (touching && asked_.touching == intersect::Touching::miss) return end(Tri::no);
        met_.root = root, met_.at = at, met_.touching = touching;
        return end(Tri::yes);
    }

    const QuarticSpan<F>& span_;
    const RangeOfSpan<F>* range_;
    intersect::Convention asked_;
    F begin_;
    RootHit<F> met_{Tri::unknown};
};

template <class E, class F = typename EnclosingPart<E>::type>
RootHit<F> root_hit(const QuarticSpan<E>& s, const RangeOfSpan<E>* range, intersect::Convention asked) {
    const QuarticSpan<F> part = enclosing_part(s);
    const auto of = [](const E& x) { return EnclosingPart<E>::of(x); };
    std::optional<RangeOfSpan<F>> within;
    if (range) within = RangeOfSpan<F>{of(range->begin), {of(range->end.n), of(range->end.m)}, range->open};
    return QuarticWalk<F>(part, within ? &*within : nullptr, asked).find();
}

/// Root as a function of numbers with a gradient, by f = 0: x' = −f'/(∂f/∂x). At a double root the gradient is unknown.
template <class E>
Enclosed<E> enclose(const QuarticSpan<E>& s, const RangeOfSpan<E>* range, intersect::Convention convention) {
    const auto met = root_hit(s, range, convention);
    if (!met.hit.is_yes()) return {met.hit};
    if (met.at == Crossing::begin) return enclosed_begin(s.d2, range, met.touching, met.on_surface);
    E x(met.roots[met.root].root);
    if constexpr (!std::is_same_v<E, typename EnclosingPart<E>::type>) {
        const E f = s.f.at(x);
        const auto steep = met.roots.f.slope().at(x.value());
        typename E::Gradient gradient;
        for (const auto& slope : f.gradient()) gradient.push_back(-slope / steep);
        x = E(x.value(), gradient);
    }
    const E t = s.time(x);
    return {.hit = Tri::yes,
            .t = t,
            .distance = t * sqrt(s.d2),
            .touching = met.touching,
            .on_surface = met.on_surface,
            .at = met.at,
            .at_double_root = !met.roots[met.root].crosses};
}

/// x = u + v √d, and sums and products of such numbers. A distance m lies at x = b + a m/√d2, and d2 x is such a
/// number.
template <class E>
struct QuadraticSurd {
    E u, v, d;

    friend QuadraticSurd operator*(const QuadraticSurd& a, const QuadraticSurd& b) {
        return {a.u * b.u + a.v * b.v * a.d, a.u * b.v + a.v * b.u, a.d};
    }
    [[nodiscard]] std::optional<int> sign() const { return sign_of_sum<E>(u, v * d, d); }
};

/// Order of the quartic root that the ray meets relative to m. A `simple` root at a distance is decided with a factor
/// of d2 to the power of its degree.
template <class E>
std::optional<int> side_of(const QuarticSpan<E>& s, const E& m, Length length, const RangeOfSpan<E>* range,
                           intersect::Convention convention) {
    const auto met = root_hit(s, range, convention);
    if (!met.hit.is_yes()) return std::nullopt;
    if (met.at == Crossing::begin) return side_of_fraction<E>({begin_of(range), E(1)}, s.d2, m, length);
    const EnclosedRoots<E>& roots = met.roots;
    if (length == Length::parameter) return roots.order(met.root, s.place(m));
    const QuadraticSurd<E> x{s.b * s.d2, s.a * m, s.d2};
    return roots.order(
        met.root, [&](const E& p) { return sign_of_sum<E>(p - s.b, -(s.a * m), s.d2); },
        [&] {
            QuadraticSurd<E> y{roots.simple.leading(), E(0), s.d2};
            E power(1);
            for (int i = roots.simple.degree - 1; i >= 0; --i) {
                power = power * s.d2;
                y = y * x;
                y.u = y.u + power * roots.simple.of(i);
            }
            return y.sign();
        });
}

template <class E>
std::optional<int> side_of(const Ray<E>& ray, const Primitive<E>& primitive, const E& m, Length length,
                           const RangeOfSpan<E>* range = nullptr, intersect::Convention convention = {}) {
    return with_span(ray, primitive, [&](const auto& span) { return side_of(span, m, length, range, convention); });
}

}  // namespace lostbits::measure::truth
