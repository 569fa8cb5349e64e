#include "measure/answer/steps.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <span>

#include "intersect/simd/packed.hpp"
#include "intersect/transform/transformed_form.hpp"
#include "measure/truth/missing.hpp"
#include "measure/truth/truth.hpp"
#include "number/real.hpp"
#include "number/rounded.hpp"
#include "number/with_number.hpp"
#include "shapes/lift.hpp"

namespace lostbits::measure::answer {

using intersect::table::Intersector;
using intersect::transform::Maps;
using intersect::transform::ObjectRay;
using intersect::transform::StepsIn;
using intersect::transform::TransformMethod;
using truth::Certified;

std::optional<double> evaluate_one(const intersect::table::Intersector& row, const Format& format,
                                   const Ray<double>& ray, const Primitive<double>& primitive, double tmax) {
    std::optional<double> answer;
    intersect::simd::with_kernel(row, {row.info, row.native32, row.native64}, format, [&]<class S>(const auto& kernel) {
        const auto& [o, d] = ray;
        const std::array<S, 6> x{static_cast<S>(o.x), static_cast<S>(o.y), static_cast<S>(o.z),
                                 static_cast<S>(d.x), static_cast<S>(d.y), static_cast<S>(d.z)};
        const auto one = [](const S& value) { return std::span(&value, 1); };
        const S end = static_cast<S>(tmax);
        intersect::table::RayBatch<S> rays{one(x[0]), one(x[1]), one(x[2]), one(x[3]), one(x[4]), one(x[5])};
        if (!std::isinf(tmax)) rays.tmax = one(end);
        S t{}, near{}, far{};
        std::uint8_t hit = 0;
        kernel(rays, intersect::Target<S>(transformed(primitive, [](double n) { return static_cast<S>(n); })),
               intersect::table::HitBatch<S>{std::span(&t, 1), std::span(&near, 1), std::span(&far, 1),
                                             std::span(&hit, 1)});
        if (hit != 0) answer = static_cast<double>(t);
    });
    return answer;
}

namespace {

template <class T>
Vec<Real> exactly(const Vec<T>& v) {
    return {Real(as_double(v.x)), Real(as_double(v.y)), Real(as_double(v.z))};
}
template <class T>
Affine<Real> exactly(const Affine<T>& m) {
    return {{exactly(m.rows[0]), exactly(m.rows[1]), exactly(m.rows[2])}, exactly(m.shift)};
}

/// t as a certified value. A Real has 256 bits: what the value leaves out is less than any of the bounds that go into
/// it.
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

/// Takes one ray through the steps of a row, in T.
template <class T>
class Walk {
public:
    Walk(const Intersector& row, const Format& format, const Ray<double>& ray, const Primitive<double>& primitive,
         const Range<double>& range)
        : row_(row),
          made_(intersect::transform::transformed_parts_of(row)),
          format_(format),
          primitive_(primitive),
          range_(range) {
        world_ = lift_ray<T>(ray);
        exact_world_ = {exactly(world_.origin), exactly(world_.direction)};
        plain_ = primitive;
        plain_.placed.reset();
    }

