#include "intersect/simd/packed_many.hpp"

#include <algorithm>

#include "intersect/catalogue.hpp"
#include "intersect/simd/packed_target.hpp"
#include "intersect/table/kernels.hpp"

namespace lostbits::intersect::simd {
namespace {

template <class F>
struct RayNumbers {
    F numbers[6];
    explicit RayNumbers(const Ray<F>& ray)
        : numbers{ray.origin.x, ray.origin.y, ray.origin.z, ray.direction.x, ray.direction.y, ray.direction.z} {}
};

/// The solids after the last whole register, in buffers of a register's size.
template <class F>
[[gnu::noinline]] void run_tail(void (*kernel)(const RawSolids<F>&), std::size_t lanes, std::size_t columns,
                                const RawSolids<F>& all) {
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

/// Whole registers, then the rest.
template <class F>
void run_all(void (*kernel)(const RawSolids<F>&), std::size_t lanes, std::size_t columns, RawSolids<F> all) {
    if (all.size % lanes) run_tail<F>(kernel, lanes, columns, all);
    all.size -= all.size % lanes;
    if (all.size) kernel(all);
}

template <class F>
void run_packed(void (*kernel)(const RawSolids<F>&), std::size_t lanes, const Ray<F>& ray, const BoxArrays<F>& b,
                std::span<F> t) {
    const RayNumbers<F> r(ray);
    run_all<F>(kernel, lanes, 6,
               {r.numbers,
                {b.lo_x.data(), b.lo_y.data(), b.lo_z.data(), b.hi_x.data(), b.hi_y.data(), b.hi_z.data()},
                t.data(),
                nullptr,
                b.size()});
}

template <class F>
void run_packed(void (*kernel)(const RawSolids<F>&), std::size_t lanes, const Ray<F>& ray, const SphereArrays<F>& s,
                std::span<F> t, std::span<std::uint8_t> hit) {
    const RayNumbers<F> r(ray);
    run_all<F>(kernel, lanes, 4,
               {r.numbers,
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

std::span<const ManyRow> scalar_rows() {
    static const auto rows = [] {
        std::array<ManyRow, form_count> filled{};
        std::size_t i = 0;
        for_each_form([&]<class Form>() {
            ManyRow& row = filled[i++];
            row.info = &Form::info;
            constexpr bool has64 = Form::info.formats == Formats::all;
            if constexpr (shape_of<Form> == Shape::sphere) {
                row.spheres32 = scalar_spheres<Form, float>;
                if constexpr (has64) row.spheres64 = scalar_spheres<Form, double>;
            } else if constexpr (shape_of<Form> == Shape::box) {
                row.boxes32 = scalar_boxes<Form, float>;
                if constexpr (has64) row.boxes64 = scalar_boxes<Form, double>;
            }
        });
        return filled;
    }();
    return rows;
}

/// The rows of registers of so many bytes, which `fill` was compiled for.
std::array<ManyRow, form_count> rows_of(std::size_t bytes, void (*fill)(RawManyRow*)) {
    std::array<RawManyRow, form_count> raw{};
    fill(raw.data());
    std::array<ManyRow, form_count> rows{};
    for (std::size_t i = 0; i < form_count; ++i) {
        const ManyRow& scalar = scalar_rows()[i];
        rows[i].info = scalar.info;
        if (scalar.boxes32) rows[i].boxes32 = {raw[i].f32, bytes / sizeof(float)};
        if (scalar.boxes64) rows[i].boxes64 = {raw[i].f64, bytes / sizeof(double)};
        if (scalar.spheres32) rows[i].spheres32 = {raw[i].f32, bytes / sizeof(float)};
        if (scalar.spheres64) rows[i].spheres64 = {raw[i].f64, bytes / sizeof(double)};
    }
    return rows;
}

}  // namespace

template <class S, class Solids, class... Answers>
void ManyKernel<S, Solids, Answers...>::operator()(const Ray<S>& ray, const Solids& solids, Answers... answers) const {
    if (plain_) plain_(ray, solids, answers...);
    else run_packed<S>(packed_, lanes_, ray, solids, answers...);
}

template class ManyKernel<float, BoxArrays<float>, std::span<float>>;
template class ManyKernel<double, BoxArrays<double>, std::span<double>>;
template class ManyKernel<float, SphereArrays<float>, std::span<float>, std::span<std::uint8_t>>;
template class ManyKernel<double, SphereArrays<double>, std::span<double>, std::span<std::uint8_t>>;

ManyRow many_kernels(const table::Intersector& form) {
    const auto table = table::catalogue();
    for (std::size_t i = 0; i < table.size(); ++i) {
        if (table[i].info == form.info && table[i].native32 == form.native32 && table[i].native64 == form.native64)
            return many_rows(current_isa())[i];
    }
    ManyRow none;
    none.info = form.info;
    return none;
}

std::span<const ManyRow> many_rows(Isa isa) {
    if (packed_rows(isa).empty()) return {};
    if (isa == Isa::scalar) return scalar_rows();
#if defined(LOSTBITS_PACKED_X86)
    if (isa == Isa::w256) {
        static const auto w256 = rows_of(32, fill_many_w256);
        return w256;
    }
    if (isa == Isa::w512) {
        static const auto w512 = rows_of(64, fill_many_w512);
        return w512;
    }
#endif
    static const auto w128 = rows_of(16, fill_many_w128);
    return w128;
}

}  // namespace lostbits::intersect::simd
