#include "measure/picture/blockers.hpp"

#include <algorithm>

#include "intersect/process/parallel.hpp"
#include "intersect/simd/packed.hpp"

namespace lostbits::measure::picture {
namespace {

template <class S>
std::vector<S> stored(const std::vector<double>& x, std::size_t begin, std::size_t count) {
    std::vector<S> y(count);
    std::transform(x.begin() + static_cast<std::ptrdiff_t>(begin),
                   x.begin() + static_cast<std::ptrdiff_t>(begin + count), y.begin(),
                   [](double v) { return static_cast<S>(v); });
    return y;
}

struct Part {
    std::size_t begin, count;
    bool own_counts;
};

/// One chunk of shadow rays against all solids.
template <class S, class Kernel>
void compare_against(const Kernel& kernel, const ShadowRays& shadow, std::span<const Solid<double>> solids,
                     const Part& part, std::vector<std::uint8_t>& blocked) {
    const auto [begin, count, own_counts] = part;
    const scene::rays::RayBlock& r = shadow.rays;
    const auto ox = stored<S>(r.ox, begin, count), oy = stored<S>(r.oy, begin, count),
               oz = stored<S>(r.oz, begin, count);
    const auto dx = stored<S>(r.dx, begin, count), dy = stored<S>(r.dy, begin, count),
               dz = stored<S>(r.dz, begin, count);
    const intersect::table::RayBatch<S> batch{ox, oy, oz, dx, dy, dz};
    std::vector<S> t(count), near(count), far(count);
    std::vector<std::uint8_t> hit(count);
    for (std::size_t s = 0; s < solids.size(); ++s) {
        kernel(batch, transformed(solids[s], [](double x) { return static_cast<S>(x); }),
               intersect::table::HitBatch<S>{t, near, far, hit});
        for (std::size_t i = 0; i < count; ++i) {
            const std::size_t p = begin + i;
            const bool own = shadow.own[p] == static_cast<std::int32_t>(s);
            if (hit[i] == 0 || (own && !own_counts)) continue;
            const auto at = static_cast<double>(t[i]);
            if (at > 0 && at < shadow.reach[p]) blocked[p] |= own ? blocked_by_own : blocked_by_other;
        }
    }
}

}  // namespace

void ShadowRays::add(const Vec<double>& origin, const Vec<double>& direction, double light_t, std::int32_t leaves) {
    rays.ox.push_back(origin.x);
    rays.oy.push_back(origin.y);
    rays.oz.push_back(origin.z);
    rays.dx.push_back(direction.x);
    rays.dy.push_back(direction.y);
    rays.dz.push_back(direction.z);
    reach.push_back(light_t);
    own.push_back(leaves);
}

std::vector<std::uint8_t> find_blockers(const intersect::table::Intersector& form, const Format& format,
                                        const ShadowRays& shadow, const truth::FormatInputs& among, bool own_counts) {
    std::vector<std::uint8_t> blocked(shadow.rays.size(), blocked_by_nothing);
    const intersect::simd::PackedRow native = intersect::simd::packed_kernels(form);
    constexpr std::size_t chunk = 4096;
    const std::size_t chunks = (blocked.size() + chunk - 1) / chunk;
    intersect::process::in_parallel(std::size_t{0}, chunks, [&](std::size_t c) {
        among.stop.check();
        const std::size_t begin = c * chunk, count = std::min(chunk, blocked.size() - begin);
        with_kernel(form, native, format, [&]<class S>(const auto& kernel) {
            compare_against<S>(kernel, shadow, among.solids.listed(), {begin, count, own_counts}, blocked);
        });
    });
    return blocked;
}

}  // namespace lostbits::measure::picture