    Steps walk(const Certified& truth) {
        const StepsIn<T>& here = intersect::transform::steps_in<T>(*made_.method);
        const StepsIn<Real>& exact = made_.method->real;
        Steps found;
        found.t[0] = truth;
        const Maps<T> maps = here.maps(transformed(*primitive_.placed, [](double x) { return static_cast<T>(x); }));
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

    /// t in the world where the form and the way back are exact.
    std::optional<Certified> met(const ObjectRay<Real>& in) const {
        Primitive<Real> object = transformed(plain_, [](double x) { return Real(x); });
        if (in.scale != 1) object = scaled(object, in.scale);
        const truth::Truth truth = truth::find_truth(in.ray, object, {}, row_.info->convention().of(object.shape),
                                                     scaled_range(word_of(in.length)));
        if (!truth.is_hit()) return std::nullopt;
        return known(made_.method->real.back(maps_, exact_world_, in, value_of(truth.t)));
    }

    /// Answer of the form; nothing if it misses.
    std::optional<T> asked(const ObjectRay<T>& in) const {
        Primitive<T> object = lift_primitive<T>(plain_);
        if (as_double(in.scale) != 1) object = scaled(object, in.scale);
        const auto t =
            evaluate_one(*made_.form, format_, as_doubles(in.ray), as_doubles(object),
                         std::isinf(range_.tmax) ? range_.tmax : as_double(static_cast<T>(range_.tmax) * in.length));
        return t ? std::optional(static_cast<T>(*t)) : std::nullopt;
    }

    const Intersector& row_;
    intersect::transform::TransformedFormParts made_;
    const Format& format_;
    const Primitive<double>& primitive_;
    Range<double> range_;
    Ray<T> world_;
    Ray<Real> exact_world_;
    Primitive<double> plain_;
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

Steps steps_of(const Intersector& row, const Format& format, const Ray<double>& ray, const Primitive<double>& primitive,
               const Range<double>& range) {
    const truth::Truth truth = truth::find_truth(ray, primitive, {}, row.info->convention().of(primitive.shape), range);
    const bool unit = row.info->direction == intersect::Direction::unit;
    return with_number(format, [&]<class T>() {
        Steps found = Walk<T>(row, format, ray, primitive, range).walk(unit ? truth.distance : truth.t);
        if (!truth.is_hit()) found.t[0].reset();
        return found;
    });
}

namespace {

/// A ray and the primitive that it is tested against, in numbers of the format.
struct RangedProblem {
    Ray<double> ray;
    Primitive<double> primitive;
    Range<double> range;
};

RangedProblem object_of(const TransformMethod& space, const Format& format, const RangedProblem& world) {
    return with_number(format, [&]<class T>() {
        const auto lift = [](double x) { return static_cast<T>(x); };
        const auto& steps = intersect::transform::steps_in<T>(space);
        const auto in = steps.to_object(steps.maps(transformed(*world.primitive.placed, lift)), lift_ray<T>(world.ray));
        Primitive<T> object = lift_primitive<T>(world.primitive);
        object.placed.reset();
        if (as_double(in.scale) != 1) object = scaled(object, in.scale);
        RangedProblem there{as_doubles(in.ray), as_doubles(object), world.range};
        there.range.tmin = as_double(lift(world.range.tmin) * in.length);
        there.range.tmax = as_double(lift(world.range.tmax) * in.length);
        return there;
    });
}

}  // namespace

Levels levels_of(const Intersector& row, const Format& format, const Ray<double>& ray,
                 const Primitive<double>& primitive, const Range<double>& range) {
    Levels found;
    RangedProblem at{ray, primitive, range};
    bool is_lost = !evaluate_one(row, format, ray, primitive, range.tmax);
    const auto lose = [&](Level level) {
        if (is_lost) found.lost_to = level;
        is_lost = false;
    };
    const Intersector* now = &row;
    for (;;) {
        if (const auto behind = intersect::bounding_box::boxed_parts_of(*now); behind.form != nullptr) {
            const BoundingBox<double> box = behind.method->in(format, at.primitive);
            found.boxes.push_back({at.ray, box});
            if (!evaluate_one(*behind.box, format, at.ray, box, at.range.tmax))
                lose(at.primitive.placed ? Level::world_box : Level::box);
            now = behind.form;
        } else if (const auto through = intersect::transform::transformed_parts_of(*now); through.form != nullptr) {
            if (at.primitive.placed) {
                at = object_of(*through.method, format, at);
                const auto words = now->info->convention().of(primitive.shape);
                if (!truth::find_truth(at.ray, at.primitive, {}, words, at.range).is_hit()) lose(Level::space);
            }
            now = through.form;
        } else {
            lose(Level::form);
            return found;
        }
    }
}

/// A box test that hits still hits with a later end of the ray. So k is doubled until the row hits, and then bisected.
double end_margin(const Intersector& row, const Format& format, const Ray<double>& ray,
                  const Primitive<double>& primitive, const Range<double>& range) {
    const auto t = evaluate_one(row, format, ray, primitive, range.tmax);
    if (!t || !std::isfinite(*t)) return truth::missing;
    const double ulp =
        std::ldexp(1, static_cast<int>(ulp_exponent(format.parameters, *t == 0 ? -100000 : std::ilogb(*t))));
    const auto is_found = [&](double k) {
        const double end = rounding::to_format(*t + k * ulp, 0, format.parameters);
        return evaluate_one(row, format, ray, primitive, std::min(end, range.tmax)).has_value();
    };
    if (is_found(0)) return 0;
    double lost = 0, found = 1;
    for (; !is_found(found); found *= 2) {
        if (found > std::ldexp(1, format.parameters.precision)) return HUGE_VAL;
        lost = found;
    }
    while (found - lost > 1) {
        const double between = std::floor((lost + found) / 2);
        (is_found(between) ? found : lost) = between;
    }
    return found;
}

}  // namespace lostbits::measure::answer
