#include "intersect/transform/transformed_form.hpp"

#include <string>
#include <tuple>

#include "intersect/simd/packed.hpp"
#include "intersect/table/composed_forms.hpp"
#include "intersect/table/joined_tapes.hpp"
#include "number/error.hpp"
#include "shapes/lift.hpp"

namespace lostbits::intersect::transform {

using table::HitBatch;
using table::Intersector;
using table::RayBatch;

namespace {

using Parts = std::tuple<const TransformMethod*, const Intersector*>;
using TransformedForms = table::ComposedForms<Parts>;
TransformedForms& transformed_forms() {
    static TransformedForms composed_forms;
    return composed_forms;
}

TransformedFormParts to_parts(const Parts& parts) {
    return std::apply([](auto... part) { return TransformedFormParts{part...}; }, parts);
}
TransformedFormParts parts_of_context(void* context) {
    return to_parts(static_cast<const TransformedForms::ComposedForm*>(context)->parts);
}

template <class S>
Primitive<S> make_object_primitive(const Primitive<S>& primitive, const S& scale) {
    Primitive<S> object = primitive;
    object.transform.reset();
    return scale == S(1) ? object : scaled(object, scale);
}

/// Runs a batch: converts the rays to the space of the primitive, runs the form there, and converts its answers back.
/// Either all rays share one primitive, or each ray is a batch of its own.
template <class T, class S, class Kernel>
void evaluate(const BatchFunctions<T, S>& steps, const Kernel& kernel, const RayBatch<S>& rays, const Target<S>& target,
              const HitBatch<S>& hits) {
    const std::size_t primitives = target.primitives.size();
    for (std::size_t i = 0, end = 0; i < rays.size(); i = end) {
        // Takes the next rays that share a primitive: the whole batch, or one ray.
        const Primitive<S>& primitive = target.primitives[primitives == 1 ? 0 : i];
        end = primitives == 1 ? rays.size() : i + 1;
        const auto slice = [&](auto span) { return span.empty() ? span : span.subspan(i, end - i); };
        const RayBatch<S> world_rays{slice(rays.ox), slice(rays.oy),   slice(rays.oz),   slice(rays.dx), slice(rays.dy),
                                     slice(rays.dz), slice(rays.tmax), slice(rays.tmin), rays.open_ends};
        const HitBatch<S> batch_hits{slice(hits.t), slice(hits.near), slice(hits.far), slice(hits.hit)};

        // A primitive without a transform is in the world already.
        if (!primitive.transform) {
            kernel(world_rays, Target<S>(primitive), batch_hits);
            continue;
        }

        // Moves the rays to the space of the primitive.
        const auto lifted = convert_numbers(*primitive.transform, [](const S& x) { return T(x); });
        const MatrixPair<T> maps = steps.maps(lifted);
        thread_local ObjectColumns<S> columns;
        steps.to_object(maps, world_rays, columns);
        const auto& [ox, oy, oz, dx, dy, dz] = columns.ray;
        RayBatch<S> object_rays{ox, oy, oz, dx, dy, dz};

        // Rescales the ends of the rays to the new lengths of their directions.
        thread_local std::vector<S> ends;
        if (!world_rays.tmax.empty()) {
            ends.resize(world_rays.size());
            for (std::size_t k = 0; k < ends.size(); ++k) ends[k] = world_rays.tmax[k] * columns.length[k];
            object_rays.tmax = ends;
            object_rays.open_ends.tmax = world_rays.open_ends.tmax;
        }

        // Runs the form there, and converts its answers back to the world.
        kernel(object_rays, Target<S>(make_object_primitive(primitive, columns.scale)), batch_hits);
        steps.back(maps, world_rays, columns, batch_hits);
    }
}

void evaluate_32(void* context, const RayBatch<float>& rays, const Target<float>& target, const HitBatch<float>& hits) {
    evaluate(parts_of_context(context).method->batch32, simd::packed_kernels(*parts_of_context(context).form).f32, rays,
             target, hits);
}
void evaluate_64(void* context, const RayBatch<double>& rays, const Target<double>& target,
                 const HitBatch<double>& hits) {
    evaluate(parts_of_context(context).method->batch64, simd::packed_kernels(*parts_of_context(context).form).f64, rays,
             target, hits);
}
void evaluate_rounded(void* context, const FloatFormat& format, const RayBatch<double>& rays,
                      const Target<double>& target, const HitBatch<double>& hits) {
    const CurrentFormat::Scope scope(format);
    const auto kernel = [&](const auto&... a) { parts_of_context(context).form->rounded(format, a...); };
    evaluate(parts_of_context(context).method->batch_rounded, kernel, rays, target, hits);
}

/// Runs a form over enclosures. If the determinant is not known to differ from 0, the answer is unknown.
template <auto steps_member, auto kernel_member, class E>
Hit<E> enclose_hit(void* context, const Ray<E>& ray, const Target<E>& target) {
    const TransformedFormParts form_parts = parts_of_context(context);
    const Primitive<E>& primitive = target.primitives.front();
    if (!primitive.transform) return (form_parts.form->*kernel_member)(ray, target);
    const StepFunctions<E>& steps = form_parts.method->*steps_member;
    const MatrixPair<E> maps = steps.maps(*primitive.transform);
    const ObjectRay<E> object_ray = steps.to_object(maps, ray);
    const Primitive<E> object = scaled(primitive, object_ray.scale);
    const Hit<E> hit = (form_parts.form->*kernel_member)(object_ray.ray, Target<E>(object));
    return {hit.hit, steps.back(maps, ray, object_ray, hit.t), steps.back(maps, ray, object_ray, hit.near),
            steps.back(maps, ray, object_ray, hit.far)};
}

/// The inputs of a row with a transform: the ray and the matrix for the method, the numbers of the primitive and the
/// end of the ray for the form.
struct TransformedInputs {
    WorldNodes world{};
    std::vector<NodeId> numbers;
    NodeId end = no_node;
};

TransformedInputs record_transformed_inputs(const Format& format, const Ray<double>& ray,
                                            const Primitive<double>& primitive, double tmax, Tape& tape) {
    const auto input = [&](double x) { return tape.add_input(format.parameters, x); };
    TransformedInputs inputs;
    WorldNodes& world = inputs.world;
    for (std::size_t k = 0; k < 6; ++k)
        world.ray[k] = input(k < 3 ? ray.origin[static_cast<int>(k)] : ray.direction[static_cast<int>(k - 3)]);
    for (const double x : primitive.shape_numbers()) inputs.numbers.push_back(input(x));
    for (std::size_t k = 0; k < world.matrix.size(); ++k) world.matrix[k] = input(primitive.transform->matrix[k]);
    world.is_inverse = primitive.transform->is_inverse;
    inputs.end = input(tmax);
    return inputs;
}

NodeId record_product(const Format& format, NodeId a, NodeId b, double product, Tape& tape) {
    return tape.add(TapeOp::mul, format.parameters, product, {a, b});
}

/// Appends the numbers of the primitive to the form's inputs, and returns the primitive in its own space. A method that
/// scales the primitive scales each of its numbers except directions.
Primitive<double> record_object_primitive(const Format& format, const Primitive<double>& primitive,
                                          const std::vector<NodeId>& numbers, NodeId scale,
                                          std::vector<NodeId>& form_inputs, Tape& tape) {
    Primitive<double> object_primitive = primitive;
    object_primitive.transform.reset();
    const bool is_scaled = tape[scale].op != TapeOp::constant;
    if (is_scaled)
        with_number(format, [&]<class F>() {
            object_primitive =
                convert_numbers(scaled(lift_primitive<F>(object_primitive), static_cast<F>(tape[scale].value)),
                                [](const F& x) { return as_double(x); });
        });
    for_each_key(primitive.shape, [&](const Key& key, std::size_t first) {
        for (std::size_t k = first; k < first + key.count(); ++k)
            form_inputs.push_back(is_scaled && key.kind != Key::Kind::direction
                                      ? record_product(format, scale, numbers[k], object_primitive.numbers[k], tape)
                                      : numbers[k]);
    });
    return object_primitive;
}

/// Appends the end of the ray to the form's inputs, and returns its value. It is multiplied by the length of the ray's
/// direction, unless that length is always 1.
double record_object_tmax(const Format& format, double tmax, NodeId end, NodeId length,
                          std::vector<NodeId>& form_inputs, Tape& tape) {
    if (tape[length].op == TapeOp::constant) {
        form_inputs.push_back(end);
        return tmax;
    }
    double object_tmax = tmax;
    with_number(format,
                [&]<class F>() { object_tmax = as_double(static_cast<F>(tmax) * static_cast<F>(tape[length].value)); });
    form_inputs.push_back(record_product(format, end, length, object_tmax, tape));
    return object_tmax;
}

/// Records the steps and the form. `record_object(ray, target, tmax, tape)` records the form in the space of the
/// primitive.
template <class RecordObject>
void record_with(const TransformedFormParts& form_parts, const Format& format, const Ray<double>& ray,
                 const Primitive<double>& primitive, double tmax, Tape& tape, const RecordObject& record_object) {
    tape.clear();
    const TransformedInputs inputs = record_transformed_inputs(format, ray, primitive, tmax, tape);
    form_parts.method->record(format, tape, inputs.world, [&](const ObjectNodes& object) {
        std::vector<NodeId> form_inputs(object.ray.begin(), object.ray.end());
        const Primitive<double> object_primitive =
            record_object_primitive(format, primitive, inputs.numbers, object.scale, form_inputs, tape);
        const double object_tmax = record_object_tmax(format, tmax, inputs.end, object.length, form_inputs, tape);

        // Records the form on a tape of its own, which then continues the tape of the steps.
        const auto value = [&](std::size_t k) { return tape[object.ray[k]].value; };
        const Ray<double> object_ray{{value(0), value(1), value(2)}, {value(3), value(4), value(5)}};
        Tape form_tape;
        form_tape.runs_every_loop = tape.runs_every_loop;
        record_object(object_ray, Target<double>(object_primitive), object_tmax, form_tape);
        return table::append_tape(form_tape, form_inputs, tape);
    });
}

void record(void* context, const Format& format, const Ray<double>& ray, const Target<double>& target, double tmax,
            Tape& tape) {
    const TransformedFormParts form_parts = parts_of_context(context);
    const Primitive<double>& primitive = target.primitives.front();
    if (!primitive.transform) return form_parts.form->record(format, ray, target, tmax, tape);
    record_with(
        form_parts, format, ray, primitive, tmax, tape,
        [&](const Ray<double>& object_ray, const Target<double>& object_target, double object_tmax, Tape& form_tape) {
            form_parts.form->record(format, object_ray, object_target, object_tmax, form_tape);
        });
}
void record_all(void* context, const Target<double>& target, Tape& tape) {
    const TransformedFormParts form_parts = parts_of_context(context);
    const Primitive<double>& primitive = target.primitives.front();
    if (!primitive.transform) return form_parts.form->record_all(target, tape);
    record_with(form_parts, *find_format("f32"), {Vec<double>(1, 2, 3), Vec<double>(4, 5, 6)}, primitive, HUGE_VAL,
                tape, [&](const Ray<double>&, const Target<double>& object_target, double, Tape& form_tape) {
                    form_parts.form->record_all(object_target, form_tape);
                });
}

void fill_form(TransformedForms::ComposedForm& composed) {
    const auto& [method, tested_form] = composed.parts;
    const Info& form = *tested_form->info;
    const TransformMethodInfo& method_info = *method->info;
    const auto text = [](auto&... parts) {
        std::string result;
        ((result += parts), ...);
        return result;
    };

    composed.name = text(form.name, "@", method_info.name);
    composed.title = text(form.title, "; ", method_info.title);
    composed.source = text(form.source, "; ", method_info.source);
    composed.copy_contract(form);
    // A transform method that normalises gives the form unit directions, so the requirement of the method alone
    // applies. With any other method, the form's requirement applies too.
    if (method_info.normalises) composed.info.direction = method_info.direction;
    else if (method_info.direction == Direction::unit) composed.info.direction = Direction::unit;

    // The row has each arithmetic that the form has.
    composed.intersector = {
        .info = &composed.info, .shape = tested_form->shape, .native32 = nullptr, .native64 = nullptr};
    if (tested_form->native32) composed.intersector.native32 = {evaluate_32, &composed};
    if (tested_form->native64) composed.intersector.native64 = {evaluate_64, &composed};
    if (tested_form->rounded) composed.intersector.rounded = {evaluate_rounded, &composed};
    if (tested_form->ball)
        composed.intersector.ball = {enclose_hit<&TransformMethod::ball, &Intersector::ball, Ball>, &composed};
    if (tested_form->interval)
        composed.intersector.interval = {enclose_hit<&TransformMethod::interval, &Intersector::interval, Interval>,
                                         &composed};
    if (tested_form->record) composed.intersector.record = {record, &composed};
    if (tested_form->record_all) composed.intersector.record_all = {record_all, &composed};
    composed.intersector.has_transform_method = true;
}

}  // namespace

const Intersector& transformed_form(const TransformMethod& method, const Intersector& form) {
    const std::string name(form.info->name);
    if (!is_primitive(form.shape))
        throw InputError(name + "@" + std::string(method.info->name) +
                         ": a form that marches takes all primitives at once and in the world; leave @TRANSFORM out");
    if (form.is_set() || form.has_transform_method)
        throw InputError(name + "@" + std::string(method.info->name) + ": write one @TRANSFORM after each form");
    return transformed_forms().find_or_add({&method, &form}, fill_form);
}

TransformedFormParts find_transformed_parts(const Intersector& form) {
    return to_parts(transformed_forms().find_parts(form));
}

}  // namespace lostbits::intersect::transform
