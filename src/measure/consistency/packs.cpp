// Rays one by one, and together: by the kernels of one ray and by those of every register width.
#include <bit>
#include <cmath>

#include "measure/consistency/check.hpp"

namespace lostbits::measure::consistency {

namespace {

/// The same bits; a NaN is a NaN.
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

void check_packs(const RowOnBand& on, AccordOfPixels& out) {
    const intersect::Info& info = *on.row.form->info;
    std::vector<AskedForm> widths;
    const bool software = on.row.format.engine == Format::Engine::rounded;  // which has no registers
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
