// Computations that are asked to stop in the middle, each by its own request and no other.
#include <atomic>
#include <functional>

#include "catch.hpp"
#include "measure/check/claim.hpp"
#include "measure/choose/candidates.hpp"
#include "measure/consistency/consistency.hpp"
#include "measure/evaluate/bits_needed.hpp"
#include "measure/evaluate/map.hpp"
#include "measure/judge/judge.hpp"
#include "measure/offset/offsets.hpp"
#include "measure/render/render.hpp"
#include "measure/rows.hpp"
#include "measure/study/study.hpp"
#include "measure/trade/timing.hpp"

#include "measure/sweep/exhaustive.hpp"
#include "measure/sweep/sweep.hpp"
#include "measure/sweep/worst.hpp"
#include "number/error.hpp"
#include "scene/check/claims_file.hpp"
#include "scene/file/scene.hpp"
#include "scene/ray_file/ray_file.hpp"

namespace lostbits::test::test_interrupted {

using intersect::process::StopToken;
using measure::evaluate::FormSummary;
using measure::metric::Metric;
using measure::metric::Sample;

namespace {

scene::file::Scene scene_named(const std::string& name, StopToken stop = {}) {
    const auto found = scene::file::find_scene(name, LOSTBITS_DATA_DIR);
    return scene::file::load_scene(found.path, {.variant = found.variant, .size = std::pair{16, 16}, .stop = stop})
        .front();
}

std::vector<FormSummary> mapped(const scene::file::Scene& scene, const Metric& metric, StopToken stop) {
    return measure::evaluate::run_map({.scene = &scene,
                                       .tested_forms = {test::row("sphere.schoolbook", "f32")},
                                       .metrics = {&metric},
                                       .limit = {.stop = stop}});
}

}  // namespace

TEST_CASE("of two maps in one process, one stops at the requested ray and the other continues", "[measure][map]") {
    static std::atomic<bool> first_asked;
    static int measured, others;
    static const scene::file::Scene* scene;
    static std::atomic<bool> second_asked;
    static std::vector<FormSummary> other;
    first_asked = second_asked = false;
    measured = others = 0;
    const auto loaded = scene_named("near-benign");
    scene = &loaded;
    const Metric asks{.name = "asks", .value = [](const Sample&) {
                          ++measured;
                          first_asked = true;
                          const Metric goes_on{.name = "goes_on", .value = [](const Sample&) {
                                                   ++others;
                                                   return 0.0;
                                               }};
                          other = mapped(*scene, goes_on, StopToken(second_asked));
                          return 0.0;
                      }};
    CHECK_THROWS_AS(mapped(loaded, asks, StopToken(first_asked)), Interrupted);
    CHECK(measured == 1);
    REQUIRE(other.size() == 1);
    CHECK(other.front().ray_count == 256);
    CHECK(others > 1);
    CHECK(static_cast<std::uint64_t>(others) == other.front().count(measure::answer::Outcome::agree_hit));
}

TEST_CASE("every computation stops where its own request says so") {
    const std::atomic<bool> flag{true};
    const StopToken stop(flag);
    const measure::truth::ProofLimit limit{.stop = stop};
    const std::filesystem::path data = LOSTBITS_DATA_DIR, sweeps = data / "sweeps";
    const auto scene = scene_named("raycast-acne");
    const measure::evaluate::TestedForm row = test::row("sphere.half_b", "f32");
    const std::vector<measure::evaluate::TestedForm> tested_forms{row};
    const auto& metrics = test::case_metrics;
    const scene::sweep::SweepFile sweep(sweeps / "sphere-distance.toml", data);
    const scene::sweep::CaseFile cases(sweeps / "extremes/contact.toml");
    const scene::sweep::ExhaustiveFile floats(sweeps / "exhaustive-distance.toml", LOSTBITS_DATA_DIR);
    const scene::sweep::SearchFile search(sweeps / "worst/near.toml");
    measure::sweep::ExhaustiveState state;
    const test::TextFile file("ox,oy,oz,dx,dy,dz\n0,0,-5,0,0,1\n");
    const auto open = [&](StopToken token) {
        return scene::ray_file::open_ray_file(
            file.path(), {.container = scene::ray_file::Container::csv, .primitive = Shape::sphere, .stop = token});
    };
    const auto rays = open({});
    std::vector<scene::check::Claim> claims{scene::check::read_claims(data / "claims/sphere.toml").front()};
    measure::trade::TimedWork pass{.pass = [] {}, .item_count = 1, .needs_warm_up = false};
    namespace m = measure;
    const std::pair<const char*, std::function<void()>> all[] = {
        {"map",
         [&] {
             m::evaluate::run_map({.scene = &scene, .tested_forms = tested_forms, .metrics = metrics, .limit = limit});
         }},
        {"needed",
         [&] {
             m::study::run_study(
                 m::evaluate::BitsNeededStudy{.scene = scene, .tested_forms = {row.form}, .limit = limit});
         }},
        {"render",
         [&] {
             m::study::run_study(m::render::RenderStudy{.scene = scene,
                                                        .stages = {scene::file::Stage::visible},
                                                        .tested_forms = tested_forms,
                                                        .limit = {.stop = stop}});
         }},
        {"offsets",
         [&] {
             m::study::run_study(m::offset::OffsetStudy{.scene = scene,
                                                        .tested_forms = {{row, m::offset::HitPointKind::computed}},
                                                        .strategies = m::offset::all_strategies(),
                                                        .limit = limit});
         }},
        {"consistency",
         [&] {
             m::study::run_study(m::consistency::ConsistencyStudy{
                 .scene = scene, .tested_forms = tested_forms, .checks = m::consistency::all_checks(), .limit = limit});
         }},
        {"sweep",
         [&] {
             m::sweep::run_sweep({.sweep = sweep, .tested_forms = tested_forms, .metrics = metrics, .limit = limit});
         }},
        {"cases",
         [&] {
             m::sweep::run_cases({.file = cases, .tested_forms = tested_forms, .metrics = metrics, .limit = limit});
         }},
        {"every float",
         [&] { m::sweep::run_exhaustive({.sweep = floats, .tested_forms = tested_forms, .limit = limit}, state); }},
        {"search",
         [&] {
             m::sweep::find_worst({.search = search, .tested_forms = tested_forms, .metrics = metrics, .limit = limit});
         }},
        {"judge",
         [&] {
             m::judge::run_judge(*rays, {.primitives = {Sphere<double>{{0, 0, 0}, 1}},
                                         .tested_forms = tested_forms,
                                         .metrics = metrics,
                                         .limit = limit});
         }},
        {"a file of rays", [&] { open(stop); }},
        {"a flake", [&] { static_cast<void>(scene_named("sphereflake-near", stop).primitives()); }},
        {"choice",
         [&] { m::choose::measure_quality({.scene = &scene, .tested_forms = tested_forms, .limit = limit}); }},
        {"claims", [&] { m::check::measure_claims(claims, {.data_dir = data, .stop = stop}); }},
        {"times",
         [&] {
             m::trade::sample_interleaved({&pass, 1}, {.stop = stop});
         }},
        {"times of threads",
         [&] { m::trade::measure_thread_speedups([](std::size_t) { return [] {}; }, {.stop = stop}); }}};
    for (const auto& [what, ask] : all) {
        INFO(what);
        CHECK_THROWS_AS(ask(), Interrupted);
    }
    CHECK(state.tried_float_count == 0);
}

}  // namespace lostbits::test::test_interrupted
