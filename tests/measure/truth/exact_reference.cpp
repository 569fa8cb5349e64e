#include "measure/truth/exact_reference.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace lostbits::test {

using measure::truth::CertifiedNumber;

Dyadic::Dyadic(double x) {
    int e = 0;
    m_ = static_cast<std::int64_t>(std::ldexp(std::frexp(x, &e), 53));
    e_ = x == 0 ? 0 : e - 53;
}

Dyadic::Dyadic(mpfr_srcptr x) {
    if (mpfr_zero_p(x) == 0) e_ = mpfr_get_z_2exp(m_.backend().data(), x);
}

Dyadic Dyadic::scaled(std::int64_t e) const {
    Dyadic r = *this;
    r.e_ += e;
    return r;
}

Dyadic operator+(const Dyadic& a, const Dyadic& b) {
    if (a.sign() == 0) return b;
    if (b.sign() == 0) return a;
    if (a.e_ < b.e_) return b + a;
    Dyadic r = a;
    r.m_ <<= static_cast<unsigned long>(a.e_ - b.e_);
    r.m_ += b.m_;
    r.e_ = b.e_;
    return r;
}

Dyadic operator-(const Dyadic& a) {
    Dyadic r = a;
    r.m_.backend().negate();
    return r;
}

Dyadic operator*(const Dyadic& a, const Dyadic& b) {
    Dyadic r;
    r.m_ = a.m_ * b.m_;
    r.e_ = a.e_ + b.e_;
    return r;
}

Dyadic::Fraction Dyadic::fraction() const {
    const Integer power = Integer(1) << static_cast<unsigned long>(std::abs(e_));
    return e_ < 0 ? Fraction(m_, power) : Fraction(m_ * power);
}

namespace {

Dyadic square(const Dyadic& x) { return x * x; }

/// The sign of u + v/√a for a > 0: that of the larger of u² a and v² where the two differ in sign.
int sign_of_sum(const Dyadic& u, const Dyadic& v, const Dyadic& a) {
    if (u.sign() == 0 || v.sign() == 0 || u.sign() == v.sign()) return u.sign() != 0 ? u.sign() : v.sign();
    return u.sign() * compare(square(u) * a, square(v));
}

}  // namespace

// a t² + 2 h t + c = 0: where the near root is not in the range it may be the far one.
template <class S>
void ExactHit::find(const Ray<S>& ray, const Sphere<S>& sphere, const Range<double>& range) {
    for (int i = 0; i < 3; ++i) {
        f_[i] = Dyadic(ray.origin[i]) - Dyadic(sphere.centre[i]);
        d_[i] = Dyadic(ray.direction[i]);
    }
    r2_ = square(Dyadic(sphere.radius));
    a_ = square(d_[0]) + square(d_[1]) + square(d_[2]);
    h_ = f_[0] * d_[0] + f_[1] * d_[1] + f_[2] * d_[2];
    c_ = square(f_[0]) + square(f_[1]) + square(f_[2]) - r2_;
    discriminant_ = square(h_) - a_ * c_;
    far_ = !is_in(range);
    hit_ = discriminant_.sign() >= 0 && range.tmin >= 0 && is_in(range);
}
template void ExactHit::find(const Ray<double>&, const Sphere<double>&, const Range<double>&);
template void ExactHit::find(const Ray<Real>&, const Sphere<Real>&, const Range<double>&);

bool ExactHit::is_in(const Range<double>& range) const {
    const int begun = side(Dyadic(range.tmin)), ended = std::isinf(range.tmax) ? -1 : side(Dyadic(range.tmax));
    return (range.open_ends.tmin ? begun > 0 : begun >= 0) && (range.open_ends.tmax ? ended < 0 : ended <= 0);
}

