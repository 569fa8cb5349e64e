#include "intersect/bounding_box/behind.hpp"

#include <algorithm>
#include <string>
#include <tuple>
#include <vector>

#include "intersect/simd/packed.hpp"
#include "intersect/table/composed_forms.hpp"
#include "intersect/table/joined_tapes.hpp"
#include "intersect/table/recording.hpp"
#include "intersect/transform/transformed_form.hpp"
#include "number/error.hpp"
#include "shapes/lift.hpp"
#include "shapes/number_names.hpp"

namespace lostbits::intersect::bounding_box {

using table::HitBatch;
using table::Intersector;
using table::RayBatch;

namespace {

using Parts = std::tuple<const BoxMethod*, const Intersector*, const Intersector*>;
using BoxedForms = table::ComposedForms<Parts>;
BoxedForms& boxed_forms() {
    static BoxedForms composed_forms;
    return composed_forms;
}

BoxedFormParts parts_in(const Parts& parts) {
    return std::apply([](auto... part) { return BoxedFormParts{part...}; }, parts);
}
BoxedFormParts parts_of_context(void* context) {
    return parts_in(static_cast<const BoxedForms::ComposedForm*>(context)->parts);
}

template <class S>
Primitive<S> box_around(const BoxedFormParts& form_parts, const Format& format, const Primitive<S>& primitive) {
    const BoundingBox<double> box = form_parts.method->compute_box(
        format, convert_numbers(primitive, [](const S& x) { return static_cast<double>(x); }));
    return lift_primitive<S>(Primitive<double>(box));
}

/// Buffers for the answers of the box form, of which only the decisions are used.
template <class S>
struct Decisions {
    std::vector<S> t;
    std::vector<std::uint8_t> hit;

