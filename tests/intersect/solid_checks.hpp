// What holds of every shape: held against an answer in fractions, or against itself. An answer says whether the ray
// meets the solid (`meets`), clear of every equality (`is_clear`), and whether a t that is off by at most e may be the
// first point (`is_first`).
#pragma once

#include <array>
#include <string>
#include <string_view>

#include "catch.hpp"
#include "intersect/catalogue.hpp"
#include "intersect/certified_root.hpp"

namespace lostbits::test {

/// Whether a form that computes without rounding answers each ray rightly: in `Real`, to 2^-150.
template <class Forms>
class UnroundedForms {
public:
    template <class S, class Answer>
    void ask(std::string_view family, const Ray<double>& asked, const S& solid, const Answer& right, bool from_inside) {
        if (!right.is_clear()) return;
        std::size_t form = 0;
        Forms::for_each([&]<class Form>() {
            Tally& tally = tallies_[form++];
            if (Form::info.roots == intersect::Roots::near_only && from_inside) return;
            Ray<Real> ray{lifted<Real>(asked.origin), lifted<Real>(asked.direction)};
            const Real size = Form::info.direction == intersect::Direction::unit ? length(ray.direction) : Real(1);
            ray.direction = Vec<Real>(ray.direction.x / size, ray.direction.y / size, ray.direction.z / size);
            const Hit<Real> h = Form::intersect(ray, solid);
            const Rational t = h.hit ? rational_from(Real(h.t / size)) : Rational(0);
            const bool good = h.hit == right.meets() && (!h.hit || right.is_first(t, power_of_two(-150) * abs(t)));
            ++tally.asked, tally.hits += h.hit;
            if (!good && tally.wrong++ == 0) tally.first = family;
        });
    }
    void check(long least) const {
        std::size_t form = 0;
        Forms::for_each([&]<class Form>() {
            const Tally& t = tallies_[form++];
            INFO(Form::info.name << ": asked " << t.asked << ", hits " << t.hits << ", wrong " << t.wrong
                                 << ", first in " << t.first);
            CHECK(t.wrong == 0);
            CHECK(t.asked > least);
            CHECK(t.hits > t.asked / 5);
            CHECK(t.hits < t.asked);
        });
    }

private:
    struct Tally {
        long asked = 0, hits = 0, wrong = 0;
        std::string first = "none";  ///< of the families, in which it is wrong
    };
    std::array<Tally, Forms::size> tallies_{};
};

/// The solid with its numbers in another arithmetic.
template <template <class> class S>
S<Real> in_real(const S<double>& plain) {
    std::array<Real, most_numbers> numbers;
    std::size_t k = 0;
    plain.each([&](double x) { numbers[k++] = Real(x); });
    return S<Real>::of([&](std::size_t i) { return numbers[i]; });
}

/// The nearest point of the surface: on it, as far away as `distance` says, with a normal of length one.
template <template <class> class S>
void check_nearest_point(const S<double>& plain, const Vec<double>& q) {
    const Real tolerance = ldexp(Real(1), -180);
    const S<Real> s = in_real(plain);
    const Vec<Real> p = lifted<Real>(q);
    const Ray<Real> ray{p, p};
    const Vec<Real> on = s.projected(ray, p);
    const Real d = s.distance(p);
    REQUIRE(abs(s.off_surface(on)) * s.unit() <= tolerance);
    REQUIRE(abs(s.off_surface(p)) * s.unit() <= abs(d) + tolerance);
    const Vec<Real> n = s.outward_normal(ray, on);
    REQUIRE(abs(Real(length(n) - Real(1))) <= tolerance);
    REQUIRE(abs(s.distance(on + ldexp(Real(1), -20) * n)) > 0);
    REQUIRE((s.distance(p) <= 0) == plain.may_hold(q));
}

/// A point put onto the surface in float lies within its bound; what is returned is how much of that it takes.
template <template <class> class S>
double share_of_bound(const S<double>& solid, const Vec<double>& at) {
    std::array<float, most_numbers> numbers;
    std::size_t k = 0;
    solid.each([&](double x) { numbers[k++] = static_cast<float>(x); });
    const S<float> s = S<float>::of([&](std::size_t i) { return numbers[i]; });
    const S<Real> same = S<Real>::of([&](std::size_t i) { return Real(numbers[i]); });
    const auto exact = [](const Vec<float>& x) { return Vec<Real>(Real(x.x), Real(x.y), Real(x.z)); };
    // Put back by what rounding moved it: a point near the surface, as hits are.
    const Vec<Real> p = lifted<Real>(at), on = same.projected(Ray<Real>{p, p}, p);
    const Vec<float> near(static_cast<float>(on.x), static_cast<float>(on.y), static_cast<float>(on.z));
    const BoundedPoint<float> b = s.bounded_point(Ray<float>{near, {1, 0, 0}}, 0, near);
    double allowed = 0;
    for (int i = 0; i < 3; ++i) allowed += static_cast<double>(b.delta[i]) * static_cast<double>(b.delta[i]);
    return static_cast<double>(abs(same.distance(exact(b.p)))) / std::sqrt(allowed);
}

}  // namespace lostbits::test
