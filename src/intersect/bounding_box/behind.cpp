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
using Rows = table::ComposedForms<Parts>;
Rows& rows() {
    static Rows all;
    return all;
}

BoxedFormParts parts_in(const Parts& parts) {
    return std::apply([](auto... each) { return BoxedFormParts{each...}; }, parts);
}
BoxedFormParts of(void* own) { return parts_in(static_cast<const Rows::Made*>(own)->parts); }

template <class S>
Primitive<S> box_around(const BoxedFormParts& row, const Format& format, const Primitive<S>& primitive) {
    const BoundingBox<double> box =
        row.method->in(format, transformed(primitive, [](const S& x) { return static_cast<double>(x); }));
    return lift_primitive<S>(Primitive<double>(box));
}

/// Answers of the box form. Only its decisions are used; its t goes to a buffer.
template <class S>
struct Decisions {
    std::vector<S> t;
    std::vector<std::uint8_t> hit;

    HitBatch<S> batch(std::size_t n) {
        t.resize(3 * n), hit.resize(n);
        const std::span all(t);
        return {all.first(n), all.subspan(n, n), all.last(n), hit};
    }
};

/// Runs the form and the box form on a batch. A ray hits if both hit. The target has one primitive for all rays, or one
/// for each ray.
template <class S, class OfBox, class OfForm>
void evaluate(const BoxedFormParts& row, const Format& format, const OfBox& box, const OfForm& form,
              const RayBatch<S>& rays, const Target<S>& target, const HitBatch<S>& hits) {
    form(rays, target, hits);
    std::vector<Primitive<S>> boxes;
    boxes.reserve(target.primitives.size());
    for (const Primitive<S>& primitive : target.primitives) boxes.push_back(box_around(row, format, primitive));
    Decisions<S> found;
    const HitBatch<S> of_boxes = found.batch(rays.size());
    box(rays, boxes.size() == 1 ? Target<S>(boxes.front()) : Target<S>(std::span<const Primitive<S>>(boxes)), of_boxes);
    for (std::size_t i = 0; i < rays.size(); ++i) hits.hit[i] = hits.hit[i] != 0 && found.hit[i] != 0;
}

/// Does the same in native arithmetic; in packs of rays if all of them share one primitive.
template <class S>
void evaluate_natively(void* own, const RayBatch<S>& rays, const Target<S>& target, const HitBatch<S>& hits) {
    const BoxedFormParts row = of(own);
    static const Format format = *find_format(std::same_as<S, float> ? "f32" : "f64");
    const bool one = target.primitives.size() == 1;
    const auto kernel = [one](const Intersector& form) {
        if constexpr (std::same_as<S, float>) return one ? simd::packed_kernels(form).f32 : form.native32;
        else return one ? simd::packed_kernels(form).f64 : form.native64;
    };
    evaluate(row, format, kernel(*row.box), kernel(*row.form), rays, target, hits);
}
void evaluate_rounded(void* own, const FloatFormat& format, const RayBatch<double>& rays, const Target<double>& target,
                      const HitBatch<double>& hits) {
    const auto kernel = [&format](const Intersector& form) {
        return [&](const auto&... a) { form.rounded(format, a...); };
    };
    evaluate(of(own), Format{"", format, Format::Engine::rounded}, kernel(*of(own).box), kernel(*of(own).form), rays,
             target, hits);
}

/// Enclosures leave the box out: in exact arithmetic, every hit of the form also hits the box.
Hit<Ball> ball(void* own, const Ray<Ball>& ray, const Target<Ball>& target) { return of(own).form->ball(ray, target); }
Hit<Interval> interval(void* own, const Ray<Interval>& ray, const Target<Interval>& target) {
    return of(own).form->interval(ray, target);
}

/// Records the box form, then the form. `inside(row, target, tape)` records one of them.
template <class Inside>
void record_with(const BoxedFormParts& row, const Format& format, const Ray<double>& ray, const Target<double>& target,
                 double tmax, Tape& tape, const Inside& inside) {
    tape.clear();
    const bool every_loop = tape.every_loop;
    const auto input = [&](double x) { return tape.add_input(format.parameters, x); };
    std::vector<NodeId> of_form, of_box;
    for (const Vec<double>& v : {ray.origin, ray.direction})
        for (int k = 0; k < 3; ++k) of_form.push_back(input(v[k]));
    of_box = of_form;
    const Primitive<double> primitive = target.primitives.front(), box = box_around(row, format, primitive);
    for (const double x : primitive.used()) of_form.push_back(input(x));
    if (primitive.placed)
        for (const double x : primitive.placed->matrix) of_form.push_back(input(x));
    of_form.push_back(input(tmax));
    for (const double x : box.used()) of_box.push_back(input(x));
    of_box.push_back(of_form.back());
    const auto part = [&](const Intersector& form, const Target<double>& at, const std::vector<NodeId>& inputs) {
        Tape own;
        own.every_loop = every_loop;
        inside(form, at, own);
        return table::append(own, inputs, tape);
    };
    const TapeOutputs box_outcome = part(*row.box, Target<double>(box), of_box);
    TapeOutputs answer = part(*row.form, target, of_form);
    const bool hit = tape[box_outcome.hit].value != 0 && tape[answer.hit].value != 0;
    answer.hit = tape.add(TapeOp::both, format.parameters, hit ? 1 : 0, {box_outcome.hit, answer.hit});
    tape.outputs = answer;
}
void record(void* own, const Format& format, const Ray<double>& ray, const Target<double>& target, double tmax,
            Tape& tape) {
    record_with(of(own), format, ray, target, tmax, tape,
                [&](const Intersector& form, const Target<double>& at, Tape& there) {
                    form.record(format, ray, at, tmax, there);
                });
}
void record_all(void* own, const Target<double>& target, Tape& tape) {
    record_with(of(own), *find_format("f32"), {Vec<double>(1, 2, 3), Vec<double>(4, 5, 6)}, target, HUGE_VAL, tape,
                [](const Intersector& form, const Target<double>& at, Tape& there) { form.record_all(at, there); });
}

