// A batch and its target as the kernels of packed_raw.hpp read them.
#pragma once

#include <vector>

#include "intersect/simd/packed_raw.hpp"
#include "intersect/table/table.hpp"

namespace lostbits::intersect::simd {

/// The numbers of a target in one row; lives as long as the batches that point to it.
template <class F>
class FlatTarget {
public:
    explicit FlatTarget(const Target<F>& target) {
        // One solid needs no copy, and its batches no memory: its numbers lie in a row as they are.
        if (target.solids.size() == 1) {
            raw_.numbers = target.solids.front().numbers.data();
            raw_.shapes = reinterpret_cast<const std::uint8_t*>(&target.solids.front().shape);
        } else {
            for (const Solid<F>& solid : target.solids) {
                numbers_.insert(numbers_.end(), solid.numbers.begin(), solid.numbers.end());
                shapes_.push_back(static_cast<std::uint8_t>(solid.shape));
            }
            raw_.numbers = numbers_.data();
            raw_.shapes = shapes_.data();
        }
        raw_.solids = target.solids.size();
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

/// `size` rays from ray i on.
template <class F>
RawBatch<F> raw_batch(const table::RayBatch<F>& rays, const RawTarget<F>& target, const table::HitBatch<F>& hits,
                      std::size_t i, std::size_t size) {
    return {{rays.ox.data() + i, rays.oy.data() + i, rays.oz.data() + i, rays.dx.data() + i, rays.dy.data() + i,
             rays.dz.data() + i},
            rays.tmax.empty() ? nullptr : rays.tmax.data() + i,
            &target,
            hits.t.data() + i,
            hits.near.data() + i,
            hits.far.data() + i,
            hits.hit.data() + i,
            size};
}

}  // namespace lostbits::intersect::simd
