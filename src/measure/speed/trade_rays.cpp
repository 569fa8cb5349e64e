#include "measure/speed/trade_rays.hpp"

#include <algorithm>
#include <memory>
#include <random>

#include "measure/truth/unit_direction.hpp"
#include "scene/sweep/families.hpp"

namespace lostbits::measure::speed {
namespace {

using scene::rays::RayGroup;
using scene::sweep::FamilyRow;

std::vector<Ray<double>> unit_rays(const RayGroup& group) {
    std::vector<Ray<double>> rays;
    for (std::size_t i = 0; i < group.rays.size(); ++i) {
        const Ray<double> ray = group.rays[i];
        rays.push_back({ray.origin, truth::unit_direction(ray.direction, binary32)});
    }
    return rays;
}

const FamilyRow& family_of(Shape shape) {
    return *std::ranges::find(scene::sweep::families(), shape, &FamilyRow::shape);
}

}  // namespace

std::span<const RaySet> ray_sets(Shape shape) {
    return is_solid(shape) ? family_of(shape).sets() : std::span<const RaySet>();
}

RayPool ray_pool(Shape shape) {
    const scene::rays::HitsAndMisses rays = family_of(shape).timed();
    return {rays.hits.solids.front(), unit_rays(rays.hits), unit_rays(rays.misses)};
}

template <class S>
RayStore<S>::RayStore(const RayPool& pool, std::size_t bytes, double hit_rate, std::size_t slice, std::uint64_t seed)
    : solid_(transformed(pool.solid, [](double x) { return static_cast<S>(x); })),
      rays_(std::max(bytes / bytes_per_ray / whole, std::size_t{1}) * whole),
      slice_(slice == 0 ? rays_ : std::min(rays_, (slice + whole - 1) / whole * whole)) {
    constexpr std::size_t line = 64, stagger = 5 * line;
    const std::size_t column = (rays_ * sizeof(S) + stagger + line - 1) / line * line;
    memory_.resize(numbers * column + rays_ + line);
    void* start = memory_.data();
    std::size_t room = memory_.size();
    std::align(line, memory_.size() - line, start, room);
    auto* const first = static_cast<std::byte*>(start);
    for (std::size_t c = 0; c < numbers; ++c) columns_[c] = reinterpret_cast<S*>(first + c * column);
    hit_ = reinterpret_cast<std::uint8_t*>(first + numbers * column);
    fill(pool, hit_rate, seed);
}

template <class S>
void RayStore<S>::fill(const RayPool& pool, double hit_rate, std::uint64_t seed) {
    std::mt19937_64 random(seed);
    std::vector<char> hits(rays_);
    std::fill_n(hits.begin(), static_cast<std::size_t>(hit_rate * static_cast<double>(rays_) + 0.5), 1);
    for (std::size_t i = rays_; i > 1; --i) std::swap(hits[i - 1], hits[random() % i]);
    for (std::size_t i = 0; i < rays_; ++i) {
        const auto& rays = hits[i] ? pool.hits : pool.misses;
        const Ray<double>& ray = rays[random() % rays.size()];
        const double parts[] = {ray.origin.x,    ray.origin.y,    ray.origin.z,
                                ray.direction.x, ray.direction.y, ray.direction.z};
        for (std::size_t c = 0; c < 6; ++c) columns_[c][i] = static_cast<S>(parts[c]);
    }
}

template <class S>
double RayStore<S>::found() const {
    return static_cast<double>(std::count(hit_, hit_ + rays_, std::uint8_t{1})) / static_cast<double>(rays_);
}

template class RayStore<float>;
template class RayStore<double>;

}  // namespace lostbits::measure::speed
