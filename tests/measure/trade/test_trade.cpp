// Speed against accuracy: the inputs of a comparison, on rays with the stated properties. No test asserts a time.
#include <sched.h>

#include <algorithm>
#include <cmath>

#include "catch.hpp"
#include "measure/rows.hpp"
#include "measure/trade/scene_work.hpp"
#include "measure/trade/trade.hpp"
#include "number/real.hpp"
#include "scene/file/scene.hpp"

namespace test_trade {

using namespace lostbits;
using namespace lostbits::test;

namespace {

constexpr double no_bits = std::numeric_limits<double>::quiet_NaN();

OperationCounts operations(std::string_view form) {
    const measure::trade::RayPool pool = measure::trade::make_ray_pool(form_named(form).shape);
    const auto narrow = [](const Vec<double>& v) {
        return Vec<float>(static_cast<float>(v.x), static_cast<float>(v.y), static_cast<float>(v.z));
    };
    const Primitive<float> primitive = convert_numbers(pool.primitive, [](double x) { return static_cast<float>(x); });
    return form_named(form).count({narrow(pool.hits[0].origin), narrow(pool.hits[0].direction)},
                                  intersect::Target<float>(primitive), HUGE_VALF);
}

OperationCounts counts(std::initializer_list<std::pair<Operation, std::uint64_t>> some) {
    OperationCounts c;
    for (const auto& [o, n] : some) c[o] = n;
    return c;
}

std::string text(const OperationCounts& c) {
    std::string s;
    for (std::size_t i = 0; i < operation_names.size(); ++i)
        s += std::string(operation_names[i]) + " " + std::to_string(c.counts[i]) + ", ";
    return s;
}

template <class S, class Native>
void check_store(Native native, const measure::trade::RayPool& pool) {
    for (const double rate : {0.0, 0.5, 1.0, 0.3}) {
        for (const std::size_t rays_per_run : {std::size_t{0}, std::size_t{128}}) {
            measure::trade::RayStore<S> store(pool, 50000, rate, rays_per_run, 3);
            CHECK(store.bytes() <= 50000);
            CHECK(store.bytes() > 40000);
            CHECK(store.rays_per_run() == (rays_per_run == 0 ? store.ray_count() : rays_per_run));
            std::size_t calls = 0;
            for (std::size_t seen = 0; seen < store.ray_count(); seen += store.rays_per_run(), ++calls)
                store.run(native);
            // Rays left over after the last whole run are never run.
            const double whole = static_cast<double>(store.ray_count() / store.rays_per_run() * store.rays_per_run()) /
                                 static_cast<double>(store.ray_count());
            CHECK(store.hit_fraction() <= rate + 1e-3);
            CHECK(store.hit_fraction() >= rate * whole - 0.02);
            if (rays_per_run == 0)
                CHECK(std::fabs(store.hit_fraction() - rate) <= 1.0 / static_cast<double>(store.ray_count()));
        }
    }
}

}  // namespace

TEST_CASE("operation counts agree with those counted by hand", "[trade]") {
    using O = Operation;
    INFO(text(operations("sphere.schoolbook")));
    CHECK(
        operations("sphere.schoolbook") ==
        counts({{O::add, 13}, {O::mul, 16}, {O::div, 2}, {O::sqrt, 1}, {O::compare, 3}, {O::choose, 1}, {O::sign, 2}}));
    INFO(text(operations("sphere.unified")));
    CHECK(
        operations("sphere.unified") ==
        counts({{O::add, 17}, {O::mul, 18}, {O::div, 3}, {O::sqrt, 1}, {O::compare, 4}, {O::choose, 4}, {O::sign, 2}}));
    INFO(text(operations("box.signs")));
    CHECK(operations("box.signs") ==
          counts({{O::add, 6}, {O::mul, 6}, {O::div, 3}, {O::compare, 4}, {O::choose, 12}, {O::sign, 3}}));
    CHECK(operations("sphere.double_inside")[O::convert] == 13);
    CHECK(operations("sphere.kahan_discriminant")[O::fma] > 0);
}

TEST_CASE("constants cost nothing, and values computed from inputs do", "[trade]") {
    operation_counts() = {};
    const Counted<float> half = Counted<float>(1) / Counted<float>(2);
    CHECK(operation_counts() == OperationCounts{});
    CHECK((half * Counted<float>(3.0F)).value() == 1.5F);
    CHECK(operation_counts() == counts({{Operation::mul, 1}}));
}

TEST_CASE("a row is dominated if another is better in one respect and at least equal in the other", "[trade]") {
    const std::vector<measure::trade::ParetoPoint> all{
        {1, 0, 20},           // on the front
        {2, 0, 20},           // slower, no better
        {2, 0, 22},           // on the front
        {2, 0, 22},           // equal to it: neither dominates the other
        {1, 0.1, 30},         // more bits, but wrong decisions come first
        {0.5, 0.1, 10},       // the fastest
        {0.5, 0.1, no_bits},  // as fast and as often wrong, without a bit
        {0.4, 1, no_bits},    // faster still: no row is as fast
        {3, 0, no_bits},      // never wrong, but slower than others that are not
    };
    CHECK(find_dominated(all) == std::vector<bool>{false, true, false, false, true, false, true, false, true});
    CHECK(measure::trade::find_dominated({}).empty());
}

TEST_CASE("the cheapest row is the fastest that is never wrong and accurate enough", "[trade]") {
    const std::vector<measure::trade::ParetoPoint> all{
        {1, 0.001, 24}, {3, 0, 22}, {2, 0, 21.9}, {1.5, 0, no_bits}, {4, 0, 45}};
    CHECK(measure::trade::find_cheapest(all, 20) == std::size_t{2});
    CHECK(measure::trade::find_cheapest(all, 22) == std::size_t{1});
    CHECK(measure::trade::find_cheapest(all, 40) == std::size_t{4});
    CHECK_FALSE(measure::trade::find_cheapest(all, 46).has_value());
}

TEST_CASE("a row is ranked by its median, all wrong decisions and the 99th percentile", "[trade]") {
    const std::vector<const measure::metric::Metric*> lost{measure::metric::find_metric("lost_bits")};
    measure::evaluate::FormSummary s;
    s.ray_count = 100;
    s.outcomes = {90, 2, 1, 2, 1, 4};
    s.metrics = std::vector<measure::metric::Distribution>(1);
    for (int i = 1; i <= 100; ++i) s.metrics[0].add(i == 100 ? 20 : 4);
    s.metrics[0].seal();
    const measure::trade::ParetoPoint got =
        measure::trade::make_pareto_point({2e-9, 1e-9, 3e-9}, row("sphere.unified", "f32"), s, lost);
    CHECK(got.time_ns == Approx(2));
    CHECK(got.wrong_fraction == 4.0 / 96);
    CHECK(got.kept_bits == Approx(20).epsilon(0.001));
    CHECK_FALSE(got.never_wrong());
}

TEST_CASE("ray buffers hold the stated share of hits", "[trade]") {
    check_store<float>(form_named("sphere.unified").native32, measure::trade::make_ray_pool(Shape::sphere));
    check_store<double>(form_named("sphere.unified_unit").native64, measure::trade::make_ray_pool(Shape::sphere));
    check_store<float>(form_named("box.signs").native32, measure::trade::make_ray_pool(Shape::box));
    check_store<double>(form_named("box.divide").native64, measure::trade::make_ray_pool(Shape::box));
}

TEST_CASE("rays are sampled evenly over a scene and compared with the primitives that most of them hit", "[trade]") {
    const auto scene = scene_named("near-benign");
    measure::trade::SceneWork work(scene);
    CHECK(work.ray_count() > 1800);
    CHECK(work.ray_count() <= 2100);
    CHECK(work.primitive_count() == 3);  // the fourth is hidden behind the first
    CHECK(work.hit_rate() > 0.05);
    CHECK(work.hit_rate() < 0.95);
    for (const auto& [format, size] : {std::pair{"f32", std::size_t{4}}, {"f64", std::size_t{8}}}) {
        const measure::evaluate::TestedForm timed = row("sphere.schoolbook", format);
        CHECK(work.bytes(timed.format) == work.ray_count() * (9 * size + 1));
        const auto pass = work.work_for(timed, intersect::simd::packed_kernels(*timed.form));
        CHECK(pass.item_count == work.ray_count() * 3);
        pass.pass();
    }
    scene::file::Scene away = scene;
    away.listed.erase(away.listed.begin() + 1, away.listed.end());
    away.listed.front().set_point(
        0, {away.listed.front().numbers[0], away.listed.front().numbers[1], Real(50)});  // behind the eye
    measure::trade::SceneWork missing(away);
    CHECK(missing.hit_rate() == 0);
    CHECK(missing.primitive_count() == 1);
}

TEST_CASE("every row has a kernel at every register width", "[trade]") {
    const auto kernels = measure::trade::make_trade_kernels(
        {row("sphere.unified", "f32"), row("sphere.double_inside", "f32"), row("box.signs", "f64")});
    CHECK(kernels.size() == 3 * intersect::simd::available_isas().size());
    for (const measure::trade::TradeKernel& kernel : kernels) {
        CHECK((kernel.f32 != nullptr) == (kernel.measured.format.name == "f32"));
        CHECK((kernel.f64 != nullptr) == (kernel.measured.format.name == "f64"));
        if (kernel.isa == "scalar" && kernel.f32) CHECK(kernel.f32 == kernel.measured.form->native32);
    }
}

TEST_CASE("median and quartiles follow their definition", "[trade]") {
    const measure::trade::Timing odd = measure::trade::summarise_samples({5, 1, 4, 2, 3});
    CHECK(odd.median == 3);
    CHECK(odd.low_quartile == 2);
    CHECK(odd.high_quartile == 4);
    const measure::trade::Timing even = measure::trade::summarise_samples({4, 1});
    CHECK(even.median == 2.5);
    CHECK(even.low_quartile == 1.75);
    CHECK(measure::trade::summarise_samples({7}).high_quartile == 7);
}

TEST_CASE("every row is timed in every round, and the thread's affinity is restored", "[trade]") {
    const auto allowed = [] {
        cpu_set_t set;
        CPU_ZERO(&set);
        REQUIRE(sched_getaffinity(0, sizeof set, &set) == 0);
        return set;
    };
    const cpu_set_t before = allowed();
    std::vector<int> calls(3), processors;
    std::vector<measure::trade::TimedWork> work;
    for (std::size_t i = 0; i < calls.size(); ++i) {
        work.push_back({[&calls, &processors, i] {
                            ++calls[i];
                            processors.push_back(sched_getcpu());
                        },
                        10, i == 0});
    }
    std::uint64_t done = 0;
    const auto timings = measure::trade::time_interleaved(
        work, {.repetitions = 4, .min_seconds = 1e-6, .seed = 2, .progress = [&done](std::uint64_t n) { done += n; }});
    REQUIRE(timings.size() == 3);
    for (const measure::trade::Timing& timing : timings)
        CHECK((timing.median > 0 && timing.low_quartile <= timing.median && timing.median <= timing.high_quartile));
    for (const int n : calls) CHECK(n > 4);
    CHECK(done == 12);
    CHECK(std::ranges::all_of(processors, [&](int p) { return p == processors.front(); }));
    const cpu_set_t after = allowed();
    CHECK(CPU_EQUAL(&before, &after));
    CHECK_THROWS_AS(measure::trade::time_interleaved(work, {.repetitions = 2,
                                                            .min_seconds = 1e-6,
                                                            .progress =
                                                                [](std::uint64_t n) {
                                                                    if (n > 0) throw std::runtime_error("stop");
                                                                }}),
                    std::runtime_error);
    const cpu_set_t stopped = allowed();
    CHECK(CPU_EQUAL(&before, &stopped));
}

TEST_CASE("loads combine every working set with every share of hits", "[trade]") {
    const auto loads = measure::trade::make_trade_loads({48 << 10, 2 << 20, std::size_t{260} << 20});
    REQUIRE(loads.size() == 9);
    CHECK(loads[0].bytes == 24 << 10);
    CHECK(loads[3].bytes == 1 << 20);
    CHECK(loads[6].bytes == (std::size_t{520} << 20) / 6);
    CHECK(loads[measure::trade::reference_load(loads)].working_set == "l1");
    CHECK(loads[measure::trade::reference_load(loads)].hit_rate == 0.5);
    CHECK(measure::trade::make_trade_loads({1, 1, 1})[8].bytes == std::size_t{32} << 20);
    CHECK(measure::trade::read_cache_sizes().l1 > 0);
}

}  // namespace test_trade
