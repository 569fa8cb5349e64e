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
using intersect::transform::MatrixPair;
using intersect::transform::ObjectRay;
using intersect::transform::StepFunctions;
using intersect::transform::TransformMethod;
using truth::CertifiedNumber;

std::optional<double> evaluate_one(const intersect::table::Intersector& form, const Format& format,
                                   const Ray<double>& ray, const Primitive<double>& primitive, double tmax) {
    std::optional<double> answer;
    intersect::simd::with_kernel(
        form, {form.info, form.native32, form.native64}, format, [&]<class S>(const auto& kernel) {
            const auto& [o, d] = ray;
            const std::array<S, 6> x{static_cast<S>(o.x), static_cast<S>(o.y), static_cast<S>(o.z),
                                     static_cast<S>(d.x), static_cast<S>(d.y), static_cast<S>(d.z)};
            const auto span_of_one = [](const S& value) { return std::span(&value, 1); };
            const S end = static_cast<S>(tmax);

            // A batch of one ray.
            intersect::table::RayBatch<S> rays{span_of_one(x[0]), span_of_one(x[1]), span_of_one(x[2]),
                                               span_of_one(x[3]), span_of_one(x[4]), span_of_one(x[5])};
            if (!std::isinf(tmax)) rays.tmax = span_of_one(end);

            S t{}, near{}, far{};
            std::uint8_t hit = 0;
            kernel(rays, intersect::Target<S>(convert_numbers(primitive, [](double n) { return static_cast<S>(n); })),
                   intersect::table::HitBatch<S>{std::span(&t, 1), std::span(&near, 1), std::span(&far, 1),
                                                 std::span(&hit, 1)});
            if (hit != 0) answer = static_cast<double>(t);
        });
    return answer;
}

namespace {

template <class T>
Vec<Real> to_real(const Vec<T>& v) {
    return {Real(as_double(v.x)), Real(as_double(v.y)), Real(as_double(v.z))};
}
template <class T>
Affine<Real> to_real(const Affine<T>& m) {
    return {{to_real(m.rows[0]), to_real(m.rows[1]), to_real(m.rows[2])}, to_real(m.shift)};
}
Real to_real(const CertifiedNumber& t) { return ldexp(Real(t.hi) + Real(t.lo), static_cast<int>(t.exponent)); }

/// Returns t as a certified value. A Real has 256 bits. The bits that do not fit into the value are smaller than its
/// error bound.
std::optional<CertifiedNumber> to_certified(const Real& t) {
    if (t == 0) return CertifiedNumber{};
    int exponent = 0;
    const Real scaled = frexp(t, &exponent);
    const double hi = nearest_double(scaled), lo = nearest_low_double(scaled);
    CertifiedNumber result = truth::make_certified(hi, lo, std::fabs(hi) * 0x1p-70);
    result.exponent += exponent;
    return result;
}

/// Computes the answers tₖ of a row for one ray, in the number type T: the first k steps are rounded, the others exact.
template <class T>
class StepwiseAnswers {
public:
    StepwiseAnswers(const Intersector& form, const Format& format, const Ray<double>& ray,
                    const Primitive<double>& primitive, const Range<double>& range)
        : row_(form),
          parts_(intersect::transform::find_transformed_parts(form)),
          format_(format),
          primitive_(primitive),
          range_(range) {
        world_ = lift_ray<T>(ray);
        exact_world_ = {to_real(world_.origin), to_real(world_.direction)};
        object_primitive_ = primitive;
        object_primitive_.transform.reset();
    }