    HitBatch<S> batch(std::size_t n) {
        t.resize(3 * n);
        hit.resize(n);
        const std::span values(t);
        return {values.first(n), values.subspan(n, n), values.last(n), hit};
    }
};

/// Runs the form and the box form on a batch. A ray hits if both hit. The target has one primitive for all rays, or one
/// for each ray.
template <class S, class BoxKernel, class FormKernel>
void evaluate(const BoxedFormParts& form_parts, const Format& format, const BoxKernel& box, const FormKernel& form,
              const RayBatch<S>& rays, const Target<S>& target, const HitBatch<S>& hits) {
    form(rays, target, hits);

    // Asks the box form about the box of each primitive.
    std::vector<Primitive<S>> boxes;
    boxes.reserve(target.primitives.size());
    for (const Primitive<S>& primitive : target.primitives) boxes.push_back(box_around(form_parts, format, primitive));
    Decisions<S> decisions;
    const HitBatch<S> box_hits = decisions.batch(rays.size());
    box(rays, boxes.size() == 1 ? Target<S>(boxes.front()) : Target<S>(std::span<const Primitive<S>>(boxes)), box_hits);

    for (std::size_t i = 0; i < rays.size(); ++i) hits.hit[i] = hits.hit[i] != 0 && decisions.hit[i] != 0;
}

/// Runs both forms in native arithmetic; in packs of rays if all rays share one primitive.
template <class S>
void evaluate_natively(void* context, const RayBatch<S>& rays, const Target<S>& target, const HitBatch<S>& hits) {
    const BoxedFormParts form_parts = parts_of_context(context);
    static const Format format = *find_format(std::same_as<S, float> ? "f32" : "f64");
    const bool has_one_primitive = target.primitives.size() == 1;
    const auto kernel = [has_one_primitive](const Intersector& form) {
        if constexpr (std::same_as<S, float>) return has_one_primitive ? simd::packed_kernels(form).f32 : form.native32;
        else return has_one_primitive ? simd::packed_kernels(form).f64 : form.native64;
    };
    evaluate(form_parts, format, kernel(*form_parts.box), kernel(*form_parts.form), rays, target, hits);
}
void evaluate_rounded(void* context, const FloatFormat& format, const RayBatch<double>& rays,
                      const Target<double>& target, const HitBatch<double>& hits) {
    const auto kernel = [&format](const Intersector& form) {
        return [&](const auto&... a) { form.rounded(format, a...); };
    };
    evaluate(parts_of_context(context), Format{"", format, Format::Engine::rounded},
             kernel(*parts_of_context(context).box), kernel(*parts_of_context(context).form), rays, target, hits);
}

/// Enclosures omit the box: in exact arithmetic, every hit of the form also hits the box.
Hit<Ball> ball(void* context, const Ray<Ball>& ray, const Target<Ball>& target) {
    return parts_of_context(context).form->ball(ray, target);
}
Hit<Interval> interval(void* context, const Ray<Interval>& ray, const Target<Interval>& target) {
    return parts_of_context(context).form->interval(ray, target);
}

/// The inputs of a row with a box, and those of its two forms among them: the form takes the primitive, the box form
/// the box, and both take the ray and its end.
struct BoxedInputs {
    std::vector<NodeId> form, box;
};

BoxedInputs record_boxed_inputs(const Format& format, const Ray<double>& ray, const Primitive<double>& primitive,
                                const Primitive<double>& box, double tmax, Tape& tape) {
    const auto input = [&](double x) { return tape.add_input(format.parameters, x); };
    BoxedInputs inputs;
    for (const Vec<double>& v : {ray.origin, ray.direction})
        for (int k = 0; k < 3; ++k) inputs.form.push_back(input(v[k]));
    inputs.box = inputs.form;

    for (const double x : primitive.shape_numbers()) inputs.form.push_back(input(x));
    if (primitive.transform)
        for (const double x : primitive.transform->matrix) inputs.form.push_back(input(x));
    inputs.form.push_back(input(tmax));

    for (const double x : box.shape_numbers()) inputs.box.push_back(input(x));
    inputs.box.push_back(inputs.form.back());
    return inputs;
}

/// Records the box form, then the form. `record_form(form, target, tape)` records one of them.
template <class RecordRow>
void record_with(const BoxedFormParts& form_parts, const Format& format, const Ray<double>& ray,
                 const Target<double>& target, double tmax, Tape& tape, const RecordRow& record_form) {
    tape.clear();
    const bool runs_every_loop = tape.runs_every_loop;
    const Primitive<double> primitive = target.primitives.front(), box = box_around(form_parts, format, primitive);
    const BoxedInputs inputs = record_boxed_inputs(format, ray, primitive, box, tmax, tape);

    // Records each form on a tape of its own, which then continues the tape of the row.
    const auto append_form = [&](const Intersector& form, const Target<double>& part_target,
                                 const std::vector<NodeId>& part_inputs) {
        Tape form_tape;
        form_tape.runs_every_loop = runs_every_loop;
        record_form(form, part_target, form_tape);
        return table::append_tape(form_tape, part_inputs, tape);
    };
    const TapeOutputs box_outcome = append_form(*form_parts.box, Target<double>(box), inputs.box);
    TapeOutputs answer = append_form(*form_parts.form, target, inputs.form);

    // A ray hits if both forms report a hit.
    const bool hit = tape[box_outcome.hit].value != 0 && tape[answer.hit].value != 0;
    answer.hit = tape.add(TapeOp::logical_and, format.parameters, hit ? 1 : 0, {box_outcome.hit, answer.hit});
    tape.outputs = answer;
}
void record(void* context, const Format& format, const Ray<double>& ray, const Target<double>& target, double tmax,
            Tape& tape) {
    record_with(parts_of_context(context), format, ray, target, tmax, tape,
                [&](const Intersector& form, const Target<double>& part_target, Tape& part_tape) {
                    form.record(format, ray, part_target, tmax, part_tape);
                });
}
void record_all(void* context, const Target<double>& target, Tape& tape) {
    record_with(parts_of_context(context), *find_format("f32"), {Vec<double>(1, 2, 3), Vec<double>(4, 5, 6)}, target,
                HUGE_VAL, tape, [](const Intersector& form, const Target<double>& part_target, Tape& part_tape) {
                    form.record_all(part_target, part_tape);
                });
}

std::string join_text(auto... parts) {
    std::string result;
    ((result += parts), ...);
    return result;
}

void fill_form(BoxedForms::ComposedForm& composed) {
    const BoxedFormParts parts = parts_of_context(&composed);
    const Info &form = *parts.form->info, &box = *parts.box->info;
    const BoxMethodInfo& box_method = *parts.method->info;

    composed.name = join_text(form.name, "^", box.name);
    if (parts.method != &default_box_method()) composed.name += join_text("~", box_method.name);
    composed.title = join_text(form.title, "; behind a box: ", box.title, "; ", box_method.title);
    composed.source = join_text(form.source, "; ", box.source);
    if (box_method.source != "-") composed.source += join_text("; ", box_method.source);
    composed.copy_contract(form);

    // The row has each arithmetic that both forms have. Enclosures omit the box.
    composed.intersector = {
        .info = &composed.info, .shape = parts.form->shape, .native32 = nullptr, .native64 = nullptr};
    if (parts.form->native32 && parts.box->native32)
        composed.intersector.native32 = {evaluate_natively<float>, &composed};
    if (parts.form->native64 && parts.box->native64)
        composed.intersector.native64 = {evaluate_natively<double>, &composed};
    if (parts.form->rounded && parts.box->rounded) composed.intersector.rounded = {evaluate_rounded, &composed};
    if (parts.form->ball) composed.intersector.ball = {ball, &composed};
    if (parts.form->interval) composed.intersector.interval = {interval, &composed};
    if (parts.form->record && parts.box->record) composed.intersector.record = {record, &composed};
    if (parts.form->record_all && parts.box->record_all) composed.intersector.record_all = {record_all, &composed};
    composed.intersector.has_transform_method = parts.form->has_transform_method;
}

/// Returns the reason why a form cannot have such a box; empty if it can.
std::string refusal(const Intersector& box, const Intersector& form) {
    if (form.is_set()) return "write ^BOX after each form of a set";
    if (!is_primitive(form.shape))
        return "a form that marches takes all primitives at once, so no single one has a bounding box; leave ^BOX out";
    if (!has_bounding_box(form.shape))
        return join_text(with_article(form.shape), " has no end, so it has no bounding box; leave ^BOX out");
    if (box.is_set() || box.shape != bounding_box_shape || box.has_transform_method ||
        find_boxed_parts(box).form != nullptr)
        return join_text(box.info->name, " is not a form of boxes; write one after the ^, such as box.signs");
    if (box.info->direction == Direction::unit && form.info->direction != Direction::unit)
        return join_text(box.info->name, " needs unit directions, but ", form.info->name,
                         " takes any; choose another form of boxes");
    return "";
}

}  // namespace

const Intersector& boxed_form(const BoxMethod& method, const Intersector& box, const Intersector& form) {
    if (const std::string reason = refusal(box, form); !reason.empty())
        throw InputError(join_text(form.info->name, "^", box.info->name, ": ", reason));
    return boxed_forms().find_or_add({&method, &box, &form}, fill_form);
}

BoxedFormParts find_boxed_parts(const Intersector& form) { return parts_in(boxed_forms().find_parts(form)); }

bool has_box(const Intersector& form) {
    if (form.is_set()) return std::ranges::any_of(form.parts, [](const Intersector* part) { return has_box(*part); });
    if (find_boxed_parts(form).form != nullptr) return true;
    const auto transformed_parts = transform::find_transformed_parts(form);
    return transformed_parts.form != nullptr && has_box(*transformed_parts.form);
}

const Intersector& without_world_boxes(const Intersector& form) {
    const BoxedFormParts parts = find_boxed_parts(form);
    return parts.form != nullptr && form.has_transform_method ? without_world_boxes(*parts.form) : form;
}

std::vector<std::string> find_names_on_tape(const Intersector& form, const Target<double>& target) {
    std::vector<std::string> names = table::input_names(form, target);
    const Intersector* current = &form;
    for (bool in_world = !target.primitives.empty() && target.primitives.front().transform;;) {
        if (const BoxedFormParts parts = find_boxed_parts(*current); parts.form != nullptr) {
            for (const char* const coordinate : {"lo.x", "lo.y", "lo.z", "hi.x", "hi.y", "hi.z"})
                names.push_back(join_text(in_world ? "world_box." : "box.", coordinate));
            current = parts.form;
        } else if (const auto transformed_parts = transform::find_transformed_parts(*current);
                   transformed_parts.form != nullptr) {
            in_world = false;
            current = transformed_parts.form;
        } else {
            return names;
        }
    }
}

const Intersector& innermost_form(const Intersector& form) {
    if (const BoxedFormParts parts = find_boxed_parts(form); parts.form != nullptr) return innermost_form(*parts.form);
    const auto transformed_parts = transform::find_transformed_parts(form);
    return transformed_parts.form != nullptr ? innermost_form(*transformed_parts.form) : form;
}

const Intersector& with_other_form(const Intersector& composed_form, const Intersector& form) {
    if (const BoxedFormParts parts = find_boxed_parts(composed_form); parts.form != nullptr)
        return boxed_form(*parts.method, *parts.box, with_other_form(*parts.form, form));
    const auto transformed_parts = transform::find_transformed_parts(composed_form);
    return transformed_parts.form != nullptr
               ? transform::transformed_form(*transformed_parts.method, with_other_form(*transformed_parts.form, form))
               : form;
}

}  // namespace lostbits::intersect::bounding_box
