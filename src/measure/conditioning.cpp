#include "measure/conditioning.hpp"

#include <limits>
#include <optional>

#include "measure/metrics.hpp"
#include "number/dual.hpp"

namespace lostbits {
namespace {

constexpr std::size_t inputs = 10;

template <class E>
using Sensitive = Dual<E, inputs>;

/// Every number of the problem as an input of its own.
template <class E, class S>
struct Problem {
    std::array<E, inputs> x;
    Ray<Sensitive<E>> ray;
    Sphere<Sensitive<E>> sphere;

    Problem(const Ray<S>& r, const Sphere<S>& s)
        : x{lift<E>(r.origin.x),    lift<E>(r.origin.y),    lift<E>(r.origin.z),    lift<E>(r.direction.x), lift<E>(r.direction.y),
            lift<E>(r.direction.z), lift<E>(s.centre.x), lift<E>(s.centre.y), lift<E>(s.centre.z), lift<E>(s.radius)},
          ray{vec(0), vec(3)},
          sphere{vec(6), Sensitive<E>::input(x[9], 9)} {}

private:
    [[nodiscard]] Vec<Sensitive<E>> vec(std::size_t i) const {
        return {Sensitive<E>::input(x[i], i), Sensitive<E>::input(x[i + 1], i + 1), Sensitive<E>::input(x[i + 2], i + 2)};
    }
};

constexpr double tightness = 0x1p-20;

std::optional<double> close_enough(const Ball& k) {
    if (!k.is_bounded() || !(k.radius() <= tightness * std::fabs(k.hi()))) return std::nullopt;
    return k.hi();
}

std::optional<double> close_enough(const Interval& k) {
    if (!k.is_bounded()) return std::nullopt;
    const double low = mpfr_get_d(k.lower(), MPFR_RNDD), high = mpfr_get_d(k.upper(), MPFR_RNDU);
    if (std::isinf(low)) return low;
    if (!(high - low <= tightness * high)) return std::nullopt;
    return mpfr_get_d(k.lower(), MPFR_RNDN);
}

/// κ at one precision; nothing where it is too low.
template <class E, class S>
std::optional<double> condition_in(const Ray<S>& ray, const Sphere<S>& sphere) {
    const Problem<E, S> problem(ray, sphere);
    const Enclosed<Sensitive<E>> found = enclose(problem.ray, problem.sphere);
    if (found.hit.is_no()) return std::numeric_limits<double>::quiet_NaN();
    if (!found.hit.is_yes()) return std::nullopt;
    if (found.t.value().is_exact() && (found.t.value() <= E(0)).is_yes()) return std::numeric_limits<double>::infinity();
    E sum(0);
    for (std::size_t i = 0; i < inputs; ++i) sum = sum + abs(problem.x[i] * found.t.derivative(i));
    return close_enough(sum / found.t.value());
}

template <class S>
double find_condition(const Ray<S>& ray, const Sphere<S>& sphere) {
    if (const auto quick = condition_in<Ball>(ray, sphere)) return *quick;
    for (int bits = 384; bits <= 24576; bits *= 4) {
        const Interval::Precision precision(bits);
        if (const auto k = condition_in<Interval>(ray, sphere)) return *k;
    }
    // What no precision settles is a division by a root that is exactly zero: a tangent.
    return std::numeric_limits<double>::infinity();
}

}  // namespace

double condition(const Ray<double>& ray, const Sphere<double>& sphere) { return find_condition(ray, sphere); }
double condition(const Ray<Real>& ray, const Sphere<Real>& sphere) { return find_condition(ray, sphere); }

double inherent_bits(double condition, int precision) { return lost_bits(condition / 2, precision); }

}  // namespace lostbits