    Steps compute(const CertifiedNumber& true_t) {
        const StepFunctions<T>& rounded_steps = intersect::transform::step_functions<T>(*parts_.method);
        const StepFunctions<Real>& exact_steps = parts_.method->real;
        Steps steps;
        steps.t[Steps::none_rounded] = true_t;

        // From here on, both matrices are those that the format computed.
        const MatrixPair<T> maps =
            rounded_steps.maps(convert_numbers(*primitive_.transform, [](double x) { return static_cast<T>(x); }));
        maps_ = {to_real(maps.to_world), to_real(maps.to_object)};

        // Rounds one more step of the ray's transform for each answer.
        const auto finish_exactly = [&](const Vec<Real>& o, const Vec<Real>& d) {
            return exact_steps.finish(maps_, exact_world_.origin, Ray<Real>{o, d});
        };
        const Vec<T> o = rounded_steps.origin(maps, world_.origin), d = rounded_steps.direction(maps, world_.direction);
        const Vec<Real> exact_d = exact_steps.direction(maps_, exact_world_.direction);
        steps.t[Steps::inverse_rounded] =
            exact_t(finish_exactly(exact_steps.origin(maps_, exact_world_.origin), exact_d));
        steps.t[Steps::origin_rounded] = exact_t(finish_exactly(to_real(o), exact_d));
        steps.t[Steps::direction_rounded] = exact_t(finish_exactly(to_real(o), to_real(d)));

        // The ray in the space of the primitive, as the format computes it.
        const ObjectRay<T> object_ray = rounded_steps.finish(maps, world_.origin, Ray<T>{o, d});
        const ObjectRay<Real> exact_object_ray{{to_real(object_ray.ray.origin), to_real(object_ray.ray.direction)},
                                               Real(as_double(object_ray.length)),
                                               Real(as_double(object_ray.scale))};
        steps.t[Steps::finish_rounded] = exact_t(exact_object_ray);

        // Rounds the form too, then the transform of its answer back into the world.
        if (const auto t = rounded_t(object_ray)) {
            if (std::isfinite(as_double(*t)))
                steps.t[Steps::form_rounded] =
                    to_certified(exact_steps.back(maps_, exact_world_, exact_object_ray, Real(as_double(*t))));
            const double rounded_world_t = as_double(rounded_steps.back(maps, world_, object_ray, *t));
            if (std::isfinite(rounded_world_t)) steps.t[Steps::all_rounded] = truth::as_certified(rounded_world_t);
        }
        return steps;
    }

private:
    [[nodiscard]] Range<double> scaled_range(double length) const {
        Range<double> range = range_;
        range.tmin *= length;
        range.tmax *= length;
        return range;
    }

    /// Returns t in the world if the form and the transform back are exact; empty for a miss.
    std::optional<CertifiedNumber> exact_t(const ObjectRay<Real>& object_ray) const {
        Primitive<Real> object = convert_numbers(object_primitive_, [](double x) { return Real(x); });
        if (object_ray.scale != 1) object = scaled(object, object_ray.scale);
        const truth::Truth object_truth =
            truth::find_truth(object_ray.ray, object, {}, row_.info->convention().for_shape(object.shape),
                              scaled_range(nearest_double(object_ray.length)));
        if (!object_truth.is_hit()) return std::nullopt;
        return to_certified(parts_.method->real.back(maps_, exact_world_, object_ray, to_real(object_truth.t)));
    }

    /// Returns the answer of the form in its format; empty for a miss.
    std::optional<T> rounded_t(const ObjectRay<T>& object_ray) const {
        Primitive<T> object = lift_primitive<T>(object_primitive_);
        if (as_double(object_ray.scale) != 1) object = scaled(object, object_ray.scale);
        const auto t = evaluate_one(
            *parts_.form, format_, as_doubles(object_ray.ray), as_doubles(object),
            std::isinf(range_.tmax) ? range_.tmax : as_double(static_cast<T>(range_.tmax) * object_ray.length));
        return t ? std::optional(static_cast<T>(*t)) : std::nullopt;
    }

