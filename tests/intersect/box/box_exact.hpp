// Rays and boxes as exact fractions, and the exact answer: the t at which the ray lies in the box, interval by
// interval, with divisions. No form and no enclosure computes it like this.
#pragma once

#include <array>
#include <cmath>
#include <optional>

#include "geometry/range.hpp"
#include "geometry/ray.hpp"
#include "intersect/exact.hpp"
#include "shapes/box/box.hpp"

namespace lostbits::test {

/// A set of t without gaps. An end that is missing lies at infinity; one that is not `included` does not belong.
class Span {
public:
    struct End {
        Rational t;
        bool included;
    };

    void starts_at(const Rational& t, bool included) {
        if (!from_ || t > from_->t || (t == from_->t && !included)) from_ = End{t, included};
    }
    void ends_at(const Rational& t, bool included) {
        if (!to_ || t < to_->t || (t == to_->t && !included)) to_ = End{t, included};
    }
    void clear() { empty_ = true; }

    [[nodiscard]] bool is_empty() const {
        if (empty_) return true;
        if (!from_ || !to_ || from_->t < to_->t) return false;
        return from_->t > to_->t || !from_->included || !to_->included;
    }
    [[nodiscard]] const Rational& start() const { return from_->t; }
    [[nodiscard]] const Rational& end() const { return to_->t; }

private:
    std::optional<End> from_, to_;
    bool empty_ = false;
};

struct BoxCase {
    std::array<Rational, 3> origin, direction, lo, hi;
    std::optional<Rational> tmax;  ///< none: the ray has no end
    Rational tmin = 0;
    OpenEnds open_ends = {};
};

inline BoxCase exactly(const Ray<double>& ray, const Box<double>& box, double tmax) {
    BoxCase x;
    for (int i = 0; i < 3; ++i) {
        const auto k = static_cast<std::size_t>(i);
        x.origin[k] = Rational(ray.origin[i]);
        x.direction[k] = Rational(ray.direction[i]);
        x.lo[k] = Rational(box.lo[i]);
        x.hi[k] = Rational(box.hi[i]);
    }
    if (!std::isinf(tmax)) x.tmax = Rational(tmax);
    return x;
}

/// The t at which the whole line lies in the box, with or without its boundary.
inline Span line_in_box(const BoxCase& x, bool closed) {
    Span span;
    for (std::size_t i = 0; i < 3; ++i) {
        if (x.direction[i] == 0) {
            const bool in = closed ? x.lo[i] <= x.origin[i] && x.origin[i] <= x.hi[i]
                                   : x.lo[i] < x.origin[i] && x.origin[i] < x.hi[i];
            if (!in) span.clear();
            continue;
        }
        const Rational to_lo = (x.lo[i] - x.origin[i]) / x.direction[i];
        const Rational to_hi = (x.hi[i] - x.origin[i]) / x.direction[i];
        span.starts_at(to_lo < to_hi ? to_lo : to_hi, closed);
        span.ends_at(to_lo < to_hi ? to_hi : to_lo, closed);
    }
    return span;
}

/// The t of its range at which the ray lies in the box.
inline Span ray_in_box(const BoxCase& x, bool closed) {
    Span span = line_in_box(x, closed);
    span.starts_at(x.tmin, !x.open_ends.tmin);
    if (x.tmax) span.ends_at(*x.tmax, !x.open_ends.tmax);
    return span;
}

}  // namespace lostbits::test
