// The rays of a trade: sets on which accuracy is measured, and arrays in memory on which time is.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "intersect/table/table.hpp"
#include "scene/rays/family_parts.hpp"

namespace lostbits::measure::speed {

using scene::rays::RaySet;

/// The sets of a shape, the easy one first. Seeded: always the same rays.
std::span<const RaySet> ray_sets(Shape shape);

/// One solid, and rays that hit it and rays that miss it, all of the easy kind, directions of unit length to binary32,
/// so that every form can be given them.
struct RayPool {
    Solid<double> solid;
    std::vector<Ray<double>> hits, misses;
};
RayPool ray_pool(Shape shape);

/// Rays of a pool and room for their answers, as many as fit into so many bytes, in one block of memory. Columns start
/// at cache lines, each at another place of its page, so that reads and writes do not collide there.
template <class S>
class RayStore {
public:
    /// The share of hits is exact to one ray; hits and misses are shuffled. `slice` rays are given to a kernel at once,
    /// all of them if zero.
    RayStore(const RayPool& pool, std::size_t bytes, double hit_rate, std::size_t slice, std::uint64_t seed);
    RayStore(const RayStore&) = delete;
    RayStore& operator=(const RayStore&) = delete;

    [[nodiscard]] std::size_t rays() const { return rays_; }
    [[nodiscard]] std::size_t slice() const { return slice_; }
    [[nodiscard]] std::size_t bytes() const { return rays_ * bytes_per_ray; }

    /// The kernel on the next slice, round and round.
    template <class Kernel>
    void run(const Kernel& kernel) {
        const auto in = [this](std::size_t c) { return std::span<const S>(columns_[c] + at_, slice_); };
        const auto out = [this](std::size_t c) { return std::span<S>(columns_[c] + at_, slice_); };
        kernel(intersect::table::RayBatch<S>{in(0), in(1), in(2), in(3), in(4), in(5)}, solid_,
               intersect::table::HitBatch<S>{out(6), out(7), out(8), {hit_ + at_, slice_}});
        at_ += slice_;
        if (at_ + slice_ > rays_) at_ = 0;
    }
    /// The share of hits that the last pass over everything found.
    [[nodiscard]] double found() const;

private:
    static constexpr std::size_t numbers = 9;  ///< a ray: origin, direction; t, near, far
    static constexpr std::size_t bytes_per_ray = numbers * sizeof(S) + 1;
    static constexpr std::size_t whole = 64;  ///< rays: a multiple of what any register holds

    void fill(const RayPool& pool, double hit_rate, std::uint64_t seed);

    Solid<S> solid_;
    std::size_t rays_, slice_, at_ = 0;
    std::vector<std::byte> memory_;
    std::array<S*, numbers> columns_{};
    std::uint8_t* hit_ = nullptr;
};

extern template class RayStore<float>;
extern template class RayStore<double>;

}  // namespace lostbits::measure::speed
