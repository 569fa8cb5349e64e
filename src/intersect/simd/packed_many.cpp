#include "intersect/simd/packed_many.hpp"

#include <algorithm>
#include <iterator>

#include "intersect/simd/of_width.hpp"
#include "intersect/simd/packed_target.hpp"
#include "intersect/table/fill_forms.hpp"

namespace lostbits::intersect::simd {
namespace {

template <class F>
struct RayNumbers {
    F numbers[6];
    explicit RayNumbers(const Ray<F>& ray)
        : numbers{ray.origin.x, ray.origin.y, ray.origin.z, ray.direction.x, ray.direction.y, ray.direction.z} {}
};

/// Runs the kernel on the primitives after the last whole register, in buffers of a register's size.
template <class F>
[[gnu::noinline]] void run_primitive_tail(void (*kernel)(const RawPrimitives<F>&), std::size_t lane_count,
                                          const RawPrimitives<F>& all) {
    const std::size_t rest_count = all.size % lane_count, whole_count = all.size - rest_count;
    RegisterColumn<F> numbers[std::extent_v<decltype(RawPrimitives<F>::numbers)>], t;
    std::uint8_t hit[sizeof t.lanes / sizeof(F)];
    RawPrimitives<F> part{.ray = all.ray, .numbers = {}, .t = t.lanes, .hit = hit, .size = lane_count};
    for (std::size_t c = 0; c < std::size(numbers) && all.numbers[c]; ++c) {
        numbers[c].fill(all.numbers[c] + whole_count, rest_count, lane_count);
        part.numbers[c] = numbers[c].lanes;
    }
    t.fill(all.t + whole_count, rest_count, lane_count);
    kernel(part);
    std::copy_n(t.lanes, rest_count, all.t + whole_count);
    if (all.hit) std::copy_n(hit, rest_count, all.hit + whole_count);
}

/// Runs the kernel on the primitives that do not fill a register, then on the whole registers.
template <class F>
void run_primitives(void (*kernel)(const RawPrimitives<F>&), std::size_t lane_count, const Ray<F>& ray,
                    const PrimitiveArrays<F>& primitives, std::span<F> t, std::span<std::uint8_t> hit) {
    const RayNumbers<F> r(ray);
    RawPrimitives<F> all{r.numbers, {}, t.data(), hit.data(), primitives.size()};
    std::ranges::transform(primitives.numbers, all.numbers, [](const auto& column) { return column.data(); });
    if (all.size % lane_count) run_primitive_tail<F>(kernel, lane_count, all);
    all.size -= all.size % lane_count;
    if (all.size) kernel(all);
}

std::span<const ManyFormKernels> scalar_many_rows() {
    static const auto rows = [] {
        std::vector<ManyFormKernels> filled;
        append_many_kernels<FirstForms>(filled);
        append_many_kernels<SecondForms>(filled);
        return filled;
    }();
    return rows;
}

/// The rows for a register width. The functions were compiled for that width.
std::vector<ManyFormKernels> rows_for_width(Isa isa) {
    using Fill = RawManyFormKernels*(RawManyFormKernels*);
    constexpr FunctionOfWidth<Fill> fill_first = LOSTBITS_OF_EACH_WIDTH(fill_many, <FirstForms>);
    constexpr FunctionOfWidth<Fill> fill_second = LOSTBITS_OF_EACH_WIDTH(fill_many, <SecondForms>);
    const auto scalar = scalar_many_rows();
    std::vector<RawManyFormKernels> raw(scalar.size());
    fill_second.at(isa)(fill_first.at(isa)(raw.data()));
    std::vector<ManyFormKernels> rows(scalar.begin(), scalar.end());
    for (std::size_t i = 0; i < rows.size(); ++i) {
        if (rows[i].f32) rows[i].f32 = {raw[i].f32, bytes_of(isa) / sizeof(float)};
        if (rows[i].f64) rows[i].f64 = {raw[i].f64, bytes_of(isa) / sizeof(double)};
    }
    return rows;
}

}  // namespace

template <class S>
void ManyKernel<S>::operator()(const Ray<S>& ray, const PrimitiveArrays<S>& primitives, std::span<S> t,
                               std::span<std::uint8_t> hit) const {
    if (plain_) plain_(ray, primitives, t, hit);
    else run_primitives<S>(packed_, lane_count_, ray, primitives, t, hit);
}

template class ManyKernel<float>;
template class ManyKernel<double>;

ManyFormKernels many_kernels(const table::Intersector& form) {
    const auto catalogue = table::catalogue();
    for (std::size_t i = 0; i < catalogue.size(); ++i) {
        if (catalogue[i].info == form.info && catalogue[i].native32 == form.native32 &&
            catalogue[i].native64 == form.native64)
            return all_many_kernels(current_isa())[i];
    }
    ManyFormKernels no_kernels;
    no_kernels.info = form.info;
    return no_kernels;
}

std::span<const ManyFormKernels> all_many_kernels(Isa isa) {
    if (all_packed_kernels(isa).empty()) return {};
    if (isa == Isa::scalar) return scalar_many_rows();
    return with_width(isa, []<Isa width>() -> std::span<const ManyFormKernels> {
        static const auto rows = rows_for_width(width);
        return rows;
    });
}

}  // namespace lostbits::intersect::simd
