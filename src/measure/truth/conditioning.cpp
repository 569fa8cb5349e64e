#include "measure/truth/conditioning.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>
#include <variant>
#include <vector>

#include "intersect/conventions.hpp"
#include "intersect/process/parallel.hpp"
#include "measure/truth/band.hpp"
#include "measure/truth/missing.hpp"
#include "number/dual.hpp"

namespace lostbits::measure::truth {

using intersect::Convention;

namespace {

/// Problem as a list of the numbers of the origin, the direction, the primitive and its matrix.
struct FlatProblem {
    Shape shape;
    std::variant<std::vector<double>, std::vector<Real>> numbers;
    std::optional<Transform<int>> transform;  ///< kind of the matrix, without its numbers

    template <class S>
    FlatProblem(const Ray<S>& ray, const Primitive<S>& primitive) : shape(primitive.shape) {
        auto& all_numbers = numbers.emplace<std::vector<S>>();
        for (const Vec<S>& v : {ray.origin, ray.direction}) all_numbers.insert(all_numbers.end(), {v.x, v.y, v.z});
        all_numbers.insert(all_numbers.end(), primitive.shape_numbers().begin(), primitive.shape_numbers().end());
        if (!primitive.transform) return;
        all_numbers.insert(all_numbers.end(), primitive.transform->matrix.begin(), primitive.transform->matrix.end());
        transform = convert_numbers(*primitive.transform, [](const S&) { return 0; });
    }
};

/// Number with enough derivatives for any primitive. If each shape had its own count, the code would be compiled once
/// for each.
template <class E>
using DualEnclosure = Dual<E, 6 + max_primitive_number_count>;

/// Problem in which each number is an input that t is differentiated by.
template <class E>
struct Problem {
    std::vector<E> inputs;
    Ray<DualEnclosure<E>> ray;
    Primitive<DualEnclosure<E>> primitive;

