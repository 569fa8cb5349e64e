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
    // Copies: the stores below could reach the batch itself, and everything would be read again after each.
    const F *const ox = batch.rays[0], *const oy = batch.rays[1], *const oz = batch.rays[2];
    const F *const dx = batch.rays[3], *const dy = batch.rays[4], *const dz = batch.rays[5], *const tmax = batch.tmax;
    F *const t = batch.t, *const near = batch.near, *const far = batch.far;
    std::uint8_t* const decisions = batch.hit;
    const std::size_t size = batch.size;
    const auto number = [s = batch.solid](int k) { return P(s[k]); };
    const P n0 = number(0), n1 = number(1), n2 = number(2), n3 = number(3);  // the centre and radius, or lo and hi
    F nowhere[P::lanes];
    P(std::numeric_limits<F>::infinity()).store(nowhere);
    for (std::size_t i = 0; i < size; i += P::lanes) {
        const auto at = [i](const F* column) { return P::load(column + i); };
        const Ray<P> ray{{at(ox), at(oy), at(oz)}, {at(dx), at(dy), at(dz)}};
        const Hit<P> hit = [&] {
            if constexpr (takes_sphere<Form>) return Form::intersect(ray, Sphere<P>{{n0, n1, n2}, n3});
            else return Form::intersect(ray, Box<P>{{n0, n1, n2}, {n3, number(4), number(5)}}, P::load(tmax ? tmax + i : nowhere));
        }();
        hit.t.store(t + i);
        hit.near.store(near + i);
        hit.far.store(far + i);
        bool decision[P::lanes];
        hit.hit.store(decision);
        std::memcpy(decisions + i, decision, P::lanes);
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
