// Compares an exact length t* with a number by signs of dyadic polynomials, without computing the length. Also finds
// the root at which a ray meets a surface of degree four, for `enclose`.
#pragma once

#include <optional>

#include "measure/truth/enclose.hpp"
#include "measure/truth/truth.hpp"
#include "number/dual.hpp"

namespace lostbits::measure::truth {

/// Result of `find.operator()<E>()` for E = Ball; if that is empty, for E = Interval, at precisions that double from
/// 192 bits. The result is an optional, which is empty if no precision decides.
template <class Find>
auto find_at_rising_precision(const Find& find) {
    auto found = find.template operator()<Ball>();
    for (int bits = 192; !found && bits <= ProofLimit{}.max_bits; bits *= 2) {
        const Interval::Precision precision(bits);
        found = find.template operator()<Interval>();
    }
    return found;
}

/// Sign of x: −1, 0 or +1; empty if this precision does not decide.
template <class E>
std::optional<int> sign(const E& x) {
    const E zero(0);
    if ((x < zero).is_yes()) return -1;
    if ((x > zero).is_yes()) return 1;
    if ((x <= zero && x >= zero).is_yes()) return 0;
    return std::nullopt;
}

/// Sign of u + v/√a for a > 0. If u and v differ in sign, it is the sign of u if u² a > v², and of v if u² a < v².
template <class E>
std::optional<int> sign_of_sum(const E& u, const E& v, const E& a) {
    const auto sign_of_u = sign(u), sign_of_v = sign(v);
    if (!sign_of_u || !sign_of_v) return std::nullopt;
    if (*sign_of_u == 0 || *sign_of_v == 0 || *sign_of_u == *sign_of_v)
        return *sign_of_u != 0 ? *sign_of_u : *sign_of_v;
    const auto order = sign<E>(square(u) * a - square(v));
    if (!order) return std::nullopt;
    return *sign_of_u * *order;
}

/// Order of a length relative to the target m > 0: −1 below, 0 at, +1 above. The order of the parameter f.n/f.m is the
/// sign of f.n − m f.m. The order of the distance is the sign of f.n² d2 − (m f.m)², where d2 is the square of the
/// direction.
template <class E>
std::optional<int> compare_fraction(const Fraction<E>& f, const E& d2, const E& target, Length length) {
    const E scaled_target = target * f.m;
    if (length == Length::parameter) return sign<E>(f.n - scaled_target);
    return sign<E>(square(f.n) * d2 - square(scaled_target));
}

/// Order of a root of a quadratic relative to the target m > 0. With P(t) = a t² + 2 h t + c, the near root is above m
/// if P(m) > 0 and a m + h < 0. The far root is above m if P(m) < 0 or a m + h < 0. For a distance m, the parameter is
/// m/√d2, and both expressions are multiplied by a power of √d2: their signs are those of (a m² + d2 c) + 2 d2 h m/√d2
/// and a m + d2 h/√d2. If a < 0 (a line steeper than a cone), the line enters at the larger root, where P falls: it is
/// the far root of −P.
template <class E>
std::optional<int> compare_root(const QuadraticSpan<E>& span, Crossing root, const E& target, Length length) {
    const auto sign_of_a = sign<E>(span.a);
    if (!sign_of_a) return std::nullopt;
    if (*sign_of_a < 0)
        return compare_root<E>({-span.h, -span.c, -span.a, span.q, span.d2},
                               root == Crossing::near ? Crossing::far : Crossing::near, target, length);
    const bool is_parameter = length == Length::parameter;
    const auto sign_of_p = is_parameter ? sign<E>((span.a * target + span.h + span.h) * target + span.c)
                                        : sign_of_sum<E>(span.a * square(target) + span.d2 * span.c,
                                                         (span.h + span.h) * target * span.d2, span.d2);
    if (!sign_of_p) return std::nullopt;
    if (*sign_of_p < 0) return root == Crossing::near ? -1 : 1;
    // Here P(m) ≥ 0, so m lies at a root or outside both. If m is before the middle of the roots, it is below the far
    // root; if m is after the middle, it is above the near root.
    const auto past_middle =
        is_parameter ? sign<E>(span.a * target + span.h) : sign_of_sum<E>(span.a * target, span.d2 * span.h, span.d2);
    if (!past_middle) return std::nullopt;
    if (root == Crossing::near) return *past_middle > 0 ? -1 : *sign_of_p;
    return *past_middle < 0 ? 1 : -*sign_of_p;
}

/// Order of the hit of a quadratic surface relative to the target m > 0, for a ray that hits. Without a range, a ray
/// from outside hits at the near root. A ray from inside hits at the far root, and its near root lies before every m >
/// 0.
template <class E>
std::optional<int> compare_hit(const QuadraticSpan<E>& span, const E& target, Length length, const SpanRange<E>* range,
                               intersect::Convention convention) {
    Crossing crossing = Crossing::far;
    if (range) {
        const EnclosedHit<E> found = enclose(span, range, convention);
        if (!found.hit.is_yes()) return std::nullopt;
        crossing = found.crossing;
    } else {
        const auto sign_of_c = sign(span.c);
        if (!sign_of_c) return std::nullopt;
        if (*sign_of_c > 0) crossing = Crossing::near;
    }
    if (crossing == Crossing::begin) return compare_fraction<E>({begin_of(range), E(1)}, span.d2, target, length);
    return compare_root(span, crossing, target, length);
}

/// Order of the point where the line enters (`Crossing::near`) or leaves, relative to the target m > 0.
template <class E>
std::optional<int> compare_boundary_point(const CappedSpan<E>& span, Crossing crossing, const E& target,
                                          Length length) {
    const bool is_entry = crossing == Crossing::near;
    if ((is_entry ? span.enters_by_cap() : span.leaves_by_cap()).is_yes())
        return compare_fraction(is_entry ? span.planes_entry : span.planes_exit, span.d2, target, length);
    return compare_root(span.side, crossing, target, length);
}
template <class E>
std::optional<int> compare_boundary_point(const JoinedSpan<E>& span, Crossing crossing, const E& target,
                                          Length length) {
    return compare_root(crossing == Crossing::near ? span.enter : span.leave, crossing, target, length);
}

template <class E>
std::optional<int> compare_boundary_point(const FlatSpan<E>& span, Crossing, const E& target, Length length) {
    return compare_fraction(span.at, span.d2, target, length);
}
template <class E>
std::optional<int> compare_boundary_point(const WallSpan<E>& span, Crossing crossing, const E& target, Length length) {
    return compare_root(span.primitive.side, crossing, target, length);
}

/// Order of the hit relative to the target m > 0, for a ray that hits.
template <class E, class S>
requires(ComparableSpan<S, E> || SurfaceSpan<S, E>) std::optional<int> compare_hit(const S& s, const E& target,
                                                                                   Length length,
                                                                                   const SpanRange<E>* range,
                                                                                   intersect::Convention convention) {
    const EnclosedHit<E> found = enclose<E>(s, range, convention);
    if (!found.hit.is_yes()) return std::nullopt;
    if (found.crossing == Crossing::begin) return compare_fraction<E>({begin_of(range), E(1)}, s.d2, target, length);
    return compare_boundary_point<E>(s, found.crossing, target, length);
}

/// Order of t* relative to the target m > 0, for a ray that hits. t* is the start of the range, the first entry, or the
/// first exit if that is the answer from inside.
template <class E>
std::optional<int> compare_hit(const SlabSpan<E>& span, const E& target, Length length, const SpanRange<E>* range,
                               intersect::Convention convention) {
    Fraction<E> answer = range ? largest_entry(span, *range) : largest_entry(span);
    if (range) {
        const EnclosedHit<E> found = enclose(span, range, convention);
        if (!found.hit.is_yes()) return std::nullopt;
        if (found.crossing == Crossing::far) answer = smallest_exit(span);
    } else if (convention.inside == intersect::Inside::exit && (answer.n <= E(0)).is_yes()) {
        answer = smallest_exit(span);
    }
    return compare_fraction(answer, span.d2, target, length);
}

/// Enclosure of a number without its gradient: the number itself, or the value of a `Dual`.
template <class E>
struct PlainNumber {
    using type = E;
    static const E& value(const E& x) { return x; }
};
template <class F, std::size_t N>
struct PlainNumber<Dual<F, N>> {
    using type = F;
    static const F& value(const Dual<F, N>& x) { return x.value(); }
};
template <class E, class F = typename PlainNumber<E>::type>
QuarticSpan<F> plain_span_of(const QuarticSpan<E>& span) {
    const auto value = [](const E& x) { return PlainNumber<E>::value(x); };
    QuarticSpan<F> plain_span{{{}, span.f.degree}, value(span.a), value(span.b), value(span.bound), value(span.d2)};
    for (std::size_t i = 0; i < span.f.c.size(); ++i) plain_span.f.c[i] = value(span.f.c[i]);
    return plain_span;
}

/// Hit of a quartic surface, at one of its roots or at the start of the ray.
template <class F>
struct RootHit {
    Tri hit;
    int root = -1;
    bool touching = false, on_surface = false;
    Crossing crossing = Crossing::begin;
    EnclosedRoots<F> roots = {};
};

/// Walks along the roots of an enclosing quartic f to the first one that counts as a hit. At a root where f does not
/// change its sign, the line touches the surface, from outside or from inside. The convention decides whether this
/// touch is a hit, whatever lies behind it. The rule is the same for rays from outside and from inside. If the range of
/// a ray ends at the root where the ray enters, the ray touches the surface there.
template <class F>
class QuarticWalk {
public:
    QuarticWalk(const QuarticSpan<F>& span, const SpanRange<F>* range, intersect::Convention convention)
        : span_(span), range_(range), convention_(convention), begin_(range ? span.x_at(range->begin) : span.b) {}

