#include "measure/render/blockers.hpp"

#include <algorithm>

#include "intersect/process/parallel.hpp"
#include "intersect/simd/packed.hpp"
#include "measure/answer/chunk.hpp"

namespace lostbits::measure::render {
namespace {

struct Chunk {
    std::size_t begin, count;
    bool tests_departed_sphere;
};

/// Tests one chunk of shadow rays against all primitives, and sets the bits of `blocked`.
template <class S, class Kernel>
void test_chunk(const Kernel& kernel, const ShadowRays& shadow, std::span<const Primitive<double>> primitives,
                const Chunk& chunk, std::vector<std::uint8_t>& blocked) {
    const auto [begin, count, tests_departed_sphere] = chunk;
    answer::KernelBuffers<S> buffers(shadow.rays, begin, count);
    for (std::size_t s = 0; s < primitives.size(); ++s) {
        kernel(buffers.rays(), lift_primitive<S>(primitives[s]), buffers.hits());
        for (std::size_t i = 0; i < count; ++i) {
            const std::size_t ray_index = begin + i;
            const bool is_departed_sphere = shadow.departed_sphere[ray_index] == static_cast<std::int32_t>(s);
            if (buffers.hit[i] == 0 || (is_departed_sphere && !tests_departed_sphere)) continue;
            const auto t = static_cast<double>(buffers.t[i]);
            if (t > 0 && t < shadow.reach[ray_index])
                blocked[ray_index] |= is_departed_sphere ? blocked_by_departed_sphere : blocked_by_other;
        }
    }
}

}  // namespace

void ShadowRays::add(const Vec<double>& origin, const Vec<double>& direction, double light_t,
                     std::int32_t departed_sphere_index) {
    rays.push({origin, direction});
    reach.push_back(light_t);
    departed_sphere.push_back(departed_sphere_index);
}

std::vector<std::uint8_t> find_blockers(const intersect::table::Intersector& form, const Format& format,
                                        const ShadowRays& shadow, const truth::FormatInputs& inputs,
                                        bool tests_departed_sphere) {
    std::vector<std::uint8_t> blocked(shadow.rays.size(), blocked_by_nothing);
    const intersect::simd::PackedFormKernels native = intersect::simd::packed_kernels(form);
    constexpr std::size_t chunk_size = 4096;
    const std::size_t chunk_count = (blocked.size() + chunk_size - 1) / chunk_size;
    intersect::process::in_parallel(std::size_t{0}, chunk_count, [&](std::size_t c) {
        inputs.stop.check();
        const std::size_t begin = c * chunk_size, count = std::min(chunk_size, blocked.size() - begin);
        with_kernel(form, native, format, [&]<class S>(const auto& kernel) {
            test_chunk<S>(kernel, shadow, inputs.primitives.listed_primitives(), {begin, count, tests_departed_sphere},
                          blocked);
        });
    });
    return blocked;
}

}  // namespace lostbits::measure::render
