// Rays and boxes in memory that kernels are timed on: one ray against many boxes, or many rays against one primitive.
// Also the sets of rays on which accuracy is measured.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "intersect/simd/packed_many.hpp"
#include "intersect/simd/plain_many.hpp"
#include "intersect/table/table.hpp"
#include "measure/trade/timing.hpp"
#include "scene/rays/distribution_parts.hpp"

namespace lostbits::measure::trade {

using scene::rays::RaySet;

/// Ray sets of a shape, the easy one first. The seeds are fixed: the rays are always the same.
std::span<const RaySet> ray_sets(Shape shape);

/// One primitive, with rays that hit it and rays that miss it. All rays are easy, and their directions have unit length
/// in binary32, so that every form accepts them.
struct RayPool {
    Primitive<double> primitive;
    std::vector<Ray<double>> hits, misses;
};
RayPool make_ray_pool(Shape shape);

/// Rays of a pool and a buffer for their answers, as many as fit into `bytes` bytes, in one block of memory. Columns
/// start at cache lines, each at another offset in its page, so that reads and writes do not collide.
template <class S>
class RayStore {
public:
    /// The fraction of hits is exact to one ray; hits and misses are shuffled. A kernel gets `rays_per_run` rays at
    /// once; 0 means all of them.
    RayStore(const RayPool& pool, std::size_t bytes, double hit_rate, std::size_t rays_per_run, std::uint64_t seed);
    RayStore(const RayStore&) = delete;
    RayStore& operator=(const RayStore&) = delete;

    [[nodiscard]] std::size_t ray_count() const { return ray_count_; }
    [[nodiscard]] std::size_t rays_per_run() const { return rays_per_run_; }
    [[nodiscard]] std::size_t bytes() const { return ray_count_ * bytes_per_ray; }

    /// Runs the kernel on the next `rays_per_run` rays; after the last ones, starts again at the first.
    template <class Kernel>
    void run(const Kernel& kernel) {
        const auto input = [this](std::size_t c) { return std::span<const S>(columns_[c] + next_ray_, rays_per_run_); };
        const auto output = [this](std::size_t c) { return std::span<S>(columns_[c] + next_ray_, rays_per_run_); };
        kernel(intersect::table::RayBatch<S>{input(0), input(1), input(2), input(3), input(4), input(5)}, primitive_,
               intersect::table::HitBatch<S>{output(6), output(7), output(8), {hit_ + next_ray_, rays_per_run_}});
        next_ray_ += rays_per_run_;
        if (next_ray_ + rays_per_run_ > ray_count_) next_ray_ = 0;
    }
    /// Fraction of the rays that hit in the last pass over all of them.
    [[nodiscard]] double hit_fraction() const;

private:
    static constexpr std::size_t numbers_per_ray = 9;  ///< origin, direction; t, near, far
    static constexpr std::size_t bytes_per_ray = numbers_per_ray * sizeof(S) + 1;
    static constexpr std::size_t ray_granularity = 64;  ///< a multiple of the number of rays that any register holds

    void fill(const RayPool& pool, double hit_rate, std::uint64_t seed);

    Primitive<S> primitive_;
    std::size_t ray_count_, rays_per_run_, next_ray_ = 0;
    std::vector<std::byte> memory_;
    std::array<S*, numbers_per_ray> columns_{};
    std::uint8_t* hit_ = nullptr;
};

extern template class RayStore<float>;
extern template class RayStore<double>;

/// Boxes scattered along a ray, a column per number, and the t of each box: infinite at first; once the box was hit,
/// the t where the ray enters. Columns start at cache lines, each at another offset in its page, so that reads and
/// writes do not collide.
template <class S>
class BoxField {
public:
    /// Makes as many boxes as fit into `bytes` bytes, rounded to a multiple of 64.
    explicit BoxField(std::size_t bytes);
    BoxField(const BoxField&) = delete;
    BoxField& operator=(const BoxField&) = delete;

    Ray<S> ray;
    std::array<std::span<S>, 6> columns;  ///< lo x, y, z, hi x, y, z
    std::span<S> t;

    [[nodiscard]] intersect::simd::PrimitiveArrays<S> arrays() const {
        return {columns[0], columns[1], columns[2], columns[3], columns[4], columns[5]};
    }
    [[nodiscard]] std::array<const S*, 6> pointers() const;
    [[nodiscard]] std::array<S, 6> ray_numbers() const;

private:
    std::vector<std::byte> memory_;
};

extern template class BoxField<float>;
extern template class BoxField<double>;

/// Returns the size of a working set in bytes. `l1` is half of the first cache, `l2` half of the second, `memory` twice
/// the last (between 64 MiB and 1 GiB). Zero for another name.
std::size_t working_set_bytes(std::string_view name, const CacheSizes& caches);

/// A form in a kernel. `scalar`, `128`, `256`, `512` are those of `Isa`. `plain-256` and `plain-structs-256` are the
/// loops of `PlainFormKernels`, which exist only for one ray against many boxes in float.
struct TimedKernel {
    std::string_view form_name, kernel_name, format_name;
};

/// Object that is created at its first use.
template <class T>
class LazyObject {
public:
    template <class... Args>
    const std::shared_ptr<T>& operator()(Args&&... args) {
        if (!object_) object_ = std::make_shared<T>(std::forward<Args>(args)...);
        return object_;
    }

private:
    std::shared_ptr<T> object_;
};

/// One ray against as many boxes as fit into a number of bytes. All kernels of a format work on the same boxes, one at
/// a time; the boxes live as long as any work on them.
class BoxWork {
public:
    explicit BoxWork(std::size_t bytes) : bytes_(bytes) {}

    /// Returns the work of a kernel; nothing if this build or this processor does not have it.
    std::optional<TimedWork> work_for(const TimedKernel& kernel);
    const std::shared_ptr<BoxField<float>>& f32() { return f32_(bytes_); }
    const std::shared_ptr<BoxField<double>>& f64() { return f64_(bytes_); }

private:
    const std::shared_ptr<std::vector<intersect::simd::PlainBox>>& box_structs();

    std::size_t bytes_;
    LazyObject<BoxField<float>> f32_;
    LazyObject<BoxField<double>> f64_;
    LazyObject<std::vector<intersect::simd::PlainBox>> box_structs_;
};

/// Many rays against the primitive of `make_ray_pool`, half of which hit it; otherwise like `BoxWork`.
class RayWork {
public:
    explicit RayWork(std::size_t bytes) : bytes_(bytes) {}

    std::optional<TimedWork> work_for(const TimedKernel& kernel);
    const std::shared_ptr<RayStore<float>>& f32(Shape shape) { return store(f32_, shape); }
    const std::shared_ptr<RayStore<double>>& f64(Shape shape) { return store(f64_, shape); }

private:
    template <class S>
    using Stores = std::array<LazyObject<RayStore<S>>, shape_names.size()>;
    template <class S>
    const std::shared_ptr<RayStore<S>>& store(Stores<S>& stores, Shape shape) {
        return stores[static_cast<std::size_t>(shape)](make_ray_pool(shape), bytes_, 0.5, std::size_t{0},
                                                       std::uint64_t{1});
    }

    std::size_t bytes_;
    Stores<float> f32_;
    Stores<double> f64_;
};

/// True if so many bytes fit in cache: an untimed pass over them leaves them there.
bool fits_in_cache(std::size_t bytes);

}  // namespace lostbits::measure::trade