// Q(x) = |f + x d|² − r² tells whether the point at x is outside; (f + x d)·d whether it is past the closest approach.
// The near root is above x where the point is outside and not past, the far one where it is inside or not yet past.
int ExactHit::side(const Dyadic& x) const {
    Dyadic q = -r2_, past;
    for (int i = 0; i < 3; ++i) {
        const Dyadic p = f_[i] + x * d_[i];
        q = q + square(p);
        past = past + p * d_[i];
    }
    if (far_) return past.sign() < 0 ? 1 : -q.sign();
    return past.sign() > 0 ? -1 : q.sign();
}

// With s = t·|d| and the unit direction d/√a: Q = c + s² + 2 h s/√a, and (f + t d)·d/√a = s + h/√a.
int ExactHit::distance_side(const Dyadic& x) const {
    const int q = sign_of_sum(c_ + square(x), (h_ * x).scaled(1), a_), past = sign_of_sum(x, h_, a_);
    if (far_) return past < 0 ? 1 : -q;
    return past > 0 ? -1 : q;
}

Dyadic lower_end(const CertifiedNumber& x) { return Dyadic(x) - Dyadic(x.bound).scaled(x.exponent); }
Dyadic upper_end(const CertifiedNumber& x) { return Dyadic(x) + Dyadic(x.bound).scaled(x.exponent); }

bool encloses(const CertifiedNumber& t, const ExactHit& exact) {
    return exact.side(lower_end(t)) >= 0 && exact.side(upper_end(t)) <= 0;
}

bool encloses_distance(const CertifiedNumber& s, const ExactHit& exact) {
    return exact.distance_side(lower_end(s)) >= 0 && exact.distance_side(upper_end(s)) <= 0;
}

bool is_in_binade(const CertifiedNumber& x, const std::function<int(const Dyadic&)>& side) {
    if (x.is_zero()) return side(Dyadic()) == 0;
    const Dyadic start = Dyadic(1.0).scaled(x.floor_log2());
    return side(start) >= 0 && side(start.scaled(1)) < 0;
}

bool is_rounded(double rounded, const std::function<int(const Dyadic&)>& side, const FloatFormat& format) {
    if (!(rounded >= 0)) return false;
    const Dyadic tick = Dyadic(1.0).scaled(format.emin - format.precision);  // half the smallest subnormal
    const Dyadic end = Dyadic(1.0).scaled(format.emax + 1);                  // what infinity stands in place of
    Dyadic value = end;
    std::int64_t half_below = format.emax - format.precision,
                 half_above = 0;  // exponents of half the gap to either neighbour
    bool even = true;
    if (rounded < HUGE_VAL) {
        value = Dyadic(rounded);
        int e = format.emin;
        bool power_of_two = false;
        if (rounded != 0) {
            int exponent = 0;
            power_of_two = std::frexp(rounded, &exponent) == 0.5;
            e = std::max(exponent - 1, format.emin);
        }
        half_above = e - format.precision;
        half_below = power_of_two && e > format.emin ? half_above - 1 : half_above;
        const double significand = std::ldexp(rounded, static_cast<int>(format.precision - 1 - e));
        if (significand != std::floor(significand) || compare(value, end) >= 0)
            return false;  // not a number of the format
        even = std::fmod(significand, 2) == 0;
    }
    if (rounded > 0) {
        const int low = side(value - Dyadic(1.0).scaled(half_below));
        if (low < 0 || (low == 0 && !even)) return false;
    }
    if (rounded == HUGE_VAL) return true;
    const int high = side(value + (rounded == 0 ? tick : Dyadic(1.0).scaled(half_above)));
    return high < 0 || (high == 0 && even);
}

std::string paste(const Ray<double>& ray, const Sphere<double>& sphere) {
    const Vec<double>&o = ray.origin, &d = ray.direction, &c = sphere.centre;
    char text[512];
    std::snprintf(text, sizeof text,
                  "Ray<double> ray{{%a, %a, %a}, {%a, %a, %a}}; Sphere<double> sphere{{%a, %a, %a}, %a};", o.x, o.y,
                  o.z, d.x, d.y, d.z, c.x, c.y, c.z, sphere.radius);
    return text;
}

}  // namespace lostbits::test
