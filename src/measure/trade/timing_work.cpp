#include "measure/trade/timing_work.hpp"

#include <algorithm>
#include <limits>
#include <memory>
#include <random>

#include "measure/truth/unit_direction.hpp"
#include "scene/sweep/distributions.hpp"
#include "shapes/lift.hpp"

namespace lostbits::measure::trade {

namespace {

using scene::rays::RayGroup;
using scene::sweep::DistributionRow;

std::vector<Ray<double>> make_unit_rays(const RayGroup& group) {
    std::vector<Ray<double>> rays;
    for (std::size_t i = 0; i < group.rays.size(); ++i) {
        const Ray<double> ray = group.rays[i];
        rays.push_back({ray.origin, truth::unit_direction(ray.direction, binary32)});
    }
    return rays;
}

const DistributionRow& distribution_of(Shape shape) {
    return *std::ranges::find(scene::sweep::distributions(), shape, &DistributionRow::shape);
}

/// Row of a form in a table; null if the table does not have the form.
template <class Row>
const Row* row_of(std::span<const Row> rows, std::string_view form) {
    const auto found = std::ranges::find_if(rows, [form](const Row& row) { return row.info->name == form; });
    return found == rows.end() ? nullptr : &*found;
}

template <class S>
TimedWork packed_work(const std::shared_ptr<BoxField<S>>& field, intersect::simd::ManyKernel<S> kernel,
                      bool needs_warm_up) {
    return {[field, kernel] { kernel(field->ray, field->arrays(), field->t); }, field->t.size(), needs_warm_up};
}

template <class S, class Kernel>
TimedWork packed_work(const std::shared_ptr<RayStore<S>>& store, Kernel kernel, bool needs_warm_up) {
    return {[store, kernel] { store->run(kernel); }, store->rays_per_run(), needs_warm_up};
}

}  // namespace

std::span<const RaySet> ray_sets(Shape shape) {
    return is_primitive(shape) ? distribution_of(shape).ray_sets() : std::span<const RaySet>();
}

RayPool make_ray_pool(Shape shape) {
    const scene::rays::HitsAndMisses rays = distribution_of(shape).draw_timed_rays();
    return {rays.hits.primitives.front(), make_unit_rays(rays.hits), make_unit_rays(rays.misses)};
}

template <class S>
RayStore<S>::RayStore(const RayPool& pool, std::size_t bytes, double hit_rate, std::size_t rays_per_run,
                      std::uint64_t seed)
    : primitive_(lift_primitive<S>(pool.primitive)),
      ray_count_(std::max(bytes / bytes_per_ray / ray_granularity, std::size_t{1}) * ray_granularity),
      rays_per_run_(rays_per_run == 0 ? ray_count_
                                      : std::min(ray_count_, (rays_per_run + ray_granularity - 1) / ray_granularity *
                                                                 ray_granularity)) {
    constexpr std::size_t cache_line = 64, stagger = 5 * cache_line;
    const std::size_t column = (ray_count_ * sizeof(S) + stagger + cache_line - 1) / cache_line * cache_line;
    memory_.resize(numbers_per_ray * column + ray_count_ + cache_line);
    void* start = memory_.data();
    std::size_t space = memory_.size();
    std::align(cache_line, memory_.size() - cache_line, start, space);
    auto* const first = static_cast<std::byte*>(start);
    for (std::size_t c = 0; c < numbers_per_ray; ++c) columns_[c] = reinterpret_cast<S*>(first + c * column);
    hit_ = reinterpret_cast<std::uint8_t*>(first + numbers_per_ray * column);
    fill(pool, hit_rate, seed);
}

template <class S>
void RayStore<S>::fill(const RayPool& pool, double hit_rate, std::uint64_t seed) {
    std::mt19937_64 random(seed);
    std::vector<char> hits(ray_count_);
    std::fill_n(hits.begin(), static_cast<std::size_t>(hit_rate * static_cast<double>(ray_count_) + 0.5), 1);
    for (std::size_t i = ray_count_; i > 1; --i) std::swap(hits[i - 1], hits[random() % i]);
    for (std::size_t i = 0; i < ray_count_; ++i) {
        const auto& rays = hits[i] ? pool.hits : pool.misses;
        const Ray<double>& ray = rays[random() % rays.size()];
        const double parts[] = {ray.origin.x,    ray.origin.y,    ray.origin.z,
                                ray.direction.x, ray.direction.y, ray.direction.z};
        for (std::size_t c = 0; c < 6; ++c) columns_[c][i] = static_cast<S>(parts[c]);
    }
}

template <class S>
double RayStore<S>::hit_fraction() const {
    return static_cast<double>(std::count(hit_, hit_ + ray_count_, std::uint8_t{1})) / static_cast<double>(ray_count_);
}

template class RayStore<float>;
template class RayStore<double>;

template <class S>
BoxField<S>::BoxField(std::size_t bytes) : ray{{S(-3), S(0.1F), S(0.2F)}, {S(1), S(-0.25), S(0.125)}} {
    constexpr std::size_t cache_line = 64, stagger = 5 * cache_line, numbers_per_box = 7;
    const std::size_t box_count = std::max<std::size_t>(1, bytes / (numbers_per_box * sizeof(S)) / 64) * 64,
                      column = box_count * sizeof(S) + stagger;
    memory_.resize(numbers_per_box * column + cache_line);
    void* start = memory_.data();
    std::size_t space = memory_.size();
    std::align(cache_line, numbers_per_box * column, start, space);
    const auto span_of = [&](std::size_t c) {
        return std::span<S>(reinterpret_cast<S*>(static_cast<std::byte*>(start) + c * column), box_count);
    };

    // Random boxes around the ray
    std::mt19937 engine(2);
    std::uniform_real_distribution<float> position(-2, 2), side(0.1F, 1);
    for (std::size_t axis = 0; axis < 3; ++axis) {
        columns[axis] = span_of(axis);
        columns[axis + 3] = span_of(axis + 3);
        for (std::size_t i = 0; i < box_count; ++i) {
            columns[axis][i] = position(engine);
            columns[axis + 3][i] = columns[axis][i] + S(side(engine));
        }
    }

    t = span_of(6);
    std::ranges::fill(t, std::numeric_limits<S>::infinity());
}

template <class S>
std::array<const S*, 6> BoxField<S>::pointers() const {
    return {columns[0].data(), columns[1].data(), columns[2].data(),
            columns[3].data(), columns[4].data(), columns[5].data()};
}

template <class S>
std::array<S, 6> BoxField<S>::ray_numbers() const {
    return {ray.origin.x, ray.origin.y, ray.origin.z, ray.direction.x, ray.direction.y, ray.direction.z};
}

template class BoxField<float>;
template class BoxField<double>;

std::size_t working_set_bytes(std::string_view name, const CacheSizes& caches) {
    constexpr std::size_t mebibyte = std::size_t{1} << 20;
    if (name == "l1") return caches.l1 / 2;
    if (name == "l2") return caches.l2 / 2;
    return name == "memory" ? std::clamp(2 * caches.last, 64 * mebibyte, 1024 * mebibyte) : 0;
}

bool fits_in_cache(std::size_t bytes) { return bytes <= read_cache_sizes().l2; }

const std::shared_ptr<std::vector<intersect::simd::PlainBox>>& BoxWork::box_structs() {
    const BoxField<float>& field = *f32();
    auto& boxes = box_structs_(field.t.size());
    for (std::size_t i = 0; i < field.t.size(); ++i)
        for (std::size_t c = 0; c < 6; ++c) (*boxes)[i].numbers[c] = field.columns[c][i];
    return boxes;
}

std::optional<TimedWork> BoxWork::work_for(const TimedKernel& kernel) {
    const bool needs_warm_up = fits_in_cache(bytes_);

    // Loops as other projects write them
    const intersect::simd::PlainFormKernels* const plain =
        kernel.kernel_name.starts_with("plain-") && kernel.format_name == "f32"
            ? row_of(intersect::simd::all_plain_kernels(), kernel.form_name)
            : nullptr;
    if (plain && kernel.kernel_name == "plain-256")
        return TimedWork{[field = f32(), ray = f32()->ray_numbers(), boxes = f32()->pointers(), loop = plain->columns] {
                             loop(ray.data(), boxes.data(), field->t.data(), field->t.size());
                         },
                         f32()->t.size(), needs_warm_up};
    if (plain && kernel.kernel_name == "plain-structs-256")
        return TimedWork{[field = f32(), ray = f32()->ray_numbers(), boxes = box_structs(), loop = plain->structs] {
                             loop(ray.data(), boxes->data(), field->t.data(), field->t.size());
                         },
                         f32()->t.size(), needs_warm_up};

    // Kernels of the forms
    const auto isa = intersect::simd::find_isa(kernel.kernel_name);
    const intersect::simd::ManyFormKernels* const row =
        isa ? row_of(intersect::simd::all_many_kernels(*isa), kernel.form_name) : nullptr;
    if (row && row->takes_tmax && row->f32 && kernel.format_name == "f32")
        return packed_work(f32(), row->f32, needs_warm_up);
    if (row && row->takes_tmax && row->f64 && kernel.format_name == "f64")
        return packed_work(f64(), row->f64, needs_warm_up);
    return std::nullopt;
}

std::optional<TimedWork> RayWork::work_for(const TimedKernel& kernel) {
    const auto isa = intersect::simd::find_isa(kernel.kernel_name);
    const intersect::simd::PackedFormKernels* const row =
        isa ? row_of(intersect::simd::all_packed_kernels(*isa), kernel.form_name) : nullptr;
    if (!row) return std::nullopt;
    const bool needs_warm_up = fits_in_cache(bytes_);
    const Shape shape = intersect::table::catalogue()[row - intersect::simd::all_packed_kernels(*isa).data()].shape;
    if (row->f32 && kernel.format_name == "f32") return packed_work(f32(shape), row->f32, needs_warm_up);
    if (row->f64 && kernel.format_name == "f64") return packed_work(f64(shape), row->f64, needs_warm_up);
    return std::nullopt;
}

}  // namespace lostbits::measure::trade
