#include "intersect/transform/transform_method.hpp"

#include <vector>

#include "intersect/simd/packed.hpp"
#include "intersect/transform/list.hpp"
#include "intersect/transform/raw_steps.hpp"
#include "number/recorded.hpp"
#include "number/recorders/tape_recorder.hpp"

namespace lostbits::intersect::transform {

namespace {

using table::HitBatch;
using table::RayBatch;

template <class L, class T>
Maps<T> maps_of(const Placement<T>& placed) {
    const Affine<T> stored = placed.map(), other = L::inverse(stored);
    return placed.is_inverse ? Maps<T>{other, stored} : Maps<T>{stored, other};
}

template <class L, class T>
constexpr StepsIn<T> steps() {
    return {maps_of<L, T>, L::template origin<T>, L::template direction<T>, L::template finish<T>, L::template back<T>};
}

/// Converts stored numbers to the arithmetic, and back.
template <class T, class S>
Vec<T> lifted(S x, S y, S z) {
    return {T(x), T(y), T(z)};
}
template <class S, class T>
S dropped(const T& x) {
    if constexpr (std::same_as<S, T>) return x;
    else return as_double(x);
}

template <class T, class S>
Ray<T> world_ray(const RayBatch<S>& rays, std::size_t i) {
    return {lifted<T>(rays.ox[i], rays.oy[i], rays.oz[i]), lifted<T>(rays.dx[i], rays.dy[i], rays.dz[i])};
}

/// Index of a transform method in the list.
template <class L>
constexpr std::size_t index_of() {
    std::size_t place = 0, k = 0;
    for_each_transform_method([&]<class Other>() {
        if (std::same_as<L, Other>) place = k;
        ++k;
    });
    return place;
}
constexpr std::size_t space_count = [] {
    std::size_t count = 0;
    for_each_transform_method([&count]<class L>() { ++count; });
    return count;
}();

/// The steps compiled for a register width, and its size in bytes.
struct Packs {
    std::array<RawTransformRow, space_count> rows{};
    std::size_t bytes = 0;

