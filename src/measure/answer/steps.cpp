#include "measure/answer/steps.hpp"

#include <cmath>

#include "measure/answer/asked.hpp"
#include "measure/truth/missing.hpp"
#include "shapes/lift.hpp"

namespace lostbits::measure::answer {

using intersect::space::Maps;
using intersect::space::ObjectRay;
using intersect::space::StepsIn;
using intersect::table::Intersector;
using truth::Certified;

namespace {

template <class T>
Vec<Real> exactly(const Vec<T>& v) {
    return {Real(as_double(v.x)), Real(as_double(v.y)), Real(as_double(v.z))};
}
template <class T>
Affine<Real> exactly(const Affine<T>& m) {
    return {{exactly(m.rows[0]), exactly(m.rows[1]), exactly(m.rows[2])}, exactly(m.shift)};
}

/// 256 bits as a value: what they leave is less than any of the bounds that they are made of.
std::optional<Certified> known(const Real& t) {
    if (t == 0) return Certified{};
    int exponent = 0;
    const Real scaled = frexp(t, &exponent);
    const double hi = word_of(scaled), lo = low_word_of(scaled);
    Certified found = truth::certified(hi, lo, std::fabs(hi) * 0x1p-70);
    found.exponent += exponent;
    return found;
}

Real value_of(const Certified& t) { return ldexp(Real(t.hi) + Real(t.lo), static_cast<int>(t.exponent)); }

/// One ray through the steps of a row, in T.
template <class T>
class Walk {
public:
    Walk(const Intersector& row, const Format& format, const Ray<double>& ray, const Solid<double>& solid,
         const Range<double>& range)
        : row_(row), made_(intersect::space::made_of(row)), format_(format), solid_(solid), range_(range) {
        const auto vec = [](const Vec<double>& v) {
            return Vec<T>(static_cast<T>(v.x), static_cast<T>(v.y), static_cast<T>(v.z));
        };
        world_ = {vec(ray.origin), vec(ray.direction)};
        exact_world_ = {exactly(world_.origin), exactly(world_.direction)};
        plain_ = solid;
        plain_.placed.reset();
    }

    Steps walk(const Certified& truth) {
        const StepsIn<T>& here = intersect::space::steps_in<T>(*made_.space);
        const StepsIn<Real>& exact = made_.space->real;
        Steps found;
        found.t[0] = truth;
        const Maps<T> maps = here.maps(transformed(*solid_.placed, [](double x) { return static_cast<T>(x); }));
        maps_ = {exactly(maps.to_world), exactly(maps.to_object)};
        const auto finished = [&](const Vec<Real>& o, const Vec<Real>& d) {
            return exact.finish(maps_, exact_world_.origin, Ray<Real>{o, d});
        };
        const Vec<T> o = here.origin(maps, world_.origin), d = here.direction(maps, world_.direction);
        const Vec<Real> exact_d = exact.direction(maps_, exact_world_.direction);
        found.t[1] = met(finished(exact.origin(maps_, exact_world_.origin), exact_d));
        found.t[2] = met(finished(exactly(o), exact_d));
        found.t[3] = met(finished(exactly(o), exactly(d)));
        const ObjectRay<T> in = here.finish(maps, world_.origin, Ray<T>{o, d});
        const ObjectRay<Real> exact_in{
            {exactly(in.ray.origin), exactly(in.ray.direction)}, Real(as_double(in.length)), Real(as_double(in.scale))};
        found.t[4] = met(exact_in);
        if (const auto t = asked(in)) {
            if (std::isfinite(as_double(*t)))
                found.t[5] = known(exact.back(maps_, exact_world_, exact_in, Real(as_double(*t))));
            const double back = as_double(here.back(maps, world_, in, *t));
            if (std::isfinite(back)) found.t[6] = truth::exactly(back);
        }
        return found;
    }

private:
    [[nodiscard]] Range<double> scaled_range(double length) const {
        Range<double> there = range_;
        there.tmin *= length;
        there.tmax *= length;
        return there;
    }

    /// t of the world where the form and the way back are exact.
    std::optional<Certified> met(const ObjectRay<Real>& in) const {
        Solid<Real> object = transformed(plain_, [](double x) { return Real(x); });
        if (in.scale != 1) object = scaled(object, in.scale);
        const truth::Truth truth = truth::find_truth(in.ray, object, {}, row_.info->convention().of(object.shape),
                                                     scaled_range(word_of(in.length)));
        if (!truth.is_hit()) return std::nullopt;
        return known(made_.space->real.back(maps_, exact_world_, in, value_of(truth.t)));
    }

    /// What the form answers; nothing where it misses.
    std::optional<T> asked(const ObjectRay<T>& in) const {
        const auto back = [](const Vec<T>& v) { return Vec<double>(as_double(v.x), as_double(v.y), as_double(v.z)); };
        Solid<T> object = transformed(plain_, [](double n) { return static_cast<T>(n); });
        if (as_double(in.scale) != 1) object = scaled(object, in.scale);
        const auto t =
            ask_one(*made_.form, format_, {back(in.ray.origin), back(in.ray.direction)},
                    transformed(object, [](const T& n) { return as_double(n); }),
                    std::isinf(range_.tmax) ? range_.tmax : as_double(static_cast<T>(range_.tmax) * in.length));
        return t ? std::optional(static_cast<T>(*t)) : std::nullopt;
    }

    const Intersector& row_;
    intersect::space::Made made_;
    const Format& format_;
    const Solid<double>& solid_;
    Range<double> range_;
    Ray<T> world_;
    Ray<Real> exact_world_;
    Solid<double> plain_;
    Maps<Real> maps_;
};

}  // namespace

double Steps::error(std::size_t k, std::int64_t exponent) const {
    if (!t[k] || !t[k + 1]) return truth::missing;
    return truth::scaled_difference(*t[k + 1], *t[k], exponent);
}

std::optional<std::size_t> Steps::worst() const {
    for (std::size_t k = 0; k < step_count; ++k)
        if (t[k].has_value() != t[k + 1].has_value()) return k;
    if (!t[0]) return std::nullopt;
    std::optional<std::size_t> found;
    double most = 0;
    for (std::size_t k = 0; k < step_count; ++k) {
        const double size = std::fabs(error(k, t[0]->exponent));
        if (size > most) most = size, found = k;
    }
    return found;
}

Steps steps_of(const Intersector& row, const Format& format, const Ray<double>& ray, const Solid<double>& solid,
               const Range<double>& range) {
    const truth::Truth truth = truth::find_truth(ray, solid, {}, row.info->convention().of(solid.shape), range);
    const bool unit = row.info->direction == intersect::Direction::unit;
    return with_number(format, [&]<class T>() {
        Steps found = Walk<T>(row, format, ray, solid, range).walk(unit ? truth.distance : truth.t);
        if (!truth.is_hit()) found.t[0].reset();
        return found;
    });
}

}  // namespace lostbits::measure::answer
