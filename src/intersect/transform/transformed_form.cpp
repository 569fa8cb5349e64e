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
using Rows = table::ComposedForms<Parts>;
Rows& rows() {
    static Rows all;
    return all;
}

TransformedFormParts parts_in(const Parts& parts) {
    return std::apply([](auto... each) { return TransformedFormParts{each...}; }, parts);
}
TransformedFormParts of(void* own) { return parts_in(static_cast<const Rows::Made*>(own)->parts); }

template <class S>
Primitive<S> object_of(const Primitive<S>& primitive, const S& scale) {
    Primitive<S> object = primitive;
    object.placed.reset();
    return scale == S(1) ? object : scaled(object, scale);
}

/// Runs a batch: takes the rays to the space of the primitive, asks the form there, and converts its answers back. All
/// rays share one primitive, or each ray is a batch of its own.
template <class T, class S, class Kernel>
void evaluate(const BatchIn<T, S>& steps, const Kernel& kernel, const RayBatch<S>& rays, const Target<S>& target,
              const HitBatch<S>& hits) {
    const std::size_t primitives = target.primitives.size();
    for (std::size_t i = 0, end = 0; i < rays.size(); i = end) {
        const Primitive<S>& primitive = target.primitives[primitives == 1 ? 0 : i];
        end = primitives == 1 ? rays.size() : i + 1;
        const auto part = [&](auto all) { return all.empty() ? all : all.subspan(i, end - i); };
        const RayBatch<S> some{part(rays.ox), part(rays.oy),   part(rays.oz),   part(rays.dx), part(rays.dy),
                               part(rays.dz), part(rays.tmax), part(rays.tmin), rays.open};
        const HitBatch<S> to{part(hits.t), part(hits.near), part(hits.far), part(hits.hit)};
        if (!primitive.placed) {
            kernel(some, Target<S>(primitive), to);
            continue;
        }
        const auto lifted = transformed(*primitive.placed, [](const S& x) { return T(x); });
        const Maps<T> maps = steps.maps(lifted);
        thread_local ObjectColumns<S> columns;
        steps.to_object(maps, some, columns);
        const auto& [ox, oy, oz, dx, dy, dz] = columns.ray;
        RayBatch<S> inside{ox, oy, oz, dx, dy, dz};
        thread_local std::vector<S> ends;
        if (!some.tmax.empty()) {
            ends.resize(some.size());
            for (std::size_t k = 0; k < ends.size(); ++k) ends[k] = some.tmax[k] * columns.length[k];
            inside.tmax = ends;
            inside.open.tmax = some.open.tmax;
        }
        kernel(inside, Target<S>(object_of(primitive, columns.scale)), to);
        steps.back(maps, some, columns, to);
    }
}

void ask32(void* own, const RayBatch<float>& rays, const Target<float>& target, const HitBatch<float>& hits) {
    evaluate(of(own).method->batch32, simd::packed_kernels(*of(own).form).f32, rays, target, hits);
}
void ask64(void* own, const RayBatch<double>& rays, const Target<double>& target, const HitBatch<double>& hits) {
    evaluate(of(own).method->batch64, simd::packed_kernels(*of(own).form).f64, rays, target, hits);
}
void evaluate_rounded(void* own, const FloatFormat& format, const RayBatch<double>& rays, const Target<double>& target,
                      const HitBatch<double>& hits) {
    const CurrentFormat::Scope scope(format);
    const auto kernel = [&](const auto&... a) { of(own).form->rounded(format, a...); };
    evaluate(of(own).method->batch_rounded, kernel, rays, target, hits);
}

/// Runs in an enclosure. If the determinant is not known to differ from 0, the answer stays open.
template <auto of_steps, auto kernel, class E>
Hit<E> enclosed(void* own, const Ray<E>& ray, const Target<E>& target) {
    const TransformedFormParts row = of(own);
    const Primitive<E>& primitive = target.primitives.front();
    if (!primitive.placed) return (row.form->*kernel)(ray, target);
    const StepsIn<E>& steps = row.method->*of_steps;
    const Maps<E> maps = steps.maps(*primitive.placed);
    const ObjectRay<E> in = steps.to_object(maps, ray);
    const Primitive<E> object = scaled(primitive, in.scale);
    const Hit<E> hit = (row.form->*kernel)(in.ray, Target<E>(object));
    return {hit.hit, steps.back(maps, ray, in, hit.t), steps.back(maps, ray, in, hit.near),
            steps.back(maps, ray, in, hit.far)};
}