    explicit Problem(const FlatProblem& flat) : primitive(flat.shape) {
        const auto lift_all = [&](const auto& numbers) {
            for (const auto& number : numbers) inputs.push_back(lift<E>(number));
        };
        std::visit(lift_all, flat.numbers);
        std::size_t i = 0;
        const auto next_input = [&] {
            ++i;
            return DualEnclosure<E>::input(inputs[i - 1], i - 1, inputs.size());
        };
        for (auto* const v : {&ray.origin, &ray.direction}) {
            v->x = next_input();
            v->y = next_input();
            v->z = next_input();
        }
        for (auto& element : primitive.shape_numbers()) element = next_input();
        if (!flat.transform) return;
        primitive.transform = convert_numbers(*flat.transform, [](int) { return DualEnclosure<E>(0); });
        for (auto& element : primitive.transform->matrix) element = next_input();
    }
};

/// t and its derivatives by each number; only the kind `known` has them. The kind `infinite` stands for an infinite κ:
/// t is 0, or it is at a double root, which does not move in proportion to its inputs.
template <class E>
struct Sensitivity {
    enum class Kind { miss, infinite, known } kind;
    E t = E(0);
    std::vector<E> inputs = {}, derivatives = {};
};

/// Sensitivity at one precision; empty if the precision is too low.
template <class E>
std::optional<Sensitivity<E>> find_sensitivity(const FlatProblem& flat, Convention convention,
                                               const Range<double>& ray_range) {
    using Kind = typename Sensitivity<E>::Kind;
    const Problem<E> problem(flat);
    const auto range = range_over<DualEnclosure<E>, E>(ray_range);
    const auto enclosed = enclose(problem.ray, problem.primitive, range ? &*range : nullptr, convention);
    if (enclosed.hit.is_no()) return Sensitivity<E>{Kind::miss};
    if (!enclosed.hit.is_yes()) return std::nullopt;
    if (enclosed.at_double_root || (enclosed.t.value().is_exact() && (enclosed.t.value() <= E(0)).is_yes()))
        return Sensitivity<E>{Kind::infinite};
    Sensitivity<E> result{Kind::known, enclosed.t.value(), problem.inputs};
    for (std::size_t i = 0; i < result.inputs.size(); ++i) result.derivatives.push_back(enclosed.t.derivative(i));
    return result;
}

/// Largest relative width of an enclosure of κ.
constexpr double condition_tightness = 0x1p-20;

/// The κ that an enclosure holds; empty if the enclosure is too wide.
std::optional<double> tight_value(const Ball& k) {
    if (!k.is_bounded() || !(k.radius() <= condition_tightness * std::fabs(k.hi()))) return std::nullopt;
    return k.hi();
}

std::optional<double> tight_value(const Interval& k) {
    if (!k.is_bounded()) return std::nullopt;
    const double low = mpfr_get_d(k.lower(), MPFR_RNDD), high = mpfr_get_d(k.upper(), MPFR_RNDU);
    if (std::isinf(low)) return low;
    if (!(high - low <= condition_tightness * high)) return std::nullopt;
    return mpfr_get_d(k.lower(), MPFR_RNDN);
}

struct ConditionQuery {
    using Answer = double;
    static double answer_for_miss() { return missing; }
    static double answer_for_infinite() { return std::numeric_limits<double>::infinity(); }
    template <class E>
    static std::optional<double> answer(const Sensitivity<E>& sensitivity) {
        E sum(0);
        for (std::size_t i = 0; i < sensitivity.inputs.size(); ++i)
            sum = sum + abs(sensitivity.inputs[i] * sensitivity.derivatives[i]);
        return tight_value(sum / sensitivity.t);
    }
};

double middle_of(const Ball& x) { return x.hi(); }
double middle_of(const Interval& x) { return mpfr_get_d(x.lower(), MPFR_RNDN); }
double width_of(const Ball& x) { return x.is_bounded() ? x.radius() : HUGE_VAL; }
double width_of(const Interval& x) {
    return x.is_bounded() ? mpfr_get_d(x.upper(), MPFR_RNDU) - mpfr_get_d(x.lower(), MPFR_RNDD) : HUGE_VAL;
}

struct GradientQuery {
    using Answer = std::vector<double>;
    static Answer answer_for_miss() { return {}; }
    static Answer answer_for_infinite() { return {}; }
    template <class E>
    static std::optional<Answer> answer(const Sensitivity<E>& sensitivity) {
        Answer gradient;
        double largest = 0, widest = 0;
        for (const E& slope : sensitivity.derivatives) {
            gradient.push_back(middle_of(slope));
            largest = std::max(largest, std::fabs(gradient.back()));
            widest = std::max(widest, width_of(slope));
        }
        const bool is_tight = std::isfinite(largest) && widest <= 0x1p-40 * largest;
        return is_tight ? std::optional(std::move(gradient)) : std::nullopt;
    }
};

/// Answer that `Query` computes from a sensitivity; empty if the precision is too low for it.
template <class Query, class E>
std::optional<typename Query::Answer> query_answer(const std::optional<Sensitivity<E>>& sensitivity) {
    if (!sensitivity) return std::nullopt;
    switch (sensitivity->kind) {
        case Sensitivity<E>::Kind::miss: return Query::answer_for_miss();
        case Sensitivity<E>::Kind::infinite: return Query::answer_for_infinite();
        case Sensitivity<E>::Kind::known: break;
    }
    return Query::answer(*sensitivity);
}

/// Answer of `Query`, first in balls and then in intervals of rising precision.
template <class Query, class S>
typename Query::Answer answer_query(const Ray<S>& ray, const Primitive<S>& primitive, Convention convention,
                                    Range<double> range) {
    if (convention.endless) range.tmax = HUGE_VAL;
    convention = convention_in(range, convention);
    const FlatProblem flat(ray, primitive);
    if (const auto from_balls = query_answer<Query>(find_sensitivity<Ball>(flat, convention, range)))
        return *from_balls;
    for (int bits = 384; bits <= 24576; bits *= 4) {
        const Interval::Precision precision(bits);
        if (const auto answer = query_answer<Query>(find_sensitivity<Interval>(flat, convention, range)))
            return *answer;
    }

    // If no precision settles a problem, its formula divides by a square root that is exactly zero: the line is a
    // tangent.
    return Query::answer_for_infinite();
}

}  // namespace

double condition(const Ray<double>& ray, const Primitive<double>& primitive, Convention convention,
                 const Range<double>& range) {
    return answer_query<ConditionQuery>(ray, primitive, convention, range);
}
double condition(const Ray<Real>& ray, const Primitive<Real>& primitive, Convention convention,
                 const Range<double>& range) {
    return answer_query<ConditionQuery>(ray, primitive, convention, range);
}
std::vector<double> gradient(const Ray<double>& ray, const Primitive<double>& primitive, Convention convention,
                             const Range<double>& range) {
    return answer_query<GradientQuery>(ray, primitive, convention, range);
}

void Band::find_condition() {
    condition_.resize(pixel_count());
    intersect::process::in_parallel(tbb::blocked_range<std::size_t>(0, pixel_count(), 256), [&](const auto& range) {
        for (std::size_t i = range.begin(); i < range.end(); ++i) {
            limit_.stop.check();
            condition_[i] = measure_condition(i, truths_.decision[i], truths_.primitive[i], {});
        }
    });
}

double Band::measure_condition(std::size_t i, Truth::Decision decision, int primitive_index,
                               Convention convention) const {
    if (decision != Truth::Decision::hit) return missing;
    return with_ray(i, [&](const auto& ray, const auto& primitives) {
        const auto primitive = primitives[primitive_index];
        return lostbits::measure::truth::condition(ray, primitive, convention.for_shape(primitive.shape), range(i));
    });
}

double Band::condition(std::size_t i, Convention convention) const {
    if (convention.is_special() && needs_special_truth(i, convention)) {
        const Truth truth = find_ray_truth(i, convention);
        return measure_condition(i, truth.decision, truth.primitive, convention);
    }
    if (!truths_.may_differ(i, convention)) return condition_[i];
    const std::size_t key = convention_key(i, convention);
    const auto entry = special_conditions_.find(key);
    if (entry != special_conditions_.end()) return entry->second;
    const Truth& truth = special_truth(i, convention);
    return special_conditions_
        .emplace(key, measure_condition(i, truth.decision, truth.primitive, plain_part(convention)))
        .first->second;
}

double Band::measure_reach(std::size_t i, const Truth& ray_truth, Convention convention, Length length,
                           const FloatFormat& format, Perturbation perturbation) const {
    if (!ray_truth.is_hit()) return missing;
    return with_ray(i, [&](const auto& ray, const auto& primitives) {
        const auto primitive = primitives[ray_truth.primitive];
        const CertifiedNumber& answer = length == Length::distance ? ray_truth.distance : ray_truth.t;
        const double tmin = range(i).tmin;
        const bool begins_inside =
            tmin > 0 && intersect::answers_0_inside(primitive.shape, convention.for_shape(primitive.shape).inside) &&
            std::ldexp(ray_truth.t.hi, static_cast<int>(ray_truth.t.exponent)) == tmin;
        return lostbits::measure::truth::reach(ray, primitive, answer, length, format, perturbation,
                                               begins_inside ? AnswerFaces::entered_faces : AnswerFaces::every_face);
    });
}

double Band::reach(std::size_t i, Convention convention, intersect::Direction direction, const FormatInputs& inputs,
                   Perturbation perturbation) const {
    const Length length = length_of(direction);
    const auto& closed_reaches = inputs.reach[static_cast<std::size_t>(perturbation)][static_cast<std::size_t>(length)];
    const bool has_closed_reach = !closed_reaches.empty() && !may_differ(i, convention);
    return has_closed_reach
               ? closed_reaches[i]
               : measure_reach(i, truth(i, convention), convention, length, inputs.format.parameters, perturbation);
}

void Band::find_reach(FormatInputs& in, BandNeeds needs) const {
    for (const Perturbation perturbation : {Perturbation::componentwise, Perturbation::normwise}) {
        for (const Length length : {Length::parameter, Length::distance}) {
            const auto index = std::pair(static_cast<std::size_t>(perturbation), static_cast<std::size_t>(length));
            if (!needs.reach[index.first][index.second]) continue;
            std::vector<double>& reaches = in.reach[index.first][index.second];
            reaches.resize(pixel_count());
            intersect::process::in_parallel(
                tbb::blocked_range<std::size_t>(0, pixel_count(), 256), [&](const auto& range) {
                    limit_.stop.check();
                    for (std::size_t i = range.begin(); i < range.end(); ++i)
                        reaches[i] = measure_reach(i, truths_[i], {}, length, in.format.parameters, perturbation);
                });
        }
    }
}

}  // namespace lostbits::measure::truth
