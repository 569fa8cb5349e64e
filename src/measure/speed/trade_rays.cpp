#include "measure/speed/trade_rays.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <random>

#include "measure/truth/unit_direction.hpp"
#include "number/error.hpp"

namespace lostbits::measure::speed {
namespace {

using scene::rays::BoxFamily;
using scene::rays::Family;
using scene::rays::RayGroup;

std::vector<RayGroup> easy_spheres() { return scene::rays::family_rays({.distance = 4, .impact_to = 0.9}); }
std::vector<RayGroup> far_small_spheres() { return scene::rays::family_rays({.distance = 4096, .impact_to = 0.9}); }
std::vector<RayGroup> near_huge_spheres() {
    return scene::rays::family_rays(
        {.projection = Family::Projection::point, .radius = 1e6, .height = 1, .impact_to = 0.9});
}
std::vector<RayGroup> grazing_spheres() { return scene::rays::family_rays({.distance = 4, .silhouette_gap = 0x1p-10}); }

std::vector<RayGroup> easy_boxes() { return scene::rays::box_family_rays({.aim = BoxFamily::Aim::inside}); }

/// Half of the rays inside by the gap, half outside.
std::vector<RayGroup> edge_boxes() {
    auto groups = scene::rays::box_family_rays({.aim = BoxFamily::Aim::edge, .gap = -0x1p-23});
    std::ranges::move(scene::rays::box_family_rays({.aim = BoxFamily::Aim::edge, .gap = 0x1p-23}),
                      std::back_inserter(groups));
    return groups;
}

constexpr RaySet sphere_sets[] = {
    {"easy", "a sphere 4 radii away, hit within 0.9 radii of its middle", easy_spheres},
    {"far-small", "a sphere 4096 radii away, hit within 0.9 radii of its middle", far_small_spheres},
    {"near-huge", "a sphere of radius 1e6, seen from 1 above its surface", near_huge_spheres},
    {"grazing", "a sphere 4 radii away, hit 2^-10 radii inside its silhouette", grazing_spheres},
};

constexpr RaySet box_sets[] = {
    {"easy", "boxes 4 sizes away, aimed at the inside", easy_boxes},
    {"edge-grazing", "boxes 4 sizes away, aimed 2^-23 sizes inside and outside of an edge", edge_boxes},
};

constexpr std::uint64_t pool_seed = 7;
constexpr int pool_rays = 4096;

std::vector<Ray<double>> unit_rays(const RayGroup& group) {
    std::vector<Ray<double>> rays;
    for (std::size_t i = 0; i < group.rays.size(); ++i) {
        const Ray<double> ray = group.rays[i];
        rays.push_back({ray.origin, truth::unit_direction(ray.direction, binary32)});
    }
    return rays;
}

RayPool pool_of(const std::vector<RayGroup>& hits, const std::vector<RayGroup>& misses) {
    return {hits.front().solids.front(), unit_rays(hits.front()), unit_rays(misses.front())};
}

/// The first draw of a family is its solid: the same seed gives both halves the same one.
RayPool sphere_pool() {
    return pool_of(
        scene::rays::family_rays({.distance = 4, .impact_to = 0.9, .views = 1, .rays = pool_rays, .seed = pool_seed}),
        scene::rays::family_rays(
            {.distance = 4, .impact_from = 1.1, .impact_to = 1.5, .views = 1, .rays = pool_rays, .seed = pool_seed}));
}
RayPool box_pool() {
    return pool_of(
        scene::rays::box_family_rays({.aim = BoxFamily::Aim::inside, .views = 1, .rays = pool_rays, .seed = pool_seed}),
        scene::rays::box_family_rays(
            {.aim = BoxFamily::Aim::edge, .gap = 0.25, .views = 1, .rays = pool_rays, .seed = pool_seed}));
}

/// What is drawn for a shape.
constexpr struct {
    Shape shape;
    std::span<const RaySet> sets;
    RayPool (*pool)();
} drawn[] = {{Shape::sphere, sphere_sets, sphere_pool}, {Shape::box, box_sets, box_pool}};

}  // namespace

std::span<const RaySet> ray_sets(Shape shape) {
    for (const auto& of : drawn)
        if (of.shape == shape) return of.sets;
    return {};
}

RayPool ray_pool(Shape shape) {
    for (const auto& of : drawn)
        if (of.shape == shape) return of.pool();
    throw InputError(fmt::format("no random rays are drawn for {}; time their forms on a scene: lostbits trade SCENE",
                                 row_of(shape).plural));
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