    const Intersector& row_;
    intersect::transform::TransformedFormParts parts_;
    const Format& format_;
    const Primitive<double>& primitive_;
    Range<double> range_;
    Ray<T> world_;
    Ray<Real> exact_world_;
    Primitive<double> object_primitive_;
    MatrixPair<Real> maps_;
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
    std::optional<std::size_t> worst_step;
    double largest = 0;
    for (std::size_t k = 0; k < step_count; ++k) {
        const double size = std::fabs(error(k, t[0]->exponent));
        if (size > largest) {
            largest = size;
            worst_step = k;
        }
    }
    return worst_step;
}

Steps measure_steps(const Intersector& form, const Format& format, const Ray<double>& ray,
                    const Primitive<double>& primitive, const Range<double>& range) {
    const truth::Truth ray_truth =
        truth::find_truth(ray, primitive, {}, form.info->convention().for_shape(primitive.shape), range);
    const bool has_unit_directions = form.info->direction == intersect::Direction::unit;
    return with_number(format, [&]<class T>() {
        Steps steps = StepwiseAnswers<T>(form, format, ray, primitive, range)
                          .compute(has_unit_directions ? ray_truth.distance : ray_truth.t);
        if (!ray_truth.is_hit()) steps.t[Steps::none_rounded].reset();
        return steps;
    });
}

namespace {

/// A ray and the primitive that it is tested against, in numbers of the format.
struct RangedProblem {
    Ray<double> ray;
    Primitive<double> primitive;
    Range<double> range;
};

RangedProblem to_object_space(const TransformMethod& method, const Format& format, const RangedProblem& world) {
    return with_number(format, [&]<class T>() {
        const auto lift = [](double x) { return static_cast<T>(x); };
        const auto& step_functions = intersect::transform::step_functions<T>(method);
        const auto object_ray = step_functions.to_object(
            step_functions.maps(convert_numbers(*world.primitive.transform, lift)), lift_ray<T>(world.ray));
        Primitive<T> object = lift_primitive<T>(world.primitive);
        object.transform.reset();
        if (as_double(object_ray.scale) != 1) object = scaled(object, object_ray.scale);

        RangedProblem object_problem{as_doubles(object_ray.ray), as_doubles(object), world.range};
        object_problem.range.tmin = as_double(lift(world.range.tmin) * object_ray.length);
        object_problem.range.tmax = as_double(lift(world.range.tmax) * object_ray.length);
        return object_problem;
    });
}

}  // namespace

Levels find_lost_level(const Intersector& form, const Format& format, const Ray<double>& ray,
                       const Primitive<double>& primitive, const Range<double>& range) {
    Levels levels;
    RangedProblem problem{ray, primitive, range};

    // The first level that misses loses the hit, if the row misses at all.
    bool is_lost = !evaluate_one(form, format, ray, primitive, range.tmax);
    const auto lose_to = [&](Level level) {
        if (is_lost) levels.lost_to = level;
        is_lost = false;
    };

    // Takes the form apart from the outside in: a box around it, a transform, or the form itself.
    const Intersector* current = &form;
    for (;;) {
        if (const auto boxed_parts = intersect::bounding_box::find_boxed_parts(*current); boxed_parts.form != nullptr) {
            const BoundingBox<double> box = boxed_parts.method->compute_box(format, problem.primitive);
            levels.boxes.push_back({problem.ray, box});
            if (!evaluate_one(*boxed_parts.box, format, problem.ray, box, problem.range.tmax))
                lose_to(problem.primitive.transform ? Level::world_box : Level::box);
            current = boxed_parts.form;
        } else if (const auto transformed_parts = intersect::transform::find_transformed_parts(*current);
                   transformed_parts.form != nullptr) {
            if (problem.primitive.transform) {
                problem = to_object_space(*transformed_parts.method, format, problem);
                const auto form_convention = current->info->convention().for_shape(primitive.shape);
                if (!truth::find_truth(problem.ray, problem.primitive, {}, form_convention, problem.range).is_hit())
                    lose_to(Level::space);
            }
            current = transformed_parts.form;
        } else {
            lose_to(Level::form);
            return levels;
        }
    }
}

/// Searches for the smallest number k of ulps by which the end must move until the form hits. If it hits at one end, it
/// hits at every later one, so bisection is valid.
double find_end_margin(const Intersector& form, const Format& format, const Ray<double>& ray,
                       const Primitive<double>& primitive, const Range<double>& range) {
    const auto t = evaluate_one(form, format, ray, primitive, range.tmax);
    if (!t || !std::isfinite(*t)) return truth::missing;

    const double ulp =
        std::ldexp(1, static_cast<int>(ulp_exponent(format.parameters, *t == 0 ? -100000 : std::ilogb(*t))));
    const auto hits_with = [&](double k) {
        const double end = rounding::to_format(*t + k * ulp, 0, format.parameters);
        return evaluate_one(form, format, ray, primitive, std::min(end, range.tmax)).has_value();
    };
    if (hits_with(0)) return 0;

    // Doubles k until the form hits.
    double too_small = 0, large_enough = 1;
    for (; !hits_with(large_enough); large_enough *= 2) {
        if (large_enough > std::ldexp(1, format.parameters.precision)) return HUGE_VAL;
        too_small = large_enough;
    }

    while (large_enough - too_small > 1) {
        const double middle = std::floor((too_small + large_enough) / 2);
        (hits_with(middle) ? large_enough : too_small) = middle;
    }
    return large_enough;
}

}  // namespace lostbits::measure::answer
