// The loops over packs of primitives for one ray; see packed_batch.hpp for what such a file may include.
#pragma once

#include <cstring>
#include <type_traits>

#include "intersect/form_shape.hpp"
#include "intersect/simd/packed_raw.hpp"
#include "number/pack.hpp"
#include "number/wide/wide_pack.hpp"
#include "number/width.hpp"
#include "shapes/box/ordered_box.hpp"

namespace lostbits::intersect::simd {

/// Forms that accept the planes of a box in the order in which the ray meets them. Such a form orders the planes by the
/// sign of 1/d, which is the sign of d and so the same for all boxes. box.embree_fma changes the sign of a tiny d, so
/// it does not qualify. If d is NaN, every t is NaN, and the order has no effect.
template <class Form, class T>
concept TakesOrderedBox = requires(const Ray<T>& ray, const OrderedBox<T>& box, const T& limit) {
    Form::intersect(ray, box, limit);
};

/// The ray is the same in every iteration, so the compiler moves computations that depend only on the ray (1/d) in
/// front of the loop.
template <class Form, class F, class Width>
[[gnu::flatten]] void one_ray_many_boxes(const RawPrimitives<F>& batch) {
    using P = Pack<F, Width>;
    constexpr bool is_ordered = TakesOrderedBox<Form, P>;
    using B = std::conditional_t<is_ordered, OrderedBox<P>, Box<P>>;
    // True if the ray meets the plane `hi` before the plane `lo` along an axis.
    const auto meets_hi_first = [r = batch.ray](int axis) { return is_ordered && __builtin_signbit(r[3 + axis]); };
    const bool is_reversed[3] = {meets_hi_first(0), meets_hi_first(1), meets_hi_first(2)};
    const auto column = [&](int k) { return batch.numbers[is_reversed[k % 3] ? (k + 3) % 6 : k]; };
    // Each pointer is read from the batch into a local variable, which no store of the loop can change. A copy of the
    // whole struct would use wide moves, which wait for the narrow stores that filled the struct. This wait, and dead
    // stores in the loop, made 256 boxes 8 % slower than a loop written by hand.
    const F *const first_x = column(0), *const first_y = column(1), *const first_z = column(2);
    const F *const second_x = column(3), *const second_y = column(4), *const second_z = column(5);
    F* const t = batch.t;
    const std::size_t size = batch.size;
    const auto number = [r = batch.ray](int k) { return P(r[k]); };
    const Ray<P> ray{{number(0), number(1), number(2)}, {number(3), number(4), number(5)}};
    for (std::size_t i = 0; i < size; i += P::lanes) {
        const P tmax = P::load(t + i);
        const B box{{P::load(first_x + i), P::load(first_y + i), P::load(first_z + i)},
                    {P::load(second_x + i), P::load(second_y + i), P::load(second_z + i)}};
        const Hit<P> hit = Form::intersect(ray, box, tmax);
        select(hit.hit, hit.t, tmax).store(t + i);
    }
}

template <class Form, class F, class Width>
[[gnu::flatten]] void one_ray_many_primitives(const RawPrimitives<F>& batch) {
    using P = Pack<F, Width>;
    static_assert(!takes_tmax(shape_of<Form>));
    const RawPrimitives<F> b = batch;
    const auto number = [&b](int k) { return P(b.ray[k]); };
    const Ray<P> ray{{number(0), number(1), number(2)}, {number(3), number(4), number(5)}};
    for (std::size_t i = 0; i < b.size; i += P::lanes) {
        const auto load = [&](std::size_t column) { return P::load(b.numbers[column] + i); };
        const Hit<P> hit = intersect_numbers<Form>(ray, load, P(0));
        hit.t.store(b.t + i);
        bool decision[P::lanes];
        hit.hit.store(decision);
        std::memcpy(b.hit + i, decision, P::lanes);
    }
}

/// Fills the row of each form with the kernels of the form. They are null for a march; in binary64 also if the form
/// does not exist in this format or the shape has no kernels for many primitives (`has_many_kernels`). Returns the
/// place after the last row.
template <class Forms, class Width>
RawManyFormKernels* fill_many_form_kernels(RawManyFormKernels* row) {
    Forms::for_each([&row]<class Form>() {
        constexpr bool has_f64 = Form::info.formats == Formats::all && has_many_kernels(shape_of<Form>);
        if constexpr (meets<Form, Box>) {
            row->f32 = one_ray_many_boxes<Form, float, Width>;
            if constexpr (has_f64) row->f64 = one_ray_many_boxes<Form, double, Width>;
        } else if constexpr (!marches<Form>) {
            row->f32 = one_ray_many_primitives<Form, float, Width>;
            if constexpr (has_f64) row->f64 = one_ray_many_primitives<Form, double, Width>;
        }
        ++row;
    });
    return row;
}

template <class Forms>
RawManyFormKernels* LOSTBITS_WITH_WIDTH_SUFFIX(fill_many)(RawManyFormKernels* row) {
    return fill_many_form_kernels<Forms, BuildRegisters>(row);
}

}  // namespace lostbits::intersect::simd