std::string text(auto... parts) {
    std::string all;
    ((all += parts), ...);
    return all;
}

void fill(Rows::Made& made) {
    const BoxedFormParts parts = of(&made);
    const Info &form = *parts.form->info, &box = *parts.box->info;
    const BoxMethodInfo& box_method = *parts.method->info;
    made.name = text(form.name, "^", box.name);
    if (parts.method != &usual_box_method()) made.name += text("~", box_method.name);
    made.title = text(form.title, "; behind a box: ", box.title, "; ", box_method.title);
    made.source = text(form.source, "; ", box.source);
    if (box_method.source != "-") made.source += text("; ", box_method.source);
    made.take_contract(form);
    made.row = {.info = &made.info, .shape = parts.form->shape, .native32 = nullptr, .native64 = nullptr};
    if (parts.form->native32 && parts.box->native32) made.row.native32 = {evaluate_natively<float>, &made};
    if (parts.form->native64 && parts.box->native64) made.row.native64 = {evaluate_natively<double>, &made};
    if (parts.form->rounded && parts.box->rounded) made.row.rounded = {evaluate_rounded, &made};
    if (parts.form->ball) made.row.ball = {ball, &made};
    if (parts.form->interval) made.row.interval = {interval, &made};
    if (parts.form->record && parts.box->record) made.row.record = {record, &made};
    if (parts.form->record_all && parts.box->record_all) made.row.record_all = {record_all, &made};
    made.row.is_placed = parts.form->is_placed;
}

/// Reason why a form cannot stand behind a box; empty if it can.
std::string refusal(const Intersector& box, const Intersector& form) {
    if (form.is_set()) return "write ^BOX after each form of a set";
    if (!is_primitive(form.shape))
        return "a form that marches takes all primitives at once, so no single one has a bounding box; leave ^BOX out";
    if (!has_bounding_box(form.shape))
        return text(with_article(form.shape), " has no end, so it has no bounding box; leave ^BOX out");
    if (box.is_set() || box.shape != bounding_box_shape || box.is_placed || boxed_parts_of(box).form != nullptr)
        return text(box.info->name, " is not a form of boxes; write one after the ^, such as box.signs");
    if (box.info->direction == Direction::unit && form.info->direction != Direction::unit)
        return text(box.info->name, " needs unit directions, but ", form.info->name,
                    " takes any; choose another form of boxes");
    return "";
}

}  // namespace

const Intersector& behind(const BoxMethod& method, const Intersector& box, const Intersector& form) {
    if (const std::string why = refusal(box, form); !why.empty())
        throw InputError(text(form.info->name, "^", box.info->name, ": ", why));
    return rows().row_of({&method, &box, &form}, fill);
}

BoxedFormParts boxed_parts_of(const Intersector& row) { return parts_in(rows().parts_of(row)); }

bool has_box(const Intersector& row) {
    if (row.is_set()) return std::ranges::any_of(row.parts, [](const Intersector* part) { return has_box(*part); });
    if (boxed_parts_of(row).form != nullptr) return true;
    const auto placed = transform::transformed_parts_of(row);
    return placed.form != nullptr && has_box(*placed.form);
}

const Intersector& without_world_boxes(const Intersector& row) {
    const BoxedFormParts parts = boxed_parts_of(row);
    return parts.form != nullptr && row.is_placed ? without_world_boxes(*parts.form) : row;
}

std::vector<std::string> names_on_tape(const Intersector& row, const Target<double>& target) {
    std::vector<std::string> names = table::input_names(row, target);
    const Intersector* now = &row;
    for (bool in_world = !target.primitives.empty() && target.primitives.front().placed;;) {
        if (const BoxedFormParts parts = boxed_parts_of(*now); parts.form != nullptr) {
            for (const char* const number : {"lo.x", "lo.y", "lo.z", "hi.x", "hi.y", "hi.z"})
                names.push_back(text(in_world ? "world_box." : "box.", number));
            now = parts.form;
        } else if (const auto placed = transform::transformed_parts_of(*now); placed.form != nullptr) {
            in_world = false;
            now = placed.form;
        } else {
            return names;
        }
    }
}

const Intersector& innermost(const Intersector& row) {
    if (const BoxedFormParts parts = boxed_parts_of(row); parts.form != nullptr) return innermost(*parts.form);
    const auto placed = transform::transformed_parts_of(row);
    return placed.form != nullptr ? innermost(*placed.form) : row;
}

const Intersector& with_other_form(const Intersector& row, const Intersector& form) {
    if (const BoxedFormParts parts = boxed_parts_of(row); parts.form != nullptr)
        return behind(*parts.method, *parts.box, with_other_form(*parts.form, form));
    const auto placed = transform::transformed_parts_of(row);
    return placed.form != nullptr ? transform::through(*placed.method, with_other_form(*placed.form, form)) : form;
}

}  // namespace lostbits::intersect::bounding_box
