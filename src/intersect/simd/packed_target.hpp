// Converts a batch and its target for the kernels of packed_raw.hpp, and runs the rays that do not fill a register.
#pragma once

#include <algorithm>
#include <vector>

#include "intersect/simd/packed_raw.hpp"
#include "intersect/table/table.hpp"

namespace lostbits::intersect::simd {

/// The numbers of a target, contiguous in memory. It must live as long as the batches that point to it.
template <class F>
class FlatTarget {
public:
    explicit FlatTarget(const Target<F>& target) {
        // A single primitive needs neither a copy nor memory: its numbers are already contiguous.
        if (target.primitives.size() == 1) {
            raw_.numbers = target.primitives.front().numbers.data();
            raw_.shapes = reinterpret_cast<const std::uint8_t*>(&target.primitives.front().shape);
        } else {
            for (const Primitive<F>& primitive : target.primitives) {
                numbers_.insert(numbers_.end(), primitive.numbers.begin(), primitive.numbers.end());
                shapes_.push_back(static_cast<std::uint8_t>(primitive.shape));
            }
            raw_.numbers = numbers_.data();
            raw_.shapes = shapes_.data();
        }
        raw_.primitive_count = target.primitives.size();
        if (target.march) raw_.march = *target.march;
    }
    FlatTarget(const FlatTarget&) = delete;
    FlatTarget& operator=(const FlatTarget&) = delete;

    [[nodiscard]] const RawTarget<F>& raw() const { return raw_; }

private:
    std::vector<F> numbers_;
    std::vector<std::uint8_t> shapes_;
    RawTarget<F> raw_{};
};

/// The part of a batch with `size` rays from ray i on.
template <class F>
RawBatch<F> raw_batch(const table::RayBatch<F>& rays, const RawTarget<F>& target, const table::HitBatch<F>& hits,
                      std::size_t i, std::size_t size) {
    return {.rays = {rays.ox.data() + i, rays.oy.data() + i, rays.oz.data() + i, rays.dx.data() + i, rays.dy.data() + i,
                     rays.dz.data() + i},
            .tmax = rays.tmax.empty() ? nullptr : rays.tmax.data() + i,
            .target = &target,
            .t = hits.t.data() + i,
            .near = hits.near.data() + i,
            .far = hits.far.data() + i,
            .hit = hits.hit.data() + i,
            .size = size};
}

template <class F>
using RawKernel = void (*)(const RawBatch<F>&);

/// One column of the numbers that fill a register; there is space for the widest registers.
template <class F>
struct RegisterColumn {
    F lanes[64 / sizeof(F)];

    /// Copies the `count` numbers after the last whole register. The other lanes repeat the last of these numbers, so
    /// that no form loops longer because of a ray that is not in the batch.
    void fill(const F* tail, std::size_t count, std::size_t lane_count) {
        for (std::size_t k = 0; k < lane_count; ++k) lanes[k] = tail[std::min(k, count - 1)];
    }
};

/// Runs a batch with fewer rays than fill a register, in buffers of a register's size.
template <class F>
void run_tail(RawKernel<F> kernel, std::size_t lane_count, const RawBatch<F>& rest) {
    RegisterColumn<F> rays[6], tmax, t, near, far;
    std::uint8_t hit[sizeof t.lanes / sizeof(F)];
    RawBatch<F> full{.rays = {},
                     .tmax = nullptr,
                     .target = rest.target,
                     .t = t.lanes,
                     .near = near.lanes,
                     .far = far.lanes,
                     .hit = hit,
                     .size = lane_count};

    for (int c = 0; c < 6; ++c) {
        rays[c].fill(rest.rays[c], rest.size, lane_count);
        full.rays[c] = rays[c].lanes;
    }
    if (rest.tmax) {
        tmax.fill(rest.tmax, rest.size, lane_count);
        full.tmax = tmax.lanes;
    }
    kernel(full);

    // Copies the answers of the rays that are in the batch.
    std::copy_n(t.lanes, rest.size, rest.t);
    std::copy_n(near.lanes, rest.size, rest.near);
    std::copy_n(far.lanes, rest.size, rest.far);
    std::copy_n(hit, rest.size, rest.hit);
}

/// Runs a batch of any size by a kernel for whole registers of `lane_count` numbers.
template <class F>
void run_packed(RawKernel<F> kernel, std::size_t lane_count, const table::RayBatch<F>& rays, const Target<F>& target,
                const table::HitBatch<F>& hits) {
    const FlatTarget<F> flat(target);
    const std::size_t rest_count = rays.size() % lane_count, whole_count = rays.size() - rest_count;
    if (whole_count) kernel(raw_batch(rays, flat.raw(), hits, 0, whole_count));
    if (rest_count) run_tail(kernel, lane_count, raw_batch(rays, flat.raw(), hits, whole_count, rest_count));
}

/// A kernel for whole registers, and the number of lanes of a register: the data for a kernel of the table.
template <class F>
struct RegisterKernel {
    RawKernel<F> kernel = nullptr;
    std::size_t lane_count = 0;

    /// Returns a kernel of the table, which refers to this object. The object must outlive the kernel.
    [[nodiscard]] table::Kernel<F> table_kernel() {
        if (!kernel) return nullptr;
        return {[](void* context, const auto& rays, const auto& target, const auto& hits) {
                    const auto& pack = *static_cast<const RegisterKernel*>(context);
                    run_packed(pack.kernel, pack.lane_count, rays, target, hits);
                },
                this};
    }
};

/// The kernels of a form over packs, in registers of one size.
struct RegisterKernels {
    RegisterKernel<float> f32;
    RegisterKernel<double> f64;

    RegisterKernels() = default;
    RegisterKernels(const RawFormKernels& raw, std::size_t register_bytes)
        : f32{raw.f32, register_bytes / sizeof(float)}, f64{raw.f64, register_bytes / sizeof(double)} {}
};

}  // namespace lostbits::intersect::simd
