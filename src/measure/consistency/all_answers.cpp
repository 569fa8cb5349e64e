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

Accord compare_answers(const intersect::Info& info, const AllAnswers& a, const AllAnswers& b, std::size_t i) {
    if (a.hit[i] != b.hit[i]) return a.hit[i] != 0 ? Accord::first_alone : Accord::second_alone;
    if (a.hit[i] == 0 || !tells_t(info)) return Accord::agree;
    const bool both = info.roots == intersect::Roots::both;
    const bool same =
        is_same(a.t[i], b.t[i]) && (!both || (is_same(a.near[i], b.near[i]) && is_same(a.far[i], b.far[i])));
    return same ? Accord::agree : Accord::other_number;
}

}  // namespace

AllAnswers ask(const AskedForm& asked, const RayBlock& rays, std::span<const Solid<double>> solids, Calls calls) {
    AllAnswers answers;
    const std::size_t n = rays.size();
    intersect::simd::with_kernel(asked.form, asked.native, asked.format, [&]<class S>(const auto& kernel) {
        std::vector<Solid<S>> stored;
        for (const Solid<double>& solid : solids) stored.push_back(lift_solid<S>(solid));
        const std::span<const Solid<S>> all = stored;
        answer::KernelRoom<S> room(rays);
        for (const double end : rays.tmax) room.columns[6].push_back(static_cast<S>(end));
        // A target has primitives of one shape.
        const auto end_of = [&](std::size_t begin) {
            if (calls == Calls::one_by_one) return begin + 1;
            if (all.size() == 1) return n;
            const auto other = [&](const Solid<S>& solid) { return solid.shape != all[begin].shape; };
            return static_cast<std::size_t>(std::ranges::find_if(all.subspan(begin), other) - all.begin());
        };
        for (std::size_t begin = 0, end = 0; begin < n; begin = end) {
            asked.stop.check();
            end = end_of(begin);
            const auto own = all.size() == 1 ? all : all.subspan(begin, end - begin);
            kernel(room.rays(begin, end), intersect::Target<S>(own), room.hits(begin, end));
        }
        const auto wide = [](const std::vector<S>& told) { return std::vector<double>(told.begin(), told.end()); };
        answers = {wide(room.t), wide(room.near), wide(room.far), room.hit};
    });
    return answers;
}

bool tells_t(const intersect::Info& info) { return info.roots != intersect::Roots::none; }

std::vector<std::uint8_t> meets_before_end(const AskedForm& asked, const RayBlock& rays,
                                           std::span<const Solid<double>> solids) {
    std::vector<std::uint8_t> meets(rays.size());
    for (const Solid<double>& solid : solids) {
        const bool told = told_end(solid.shape);
        const bool both = asked.form.of(solid.shape).info->roots == intersect::Roots::both;
        const AllAnswers a = ask(asked, rays, std::span(&solid, 1));
        for (std::size_t i = 0; i < meets.size(); ++i) {
            const auto ahead = [end = rays.tmax[i]](double t) { return t > 0 && t < end; };
            const bool any = told || ahead(a.t[i]) || (both && ahead(a.far[i]));
            meets[i] |= static_cast<std::uint8_t>(a.hit[i] != 0 && any);
        }
    }
    return meets;
}

void check_packs(const RowOnBand& on, AccordOfPixels& out) {
    const intersect::Info& info = *on.row.form->info;
    std::vector<AskedForm> widths;
    const bool software = on.row.format.engine == Format::Engine::rounded;  // software formats have no registers
    for (const intersect::simd::Isa isa : intersect::simd::available_isas()) {
        if (!software || isa == intersect::simd::Isa::scalar)
            widths.emplace_back(*on.row.form, on.row.format, on.form.stop, isa);
    }
    for (const Solid<double>& solid : on.solids) {
        const std::span<const Solid<double>> one(&solid, 1);
        const AllAnswers alone = ask(on.form, on.rays(), one, Calls::one_by_one);
        for (const AskedForm& width : widths) {
            const AllAnswers together = ask(width, on.rays(), one);
            for (std::size_t i = 0; i < on.pixels(); ++i) {
                if (is_disagreement(out.accord[i])) continue;
                const Ray<double> ray = on.inputs.rays[i];
                out.set(i, compare_answers(info, alone, together, i), [&] {
                    return TwoRays{i, on.shown(ray, HUGE_VAL), on.shown(ray, HUGE_VAL)};
                });
            }
        }
    }
}

}  // namespace lostbits::measure::consistency
