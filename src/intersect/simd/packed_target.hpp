// Converts a batch and its target for the kernels of packed_raw.hpp, and runs the rays that do not fill a register.
#pragma once

#include <algorithm>
#include <vector>

#include "intersect/simd/packed_raw.hpp"
#include "intersect/table/table.hpp"

namespace lostbits::intersect::simd {

/// The numbers of a target in one row; lives as long as the batches that point to it.
template <class F>
class FlatTarget {
public:
    explicit FlatTarget(const Target<F>& target) {
        // One primitive needs neither a copy nor memory: its numbers are contiguous already.
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
        raw_.primitives = target.primitives.size();
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

/// The numbers of one column that fill a register; there is space for the widest registers.
template <class F>
struct RegisterColumn {
    F lanes[64 / sizeof(F)];

    /// Copies the `left` numbers after the last whole register. The other lanes repeat the last of them, so that no
    /// form loops longer because of a ray that is not in the batch.
    void fill(const F* from, std::size_t left, std::size_t width) {
        for (std::size_t k = 0; k < width; ++k) lanes[k] = from[std::min(k, left - 1)];
    }
};

/// Runs fewer rays than fill a register, in buffers of a register's size.
template <class F>
void run_tail(RawKernel<F> kernel, std::size_t lanes, const RawBatch<F>& rest) {
    RegisterColumn<F> rays[6], tmax, t, near, far;
    std::uint8_t hit[sizeof t.lanes / sizeof(F)];
    RawBatch<F> full{.rays = {},
                     .tmax = nullptr,
                     .target = rest.target,
                     .t = t.lanes,
                     .near = near.lanes,
                     .far = far.lanes,
                     .hit = hit,
                     .size = lanes};
    for (int c = 0; c < 6; ++c) {
        rays[c].fill(rest.rays[c], rest.size, lanes);
        full.rays[c] = rays[c].lanes;
    }
    if (rest.tmax) {
        tmax.fill(rest.tmax, rest.size, lanes);
        full.tmax = tmax.lanes;
    }
    kernel(full);
    std::copy_n(t.lanes, rest.size, rest.t);
    std::copy_n(near.lanes, rest.size, rest.near);
    std::copy_n(far.lanes, rest.size, rest.far);
    std::copy_n(hit, rest.size, rest.hit);
}

/// Runs a batch of any size by a kernel for whole registers of `lanes` numbers.
template <class F>
void run_packed(RawKernel<F> kernel, std::size_t lanes, const table::RayBatch<F>& rays, const Target<F>& target,
                const table::HitBatch<F>& hits) {
    const FlatTarget<F> flat(target);
    const std::size_t left = rays.size() % lanes, whole = rays.size() - left;
    if (whole) kernel(raw_batch(rays, flat.raw(), hits, 0, whole));
    if (left) run_tail(kernel, lanes, raw_batch(rays, flat.raw(), hits, whole, left));
}

/// A kernel for whole registers, and their number of lanes: the data behind a kernel of the table.
template <class F>
struct OwnPack {
    RawKernel<F> kernel = nullptr;
    std::size_t lanes = 0;

    /// The kernel of the table. It refers to this object, which must outlive it.
    [[nodiscard]] table::Kernel<F> bound() {
        if (!kernel) return nullptr;
        return {[](void* own, const auto& rays, const auto& target, const auto& hits) {
                    const auto& pack = *static_cast<const OwnPack*>(own);
                    run_packed(pack.kernel, pack.lanes, rays, target, hits);
                },
                this};
    }
};

/// A form over packs, in registers of one size.
struct OwnPacksOfRow {
    OwnPack<float> f32;
    OwnPack<double> f64;

    OwnPacksOfRow() = default;
    OwnPacksOfRow(const RawRow& raw, std::size_t bytes)
        : f32{raw.f32, bytes / sizeof(float)}, f64{raw.f64, bytes / sizeof(double)} {}
};

}  // namespace lostbits::intersect::simd
