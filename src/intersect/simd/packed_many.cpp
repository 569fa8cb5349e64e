#include "intersect/simd/packed_many.hpp"

#include <algorithm>
#include <utility>

#include "intersect/catalogue.hpp"
#include "intersect/simd/packed_target.hpp"
#include "intersect/table/kernels.hpp"

namespace lostbits::intersect::simd {
namespace {

template <class F>
using Kernel = void (*)(const RawSolids<F>&);

template <class F>
struct RayNumbers {
    F numbers[6];
    explicit RayNumbers(const Ray<F>& ray)
        : numbers{ray.origin.x, ray.origin.y, ray.origin.z, ray.direction.x, ray.direction.y, ray.direction.z} {}
};

/// The solids after the last whole register, in buffers of a register's size.
template <class F>
[[gnu::noinline]] void run_tail(Kernel<F> kernel, std::size_t lanes, std::size_t columns, const RawSolids<F>& all) {
    const std::size_t left = all.size % lanes, whole = all.size - left;
    RegisterColumn<F> numbers[6], t;
    std::uint8_t hit[sizeof t.lanes / sizeof(F)];
    RawSolids<F> part{.ray = all.ray, .numbers = {}, .t = t.lanes, .hit = hit, .size = lanes};
    for (std::size_t c = 0; c < columns; ++c) {
        numbers[c].fill(all.numbers[c] + whole, left, lanes);
        part.numbers[c] = numbers[c].lanes;
    }
    t.fill(all.t + whole, left, lanes);
    kernel(part);
    std::copy_n(t.lanes, left, all.t + whole);
    if (all.hit) std::copy_n(hit, left, all.hit + whole);
}

template <Isa isa>
const std::array<RawManyRow, form_count>& raw_rows() {
    static const auto rows = [] {
        std::array<RawManyRow, form_count> filled{};
        if constexpr (isa == Isa::w128) fill_many_w128(filled.data());
#if defined(LOSTBITS_PACKED_X86)
        if constexpr (isa == Isa::w256) fill_many_w256(filled.data());
        if constexpr (isa == Isa::w512) fill_many_w512(filled.data());
#endif
        return filled;
    }();
    return rows;
}

template <Isa isa, std::size_t form, class F>
void run_row(std::size_t columns, RawSolids<F> all) {
    constexpr std::size_t lanes = (isa == Isa::w512 ? 64 : isa == Isa::w256 ? 32 : 16) / sizeof(F);
    const RawManyRow& row = raw_rows<isa>()[form];
    Kernel<F> kernel;
    if constexpr (std::is_same_v<F, float>) kernel = row.f32;
    else kernel = row.f64;
    if (all.size % lanes) run_tail(kernel, lanes, columns, all);
    all.size -= all.size % lanes;
    if (all.size) kernel(all);
}

template <Isa isa, std::size_t form, class F>
void boxes(const Ray<F>& ray, const BoxArrays<F>& b, std::span<F> t) {
    const RayNumbers<F> r(ray);
    run_row<isa, form, F>(6,
                          {r.numbers,
                           {b.lo_x.data(), b.lo_y.data(), b.lo_z.data(), b.hi_x.data(), b.hi_y.data(), b.hi_z.data()},
                           t.data(),
                           nullptr,
                           b.size()});
}

template <Isa isa, std::size_t form, class F>
void spheres(const Ray<F>& ray, const SphereArrays<F>& s, std::span<F> t, std::span<std::uint8_t> hit) {
    const RayNumbers<F> r(ray);
    run_row<isa, form, F>(4, {r.numbers,
                              {s.x.data(), s.y.data(), s.z.data(), s.radius.data(), nullptr, nullptr},
                              t.data(),
                              hit.data(),
                              s.size()});
}

template <class Form, class F>
void scalar_boxes(const Ray<F>& ray, const BoxArrays<F>& b, std::span<F> t) {
    for (std::size_t i = 0; i < b.size(); ++i) {
        const Box<F> box{{b.lo_x[i], b.lo_y[i], b.lo_z[i]}, {b.hi_x[i], b.hi_y[i], b.hi_z[i]}};
        const Hit<F> hit = Form::intersect(ray, box, t[i]);
        t[i] = hit.hit ? hit.t : t[i];
    }
}

template <class Form, class F>
void scalar_spheres(const Ray<F>& ray, const SphereArrays<F>& s, std::span<F> t, std::span<std::uint8_t> hit) {
    for (std::size_t i = 0; i < s.size(); ++i) {
        const Hit<F> h = Form::intersect(ray, Sphere<F>{{s.x[i], s.y[i], s.z[i]}, s.radius[i]});
        t[i] = h.t;
        hit[i] = h.hit;
    }
}

/// Row `form` of the table: `boxes<F>()` and `spheres<F>()` give the kernels of its shape.
template <class Form, class Boxes, class Spheres>
ManyRow row_of(Boxes boxes, Spheres spheres) {
    ManyRow row{&Form::info, nullptr, nullptr, nullptr, nullptr};
    constexpr bool has64 = Form::info.formats == Formats::all;
    if constexpr (shape_of<Form> == Shape::sphere) {
        row.spheres32 = spheres.template operator()<float>();
        if constexpr (has64) row.spheres64 = spheres.template operator()<double>();
    } else if constexpr (shape_of<Form> == Shape::box) {
        row.boxes32 = boxes.template operator()<float>();
        if constexpr (has64) row.boxes64 = boxes.template operator()<double>();
    }
    return row;
}

std::span<const ManyRow> scalar_rows() {
    static const auto rows = [] {
        std::array<ManyRow, form_count> filled{};
        std::size_t i = 0;
        for_each_form([&]<class Form>() {
            filled[i++] = row_of<Form>([]<class F>() -> ManyBoxes<F> { return scalar_boxes<Form, F>; },
                                       []<class F>() -> ManySpheres<F> { return scalar_spheres<Form, F>; });
        });
        return filled;
    }();
    return rows;
}

template <Isa isa>
std::span<const ManyRow> rows_of() {
    static const auto rows = []<std::size_t... form>(std::index_sequence<form...>) {
        std::array<ManyRow, form_count> filled{};
        const auto scalar = scalar_rows();
        const auto fill = [&]<std::size_t i>() {
            const ManyRow& s = scalar[i];
            filled[i] = {s.info, s.boxes32 ? boxes<isa, i, float> : nullptr,
                         s.boxes64 ? boxes<isa, i, double> : nullptr, s.spheres32 ? spheres<isa, i, float> : nullptr,
                         s.spheres64 ? spheres<isa, i, double> : nullptr};
        };
        (fill.template operator()<form>(), ...);
        return filled;
    }
    (std::make_index_sequence<form_count>{});
    return rows;
}

}  // namespace

ManyRow many_kernels(const table::Intersector& form) {
    const auto table = table::catalogue();
    for (std::size_t i = 0; i < table.size(); ++i) {
        if (table[i].info == form.info && table[i].native32 == form.native32 && table[i].native64 == form.native64)
            return many_rows(current_isa())[i];
    }
    return {form.info, nullptr, nullptr, nullptr, nullptr};
}

std::span<const ManyRow> many_rows(Isa isa) {
    if (packed_rows(isa).empty()) return {};
    switch (isa) {
        case Isa::scalar: return scalar_rows();
        case Isa::w128: return rows_of<Isa::w128>();
        case Isa::w256: return rows_of<Isa::w256>();
        case Isa::w512: return rows_of<Isa::w512>();
    }
    return {};
}

}  // namespace lostbits::intersect::simd
