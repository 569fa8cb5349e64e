#include "intersect/transform/transform_method.hpp"

#include <vector>

#include "intersect/simd/of_width.hpp"
#include "intersect/transform/list.hpp"
#include "intersect/transform/raw_steps.hpp"
#include "number/recorded.hpp"
#include "number/recorders/tape_recorder.hpp"

namespace lostbits::intersect::transform {

namespace {

using table::HitBatch;
using table::RayBatch;

template <class Method, class T>
MatrixPair<T> make_maps(const Transform<T>& transform) {
    const Affine<T> stored = transform.map(), inverse = Method::inverse(stored);
    return transform.is_inverse ? MatrixPair<T>{inverse, stored} : MatrixPair<T>{stored, inverse};
}

template <class Method, class T>
constexpr StepFunctions<T> steps() {
    return {make_maps<Method, T>, Method::template origin<T>, Method::template direction<T>, Method::template finish<T>,
            Method::template back<T>};
}

/// Converts stored numbers to the arithmetic T, and back.
template <class T, class S>
Vec<T> to_vec(S x, S y, S z) {
    return {T(x), T(y), T(z)};
}
template <class S, class T>
S to_stored(const T& x) {
    if constexpr (std::same_as<S, T>) return x;
    else return as_double(x);
}

template <class T, class S>
Ray<T> world_ray(const RayBatch<S>& rays, std::size_t i) {
    return {to_vec<T>(rays.ox[i], rays.oy[i], rays.oz[i]), to_vec<T>(rays.dx[i], rays.dy[i], rays.dz[i])};
}

/// Index of a transform method in the list.
template <class Method>
constexpr std::size_t index_of() {
    std::size_t index = 0, k = 0;
    for_each_transform_method([&]<class Other>() {
        if (std::same_as<Method, Other>) index = k;
        ++k;
    });
    return index;
}
constexpr std::size_t method_count = [] {
    std::size_t count = 0;
    for_each_transform_method([&count]<class Method>() { ++count; });
    return count;
}();

/// The methods compiled for a register width, and that width in bytes.
struct PackedMethods {
    std::array<RawTransformKernels, method_count> rows{};
    std::size_t register_bytes = 0;