    [[nodiscard]] RootHit<F> find() {
        auto roots = enclose_roots(span_.f, span_.bound);
        if (!roots) return {Tri::unknown};
        result_.roots = *std::move(roots);
        const auto sign_at_begin = known_sign(span_.f.at(begin_));
        if (!sign_at_begin) return {Tri::unknown};
        int next = 0;
        for (; next < result_.roots.count; ++next) {
            const auto order = result_.roots.order(next, begin_);
            if (!order) return {Tri::unknown};
            if (*order == 0) return hit_from_surface(next);
            if (*order > 0) break;
        }
        return *sign_at_begin > 0 ? next_hit(next) : hit_from_inside(next);
    }

private:
    [[nodiscard]] RootHit<F> finish(Tri hit) {
        result_.hit = hit;
        return std::move(result_);
    }
    [[nodiscard]] RootHit<F> hit_at_begin() {
        result_.root = -1;
        result_.crossing = Crossing::begin;
        return finish(Tri::yes);
    }
    [[nodiscard]] RootHit<F> hit_from_inside(int next) {
        if (convention_.inside == intersect::Inside::miss) return finish(Tri::no);
        if (convention_.inside == intersect::Inside::zero && !result_.on_surface) return hit_at_begin();
        return next_hit(next, Crossing::far);
    }
    /// Decides the hit of a ray that begins at a root, as `enclose_from_inside` does for convex primitives. Here the
    /// ray may meet the surface again after it leaves.
    [[nodiscard]] RootHit<F> hit_from_surface(int root) {
        using intersect::AtOrigin, intersect::Inside, intersect::Touching;
        const bool is_leaving = result_.roots[root].sign_beyond > 0;
        const auto to_end = order_to_end(root);
        if (!to_end) return {Tri::unknown};
        const bool touching = !result_.roots[root].changes_sign || (!is_leaving && *to_end == 0);
        result_.on_surface = true;
        if (!touching || convention_.touching == Touching::hit) {
            const bool ignores_exits = convention_.inside == Inside::miss && !touching;
            const bool start_counts =
                convention_.at_origin == AtOrigin::hit || (convention_.at_origin == AtOrigin::exit && is_leaving);
            if (start_counts && !(ignores_exits && is_leaving)) {
                result_.touching = touching;
                if (known_sign(begin_of(range_)) == 0) return hit_at_begin();
                result_.root = root;
                result_.crossing = is_leaving ? Crossing::far : Crossing::near;
                return finish(Tri::yes);
            }
        }
        return is_leaving ? next_hit(root + 1) : hit_from_inside(root + 1);
    }
    /// Order of a root relative to the end of the range.
    [[nodiscard]] std::optional<int> order_to_end(int root) const {
        if (!range_ || known_sign(range_->end.m) == 0) return -1;
        return result_.roots.order(root, span_.x_at(range_->end.n));
    }
    /// Hit at the first root from index `root` on that counts; a miss if that root comes after the end of the range.
    [[nodiscard]] RootHit<F> next_hit(int root, Crossing crossing = Crossing::near) {
        const auto counts = [this](int i) {
            return result_.roots[i].changes_sign || convention_.touching == intersect::Touching::hit;
        };
        while (root < result_.roots.count && !counts(root)) ++root;
        if (root == result_.roots.count) return finish(Tri::no);
        const auto to_end = order_to_end(root);
        if (!to_end) return {Tri::unknown};
        if (*to_end > 0 || (*to_end == 0 && range_->open_ends.tmax)) return finish(Tri::no);
        const bool touching = !result_.roots[root].changes_sign || (*to_end == 0 && crossing == Crossing::near);
        if (touching && convention_.touching == intersect::Touching::miss) return finish(Tri::no);
        result_.root = root;
        result_.crossing = crossing;
        result_.touching = touching;
        return finish(Tri::yes);
    }

