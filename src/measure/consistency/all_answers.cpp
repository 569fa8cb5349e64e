// Computes all numbers that a form answers, with one call for each ray or for a batch of rays, and with the kernels of
// every register width.
#include <algorithm>
#include <bit>
#include <cmath>

#include "measure/answer/chunk.hpp"
#include "measure/consistency/check.hpp"

namespace lostbits::measure::consistency {

using scene::rays::RayBlock;

namespace {

/// True if a and b have the same bits, or are both NaN.
bool has_same_bits(double a, double b) {
    return std::bit_cast<std::uint64_t>(a) == std::bit_cast<std::uint64_t>(b) || (std::isnan(a) && std::isnan(b));
}

CheckResult compare_answers(const intersect::Info& info, const AllAnswers& a, const AllAnswers& b, std::size_t i) {
    if (a.hit[i] != b.hit[i]) return a.hit[i] != 0 ? CheckResult::first_alone : CheckResult::second_alone;
    if (a.hit[i] == 0 || !returns_t(info)) return CheckResult::agree;
    const bool has_both_roots = info.roots == intersect::Roots::both;
    const bool is_same_answer =
        has_same_bits(a.t[i], b.t[i]) &&
        (!has_both_roots || (has_same_bits(a.near[i], b.near[i]) && has_same_bits(a.far[i], b.far[i])));
    return is_same_answer ? CheckResult::agree : CheckResult::other_number;
}

}  // namespace

AllAnswers evaluate_all(const FormKernels& kernels, const RayBlock& rays, std::span<const Primitive<double>> primitives,
                        CallGrouping grouping) {
    AllAnswers answers;
    const std::size_t n = rays.size();
    intersect::simd::with_kernel(kernels.form, kernels.native, kernels.format, [&]<class S>(const auto& kernel) {
        std::vector<Primitive<S>> stored;
        for (const Primitive<double>& primitive : primitives) stored.push_back(lift_primitive<S>(primitive));
        const std::span<const Primitive<S>> targets = stored;
        answer::KernelBuffers<S> buffers(rays);
        for (const double end : rays.tmax) buffers.columns[buffers.tmax_column].push_back(static_cast<S>(end));

        // A call takes primitives of one shape.
        const auto batch_end = [&](std::size_t begin) {
            if (grouping == CallGrouping::one_by_one) return begin + 1;
            if (targets.size() == 1) return n;
            const auto has_other_shape = [&](const Primitive<S>& primitive) {
                return primitive.shape != targets[begin].shape;
            };
            return static_cast<std::size_t>(std::ranges::find_if(targets.subspan(begin), has_other_shape) -
                                            targets.begin());
        };

        for (std::size_t begin = 0, end = 0; begin < n; begin = end) {
            kernels.stop.check();
            end = batch_end(begin);
            const auto batch_targets = targets.size() == 1 ? targets : targets.subspan(begin, end - begin);
            kernel(buffers.rays(begin, end), intersect::Target<S>(batch_targets), buffers.hits(begin, end));
        }

        const auto widen = [](const std::vector<S>& column) {
            return std::vector<double>(column.begin(), column.end());
        };
        answers = {widen(buffers.t), widen(buffers.near), widen(buffers.far), buffers.hit};
    });
    return answers;
}

bool returns_t(const intersect::Info& info) { return info.roots != intersect::Roots::none; }

std::vector<std::uint8_t> find_hits_before_tmax(const FormKernels& kernels, const RayBlock& rays,
                                                const Primitive<double>& primitive) {
    std::vector<std::uint8_t> meets;
    const bool form_checks_tmax = takes_tmax(primitive.shape);
    const bool has_both_roots = kernels.form.form_for(primitive.shape).info->roots == intersect::Roots::both;
    const AllAnswers a = evaluate_all(kernels, rays, std::span(&primitive, 1));
    for (std::size_t i = 0; i < a.size(); ++i) {
        const auto is_ahead = [end = rays.tmax[i]](double t) { return t > 0 && t < end; };
        const bool is_any_ahead = form_checks_tmax || is_ahead(a.t[i]) || (has_both_roots && is_ahead(a.far[i]));
        meets.push_back(static_cast<std::uint8_t>(a.hit[i] != 0 && is_any_ahead));
    }
    return meets;
}

std::vector<std::uint8_t> find_hits_before_tmax(const FormOnBand& band_form, const RayBlock& all_rays) {
    std::vector<std::uint8_t> meets(all_rays.size());
    band_form.for_each_primitive(
        all_rays, [&](const Primitive<double>& primitive, const RayBlock& rays, const auto& ray_indices) {
            const std::vector<std::uint8_t> primitive_meets = find_hits_before_tmax(band_form.kernels, rays, primitive);
            for (std::size_t k = 0; k < ray_indices.size(); ++k) meets[ray_indices[k]] |= primitive_meets[k];
        });
    return meets;
}

void check_packs(const FormOnBand& band_form, PixelCheckResults& out) {
    const intersect::Info& info = *band_form.tested_form.form->info;
    std::vector<FormKernels> kernels_by_width;
    const bool is_software = band_form.tested_form.format.is_emulated();  // software formats have no registers
    for (const intersect::simd::Isa isa : intersect::simd::available_isas()) {
        if (!is_software || isa == intersect::simd::Isa::scalar)
            kernels_by_width.emplace_back(*band_form.tested_form.form, band_form.tested_form.format,
                                          band_form.kernels.stop, isa);
    }

    // Calls the kernels of each width for many rays at a time, and compares with calls for single rays.
    band_form.for_each_primitive(
        band_form.rays(), [&](const Primitive<double>& primitive, const RayBlock& rays, const auto& ray_indices) {
            const std::span<const Primitive<double>> target(&primitive, 1);
            const AllAnswers single_answers = evaluate_all(band_form.kernels, rays, target, CallGrouping::one_by_one);
            for (const FormKernels& width_kernels : kernels_by_width) {
                const AllAnswers batch_answers = evaluate_all(width_kernels, rays, target);
                for (std::size_t k = 0; k < ray_indices.size(); ++k) {
                    const std::size_t i = ray_indices[k];
                    if (is_disagreement(out.results[i])) continue;
                    const Ray<double> ray = band_form.inputs.rays[i];
                    out.set(i, compare_answers(info, single_answers, batch_answers, k), [&] {
                        return RayPair{i, band_form.group_to_explain(ray, HUGE_VAL),
                                       band_form.group_to_explain(ray, HUGE_VAL)};
                    });
                }
            }
        });
}

}  // namespace lostbits::measure::consistency
