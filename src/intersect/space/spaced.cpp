#include "intersect/space/spaced.hpp"

#include <string>
#include <tuple>

#include "intersect/simd/packed.hpp"
#include "intersect/table/joined_tapes.hpp"
#include "intersect/table/made_rows.hpp"
#include "number/error.hpp"
#include "shapes/lift.hpp"

namespace lostbits::intersect::space {

using table::HitBatch;
using table::Intersector;
using table::RayBatch;

namespace {

using Parts = std::tuple<const Space*, const Intersector*>;
using Rows = table::MadeRows<Parts>;
Rows& rows() {
    static Rows all;
    return all;
}

Made parts_in(const Parts& parts) {
    return std::apply([](auto... each) { return Made{each...}; }, parts);
}
Made of(void* own) { return parts_in(static_cast<const Rows::Made*>(own)->parts); }

template <class S>
Solid<S> object_of(const Solid<S>& solid, const S& scale) {
    Solid<S> object = solid;
    object.placed.reset();
    return scale == S(1) ? object : scaled(object, scale);
}

/// Runs a batch: takes the rays to the space of the primitive, asks the form there, and converts its answers back. All
/// rays share one primitive, or each ray is a batch of its own.
template <class T, class S, class Kernel>
void ask(const BatchIn<T, S>& steps, const Kernel& kernel, const RayBatch<S>& rays, const Target<S>& target,
         const HitBatch<S>& hits) {
    const std::size_t solids = target.solids.size();
    for (std::size_t i = 0, end = 0; i < rays.size(); i = end) {
        const Solid<S>& solid = target.solids[solids == 1 ? 0 : i];
        end = solids == 1 ? rays.size() : i + 1;
        const auto part = [&](auto all) { return all.empty() ? all : all.subspan(i, end - i); };
        const RayBatch<S> some{part(rays.ox), part(rays.oy),   part(rays.oz),   part(rays.dx), part(rays.dy),
                               part(rays.dz), part(rays.tmax), part(rays.tmin), rays.open};
        const HitBatch<S> to{part(hits.t), part(hits.near), part(hits.far), part(hits.hit)};
        if (!solid.placed) {
            kernel(some, Target<S>(solid), to);
            continue;
        }
        const auto lifted = transformed(*solid.placed, [](const S& x) { return T(x); });
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
        kernel(inside, Target<S>(object_of(solid, columns.scale)), to);
        steps.back(maps, some, columns, to);
    }
}

void ask32(void* own, const RayBatch<float>& rays, const Target<float>& target, const HitBatch<float>& hits) {
    ask(of(own).space->batch32, simd::packed_kernels(*of(own).form).f32, rays, target, hits);
}
void ask64(void* own, const RayBatch<double>& rays, const Target<double>& target, const HitBatch<double>& hits) {
    ask(of(own).space->batch64, simd::packed_kernels(*of(own).form).f64, rays, target, hits);
}
void ask_rounded(void* own, const FloatFormat& format, const RayBatch<double>& rays, const Target<double>& target,
                 const HitBatch<double>& hits) {
    const CurrentFormat::Scope scope(format);
    const auto kernel = [&](const auto&... a) { of(own).form->rounded(format, a...); };
    ask(of(own).space->batch_rounded, kernel, rays, target, hits);
}

/// Runs in an enclosure. If the determinant is not known to differ from 0, the answer stays open.
template <auto of_steps, auto kernel, class E>
Hit<E> enclosed(void* own, const Ray<E>& ray, const Target<E>& target) {
    const Made row = of(own);
    const Solid<E>& solid = target.solids.front();
    if (!solid.placed) return (row.form->*kernel)(ray, target);
    const StepsIn<E>& steps = row.space->*of_steps;
    const Maps<E> maps = steps.maps(*solid.placed);
    const ObjectRay<E> in = steps.to_object(maps, ray);
    const Solid<E> object = scaled(solid, in.scale);
    const Hit<E> hit = (row.form->*kernel)(in.ray, Target<E>(object));
    return {hit.hit, steps.back(maps, ray, in, hit.t), steps.back(maps, ray, in, hit.near),
            steps.back(maps, ray, in, hit.far)};
}

/// Records the steps and the form. `inside(ray, target, tmax, tape)` records the form in the space of the primitive.
template <class Inside>
void record_with(const Made& row, const Format& format, const Ray<double>& ray, const Solid<double>& solid, double tmax,
                 Tape& tape, const Inside& inside) {
    tape.clear();
    const auto input = [&](double x) { return tape.add_input(format.parameters, x); };
    WorldNodes world{};
    for (std::size_t k = 0; k < 6; ++k)
        world.ray[k] = input(k < 3 ? ray.origin[static_cast<int>(k)] : ray.direction[static_cast<int>(k - 3)]);
    std::vector<NodeId> numbers;
    for (const double x : solid.used()) numbers.push_back(input(x));
    for (std::size_t k = 0; k < world.matrix.size(); ++k) world.matrix[k] = input(solid.placed->matrix[k]);
    world.is_inverse = solid.placed->is_inverse;
    const NodeId end = input(tmax);
    row.space->record(format, tape, world, [&](const ObjectNodes& object) {
        const auto value = [&tape](NodeId node) { return tape[node].value; };
        const auto times = [&](NodeId a, NodeId b, double product) {
            return tape.add(TapeOp::mul, format.parameters, product, {a, b});
        };
        std::vector<NodeId> inputs(object.ray.begin(), object.ray.end());
        Solid<double> there = solid;
        there.placed.reset();
        const double scale = value(object.scale);
        std::size_t k = 0;
        const bool scales = tape[object.scale].op != TapeOp::constant;
        if (scales)
            with_number(format, [&]<class F>() {
                there = transformed(scaled(lift_solid<F>(there), static_cast<F>(scale)),
                                    [](const F& x) { return as_double(x); });
            });
        for_each_key(solid.shape, [&](const Key& key, std::size_t first) {
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
    const Made row = of(own);
    const Solid<double>& solid = target.solids.front();
    if (!solid.placed) return row.form->record(format, ray, target, tmax, tape);
    record_with(row, format, ray, solid, tmax, tape,
                [&](const Ray<double>& inside, const Target<double>& there, double limit, Tape& form) {
                    row.form->record(format, inside, there, limit, form);
                });
}
void record_all(void* own, const Target<double>& target, Tape& tape) {
    const Made row = of(own);
    const Solid<double>& solid = target.solids.front();
    if (!solid.placed) return row.form->record_all(target, tape);
    record_with(row, *find_format("f32"), {Vec<double>(1, 2, 3), Vec<double>(4, 5, 6)}, solid, HUGE_VAL, tape,
                [&](const Ray<double>&, const Target<double>& there, double, Tape& form) {
                    row.form->record_all(there, form);
                });
}

void fill(Rows::Made& made) {
    const auto& [by, of_form] = made.parts;
    const Info& form = *of_form->info;
    const SpaceInfo& space = *by->info;
    const auto text = [](auto&... parts) {
        std::string all;
        ((all += parts), ...);
        return all;
    };
    made.name = text(form.name, "@", space.name);
    made.title = text(form.title, "; ", space.title);
    made.source = text(form.source, "; ", space.source);
    made.tell_as(form);
    // A transform method that normalises gives the form unit directions, so its own requirement alone counts. With any
    // other, the form's requirement counts too.
    if (space.normalises) made.info.direction = space.direction;
    else if (space.direction == Direction::unit) made.info.direction = Direction::unit;
    const Intersector& inner = *of_form;
    made.row = {.info = &made.info, .shape = inner.shape, .native32 = nullptr, .native64 = nullptr};
    if (inner.native32) made.row.native32 = {ask32, &made};
    if (inner.native64) made.row.native64 = {ask64, &made};
    if (inner.rounded) made.row.rounded = {ask_rounded, &made};
    if (inner.ball) made.row.ball = {enclosed<&Space::ball, &Intersector::ball, Ball>, &made};
    if (inner.interval) made.row.interval = {enclosed<&Space::interval, &Intersector::interval, Interval>, &made};
    if (inner.record) made.row.record = {record, &made};
    if (inner.record_all) made.row.record_all = {record_all, &made};
    made.row.is_placed = true;
}

}  // namespace

const Intersector& through(const Space& space, const Intersector& form) {
    const std::string name(form.info->name);
    if (!is_solid(form.shape))
        throw InputError(name + "@" + std::string(space.info->name) +
                         ": a form that marches takes all primitives at once and in the world; leave @SPACE out");
    if (form.is_set() || form.is_placed)
        throw InputError(name + "@" + std::string(space.info->name) + ": write one @SPACE after each form");
    return rows().row_of({&space, &form}, fill);
}

Made made_of(const Intersector& row) { return parts_in(rows().parts_of(row)); }

}  // namespace lostbits::intersect::space
