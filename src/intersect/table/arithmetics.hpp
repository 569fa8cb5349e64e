// The functions of a form in each kind of arithmetic. The rows of the table point to them.
#pragma once

#include <algorithm>
#include <cmath>

#include "intersect/sdf/march_loop.hpp"
#include "intersect/table/kernels.hpp"
#include "number/counted.hpp"
#include "number/interval.hpp"
#include "number/recorded.hpp"
#include "number/recorders/bounds_recorder.hpp"
#include "number/recorders/tape_recorder.hpp"
#include "number/with_number.hpp"

namespace lostbits::intersect::table {

template <class Form>
void intersect_rounded_batch(const FloatFormat& format, const RayBatch<double>& rays, const Target<double>& target,
                             const HitBatch<double>& hits) {
    const CurrentFormat::Scope scope(format);
    constexpr EvaluateTarget<RoundedAny, MarchRecorder<RoundedAny>> evaluate = intersect_target<Form>;
    const LiftedTarget<RoundedAny> lifted(target);
    intersect_batch(evaluate, marches<Form>, rays, lifted.get(), hits);
}

/// The tmax of a ray without an end, for enclosures, whose arithmetic has no infinity. It lies beyond every t of a ray
/// and a primitive of doubles, which is less than 2^1026/2^-1074 (lengths over the smallest direction). For a `Ball`,
/// 2^1000 is enough, because a `Ball` proves nothing above 2^1000.
template <class E>
E endless_tmax() {
    const E far(0x1p1000);
    if constexpr (std::same_as<E, Interval>) return far * far * far;
    else return far;
}

template <class Form, class E>
Hit<E> enclose_hit(const Ray<E>& ray, const Target<E>& target) {
    sdf::NoMarchWatch unwatched;
    return intersect_target<Form>(ray, target, endless_tmax<E>(), unwatched);
}

/// The inputs of one evaluation in T, in their order on a tape.
template <class T>
struct LiftedInputs {
    Ray<T> ray;
    LiftedTarget<T> target;
    T tmax;

