// Ratios of speeds: a real difference is found, equal work shows none, and every timed kernel does its work.
#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <thread>

#include "catch.hpp"
#include "measure/rows.hpp"
#include "measure/trade/timing.hpp"
#include "measure/trade/timing_work.hpp"

namespace test_timing {

using namespace lostbits;
using namespace lostbits::test;

namespace {

measure::trade::TimedWork adds(int times) {
    return {[times] {
                volatile double x = 1;
                for (int i = 0; i < times; ++i) x = x * 1.0000001;
            },
            1, true};
}

/// The t of boxes after one pass from a fresh start.
std::vector<float> after_a_pass(const measure::trade::TimedKernel& kernel) {
    measure::trade::BoxWork work(1 << 14);
    const auto timed = work.work_for(kernel);
    REQUIRE(timed.has_value());
    CHECK(timed->item_count == work.f32()->t.size());
    timed->pass();
    return {work.f32()->t.begin(), work.f32()->t.end()};
}

}  // namespace

TEST_CASE("a ratio of times is the median of the ratios of the rounds", "[timing]") {
    const std::vector<double> a{2, 40, 6}, b{1, 10, 2};  // 2, 4, 3
    CHECK(measure::trade::summarise_ratios(a, b).median == 3);
    CHECK(measure::trade::summarise_ratios(a, b).low_quartile == 2.5);
    CHECK(measure::trade::summarise_ratios(b, b).high_quartile == 1);
}

TEST_CASE("twelve times the work measures as slower, and equal work as equal", "[timing]") {
    const measure::trade::TimedWork work[] = {adds(500), adds(6000), adds(500)};
    const auto samples = measure::trade::sample_interleaved(work, {.repetitions = 31, .min_seconds = 2e-4});
    CHECK(measure::trade::summarise_ratios(samples[1], samples[0]).median > 4);
    CHECK(measure::trade::summarise_ratios(samples[1], samples[0]).median < 36);
    CHECK(measure::trade::summarise_ratios(samples[2], samples[0]).median > 0.5);
    CHECK(measure::trade::summarise_ratios(samples[2], samples[0]).median < 2);
}

TEST_CASE("every thread runs its own work, and one thread alone is the reference", "[timing]") {
    std::array<std::atomic<int>, 3> passes{};
    std::array<std::atomic<bool>, 3> busy{};
    std::atomic<int> faults{0};
    const auto caller = std::this_thread::get_id();
    const auto quotients = measure::trade::measure_thread_speedups(
        [&](std::size_t i) {
            return [&, i] {
                faults += busy[i].exchange(true) || std::this_thread::get_id() == caller;
                ++passes[i];
                busy[i] = false;
            };
        },
        {.repetitions = 4, .min_seconds = 1e-3, .thread_count = 3});
    CHECK(quotients.size() == 4);
    for (const double q : quotients) CHECK((q > 0 && std::isfinite(q)));
    for (const auto& n : passes) CHECK(n > 4);
    CHECK(faults == 0);
    std::atomic<bool> stop_requested{false};
    CHECK_THROWS_AS(measure::trade::measure_thread_speedups([&](std::size_t) { return [&] { stop_requested = true; }; },
                                                            {.repetitions = 3,
                                                             .min_seconds = 1e-4,
                                                             .thread_count = 1,
                                                             .stop = intersect::process::StopToken(stop_requested)}),
                    Interrupted);
    CHECK_FALSE(measure::trade::allowed_processors().empty());
}

TEST_CASE("plain loops, packs and scalar loops do the same work", "[timing]") {
    for (const intersect::table::Intersector& form : intersect::table::intersectors(Shape::box)) {
        const std::string_view name = form.info->name;
        INFO(name);
        const auto scalar = after_a_pass({name, "scalar", "f32"});
        const auto hits = std::ranges::count_if(scalar, [](float t) { return std::isfinite(t); });
        CHECK(hits > 4);
        CHECK(hits < static_cast<std::ptrdiff_t>(scalar.size()) - 4);
        CHECK(after_a_pass({name, "128", "f32"}) == scalar);
        const auto loops = intersect::simd::all_plain_kernels();
        const auto has_info = [&form](const auto& row) { return row.info == form.info; };
        if (name == "box.filtered") CHECK(std::ranges::none_of(loops, has_info));
        if (loops.empty() || name == "box.filtered") continue;
        CHECK(after_a_pass({name, "plain-256", "f32"}) == scalar);
        CHECK(after_a_pass({name, "plain-structs-256", "f32"}) == scalar);
    }
}

TEST_CASE("a kernel that does not exist is not timed", "[timing]") {
    measure::trade::BoxWork boxes(1 << 12);
    CHECK_FALSE(boxes.work_for({"box.sign", "128", "f32"}).has_value());
    CHECK_FALSE(boxes.work_for({"sphere.unified", "128", "f32"}).has_value());
    CHECK_FALSE(boxes.work_for({"box.signs", "plain-256", "f64"}).has_value());
    CHECK_FALSE(boxes.work_for({"box.signs", "127", "f32"}).has_value());
    CHECK_FALSE(boxes.work_for({"box.signs", "128", "f16"}).has_value());
    measure::trade::RayWork rays(1 << 12);
    CHECK_FALSE(rays.work_for({"sphere.unified", "plain-256", "f32"}).has_value());
    CHECK_FALSE(rays.work_for({"sphere.double_inside", "128", "f64"}).has_value());
    REQUIRE(rays.work_for({"sphere.unified", "128", "f64"}).has_value());
    rays.work_for({"sphere.unified", "128", "f64"})->pass();
    CHECK(std::abs(rays.f64(Shape::sphere)->hit_fraction() - 0.5) < 0.02);
    CHECK(measure::trade::working_set_bytes("l2", {1000, 2000, 4000}) == 1000);
    CHECK(measure::trade::working_set_bytes("l3", {1000, 2000, 4000}) == 0);
}

}  // namespace test_timing
