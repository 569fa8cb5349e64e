// Defines `append_many_kernels`, which compiles the forms for one ray against primitives of floats and doubles.
#pragma once

#include "intersect/simd/packed_many.hpp"
#include "intersect/table/kernels.hpp"

namespace lostbits::intersect::simd {

template <class Form, class F>
void run_plain(const Ray<F>& ray, const PrimitiveArrays<F>& primitives, std::span<F> t, std::span<std::uint8_t> hit) {
    for (std::size_t i = 0; i < primitives.size(); ++i) {
        const auto number = [&primitives, i](std::size_t k) { return primitives.numbers[k][i]; };
        const Hit<F> h = intersect_numbers<Form>(ray, number, t[i]);
        if constexpr (takes_tmax(shape_of<Form>)) {
            t[i] = h.hit ? h.t : t[i];
        } else {
            t[i] = h.t;
            hit[i] = h.hit;
        }
    }
}

template <class Forms>
void append_many_kernels(std::vector<ManyFormKernels>& rows) {
    Forms::for_each([&rows]<class Form>() {
        ManyFormKernels& row = rows.emplace_back();
        row.info = &Form::info;
        row.takes_tmax = takes_tmax(shape_of<Form>);
        if constexpr (!marches<Form>) row.f32 = run_plain<Form, float>;
        if constexpr (has_many_kernels(shape_of<Form>) && Form::info.formats == Formats::all)
            row.f64 = run_plain<Form, double>;
    });
}

}  // namespace lostbits::intersect::simd