    const QuarticSpan<F>& span_;
    const SpanRange<F>* range_;
    intersect::Convention convention_;
    F begin_;
    RootHit<F> result_{Tri::unknown};
};

template <class E, class F = typename PlainNumber<E>::type>
RootHit<F> find_root_hit(const QuarticSpan<E>& span, const SpanRange<E>* range, intersect::Convention convention) {
    const QuarticSpan<F> plain_span = plain_span_of(span);
    const auto value = [](const E& x) { return PlainNumber<E>::value(x); };
    std::optional<SpanRange<F>> plain_range;
    if (range)
        plain_range = SpanRange<F>{value(range->begin), {value(range->end.n), value(range->end.m)}, range->open_ends};
    return QuarticWalk<F>(plain_span, plain_range ? &*plain_range : nullptr, convention).find();
}

/// Encloses the hit of a quartic. If the numbers have a gradient, that of the root x follows from f(x) = 0: x' =
/// −f'/(∂f/∂x). At a double root the gradient is unknown.
template <class E>
EnclosedHit<E> enclose(const QuarticSpan<E>& span, const SpanRange<E>* range, intersect::Convention convention) {
    const auto found = find_root_hit(span, range, convention);
    if (!found.hit.is_yes()) return {found.hit};
    if (found.crossing == Crossing::begin) return enclose_begin(span.d2, range, found.touching, found.on_surface);

    E x(found.roots[found.root].root);
    if constexpr (!std::is_same_v<E, typename PlainNumber<E>::type>) {
        const E f = span.f.at(x);
        const auto slope_at_root = found.roots.f.derivative().at(x.value());
        typename E::Gradient gradient;
        for (const auto& slope : f.gradient()) gradient.push_back(-slope / slope_at_root);
        x = E(x.value(), gradient);
    }

    const E t = span.t_at(x);
    return {.hit = Tri::yes,
            .t = t,
            .distance = t * sqrt(span.d2),
            .touching = found.touching,
            .on_surface = found.on_surface,
            .crossing = found.crossing,
            .at_double_root = !found.roots[found.root].changes_sign};
}

/// Number u + v √d. Products of two such numbers with one d have the same form. In a `QuarticSpan` s, a distance m is
/// at the variable x = s.b + s.a m/√(s.d2), and s.d2 x is such a number with d = s.d2.
template <class E>
struct QuadraticSurd {
    E u, v, d;

