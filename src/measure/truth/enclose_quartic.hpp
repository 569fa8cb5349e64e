// The line against a surface of degree four: which of its roots is the answer. Included by enclose.hpp.
#pragma once

#include "geometry/quartic_span.hpp"
#include "measure/truth/enclose.hpp"
#include "number/dual.hpp"

namespace lostbits::measure::truth {

/// A quartic of numbers that enclose and no more: of those with a gradient its values.
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

/// Which root of a quartic a ray meets: −1 for where it begins.
template <class F>
struct MetRoot {
    Tri hit;
    int root = -1;
    bool touching = false, on_surface = false;
    Crossing at = Crossing::begin;
    EnclosedRoots<F> roots = {};
};

/// Goes from root to root of an enclosing quartic. Where f does not change its sign at a root the line touches there,
/// from outside or from inside: that is a hit or not by the convention, whatever comes behind it. From outside and from
/// inside alike the answer is the next root that counts.
template <class F>
class QuarticWalk {
public:
    QuarticWalk(const QuarticSpan<F>& s, const RangeOfSpan<F>* range, intersect::Convention asked)
        : span_(s), range_(range), asked_(asked), begin_(range ? s.place(range->begin) : s.b) {}

    [[nodiscard]] MetRoot<F> find() {
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
    [[nodiscard]] MetRoot<F> end(Tri hit) {
        met_.hit = hit;
        return std::move(met_);
    }
    [[nodiscard]] MetRoot<F> begun() {
        met_.root = -1, met_.at = Crossing::begin;
        return end(Tri::yes);
    }
    [[nodiscard]] MetRoot<F> from_inside(int next) {
        if (asked_.inside == intersect::Inside::miss) return end(Tri::no);
        if (asked_.inside == intersect::Inside::zero && !met_.on_surface) return begun();
        return on_from(next, Crossing::far);
    }
    /// As `enclose_from_inside` has it of convex solids; behind a surface that is left there may be another.
    [[nodiscard]] MetRoot<F> from_surface(int root) {
        using intersect::AtOrigin, intersect::Inside, intersect::Touching;
        const bool touching = !met_.roots[root].crosses, leaving = met_.roots[root].behind > 0;
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
    /// The next root that counts, if it comes in time.
    [[nodiscard]] MetRoot<F> on_from(int root, Crossing at = Crossing::near) {
        const auto counts = [this](int i) {
            return met_.roots[i].crosses || asked_.touching == intersect::Touching::hit;
        };
        while (root < met_.roots.count && !counts(root)) ++root;
        if (root == met_.roots.count) return end(Tri::no);
        if (range_ && known_sign(range_->end.m) != 0) {
            const auto order = met_.roots.order(root, span_.place(range_->end.n));
            if (!order) return {Tri::unknown};
            if (*order > 0 || (*order == 0 && range_->open.tmax)) return end(Tri::no);
        }
        met_.root = root, met_.at = at, met_.touching = !met_.roots[root].crosses;
        return end(Tri::yes);
    }

    const QuarticSpan<F>& span_;
    const RangeOfSpan<F>* range_;
    intersect::Convention asked_;
    F begin_;
    MetRoot<F> met_{Tri::unknown};
};

template <class E, class F = typename EnclosingPart<E>::type>
MetRoot<F> met_root(const QuarticSpan<E>& s, const RangeOfSpan<E>* range, intersect::Convention asked) {
    const QuarticSpan<F> part = enclosing_part(s);
    const auto of = [](const E& x) { return EnclosingPart<E>::of(x); };
    std::optional<RangeOfSpan<F>> within;
    if (range) within = RangeOfSpan<F>{of(range->begin), {of(range->end.n), of(range->end.m)}, range->open};
    return QuarticWalk<F>(part, within ? &*within : nullptr, asked).find();
}

/// Of numbers with a gradient the root is a function of them by f = 0: x' = −f'/(∂f/∂x). At a double root nothing is
/// known of it.
template <class E>
Enclosed<E> enclose(const QuarticSpan<E>& s, const RangeOfSpan<E>* range, intersect::Convention convention) {
    const E zero(0);
    const auto met = met_root(s, range, convention);
    if (!met.hit.is_yes()) return {met.hit, zero, zero};
    if (met.at == Crossing::begin) return enclosed_begin(s.d2, range, met.touching, met.on_surface);
    E x(met.roots[met.root].root);
    if constexpr (!std::is_same_v<E, typename EnclosingPart<E>::type>) {
        const E f = s.f.at(x);
        const auto steep = met.roots.f.slope().at(x.value());
        typename E::Gradient gradient;
        for (std::size_t i = 0; i < gradient.size(); ++i) gradient[i] = -f.derivative(i) / steep;
        x = E(x.value(), gradient);
    }
    const E t = s.time(x);
    return {Tri::yes, t, t * sqrt(s.d2), met.touching, met.on_surface, met.at};
}

}  // namespace lostbits::measure::truth
