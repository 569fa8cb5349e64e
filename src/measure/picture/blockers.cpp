#include "measure/picture/blockers.hpp"

#include <algorithm>

#include "intersect/process/parallel.hpp"
#include "intersect/simd/packed.hpp"
#include "measure/answer/chunk.hpp"

namespace lostbits::measure::picture {
namespace {

struct Part {
    std::size_t begin, count;
    bool tests_left_sphere;
};

/// Tests one chunk of shadow rays against all primitives.
template <class S, class Kernel>
void compare_against(const Kernel& kernel, const ShadowRays& shadow, std::span<const Primitive<double>> primitives,
                     const Part& part, std::vector<std::uint8_t>& blocked) {
    const auto [begin, count, tests_left_sphere] = part;
    answer::KernelBuffers<S> buffers(shadow.rays, begin, count);
    for (std::size_t s = 0; s < primitives.size(); ++s) {
        kernel(buffers.rays(), lift_primitive<S>(primitives[s]), buffers.hits());
        for (std::size_t i = 0; i < count; ++i) {
            const std::size_t p = begin + i;
            const bool is_left_sphere = shadow.left_sphere[p] == static_cast<std::int32_t>(s);
            if (buffers.hit[i] == 0 || (is_left_sphere && !tests_left_sphere)) continue;
            const auto at = static_cast<double>(buffers.t[i]);
            if (at > 0 && at < shadow.reach[p])
                blocked[p] |= is_left_sphere ? blocked_by_left_sphere : blocked_by_other;
        }
    }
}

}  // namespace

void ShadowRays::add(const Vec<double>& origin, const Vec<double>& direction, double light_t, std::int32_t leaves) {
    rays.push({origin, direction});
    reach.push_back(light_t);
    left_sphere.push_back(leaves);
}

std::vector<std::uint8_t> find_blockers(const intersect::table::Intersector& form, const Format& format,
                                        const ShadowRays& shadow, const truth::FormatInputs& among,
                                        bool tests_left_sphere) {
    std::vector<std::uint8_t> blocked(shadow.rays.size(), blocked_by_nothing);
    const intersect::simd::PackedRow native = intersect::simd::packed_kernels(form);
    constexpr std::size_t chunk = 4096;
    const std::size_t chunks = (blocked.size() + chunk - 1) / chunk;
    intersect::process::in_parallel(std::size_t{0}, chunks, [&](std::size_t c) {
        among.stop.check();
        const std::size_t begin = c * chunk, count = std::min(chunk, blocked.size() - begin);
        with_kernel(form, native, format, [&]<class S>(const auto& kernel) {
            compare_against<S>(kernel, shadow, among.primitives.listed(), {begin, count, tests_left_sphere}, blocked);
        });
    });
    return blocked;
}

}  // namespace lostbits::measure::picture