    friend QuadraticSurd operator*(const QuadraticSurd& x, const QuadraticSurd& y) {
        return {x.u * y.u + x.v * y.v * x.d, x.u * y.v + x.v * y.u, x.d};
    }
    [[nodiscard]] std::optional<int> sign() const { return sign_of_sum<E>(u, v * d, d); }
};

/// Order of the root of a quartic that the ray hits, relative to the target m > 0. For a distance, the sign of the
/// polynomial `simple` is that of `simple` times d2 to the power of its degree, which is a `QuadraticSurd`.
template <class E>
std::optional<int> compare_hit(const QuarticSpan<E>& span, const E& target, Length length, const SpanRange<E>* range,
                               intersect::Convention convention) {
    const auto found = find_root_hit(span, range, convention);
    if (!found.hit.is_yes()) return std::nullopt;
    if (found.crossing == Crossing::begin) return compare_fraction<E>({begin_of(range), E(1)}, span.d2, target, length);
    const EnclosedRoots<E>& roots = found.roots;
    if (length == Length::parameter) return roots.order(found.root, span.x_at(target));
    const QuadraticSurd<E> x{span.b * span.d2, span.a * target, span.d2};
    return roots.order(
        found.root, [&](const E& p) { return sign_of_sum<E>(p - span.b, -(span.a * target), span.d2); },
        [&] {
            QuadraticSurd<E> y{roots.simple.leading(), E(0), span.d2};
            E power(1);
            for (int i = roots.simple.degree - 1; i >= 0; --i) {
                power = power * span.d2;
                y = y * x;
                y.u = y.u + power * roots.simple.coefficient(i);
            }
            return y.sign();
        });
}

template <class E>
std::optional<int> compare_hit(const Ray<E>& ray, const Primitive<E>& primitive, const E& target, Length length,
                               const SpanRange<E>* range = nullptr, intersect::Convention convention = {}) {
    return with_span(ray, primitive,
                     [&](const auto& span) { return compare_hit(span, target, length, range, convention); });
}

}  // namespace lostbits::measure::truth