    template <class S>
    LiftedInputs(const Ray<S>& r, const Target<S>& source, S end)
        : ray{{T(r.origin.x), T(r.origin.y), T(r.origin.z)}, {T(r.direction.x), T(r.direction.y), T(r.direction.z)}},
          target(source),
          tmax(T(end)) {}
};

template <class Form, class T>
MarchLog log_march(const Ray<double>& ray, const Target<double>& target) {
    const LiftedInputs<T> inputs(ray, target, 0.0);
    StepLog<T> log;
    const Hit<T> hit = intersect_target<Form>(inputs.ray, inputs.target.get(), inputs.tmax, log);
    const StopReason stop = log.stop(hit, *inputs.target.get().march);
    return {log.take(), {hit.hit, as_double(hit.t), as_double(hit.near), as_double(hit.far)}, stop};
}

template <class Form>
MarchLog log_form_march(const Format& format, const Ray<double>& ray, const Target<double>& target) {
    const CurrentFormat::Scope scope(format.parameters);
    return log_march<Form, RoundedAny>(ray, target);
}

/// Marks the end of each sample of a march, and gives its operations the names of the lesson SDF Sphere Marching.
struct SampleMarker : sdf::NoMarchWatch {
    void operator()(const RecordedMask& /*active*/, const Recorded& t, const Vec<Recorded>& p,
                    const Recorded& d) const {
        named("t", t);
        named("p.x", p.x);
        named("p.y", p.y);
        named("p.z", p.z);
        named("d", d);
        Recorder::current().end_sample();
    }
};

/// A form over `Recorded`: the same function serves every recorder and format.
using EvaluateRecorded = EvaluateTarget<Recorded, SampleMarker>;
template <class Form>
inline constexpr EvaluateRecorded evaluate_recorded = intersect_target<Form>;

/// Evaluates a form over `Recorded`. The thread's recorder receives the inputs in the order of `input_names`.
inline Hit<Recorded> record_hit(EvaluateRecorded evaluate, const Ray<double>& ray, const Target<double>& target,
                                double tmax) {
    const LiftedInputs<Recorded> inputs(ray, target, tmax);
    SampleMarker marks;
    return evaluate(inputs.ray, inputs.target.get(), inputs.tmax, marks, 0);
}

/// Appends the operations of `evaluate()`, which runs over `Recorded`, to the tape.
template <class Evaluate>
void record_on_tape(const Evaluate& evaluate, const FloatFormat& format, Tape& tape) {
    number::recorders::TapeRecorder recorder(tape, format);
    const Hit<Recorded> hit = evaluate();
    tape.outputs = {hit.hit.node(), hit.t.node(), hit.near.node(), hit.far.node()};
}

inline void evaluate_on_tape(EvaluateRecorded evaluate, Tape& tape, const FloatFormat& format, const Ray<double>& ray,
                             const Target<double>& target, double tmax) {
    record_on_tape([&] { return record_hit(evaluate, ray, target, tmax); }, format, tape);
}

inline void record_evaluation(EvaluateRecorded evaluate, const Format& format, const Ray<double>& ray,
                              const Target<double>& target, double tmax, Tape& tape) {
    tape.clear();
    evaluate_on_tape(evaluate, tape, format.parameters, ray, target, tmax);
}

template <class Form>
void record_form_evaluation(const Format& format, const Ray<double>& ray, const Target<double>& target, double tmax,
                            Tape& tape) {
    record_evaluation(evaluate_recorded<Form>, format, ray, target, tmax, tape);
}

/// Records all operations that the form has. A march is cut to 3 samples and 2 steps of each refinement, because
/// further ones repeat the same operations.
inline void record_all_operations(EvaluateRecorded evaluate, const Target<double>& target, Tape& tape) {
    const Ray<double> sample_ray{Vec<double>(1, 2, 3), Vec<double>(4, 5, 6)};
    tape.clear();
    tape.runs_every_loop = true;
    if (target.march) {
        MarchConstants<double> shortened = *target.march;
        shortened.max_steps = 3;
        shortened.secant_steps = std::min(shortened.secant_steps, 2);
        shortened.bisect_steps = std::min(shortened.bisect_steps, 2);
        evaluate_on_tape(evaluate, tape, binary32, sample_ray, Target<double>(target.primitives, shortened), HUGE_VAL);
    } else {
        evaluate_on_tape(evaluate, tape, binary32, sample_ray, target, HUGE_VAL);
    }
    tape.runs_every_loop = false;
}

template <class Form>
void record_whole_form(const Target<double>& target, Tape& tape) {
    record_all_operations(evaluate_recorded<Form>, target, tape);
}

/// The answer of `evaluate()`, which runs over `Recorded`, with the bounds that its recorder computes. Returns nothing
/// for formats other than binary32 and binary64.
template <class Evaluate>
std::optional<BoundedAnswer> evaluate_with_bounds(const Evaluate& evaluate, const Format& format) {
    if (format.is_emulated()) return std::nullopt;
    number::recorders::BoundsRecorder recorder(format.parameters);
    const Hit<Recorded> hit = evaluate();
    return BoundedAnswer{hit.hit.value(), recorder.is_proved(hit.hit.node()), recorder.value(hit.t.node()),
                         recorder.error(hit.t.node())};
}

template <class Form>
std::optional<BoundedAnswer> evaluate_form_with_bounds(const Format& format, const Ray<double>& ray,
                                                       const Target<double>& target, double tmax) {
    return evaluate_with_bounds([&] { return record_hit(evaluate_recorded<Form>, ray, target, tmax); }, format);
}

/// True if the form filters: it takes a watch, which is called with each wider arithmetic.
template <class Form>
inline constexpr bool filters = [] {
    if constexpr (marches<Form>) return false;
    else
        return Primitives::of_shape<shape_of<Form>>([]<template <class> class S>() {
            if constexpr (S<float>::takes_tmax)
                return requires(const Ray<float>& ray, const S<float>& primitive, float tmax, ArithmeticWatch& watch) {
                    Form::intersect(ray, primitive, tmax, watch);
                };
            else return requires(const Ray<float>& ray, const S<float>& primitive, ArithmeticWatch& watch) {
                    Form::intersect(ray, primitive, watch);
                };
        });
}();

/// True if the form performs the same operations for every ray and in every arithmetic, so that its recording can
/// replace it (`WrittenForm`). Marches have loops, and so have forms that state `has_loops`. Filters continue in wider
/// arithmetic if a bound proves nothing. A form that states `exact_is_apart` performs other operations in numbers that
/// stand for exact arithmetic.
template <class Form>
inline constexpr bool is_one_program = !marches<Form> && !filters<Form> && !requires {
    Form::exact_is_apart;
}
&&!requires { Form::has_loops; };

template <class Form>
DecidingArithmetic deciding_arithmetic_of(const Format& format, const Ray<double>& ray, const Target<double>& target,
                                          double tmax) {
    return with_number(format, [&]<class T>() {
        const LiftedInputs<T> inputs(ray, target, tmax);
        const Primitive<T>& primitive = inputs.target.get().primitives.front();
        ArithmeticWatch watch;
        Primitives::of_shape<shape_of<Form>>([&]<template <class> class S>() {
            static_cast<void>(intersect_primitive<Form>(inputs.ray, primitive.template as<S>(), inputs.tmax, watch));
        });
        return watch.widest;
    });
}

/// Counts the operations of `evaluate(ray, target, tmax)` in binary32.
template <class Evaluate>
OperationCounts count_operations(const Evaluate& evaluate, const Ray<float>& ray, const Target<float>& target,
                                 float tmax) {
    const LiftedInputs<Counted<float>> inputs(ray, target, tmax);
    operation_counts() = {};
    static_cast<void>(evaluate(inputs.ray, inputs.target.get(), inputs.tmax));
    return operation_counts();
}

template <class Form>
OperationCounts count_form_operations(const Ray<float>& ray, const Target<float>& target, float tmax) {
    constexpr EvaluateTarget<Counted<float>, sdf::NoMarchWatch> evaluate = intersect_target<Form>;
    const auto unwatched = [evaluate](const auto&... in) {
        sdf::NoMarchWatch watch;
        return evaluate(in..., watch, 0);
    };
    return count_operations(unwatched, ray, target, tmax);
}

/// Sets the functions of a form that follow from its recording: `record`, `record_all` and `bounded`.
void set_recorders(Intersector& form, const EvaluateRecorded* evaluator);

/// Sets the arithmetics of a form by its recording, which must be one program.
void set_recorded_arithmetics(Intersector& form);

}  // namespace lostbits::intersect::table