    Packs(void (*fill)(RawTransformRow*), std::size_t size) : bytes(size) { fill(rows.data()); }
};
/// The packs of a width that this machine has; null for `scalar`.
const Packs* packs_of(simd::Isa isa) {
    static const Packs w128(fill_transforms_w128, 16);
#if defined(__x86_64__)
    if (isa == simd::Isa::w256) {
        static const Packs w256(fill_transforms_w256, 32);
        return &w256;
    }
    if (isa == simd::Isa::w512) {
        static const Packs w512(fill_transforms_w512, 64);
        return &w512;
    }
#endif
    return isa == simd::Isa::scalar ? nullptr : &w128;
}

/// Calls `act(way, steps)` on the rays that fill whole packs of the current width, and returns their number. The rest
/// is left to the caller; in an arithmetic without registers, that is all of them.
template <class L, class T, class S, class Act>
std::size_t in_packs(const Maps<T>& maps, const RayBatch<S>& rays, const Act& act) {
    if constexpr (std::same_as<T, S>) {
        const Packs* const packs = packs_of(simd::current_isa());
        if (packs == nullptr) return 0;
        const std::size_t lanes = packs->bytes / sizeof(S), whole = rays.size() / lanes * lanes;
        if (whole == 0) return 0;
        std::array<S, 2 * Affine<S>::numbers> numbers;
        std::size_t k = 0;
        for (const Affine<T>* const map : {&maps.to_world, &maps.to_object})
            map->each([&](const S& x) { numbers[k++] = x; });
        RawSteps<S> steps{
            .maps = numbers.data(),
            .world = {rays.ox.data(), rays.oy.data(), rays.oz.data(), rays.dx.data(), rays.dy.data(), rays.dz.data()},
            .object = {},
            .length = nullptr,
            .scale = nullptr,
            .told = {},
            .size = whole};
        const RawTransformRow& row = packs->rows[index_of<L>()];
        if constexpr (std::same_as<S, float>) act(row.f32, steps);
        else act(row.f64, steps);
        return whole;
    } else {
        return 0;
    }
}

template <class L, class T, class S>
void batch_to_object(const Maps<T>& maps, const RayBatch<S>& rays, ObjectColumns<S>& to) {
    for (auto& column : to.ray) column.resize(rays.size());
    to.length.resize(rays.size());
    const std::size_t done = in_packs<L>(maps, rays, [&to](const auto& way, auto& steps) {
        for (std::size_t k = 0; k < to.ray.size(); ++k) steps.object[k] = to.ray[k].data();
        steps.length = to.length.data();
        steps.scale = &to.scale;
        way.to_object(steps);
    });
    for (std::size_t i = done; i < rays.size(); ++i) {
        const Ray<T> world = world_ray<T>(rays, i);
        const ObjectRay<T> in =
            L::finish(maps, world.origin, Ray<T>{L::origin(maps, world.origin), L::direction(maps, world.direction)});
        for (int k = 0; k < 3; ++k) {
            to.ray[static_cast<std::size_t>(k)][i] = dropped<S>(in.ray.origin[k]);
            to.ray[static_cast<std::size_t>(k + 3)][i] = dropped<S>(in.ray.direction[k]);
        }
        to.length[i] = dropped<S>(in.length);
        to.scale = dropped<S>(in.scale);
    }
}

template <class L, class T, class S>
void batch_back(const Maps<T>& maps, const RayBatch<S>& rays, const ObjectColumns<S>& in, const HitBatch<S>& hits) {
    const std::size_t done = in_packs<L>(maps, rays, [&](const auto& way, auto& steps) {
        // These columns are only read here. Their pointers are not const because `to_object` writes through the same
        // struct.
        for (std::size_t k = 0; k < in.ray.size(); ++k) steps.object[k] = const_cast<S*>(in.ray[k].data());
        steps.length = const_cast<S*>(in.length.data());
        steps.scale = const_cast<S*>(&in.scale);
        steps.told[0] = hits.t.data(), steps.told[1] = hits.near.data(), steps.told[2] = hits.far.data();
        way.back(steps);
    });
    for (std::size_t i = done; i < rays.size(); ++i) {
        const Ray<T> world = world_ray<T>(rays, i);
        const auto at = [&](std::size_t k) { return in.ray[k][i]; };
        const ObjectRay<T> there{
            {lifted<T>(at(0), at(1), at(2)), lifted<T>(at(3), at(4), at(5))}, T(in.length[i]), T(in.scale)};
        for (const auto* const lengths : {&hits.t, &hits.near, &hits.far})
            (*lengths)[i] = dropped<S>(L::back(maps, world, there, T((*lengths)[i])));
    }
}

template <class L>
void record(const Format& format, Tape& tape, const WorldNodes& world, const RecordForm& form) {
    using T = Recorded;
    number::recorders::TapeRecorder recorder(tape, format.parameters);
    const auto vec = [](const auto& nodes, std::size_t k) {
        return Vec<T>(T::at(nodes[k]), T::at(nodes[k + 1]), T::at(nodes[k + 2]));
    };
    const Ray<T> ray{vec(world.ray, 0), vec(world.ray, 3)};
    const Affine<T> stored = Affine<T>::of([&](std::size_t k) { return T::at(world.matrix[k]); });
    const Affine<T> other = L::inverse(stored);
    const Maps<T> maps = world.is_inverse ? Maps<T>{other, stored} : Maps<T>{stored, other};
    const ObjectRay<T> in =
        L::finish(maps, ray.origin, Ray<T>{L::origin(maps, ray.origin), L::direction(maps, ray.direction)});
    const Vec<T>&o = in.ray.origin, &d = in.ray.direction;
    TapeOutputs answer = form(
        {{o.x.node(), o.y.node(), o.z.node(), d.x.node(), d.y.node(), d.z.node()}, in.length.node(), in.scale.node()});
    for (NodeId* const t : {&answer.t, &answer.near, &answer.far}) *t = L::back(maps, ray, in, T::at(*t)).node();
    tape.outputs = answer;
}

template <class L>
constexpr TransformMethod row() {
    return {.info = &L::info,
            .f32 = steps<L, float>(),
            .f64 = steps<L, double>(),
            .rounded = steps<L, RoundedAny>(),
            .ball = steps<L, Ball>(),
            .interval = steps<L, Interval>(),
            .real = steps<L, Real>(),
            .batch32 = {maps_of<L, float>, batch_to_object<L, float, float>, batch_back<L, float, float>},
            .batch64 = {maps_of<L, double>, batch_to_object<L, double, double>, batch_back<L, double, double>},
            .batch_rounded = {maps_of<L, RoundedAny>, batch_to_object<L, RoundedAny, double>,
                              batch_back<L, RoundedAny, double>},
            .record = record<L>};
}

}  // namespace

std::span<const TransformMethod> transform_methods() {
    static const std::vector<TransformMethod> all = [] {
        std::vector<TransformMethod> rows;
        for_each_transform_method([&rows]<class L>() { rows.push_back(row<L>()); });
        return rows;
    }();
    return all;
}

const TransformMethod& usual_transform_method() { return transform_methods().front(); }

}  // namespace lostbits::intersect::transform
