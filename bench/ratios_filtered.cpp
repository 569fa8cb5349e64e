// Measures the cost of `sphere.filtered` and `box.filtered`, on rays that the cheap filter settles and on others.
#include <algorithm>
#include <cstdio>

#include "intersect/simd/packed.hpp"
#include "measure/trade/timing_work.hpp"
#include "measure/truth/unit_direction.hpp"
#include "ratios.hpp"
#include "shapes/box/distribution/distribution.hpp"
#include "shapes/sphere/distribution/distribution.hpp"
#include "two_words.hpp"

namespace bench {
namespace {

using namespace lostbits;
using intersect::simd::Isa;
using measure::trade::RayPool;
using scene::sphere::SphereDistribution;

struct Rays {
    const char* name;
    RayPool pool;
    double hit_rate;
};

std::vector<Ray<double>> unit_rays(const scene::rays::RayGroup& group) {
    std::vector<Ray<double>> rays;
    for (std::size_t i = 0; i < group.rays.size(); ++i) {
        const Ray<double> ray = group.rays[i];
        rays.push_back({ray.origin, measure::truth::unit_direction(ray.direction, binary32)});
    }
    return rays;
}

/// Many rays of one view of a ray distribution: hits, and misses close to the sphere.
RayPool view_of(SphereDistribution hits) {
    hits = scene::rays::with_single_view(hits);
    SphereDistribution misses = hits;
    misses.impact_from = 1.1;
    misses.impact_to = 1.5;
    const auto met = hits.draw().front();
    const bool point = hits.projection == SphereDistribution::Projection::point || hits.silhouette_gap != 0;
    return {met.primitives.front(), unit_rays(met), point ? unit_rays(met) : unit_rays(misses.draw().front())};
}

std::vector<Rays> draw_sphere_rays() {
    return {
        {"easy", measure::trade::make_ray_pool(Shape::sphere), 0.5},
        {"far-small", view_of({.distance = 4096, .impact_to = 0.9}), 0.5},
        {"1e6 radii", view_of({.distance = 1e6, .impact_to = 0.9}), 0.5},
        {"near-huge",
         view_of({.projection = SphereDistribution::Projection::point, .radius = 1e6, .height = 1, .impact_to = 0.9}),
         1},
        {"grazing", view_of({.distance = 4, .silhouette_gap = 0x1p-10}), 1}};
}

std::vector<Rays> draw_box_rays() {
    using Aim = scene::box::BoxDistribution::Aim;
    const auto view = [](const scene::box::BoxDistribution& distribution) {
        const auto group = scene::rays::with_single_view(distribution).draw().front();
        return RayPool{group.primitives.front(), unit_rays(group), unit_rays(group)};
    };
    return {{"easy", measure::trade::make_ray_pool(Shape::box), 0.5},
            {"edge", view({.aim = Aim::edge, .gap = 0x1p-23}), 1},
            {"face", view({.aim = Aim::face}), 1}};
}

/// Prints the nanoseconds per item of each kernel, and the ratio of the first to each of the others.
void print_over(const char* rays, std::string_view width, std::string_view format,
                const std::vector<std::pair<std::string, measure::trade::TimedWork>>& all) {
    std::vector<measure::trade::TimedWork> work;
    for (const auto& [name, one] : all) work.push_back(one);
    const auto samples = measure::trade::sample_interleaved(work, {.repetitions = 201});
    std::printf("%-10s %-6s %-4s", rays, std::string(width).c_str(), std::string(format).c_str());
    for (std::size_t k = 0; k < all.size(); ++k) {
        std::printf("  %s %.3f ns", all[k].first.c_str(), 1e9 * measure::trade::summarise_samples(samples[k]).median);
        if (k == 0) continue;
        const measure::trade::Timing over = measure::trade::summarise_ratios(samples[0], samples[k]);
        std::printf(" (x %.2f, %.2f-%.2f)", over.median, over.low_quartile, over.high_quartile);
    }
    std::printf("\n");
}

template <class S, class Kernel>
measure::trade::TimedWork work_on(const std::shared_ptr<measure::trade::RayStore<S>>& store, Kernel kernel) {
    return {[store, kernel] { store->run(kernel); }, store->rays_per_run(), true};
}

const intersect::simd::PackedFormKernels& row_of(Isa isa, std::string_view form) {
    const auto rows = intersect::simd::all_packed_kernels(isa);
    return *std::ranges::find_if(rows, [form](const auto& row) { return row.info->name == form; });
}

template <class S>
void print_forms(const Rays& rays, Isa isa, const std::vector<std::string_view>& forms) {
    const std::size_t bytes = measure::trade::working_set_bytes("l1", measure::trade::read_cache_sizes());
    const auto store = std::make_shared<measure::trade::RayStore<S>>(rays.pool, bytes, rays.hit_rate, 0, 1);
    std::vector<std::pair<std::string, measure::trade::TimedWork>> all;
    for (const std::string_view form : forms) {
        const intersect::simd::PackedFormKernels& row = row_of(isa, form);
        if constexpr (sizeof(S) == 4) all.emplace_back(form, work_on(store, row.f32));
        else if (row.f64) all.emplace_back(form, work_on(store, row.f64));
    }
    if constexpr (sizeof(S) == 8) {
        by_hand::OnePrimitive<double> loop = nullptr;
        if (isa == Isa::w128) loop = two_words_w128();
#if defined(LOSTBITS_BY_HAND)
        if (isa == Isa::w256) loop = two_words_w256();
        if (isa == Isa::w512) loop = two_words_w512();
#endif
        if (loop && rays.pool.primitive.shape == Shape::sphere)
            all.emplace_back("double-double",
                             work_on(store, [loop](const auto& r, const Primitive<S>& s, const auto& h) {
                                 const S* const in[] = {r.ox.data(), r.oy.data(), r.oz.data(),
                                                        r.dx.data(), r.dy.data(), r.dz.data()};
                                 S* const out[] = {h.t.data(), h.near.data(), h.far.data()};
                                 loop(in, s.numbers.data(), out, h.hit.data(), r.size());
                             }));
    }
    print_over(rays.name, name_of(isa), sizeof(S) == 4 ? "f32" : "f64", all);
}

}  // namespace

void print_filtered() {
    std::printf("nanoseconds per ray, and in parentheses the time of the filtered form over that of the other form\n");
    for (const Isa isa : intersect::simd::available_isas()) {
        if (isa == Isa::scalar) continue;
        for (const Rays& rays : draw_sphere_rays()) {
            print_forms<float>(rays, isa, {"sphere.filtered", "sphere.schoolbook", "sphere.double_inside"});
            print_forms<double>(rays, isa, {"sphere.filtered", "sphere.schoolbook"});
        }
        for (const Rays& rays : draw_box_rays()) {
            print_forms<float>(rays, isa, {"box.filtered", "box.signs", "box.inclusive"});
            print_forms<double>(rays, isa, {"box.filtered", "box.signs", "box.inclusive"});
        }
    }
    std::printf("\n");
}

}  // namespace bench
