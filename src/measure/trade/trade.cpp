#include "measure/trade/trade.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>

#include "measure/evaluate/map.hpp"
#include "measure/trade/scene_work.hpp"
#include "shapes/lift.hpp"

namespace lostbits::measure::trade {

using answer::Outcome;
using evaluate::TestedForm;
using intersect::table::Intersector;

namespace {

/// About 600 kB for each call of a kernel.
constexpr std::size_t rays_per_run_in_memory = std::size_t{1} << 14;

/// Arrays of a load in both formats; null for a format that is not timed.
struct Stores {
    std::unique_ptr<RayStore<float>> f32;
    std::unique_ptr<RayStore<double>> f64;
};

template <class S, class Kernel>
TimedWork work_on(RayStore<S>& store, Kernel kernel, bool needs_warm_up) {
    return {[&store, kernel] { store.run(kernel); }, store.rays_per_run(), needs_warm_up};
}

/// Fills `times`: every kernel on rays of the scene, interleaved.
void time_on_scene(const TradeRequest& request, TradeResult& result) {
    SceneWork scene_work(*request.scene, request.limit);
    std::vector<TimedWork> work;
    for (const TradeKernel& kernel : request.kernels)
        work.push_back(scene_work.work_for(kernel.measured, {kernel.measured.form->info, kernel.f32, kernel.f64}));
    const auto timings = time_interleaved(work, request.plan);
    for (std::size_t k = 0; k < timings.size(); ++k)
        result.times.push_back({{timings[k], scene_work.bytes(request.kernels[k].measured.format),
                                 scene_work.ray_count(), scene_work.hit_rate(), scene_work.primitive_count()}});
}

/// Makes the arrays of each load, in the formats of the kernels.
std::vector<Stores> make_stores(const TradeRequest& request) {
    const RayPool pool = make_ray_pool(request.shape);
    const bool has_f32 =
        std::ranges::any_of(request.kernels, [](const TradeKernel& kernel) { return kernel.f32 != nullptr; });
    const bool has_f64 =
        std::ranges::any_of(request.kernels, [](const TradeKernel& kernel) { return kernel.f64 != nullptr; });
    std::vector<Stores> stores;
    for (const TradeLoad& load : request.loads) {
        const std::size_t rays_per_run = load.working_set == "memory" ? rays_per_run_in_memory : 0;
        Stores store;
        if (has_f32)
            store.f32 =
                std::make_unique<RayStore<float>>(pool, load.bytes, load.hit_rate, rays_per_run, request.plan.seed);
        if (has_f64)
            store.f64 =
                std::make_unique<RayStore<double>>(pool, load.bytes, load.hit_rate, rays_per_run, request.plan.seed);
        stores.push_back(std::move(store));
    }
    return stores;
}

/// Fills `times`: every kernel on every load, interleaved.
void time_on_loads(const TradeRequest& request, TradeResult& result) {
    const std::vector<Stores> stores = make_stores(request);
    std::vector<TimedWork> work;
    result.times.resize(request.kernels.size());
    for (std::size_t k = 0; k < request.kernels.size(); ++k) {
        const TradeKernel& kernel = request.kernels[k];
        for (std::size_t l = 0; l < stores.size(); ++l) {
            const bool needs_warm_up = request.loads[l].working_set != "memory";
            work.push_back(kernel.f32 ? work_on(*stores[l].f32, kernel.f32, needs_warm_up)
                                      : work_on(*stores[l].f64, kernel.f64, needs_warm_up));
            const auto [bytes, ray_count] = kernel.f32 ? std::pair(stores[l].f32->bytes(), stores[l].f32->ray_count())
                                                       : std::pair(stores[l].f64->bytes(), stores[l].f64->ray_count());
            result.times[k].push_back({{}, bytes, ray_count, request.loads[l].hit_rate});
        }
    }

    const auto timings = time_interleaved(work, request.plan);
    for (std::size_t i = 0; i < timings.size(); ++i)
        result.times[i / stores.size()][i % stores.size()].timing = timings[i];
}

/// Measures the accuracy of each row once, for all its kernels.
void measure_accuracy(const TradeRequest& request, TradeResult& result) {
    std::vector<TestedForm> tested_forms;
    for (const TradeKernel& kernel : request.kernels) {
        const auto found = std::ranges::find_if(tested_forms, [&kernel](const TestedForm& tested_form) {
            return tested_form.form == kernel.measured.form && tested_form.format == kernel.measured.format;
        });
        result.form_indices.push_back(static_cast<std::size_t>(found - tested_forms.begin()));
        if (found == tested_forms.end()) tested_forms.push_back(kernel.measured);
    }
    if (request.scene) {
        const evaluate::MapStudy study{
            .scene = request.scene, .tested_forms = tested_forms, .metrics = request.metrics, .limit = request.limit};
        result.summaries.push_back(evaluate::run_map(study));
        return;
    }
    for (const RaySet& set : ray_sets(request.shape))
        result.summaries.push_back(
            evaluate::measure_groups(set.groups(), tested_forms, request.metrics, request.limit));
}

/// Counts the operations of each kernel on a ray that hits.
void count_operations(const TradeRequest& request, TradeResult& result) {
    const RayPool pool = make_ray_pool(request.shape);
    const Ray<double>& hit = pool.hits.front();
    const auto to_float = [](const Vec<double>& v) {
        return Vec<float>(static_cast<float>(v.x), static_cast<float>(v.y), static_cast<float>(v.z));
    };
    const Primitive<float> primitive = lift_primitive<float>(pool.primitive);
    const Ray<float> ray{to_float(hit.origin), to_float(hit.direction)};
    for (const TradeKernel& kernel : request.kernels) {
        const auto& count = kernel.measured.form->count;
        result.operations.push_back(
            count ? count(ray, intersect::Target<float>(primitive), std::numeric_limits<float>::infinity())
                  : OperationCounts{});
    }
}

bool is_at_least_as_accurate(const ParetoPoint& a, const ParetoPoint& b) {
    if (a.wrong_fraction != b.wrong_fraction) return a.wrong_fraction < b.wrong_fraction;
    return std::isnan(b.kept_bits) || a.kept_bits >= b.kept_bits;
}

}  // namespace

std::vector<TradeKernel> make_trade_kernels(const std::vector<TestedForm>& tested_forms) {
    std::vector<TradeKernel> kernels;
    const auto add = [&kernels](TradeKernel kernel, decltype(Intersector::native32) f32,
                                decltype(Intersector::native64) f64) {
        const Format::Engine engine = kernel.measured.format.engine;
        if (engine == Format::Engine::native32) kernel.f32 = f32;
        if (engine == Format::Engine::native64) kernel.f64 = f64;
        if (kernel.f32 || kernel.f64) kernels.push_back(std::move(kernel));
    };
    for (const TestedForm& tested_form : tested_forms) {
        // A row with a transform uses the current register width.
        const auto isas = tested_form.form->shapes().have_transform() ? std::vector{intersect::simd::current_isa()}
                                                                      : intersect::simd::available_isas();
        for (const intersect::simd::Isa isa : isas) {
            if (isas.size() > 1 && isa != intersect::simd::Isa::scalar && !is_packed(*tested_form.form, isa)) continue;
            const intersect::simd::PackedFormKernels packed = packed_kernels(*tested_form.form, isa);
            add({.measured = tested_form, .isa = name_of(isa)}, packed.f32, packed.f64);
        }
    }
    return kernels;
}

std::vector<TradeLoad> make_trade_loads(const CacheSizes& caches) {
    constexpr double hit_rates[] = {0, 0.5, 1};
    constexpr std::size_t mebibyte = std::size_t{1} << 20,
                          arrays = 2 * std::size(hit_rates);  // a format and a rate each
    const std::size_t memory = std::clamp(2 * caches.last / arrays, 32 * mebibyte, 96 * mebibyte);
    std::vector<TradeLoad> loads;
    for (const auto& [name, bytes] :
         {std::pair<std::string_view, std::size_t>{"l1", caches.l1 / 2}, {"l2", caches.l2 / 2}, {"memory", memory}}) {
        for (const double rate : hit_rates) loads.push_back({name, bytes, rate});
    }
    return loads;
}

std::vector<TradeLoad> make_scene_load() { return {{"scene", 0, 0}}; }

std::size_t reference_load(const std::vector<TradeLoad>& loads) {
    const auto found =
        std::ranges::find_if(loads, [](const TradeLoad& l) { return l.working_set == "l1" && l.hit_rate == 0.5; });
    return found == loads.end() ? 0 : static_cast<std::size_t>(found - loads.begin());
}

std::vector<TradeSet> make_trade_sets(const TradeRequest& request) {
    if (request.scene) return {{request.scene->id, request.scene->title}};
    std::vector<TradeSet> sets;
    for (const RaySet& set : ray_sets(request.shape)) sets.push_back({std::string(set.name), std::string(set.title)});
    return sets;
}

std::uint64_t count_trade_units(const TradeRequest& request) {
    return request.kernels.size() * request.loads.size() * static_cast<std::uint64_t>(request.plan.repetitions);
}

TradeResult run_trade(const TradeRequest& request) {
    TradeResult result;
    measure_accuracy(request, result);
    count_operations(request, result);
    if (request.scene) time_on_scene(request, result);
    else time_on_loads(request, result);
    return result;
}

ParetoPoint make_pareto_point(const Timing& timing, const TestedForm& tested_form,
                              const evaluate::FormSummary& accuracy,
                              const std::vector<const metric::Metric*>& metrics) {
    const std::size_t lost_bits_index = metric::index_of(metrics, "lost_bits");
    const auto wrong = accuracy.wrong_count();
    const auto known = accuracy.ray_count - accuracy.count(Outcome::unresolved);
    return {timing.median * 1e9, known == 0 ? 0 : static_cast<double>(wrong) / static_cast<double>(known),
            tested_form.format.parameters.precision - accuracy.metrics[lost_bits_index].quantile(0.99)};
}

std::vector<bool> find_dominated(const std::vector<ParetoPoint>& points) {
    const auto dominates = [](const ParetoPoint& a, const ParetoPoint& b) {
        if (a.time_ns > b.time_ns || !is_at_least_as_accurate(a, b)) return false;
        return a.time_ns < b.time_ns || !is_at_least_as_accurate(b, a);
    };
    std::vector<bool> is_dominated;
    for (const ParetoPoint& point : points)
        is_dominated.push_back(
            std::ranges::any_of(points, [&](const ParetoPoint& other) { return dominates(other, point); }));
    return is_dominated;
}

std::optional<std::size_t> find_cheapest(const std::vector<ParetoPoint>& points, double kept_bits) {
    std::optional<std::size_t> best;
    for (std::size_t i = 0; i < points.size(); ++i) {
        if (!points[i].never_wrong() || !(points[i].kept_bits >= kept_bits)) continue;
        if (!best || points[i].time_ns < points[*best].time_ns) best = i;
    }
    return best;
}

}  // namespace lostbits::measure::trade