/// Records the steps and the form. `inside(ray, target, tmax, tape)` records the form in the space of the primitive.
template <class Inside>
void record_with(const TransformedFormParts& row, const Format& format, const Ray<double>& ray,
                 const Primitive<double>& primitive, double tmax, Tape& tape, const Inside& inside) {
    tape.clear();
    const auto input = [&](double x) { return tape.add_input(format.parameters, x); };
    WorldNodes world{};
    for (std::size_t k = 0; k < 6; ++k)
        world.ray[k] = input(k < 3 ? ray.origin[static_cast<int>(k)] : ray.direction[static_cast<int>(k - 3)]);
    std::vector<NodeId> numbers;
    for (const double x : primitive.used()) numbers.push_back(input(x));
    for (std::size_t k = 0; k < world.matrix.size(); ++k) world.matrix[k] = input(primitive.placed->matrix[k]);
    world.is_inverse = primitive.placed->is_inverse;
    const NodeId end = input(tmax);
    row.method->record(format, tape, world, [&](const ObjectNodes& object) {
        const auto value = [&tape](NodeId node) { return tape[node].value; };
        const auto times = [&](NodeId a, NodeId b, double product) {
            return tape.add(TapeOp::mul, format.parameters, product, {a, b});
        };
        std::vector<NodeId> inputs(object.ray.begin(), object.ray.end());
        Primitive<double> there = primitive;
        there.placed.reset();
        const double scale = value(object.scale);
        std::size_t k = 0;
        const bool scales = tape[object.scale].op != TapeOp::constant;
        if (scales)
            with_number(format, [&]<class F>() {
                there = transformed(scaled(lift_primitive<F>(there), static_cast<F>(scale)),
                                    [](const F& x) { return as_double(x); });
            });
        for_each_key(primitive.shape, [&](const Key& key, std::size_t first) {
            for (k = first; k < first + key.count(); ++k)
                inputs.push_back(scales && key.kind != Key::Kind::direction
                                     ? times(object.scale, numbers[k], there.numbers[k])
                                     : numbers[k]);
        });
        double limit = tmax;
        if (tape[object.length].op != TapeOp::constant) {
            with_number(format, [&]<class F>() {
                limit = as_double(static_cast<F>(tmax) * static_cast<F>(value(object.length)));
            });
            inputs.push_back(times(end, object.length, limit));
        } else {
            inputs.push_back(end);
        }
        const auto& r = object.ray;
        Tape own;
        own.every_loop = tape.every_loop;
        inside(Ray<double>{{value(r[0]), value(r[1]), value(r[2])}, {value(r[3]), value(r[4]), value(r[5])}},
               Target<double>(there), limit, own);
        return table::append(own, inputs, tape);
    });
}

void record(void* own, const Format& format, const Ray<double>& ray, const Target<double>& target, double tmax,
            Tape& tape) {
    const TransformedFormParts row = of(own);
    const Primitive<double>& primitive = target.primitives.front();
    if (!primitive.placed) return row.form->record(format, ray, target, tmax, tape);
    record_with(row, format, ray, primitive, tmax, tape,
                [&](const Ray<double>& inside, const Target<double>& there, double limit, Tape& form) {
                    row.form->record(format, inside, there, limit, form);
                });
}
void record_all(void* own, const Target<double>& target, Tape& tape) {
    const TransformedFormParts row = of(own);
    const Primitive<double>& primitive = target.primitives.front();
    if (!primitive.placed) return row.form->record_all(target, tape);
    record_with(row, *find_format("f32"), {Vec<double>(1, 2, 3), Vec<double>(4, 5, 6)}, primitive, HUGE_VAL, tape,
                [&](const Ray<double>&, const Target<double>& there, double, Tape& form) {
                    row.form->record_all(there, form);
                });
}

void fill(Rows::Made& made) {
    const auto& [by, of_form] = made.parts;
    const Info& form = *of_form->info;
    const TransformMethodInfo& space = *by->info;
    const auto text = [](auto&... parts) {
        std::string all;
        ((all += parts), ...);
        return all;
    };
    made.name = text(form.name, "@", space.name);
    made.title = text(form.title, "; ", space.title);
    made.source = text(form.source, "; ", space.source);
    made.take_contract(form);
    // A transform method that normalises gives the form unit directions, so its own requirement alone counts. With any
    // other, the form's requirement counts too.
    if (space.normalises) made.info.direction = space.direction;
    else if (space.direction == Direction::unit) made.info.direction = Direction::unit;
    const Intersector& inner = *of_form;
    made.row = {.info = &made.info, .shape = inner.shape, .native32 = nullptr, .native64 = nullptr};
    if (inner.native32) made.row.native32 = {ask32, &made};
    if (inner.native64) made.row.native64 = {ask64, &made};
    if (inner.rounded) made.row.rounded = {evaluate_rounded, &made};
    if (inner.ball) made.row.ball = {enclosed<&TransformMethod::ball, &Intersector::ball, Ball>, &made};
    if (inner.interval)
        made.row.interval = {enclosed<&TransformMethod::interval, &Intersector::interval, Interval>, &made};
    if (inner.record) made.row.record = {record, &made};
    if (inner.record_all) made.row.record_all = {record_all, &made};
    made.row.is_placed = true;
}

}  // namespace

const Intersector& through(const TransformMethod& space, const Intersector& form) {
    const std::string name(form.info->name);
    if (!is_primitive(form.shape))
        throw InputError(name + "@" + std::string(space.info->name) +
                         ": a form that marches takes all primitives at once and in the world; leave @TRANSFORM out");
    if (form.is_set() || form.is_placed)
        throw InputError(name + "@" + std::string(space.info->name) + ": write one @TRANSFORM after each form");
    return rows().row_of({&space, &form}, fill);
}

TransformedFormParts transformed_parts_of(const Intersector& row) { return parts_in(rows().parts_of(row)); }

}  // namespace lostbits::intersect::transform
