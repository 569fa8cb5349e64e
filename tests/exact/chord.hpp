// The part of a line that is inside a convex primitive, and the part of it that counts.
#pragma once

#include <optional>
#include <stdexcept>
#include <variant>

#include "exact/sturm.hpp"

namespace lostbits::exact {

/// All t from `first` to `last`; a missing end is infinite.
template <class E>
struct Part {
    std::optional<Place<E>> first, last;
};
/// Nothing, or a range.
template <class E>
using Chord = std::optional<Part<E>>;

template <class E>
Chord<E> intersect_chords(const Chord<E>& a, const Chord<E>& b) {
    if (!a || !b) return std::nullopt;
    Part<E> both = *a;
    if (b->first && (!both.first || order(*both.first, *b->first) < 0)) both.first = b->first;
    if (b->last && (!both.last || order(*both.last, *b->last) > 0)) both.last = b->last;
    if (both.first && both.last && order(*both.first, *both.last) > 0) return std::nullopt;
    return both;
}

/// Everything that two ranges of one convex primitive cover together. Both ranges have ends.
template <class E>
Chord<E> join_chords(const Chord<E>& a, const Chord<E>& b) {
    if (!a || !b) return a ? a : b;
    return Part<E>{order(*a->first, *b->first) < 0 ? a->first : b->first,
                   order(*a->last, *b->last) > 0 ? a->last : b->last};
}

/// Range of t in which b + t m is between 0 and v, v > 0.
template <class E>
Chord<E> chord_between(const E& b, const E& m, const E& v) {
    const int across = sign(m);
    if (across == 0) return sign(b) >= 0 && sign(v - b) >= 0 ? Chord<E>(Part<E>{}) : std::nullopt;
    const auto at_0 = fraction(-b, m), at_v = fraction(v - b, m);
    return across > 0 ? Part<E>{at_0, at_v} : Part<E>{at_v, at_0};
}

/// Range of t within a part in which a t² + 2 h t + c ≤ 0, for a primitive that is convex there.
template <class E>
Chord<E> chord_below(const Chord<E>& part, const E& a, const E& h, const E& c) {
    if (!part) return part;
    const int bends = sign(a);
    if (bends == 0) {
        const int slope = sign(h);
        if (slope == 0) return sign(c) <= 0 ? part : std::nullopt;
        const auto at = fraction(-c, h + h);
        return intersect_chords<E>(part, slope > 0 ? Part<E>{{}, at} : Part<E>{at, {}});
    }
    const Quadratic<E> x = bends > 0 ? Quadratic<E>(a, h, c) : Quadratic<E>(-a, -h, -c);
    const int roots = sign(x.q);
    if (bends > 0) return roots < 0 ? std::nullopt : intersect_chords<E>(part, Part<E>{root_of(x, -1), root_of(x, 1)});
    if (roots <= 0) return part;
    const Chord<E> before = intersect_chords<E>(part, Part<E>{{}, root_of(x, -1)});
    const Chord<E> after = intersect_chords<E>(part, Part<E>{root_of(x, 1), {}});
    if (before && after && !in_doubt) throw std::logic_error("a cone is in two parts between its planes");
    return before ? before : after;
}

/// Range of t that counts.
template <class E>
struct Counted {
    Place<E> from;
    std::optional<Place<E>> to;
    bool open_from, open_to;

    template <class P>
    [[nodiscard]] bool has_begun(const P& t) const {
        const int since = order(t, from);
        return since > 0 || (since == 0 && !open_from);
    }
    template <class P>
    [[nodiscard]] bool has(const P& t) const {
        if (!has_begun(t)) return false;
        if (!to) return true;
        const int until = order(t, *to);
        return until < 0 || (until == 0 && !open_to);
    }
};

/// The first t that counts; nothing: a miss.
template <class E>
class First {
public:
    First(std::nullopt_t) {}                   // NOLINT(google-explicit-constructor)
    First(const Place<E>& t) : at_(t) {}       // NOLINT(google-explicit-constructor)
    First(RootOf<E> t) : at_(std::move(t)) {}  // NOLINT(google-explicit-constructor)
    [[nodiscard]] bool is_hit() const { return at_.index() != 0; }
    /// The sign of t − x, for a hit; the same for a root and for a fraction.
    [[nodiscard]] int side(const E& x) const {
        const Place<E> there = place(x);
        if (const auto* root = std::get_if<RootOf<E>>(&at_)) return order(*root, there);
        return order(std::get<Place<E>>(at_), there);
    }

private:
    std::variant<std::monostate, Place<E>, RootOf<E>> at_;
};

/// The first end that counts, for the surface of a primitive that the line passes through.
template <class E>
First<E> first_end(const Chord<E>& chord, const Counted<E>& counted) {
    if (!chord) return std::nullopt;
    const bool near = counted.has_begun(*chord->first);
    const Place<E>& end = near ? *chord->first : *chord->last;
    return counted.has(end) ? First<E>(end) : std::nullopt;
}
/// The first t that counts, for a line that runs along the surface, and for a ray that begins inside a primitive which
/// answers at the origin.
template <class E>
First<E> first_of_all(const Chord<E>& chord, const Counted<E>& counted) {
    if (!chord || !counted.has_begun(*chord->last)) return std::nullopt;
    const bool near = counted.has_begun(*chord->first);
    if (!near && counted.open_from) has_no_first = true;
    const Place<E> first = near ? *chord->first : counted.from;
    return counted.has(first) ? First<E>(first) : std::nullopt;
}
template <class E>
First<E> only(const Place<E>& t, const Counted<E>& counted) {
    return counted.has(t) ? First<E>(t) : std::nullopt;
}

}  // namespace lostbits::exact
