// Computes all numbers that a form answers, for rays one by one and together, with the kernels of every register width.
#include <algorithm>
#include <bit>
#include <cmath>

#include "measure/answer/chunk.hpp"
#include "measure/consistency/check.hpp"

namespace lostbits::measure::consistency {

using scene::rays::RayBlock;

namespace {

/// True for the same bits, and for two NaN.
bool is_same(double a, double b) {
    return std::bit_cast<std::uint64_t>(a) == std::bit_cast<std::uint64_t>(b) || (std::isnan(a) && std::isnan(b));
}

CheckResult compare_answers(const intersect::Info& info, const AllAnswers& a, const AllAnswers& b, std::size_t i) {
    if (a.hit[i] != b.hit[i]) return a.hit[i] != 0 ? CheckResult::first_alone : CheckResult::second_alone;
    if (a.hit[i] == 0 || !tells_t(info)) return CheckResult::agree;
    const bool both = info.roots == intersect::Roots::both;
    const bool same =
        is_same(a.t[i], b.t[i]) && (!both || (is_same(a.near[i], b.near[i]) && is_same(a.far[i], b.far[i])));
    return same ? CheckResult::agree : CheckResult::other_number;
}

}  // namespace

AllAnswers answers_of(const FormKernels& kernels, const RayBlock& rays, std::span<const Primitive<double>> primitives,
                      Calls calls) {
    AllAnswers answers;
    const std::size_t n = rays.size();
    intersect::simd::with_kernel(kernels.form, kernels.native, kernels.format, [&]<class S>(const auto& kernel) {
        std::vector<Primitive<S>> stored;
        for (const Primitive<double>& primitive : primitives) stored.push_back(lift_primitive<S>(primitive));
        const std::span<const Primitive<S>> all = stored;
        answer::KernelBuffers<S> buffers(rays);
        for (const double end : rays.tmax) buffers.columns[6].push_back(static_cast<S>(end));
        // A target has primitives of one shape.
        const auto end_of = [&](std::size_t begin) {
            if (calls == Calls::one_by_one) return begin + 1;
            if (all.size() == 1) return n;
            const auto other = [&](const Primitive<S>& primitive) { return primitive.shape != all[begin].shape; };
            return static_cast<std::size_t>(std::ranges::find_if(all.subspan(begin), other) - all.begin());
        };
        for (std::size_t begin = 0, end = 0; begin < n; begin = end) {
            kernels.stop.check();
            end = end_of(begin);
            const auto own = all.size() == 1 ? all : all.subspan(begin, end - begin);
            kernel(buffers.rays(begin, end), intersect::Target<S>(own), buffers.hits(begin, end));
        }
        const auto wide = [](const std::vector<S>& told) { return std::vector<double>(told.begin(), told.end()); };
        answers = {wide(buffers.t), wide(buffers.near), wide(buffers.far), buffers.hit};
    });
    return answers;
}

bool tells_t(const intersect::Info& info) { return info.roots != intersect::Roots::none; }

std::vector<std::uint8_t> meets_before_end(const FormKernels& kernels, const RayBlock& rays,
                                           const Primitive<double>& primitive) {
    std::vector<std::uint8_t> meets;
    const bool told = takes_tmax(primitive.shape);
    const bool both = kernels.form.of(primitive.shape).info->roots == intersect::Roots::both;
    const AllAnswers a = answers_of(kernels, rays, std::span(&primitive, 1));
    for (std::size_t i = 0; i < a.size(); ++i) {
        const auto ahead = [end = rays.tmax[i]](double t) { return t > 0 && t < end; };
        const bool any = told || ahead(a.t[i]) || (both && ahead(a.far[i]));
        meets.push_back(static_cast<std::uint8_t>(a.hit[i] != 0 && any));
    }
    return meets;
}

std::vector<std::uint8_t> meets_before_end(const FormOnBand& band_form, const RayBlock& all) {
    std::vector<std::uint8_t> meets(all.size());
    band_form.by_primitive(all, [&](const Primitive<double>& primitive, const RayBlock& rays, const auto& places) {
        const std::vector<std::uint8_t> one = meets_before_end(band_form.form, rays, primitive);
        for (std::size_t k = 0; k < places.size(); ++k) meets[places[k]] |= one[k];
    });
    return meets;
}

void check_packs(const FormOnBand& band_form, PixelCheckResults& out) {
    const intersect::Info& info = *band_form.row.form->info;
    std::vector<FormKernels> widths;
    const bool software = band_form.row.format.engine == Format::Engine::rounded;  // software formats have no registers
    for (const intersect::simd::Isa isa : intersect::simd::available_isas()) {
        if (!software || isa == intersect::simd::Isa::scalar)
            widths.emplace_back(*band_form.row.form, band_form.row.format, band_form.form.stop, isa);
    }
    band_form.by_primitive(
        band_form.rays(), [&](const Primitive<double>& primitive, const RayBlock& rays, const auto& places) {
            const std::span<const Primitive<double>> one(&primitive, 1);
            const AllAnswers alone = answers_of(band_form.form, rays, one, Calls::one_by_one);
            for (const FormKernels& width : widths) {
                const AllAnswers together = answers_of(width, rays, one);
                for (std::size_t k = 0; k < places.size(); ++k) {
                    const std::size_t i = places[k];
                    if (is_disagreement(out.results[i])) continue;
                    const Ray<double> ray = band_form.inputs.rays[i];
                    out.set(i, compare_answers(info, alone, together, k), [&] {
                        return TwoRays{i, band_form.shown(ray, HUGE_VAL), band_form.shown(ray, HUGE_VAL)};
                    });
                }
            }
        });
}

}  // namespace lostbits::measure::consistency
