// The loop around `Form::intersect` over packs: one translation unit for each register width includes it, each with its own
// `Width` of internal linkage (see `Registers`). They see plain pointers only: an inline function of std::span or of our own,
// compiled here under its ordinary name, could be the one that the linker keeps for everybody, on machines that
// cannot run it. A test reads the symbols of the objects.
#pragma once

#include <cstring>
#include <limits>

#include "intersect/catalogue.hpp"
#include "intersect/packed_raw.hpp"
#include "intersect/takes.hpp"
#include "number/pack.hpp"

namespace lostbits {

/// Flattened: every call inside is inlined. Otherwise the compiler keeps functions for the operators of `Outward`, packs travel
/// through the stack, and sphere.pbrt_interval takes five times as long.
template <class Form, class F, class Width>
[[gnu::flatten]] void packed_batch(const RawBatch<F>& batch) {
    using P = Pack<F, Width>;
    const auto number = [s = batch.solid](int k) { return P(s[k]); };
    const Vec<P> first(number(0), number(1), number(2));  // the centre, or lo
    F nowhere[P::lanes];
    P(std::numeric_limits<F>::infinity()).store(nowhere);
    for (std::size_t i = 0; i < batch.size; i += P::lanes) {
        const auto at = [&](int column) { return P::load(batch.rays[column] + i); };
        const Ray<P> ray{{at(0), at(1), at(2)}, {at(3), at(4), at(5)}};
        const Hit<P> hit = [&] {
            if constexpr (takes_sphere<Form>) return Form::intersect(ray, Sphere<P>{first, number(3)});
            else return Form::intersect(ray, Box<P>{first, {number(3), number(4), number(5)}}, P::load(batch.tmax ? batch.tmax + i : nowhere));
        }();
        hit.t.store(batch.t + i);
        hit.near.store(batch.near + i);
        hit.far.store(batch.far + i);
        bool decision[P::lanes];
        hit.hit.store(decision);
        std::memcpy(batch.hit + i, decision, P::lanes);
    }
}

/// A null pointer where the form does not exist in binary64.
template <class Width>
void fill_raw(RawRow* row) {
    for_each_form([&row]<class Form>() {
        row->f32 = packed_batch<Form, float, Width>;
        if constexpr (Form::info.formats == Formats::all) row->f64 = packed_batch<Form, double, Width>;
        ++row;
    });
}

}  // namespace lostbits