    PackedMethods(void (*fill)(RawTransformKernels*), std::size_t size) : register_bytes(size) { fill(rows.data()); }
};
/// The methods for an available width; null for `scalar`.
const PackedMethods* packed_methods(simd::Isa isa) {
    static constexpr simd::FunctionOfWidth<void(RawTransformKernels*)> fill = LOSTBITS_OF_EACH_WIDTH(fill_transforms);
    if (isa == simd::Isa::scalar) return nullptr;
    return simd::with_width(isa, []<simd::Isa width>() -> const PackedMethods* {
        static const PackedMethods methods(fill.at(width), simd::bytes_of(width));
        return &methods;
    });
}

/// Calls `run(functions, steps)` on the rays that fill whole packs of the current width, and returns the number of
/// these rays. The caller computes the other rays; in an arithmetic without registers, those are all rays.
template <class Method, class T, class S, class Run>
std::size_t run_in_packs(const MatrixPair<T>& maps, const RayBatch<S>& rays, const Run& run) {
    if constexpr (std::same_as<T, S>) {
        const PackedMethods* const packed = packed_methods(simd::current_isa());
        if (packed == nullptr) return 0;
        const std::size_t lane_count = packed->register_bytes / sizeof(S),
                          packed_count = rays.size() / lane_count * lane_count;
        if (packed_count == 0) return 0;

        // Passes plain pointers, since the functions are compiled for each register width.
        std::array<S, 2 * Affine<S>::number_count> numbers;
        std::size_t k = 0;
        for (const Affine<T>* const map : {&maps.to_world, &maps.to_object})
            map->for_each_number([&](const S& x) { numbers[k++] = x; });
        RawSteps<S> steps{
            .maps = numbers.data(),
            .world = {rays.ox.data(), rays.oy.data(), rays.oz.data(), rays.dx.data(), rays.dy.data(), rays.dz.data()},
            .object = {},
            .length = nullptr,
            .scale = nullptr,
            .line_parameters = {},
            .size = packed_count};

        const RawTransformKernels& row = packed->rows[index_of<Method>()];
        if constexpr (std::same_as<S, float>) run(row.f32, steps);
        else run(row.f64, steps);
        return packed_count;
    } else {
        return 0;
    }
}

template <class Method, class T, class S>
void transform_batch_to_object(const MatrixPair<T>& maps, const RayBatch<S>& rays, ObjectColumns<S>& columns) {
    for (auto& column : columns.ray) column.resize(rays.size());
    columns.length.resize(rays.size());
    const std::size_t packed_count = run_in_packs<Method>(maps, rays, [&columns](const auto& functions, auto& steps) {
        for (std::size_t k = 0; k < columns.ray.size(); ++k) steps.object[k] = columns.ray[k].data();
        steps.length = columns.length.data();
        steps.scale = &columns.scale;
        functions.to_object(steps);
    });

    // Computes the rays that fill no pack one by one.
    for (std::size_t i = packed_count; i < rays.size(); ++i) {
        const Ray<T> world = world_ray<T>(rays, i);
        const ObjectRay<T> object_ray = Method::finish(
            maps, world.origin, Ray<T>{Method::origin(maps, world.origin), Method::direction(maps, world.direction)});
        for (int k = 0; k < 3; ++k) {
            columns.ray[k][i] = to_stored<S>(object_ray.ray.origin[k]);
            columns.ray[k + 3][i] = to_stored<S>(object_ray.ray.direction[k]);
        }
        columns.length[i] = to_stored<S>(object_ray.length);
        columns.scale = to_stored<S>(object_ray.scale);
    }
}

template <class Method, class T, class S>
void transform_batch_back(const MatrixPair<T>& maps, const RayBatch<S>& rays, const ObjectColumns<S>& columns,
                          const HitBatch<S>& hits) {
    const std::size_t packed_count = run_in_packs<Method>(maps, rays, [&](const auto& functions, auto& steps) {
        // These columns are only read here. Their pointers are not const because `to_object` writes through the same
        // struct.
        for (std::size_t k = 0; k < columns.ray.size(); ++k) steps.object[k] = const_cast<S*>(columns.ray[k].data());
        steps.length = const_cast<S*>(columns.length.data());
        steps.scale = const_cast<S*>(&columns.scale);
        steps.line_parameters[0] = hits.t.data();
        steps.line_parameters[1] = hits.near.data();
        steps.line_parameters[2] = hits.far.data();
        functions.back(steps);
    });

    // Computes the rays that fill no pack one by one.
    for (std::size_t i = packed_count; i < rays.size(); ++i) {
        const Ray<T> world = world_ray<T>(rays, i);
        const auto component = [&](std::size_t k) { return columns.ray[k][i]; };
        const ObjectRay<T> object_ray{
            {to_vec<T>(component(0), component(1), component(2)), to_vec<T>(component(3), component(4), component(5))},
            T(columns.length[i]),
            T(columns.scale)};
        for (const auto* const parameters : {&hits.t, &hits.near, &hits.far})
            (*parameters)[i] = to_stored<S>(Method::back(maps, world, object_ray, T((*parameters)[i])));
    }
}

template <class Method>
void record(const Format& format, Tape& tape, const WorldNodes& world, const RecordForm& form) {
    using T = Recorded;
    number::recorders::TapeRecorder recorder(tape, format.parameters);
    const auto vec_of_nodes = [](const auto& nodes, std::size_t k) {
        return Vec<T>(T::at(nodes[k]), T::at(nodes[k + 1]), T::at(nodes[k + 2]));
    };
    const Ray<T> ray{vec_of_nodes(world.ray, 0), vec_of_nodes(world.ray, 3)};
    const Affine<T> stored = Affine<T>::of([&](std::size_t k) { return T::at(world.matrix[k]); });

    // Records the steps of the method.
    const Affine<T> inverse = Method::inverse(stored);
    const MatrixPair<T> maps = world.is_inverse ? MatrixPair<T>{inverse, stored} : MatrixPair<T>{stored, inverse};
    const ObjectRay<T> object_ray = Method::finish(
        maps, ray.origin, Ray<T>{Method::origin(maps, ray.origin), Method::direction(maps, ray.direction)});
    const Vec<T>&o = object_ray.ray.origin, &d = object_ray.ray.direction;

    // Records the form on them, then the way back of its answers.
    TapeOutputs answer = form({{o.x.node(), o.y.node(), o.z.node(), d.x.node(), d.y.node(), d.z.node()},
                               object_ray.length.node(),
                               object_ray.scale.node()});
    for (NodeId* const t : {&answer.t, &answer.near, &answer.far})
        *t = Method::back(maps, ray, object_ray, T::at(*t)).node();
    tape.outputs = answer;
}

template <class Method>
constexpr TransformMethod method_row() {
    return {.info = &Method::info,
            .f32 = steps<Method, float>(),
            .f64 = steps<Method, double>(),
            .rounded = steps<Method, RoundedAny>(),
            .ball = steps<Method, Ball>(),
            .interval = steps<Method, Interval>(),
            .real = steps<Method, Real>(),
            .batch32 = {make_maps<Method, float>, transform_batch_to_object<Method, float, float>,
                        transform_batch_back<Method, float, float>},
            .batch64 = {make_maps<Method, double>, transform_batch_to_object<Method, double, double>,
                        transform_batch_back<Method, double, double>},
            .batch_rounded = {make_maps<Method, RoundedAny>, transform_batch_to_object<Method, RoundedAny, double>,
                              transform_batch_back<Method, RoundedAny, double>},
            .record = record<Method>};
}

}  // namespace

std::span<const TransformMethod> transform_methods() {
    static const std::vector<TransformMethod> methods = [] {
        std::vector<TransformMethod> rows;
        for_each_transform_method([&rows]<class Method>() { rows.push_back(method_row<Method>()); });
        return rows;
    }();
    return methods;
}

const TransformMethod& default_transform_method() { return transform_methods().front(); }

}  // namespace lostbits::intersect::transform
