// The same question answered in exact integers, by another derivation: no enclosure, no root, no rounding.
#pragma once

#include <cmath>
#include <functional>
#include <string>

#include <boost/multiprecision/gmp.hpp>

#include "geometry/range.hpp"
#include "measure/truth/certified.hpp"
#include "number/real.hpp"
#include "shapes/box/box.hpp"
#include "shapes/sphere/sphere.hpp"

namespace lostbits::test {

/// m·2^e, exactly.
class Dyadic {
public:
    Dyadic() = default;
    explicit Dyadic(double x);
    explicit Dyadic(mpfr_srcptr x);
    explicit Dyadic(const Real& x) : Dyadic(x.backend().data()) {}
    explicit Dyadic(const measure::truth::CertifiedNumber& x)
        : Dyadic((Dyadic(x.hi) + Dyadic(x.lo)).scaled(x.exponent)) {}

    [[nodiscard]] int sign() const { return m_.sign(); }
    [[nodiscard]] Dyadic scaled(std::int64_t e) const;
    friend Dyadic operator+(const Dyadic& a, const Dyadic& b);
    friend Dyadic operator-(const Dyadic& a);
    friend Dyadic operator-(const Dyadic& a, const Dyadic& b) { return a + -b; }
    friend Dyadic operator*(const Dyadic& a, const Dyadic& b);
    friend int compare(const Dyadic& a, const Dyadic& b) { return (a - b).sign(); }
    using Fraction = boost::multiprecision::number<boost::multiprecision::gmp_rational, boost::multiprecision::et_off>;
    [[nodiscard]] Fraction fraction() const;

private:
    using Integer = boost::multiprecision::number<boost::multiprecision::gmp_int, boost::multiprecision::et_off>;
    Integer m_ = 0;
    std::int64_t e_ = 0;
};

/// The first root of |f + t d|² = r² in a range, known only by the signs that define it.
class ExactHit {
public:
    ExactHit(const Ray<double>& ray, const Sphere<double>& sphere, const Range<double>& range = {}) {
        find(ray, sphere, range);
    }
    ExactHit(const Ray<Real>& ray, const Sphere<Real>& sphere) { find(ray, sphere, {}); }

    [[nodiscard]] bool hit() const { return hit_; }
    [[nodiscard]] bool on_surface() const { return c_.sign() == 0; }
    [[nodiscard]] bool is_inside() const { return c_.sign() < 0; }
    [[nodiscard]] bool is_tangent_line() const { return discriminant_.sign() == 0; }
    /// True if, for a hit, the range ends where the line enters.
    [[nodiscard]] bool ends_at_entry(const Range<double>& range) const {
        return !far_ && !std::isinf(range.tmax) && side(Dyadic(range.tmax)) == 0;
    }
    /// The sign of t* − x, for a hit.
    [[nodiscard]] int side(const Dyadic& x) const;
    /// The sign of t*·|d| − x, for a hit.
    [[nodiscard]] int distance_side(const Dyadic& x) const;

private:
    template <class S>
    void find(const Ray<S>& ray, const Sphere<S>& sphere, const Range<double>& range);
    [[nodiscard]] bool is_in(const Range<double>& range) const;

    Dyadic f_[3], d_[3], r2_;
    Dyadic a_, h_, c_, discriminant_;
    bool hit_ = false;
    bool far_ = false;  ///< of the two roots it is the far one
};

/// (hi + lo ∓ bound)·2^exponent.
Dyadic lower_end(const measure::truth::CertifiedNumber& x);
Dyadic upper_end(const measure::truth::CertifiedNumber& x);

/// True if t* lies between both ends, and the distance too.
bool encloses(const measure::truth::CertifiedNumber& t, const ExactHit& exact);
bool encloses_distance(const measure::truth::CertifiedNumber& distance, const ExactHit& exact);

/// True if 2^k ≤ x* < 2^(k + 1) for the k = ⌊log2 x⌋ that x gives, `side(m)` being the sign of x* − m; or both are 0.
bool is_in_binade(const measure::truth::CertifiedNumber& x, const std::function<int(const Dyadic&)>& side);

/// True if `rounded` is a number x* ≥ 0 rounded to nearest, ties to even, where `side(m)` is the sign of x* − m: x*
/// lies between the midpoints on either side of `rounded`, and on one of them only where `rounded` is the even
/// neighbour. Beyond the largest number stands infinity.
bool is_rounded(double rounded, const std::function<int(const Dyadic&)>& side, const FloatFormat& format);

/// The inputs as C++ that compiles.
std::string paste(const Ray<double>& ray, const Sphere<double>& sphere);

}  // namespace lostbits::test
