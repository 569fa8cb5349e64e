// The loop around `Form::intersect` over packs. One translation unit for each register width includes this file, each
// with its own `Width` of internal linkage (see `Registers`). The interface of these units consists of plain pointers.
// If such a unit compiled an inline function of std::span or of our own under its ordinary name, the linker could keep
// this copy for all callers, also on machines that cannot run it. A test reads the symbols of the objects.
#pragma once

#include <limits>

#include "intersect/form_shape.hpp"
#include "intersect/info.hpp"
#include "intersect/sdf/march_loop.hpp"
#include "intersect/simd/packed_raw.hpp"
#include "number/pack.hpp"
#include "number/wide/wide_pack.hpp"

namespace lostbits::intersect::simd {

/// The least distance over the primitives, as in `intersect::table::UnionField`. Inlined into the forms, the distances
/// of all shapes were a sixth of the code of a width.
template <class P, class F>
[[gnu::noinline, gnu::flatten]] P min_distance(const RawTarget<F>& target, const Vec<P>& p) {
    P least(0);
    for (std::size_t k = 0; k < target.primitive_count; ++k) {
        const F* const n = target.numbers + max_number_count * k;
        P distance(0);
        Primitives::each([&]<template <class> class S>() {
            if (target.shapes[k] == static_cast<std::uint8_t>(shape_as<S>))
                distance = primitive_from<S, P>([n](std::size_t i) { return P(n[i]); }).distance(p);
        });
        least = k == 0 ? distance : min(least, distance);
    }
    return least;
}

template <class Form, class P, class F>
Hit<P> march_pack(const Ray<P>& ray, const RawTarget<F>& target) {
    sdf::NoMarchWatch unwatched;
    return Form::intersect(
        ray, [&target](const Vec<P>& p) { return min_distance<P>(target, p); },
        convert_numbers(target.march, [](const F& x) { return P(x); }), unwatched);
}

/// Flattened, so that every call inside is inlined. Otherwise the compiler keeps functions for the operators of
/// `OutwardInterval` and passes packs through the stack, and sphere.pbrt_interval takes five times as long.
template <class Form, class F, class Width>
[[gnu::flatten]] void packed_batch(const RawBatch<F>& batch) {
    using P = Pack<F, Width>;
    // These local copies cannot change. The stores below could change the batch itself, so without copies everything
    // would be read again after each store.
    const F *const ox = batch.rays[0], *const oy = batch.rays[1], *const oz = batch.rays[2];
    const F *const dx = batch.rays[3], *const dy = batch.rays[4], *const dz = batch.rays[5], *const tmax = batch.tmax;
    F *const t = batch.t, *const near = batch.near, *const far = batch.far;
    std::uint8_t* const decisions = batch.hit;
    const std::size_t size = batch.size;
    const RawTarget<F> target = *batch.target;

    P numbers[max_number_count];
    for (std::size_t k = 0; k < max_number_count; ++k) numbers[k] = P(target.numbers[k]);
    F no_end[P::lanes];
    P(std::numeric_limits<F>::infinity()).store(no_end);

    for (std::size_t i = 0; i < size; i += P::lanes) {
        const auto load = [i](const F* column) { return P::load(column + i); };
        const Ray<P> ray{{load(ox), load(oy), load(oz)}, {load(dx), load(dy), load(dz)}};
        const Hit<P> hit = [&] {
            if constexpr (marches<Form>) return march_pack<Form>(ray, target);
            else {
                const P end = P::load(tmax ? tmax + i : no_end);
                return intersect_numbers<Form>(
                    ray, [&numbers](std::size_t k) { return numbers[k]; }, end);
            }
        }();

        hit.t.store(t + i);
        hit.near.store(near + i);
        hit.far.store(far + i);
        // Stored directly into the bytes, which provide storage for bools. With an array of bools in between, every
        // register of decisions went through the stack, which took a twentieth of the time of the loop.
        hit.hit.store(reinterpret_cast<bool*>(decisions + i));
    }
}

/// Returns the kernels of a form; null in binary64 if the form does not exist in this format.
template <class Form, class Width>
RawFormKernels raw_form_kernels() {
    RawFormKernels row{packed_batch<Form, float, Width>, nullptr};
    if constexpr (Form::info.formats == Formats::all) row.f64 = packed_batch<Form, double, Width>;
    return row;
}

}  // namespace lostbits::intersect::simd
