// Every number that a form tells, ray by ray; and rays one by one and together, by the kernels of every register width.
#include <algorithm>
#include <array>
#include <bit>
#include <cmath>

#include "measure/consistency/check.hpp"

namespace lostbits::measure::consistency {

using intersect::table::HitBatch;
using intersect::table::RayBatch;
using scene::rays::RayBlock;

namespace {

template <class S>
std::vector<S> stored_as(const std::vector<double>& from) {
    std::vector<S> to(from.size());
    std::ranges::transform(from, to.begin(), [](double x) { return static_cast<S>(x); });
    return to;
}

/// Rays and answers in the storage of a kernel.
template <class S>
class StoredBatch {
public:
    explicit StoredBatch(const RayBlock& rays)
        : columns_{stored_as<S>(rays.ox),  stored_as<S>(rays.oy), stored_as<S>(rays.oz),  //
                   stored_as<S>(rays.dx),  stored_as<S>(rays.dy), stored_as<S>(rays.dz),  //
                   stored_as<S>(rays.tmax)} {
        for (auto* numbers : {&t_, &near_, &far_}) numbers->resize(rays.size());
        hit_.resize(rays.size());
    }

    [[nodiscard]] RayBatch<S> rays(std::size_t begin, std::size_t count) const {
        const auto part = [&](std::size_t k) {
            const std::span<const S> all = columns_[k];
            return all.empty() ? all : all.subspan(begin, count);
        };
        return {
            .ox = part(0), .oy = part(1), .oz = part(2), .dx = part(3), .dy = part(4), .dz = part(5), .tmax = part(6)};
    }
    [[nodiscard]] HitBatch<S> hits(std::size_t begin, std::size_t count) {
        const auto part = [&](auto& all) { return std::span(all).subspan(begin, count); };
        return {part(t_), part(near_), part(far_), part(hit_)};
    }
    [[nodiscard]] AllAnswers answers() && {
        const auto wide = [](const std::vector<S>& all) { return std::vector<double>(all.begin(), all.end()); };
        return {wide(t_), wide(near_), wide(far_), std::move(hit_)};
    }

private:
    std::array<std::vector<S>, 7> columns_;
    std::vector<S> t_, near_, far_;
    std::vector<std::uint8_t> hit_;
};

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

AllAnswers ask(const AskedForm& asked, const RayBlock& rays, std::span<const Solid<double>> solids, Calls calls) {
    AllAnswers answers;
    const std::size_t n = rays.size();
    intersect::simd::with_kernel(asked.form, asked.native, asked.format, [&]<class S>(const auto& kernel) {
        std::vector<Solid<S>> stored;
        for (const Solid<double>& solid : solids)
            stored.push_back(transformed(solid, [](double x) { return static_cast<S>(x); }));
        const std::span<const Solid<S>> all = stored;
        StoredBatch<S> batch(rays);
        // A target has solids of one shape.
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
            kernel(batch.rays(begin, end - begin), intersect::Target<S>(own), batch.hits(begin, end - begin));
        }
        answers = std::move(batch).answers();
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
