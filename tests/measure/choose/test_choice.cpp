// Forms that meet a requirement, and the margin of the requirement. Times do not matter here.
#include <algorithm>
#include <cmath>
#include <set>

#include "catch.hpp"
#include "measure/choose/candidates.hpp"
#include "measure/choose/margin.hpp"
#include "measure/evaluate/map.hpp"
#include "measure/rows.hpp"
#include "output/choose/choice_files.hpp"
#include "scene/file/scene.hpp"

namespace lostbits::test::test_choice {

using namespace lostbits::measure::choose;
using measure::evaluate::TestedForm;
using scene::file::Scene;
using test::row;

namespace {

Scene scene_named(const std::string& name) { return test::load(name, 48, 48); }

ChoiceRequest request_of(const Scene& scene, double bits) {
    ChoiceRequest request{.scene = &scene};
    request.requirement.bits = bits;
    request.plan = {.repetitions = 1, .min_seconds = 1e-6};
    return request;
}

Candidate candidate(double time, std::uint64_t wrong, double bits) {
    Candidate c{.tested_form = row("sphere.schoolbook", "f32")};
    c.time.median = time;
    c.quality = {.ray_count = 100, .wrong_count = wrong, .kept_bits = bits, .true_hit_count = 50};
    return c;
}

}  // namespace

TEST_CASE("the cheapest row that meets a requirement is neither the fastest nor the most accurate") {
    const double none = std::nan("");
    const std::vector<Candidate> all{candidate(1, 0, 9), candidate(2, 1, 20), candidate(3, 0, 17), candidate(4, 0, 22),
                                     candidate(0.5, 50, none)};
    CHECK(find_cheapest(all, {.bits = 16}) == 2);
    CHECK(find_cheapest(all, {.bits = 16, .max_wrong_fraction = 0.01}) == 1);
    CHECK(find_cheapest(all, {.bits = 8}) == 0);
    CHECK(find_fastest(all) == 4);
    CHECK(find_most_accurate(all) == 3);
    CHECK_FALSE(find_cheapest(all, {.bits = 23}));
    CHECK(find_nearest_candidate(all, {.bits = 23}) == 3);
    CHECK(measure::choose::find_nearest_candidate({candidate(1, 7, 20), candidate(2, 3, 5)}, {.bits = 1}) == 1);
    CHECK_FALSE(find_cheapest({candidate(1, 0, none)}, {.bits = 0}));
}

TEST_CASE("every row is timed on rays of the scene and has the accuracy that a map reports") {
    const Scene scene = scene_named("rtg-fig-7-3-4100-oblique");
    ChoiceRequest request = request_of(scene, 16);
    request.tested_forms = {row("sphere.schoolbook", "f32"), row("sphere.schoolbook", "f64")};
    TimedRays timed;
    const auto all = measure_candidates(request, timed);
    REQUIRE(all.size() == 2);
    CHECK(timed.primitive_count == 1);
    CHECK(timed.ray_count > 1000);
    for (const Candidate& candidate : all) CHECK(candidate.time.median > 0);
    const auto* const lost = measure::metric::find_metric("lost_bits");
    const auto summaries =
        measure::evaluate::run_map({.scene = &scene, .tested_forms = request.tested_forms, .metrics = {lost}});
    for (std::size_t r = 0; r < all.size(); ++r) {
        CHECK(all[r].quality.wrong_count == summaries[r].wrong_count());
        CHECK(all[r].quality.true_hit_count == summaries[r].true_hit_count);
    }
    CHECK(all[0].quality.wrong_count > 0);
    CHECK(all[1].quality.wrong_count == 0);
    CHECK(all[1].quality.kept_bits == 53 - summaries[1].metrics[0].quantile(0.99));
}

TEST_CASE("a form is called the fastest only beyond the noise, and scalar forms are marked") {
    const Scene scene = scene_named("near-benign");
    const ChoiceRequest request = request_of(scene, 16);
    const auto said = [&](double first, double second, double spread, std::string_view isa) {
        std::vector<Candidate> all{candidate(first * 1e-9, 0, 20), candidate(second * 1e-9, 0, 20)};
        all[1].tested_form = row("sphere.double_inside", "f32");
        for (Candidate& candidate : all) {
            candidate.isa = "512";
            candidate.time.low_quartile = candidate.time.median * (1 - spread);
            candidate.time.high_quartile = candidate.time.median * (1 + spread);
        }
        all[1].isa = isa;
        return output::choose::choice_text({request, all, {2000, 1}, find_cheapest(all, request.requirement)});
    };
    const std::string near = said(1, 1.002, 0.02, "512"), apart = said(1, 1.5, 0.02, "512");
    CHECK(near.find("It is the fastest of all") == std::string::npos);
    CHECK(near.find("whether this or sphere.double_inside in f32 with f64 inside (1.00 ns;") != std::string::npos);
    CHECK(near.find("The timing noise is too large to say") != std::string::npos);
    CHECK(apart.find("It is the fastest of all") != std::string::npos);
    CHECK(apart.find("one ray at a time") == std::string::npos);
    const std::string scalar = said(1, 1.5, 0.02, "scalar");
    CHECK(scalar.find(
              "Timed one ray at a time, because they take no more: sphere.double_inside in f32 with f64 inside; the "
              "others in registers of 512 bits") != std::string::npos);
    // In the other order, the other form is chosen.
    CHECK(said(3, 1.5, 0.02, "scalar").find("It takes 1.50 ns per ray and primitive, one ray at a time") !=
          std::string::npos);
}

TEST_CASE("the format in which a form computes is read from its operations") {
    const std::set<std::string_view> in_double{"sphere.double_inside", "triangle.pbrt",          "triangle.woop_double",
                                               "triangle.woop_once",   "torus.bracketed_double", "torus.double_inside",
                                               "tube.mitsuba"};
    for (const auto& form : intersect::table::intersectors()) {
        if (form.shape == Shape::sdf) continue;
        INFO(form.info->name);
        CHECK(computing_format({&form, *find_format("f32")}).name ==
              (in_double.contains(form.info->name) ? "f64" : "f32"));
        if (form.info->name == "sphere.double_inside") continue;
        CHECK(computing_format({&form, *find_format("bf16")}).name == "bf16");
    }
}

TEST_CASE("stretching a scene by 1 changes nothing, and by more shows the same picture from farther away") {
    const Scene scene = scene_named("near-benign");
    for (const Growth growth : growths) {
        const auto same = stretch(scene, growth, 1);
        REQUIRE(same);
        CHECK(abs(same->scene.camera.eye.x - scene.camera.eye.x) < 1e-50);
        CHECK(abs(same->scene.camera.fov_deg - scene.camera.fov_deg) < 1e-50);
        CHECK(abs(same->scene.listed[0].sphere().radius - scene.listed[0].sphere().radius) < 1e-50);
    }
    const auto far = stretch(scene, Growth::distance, 8), near = stretch(scene, Growth::distance, 1);
    CHECK(far->value == Approx(8 * near->value).epsilon(1e-14));
    const auto large = stretch(scene, Growth::radius, 1000);
    CHECK(large->value == Approx(1200).epsilon(1e-14));  // the largest of the scene has radius 1.2
    // The point nearest to the eye stays: distance to the centre less radius.
    const auto gap = [&](const Scene& s) {
        return length(s.listed[2].sphere().centre - s.camera.eye) - s.listed[2].sphere().radius;
    };
    CHECK(abs(gap(large->scene) - gap(scene)) < 1e-40);
    CHECK_FALSE(stretch(scene, Growth::view, 1e6));
    CHECK_FALSE(stretch(scene_named("rtg-fig-7-3-4100-oblique"), Growth::view, 2));  // parallel rays
}

TEST_CASE("a mesh, with a matrix or without, moves with everything else, and does not grow triangle by triangle") {
    for (const char* const name : {"mesh-icosphere-near", "instance-mesh"}) {
        Scene scene = test::load(name, 24, 24);
        scene.inputs = scene::file::InputRounding::own;  // so that the farther scene is not rounded to another one
        const auto there = stretch(scene, Growth::offset, 3);
        REQUIRE(there);
        const measure::truth::Band before(scene, 0, scene.height), after(there->scene, 0, scene.height);
        std::size_t hits = 0, other = 0;
        for (std::size_t i = 0; i < before.pixel_count(); ++i) {
            const measure::truth::Truth a = before.truth(i, {}), b = after.truth(i, {});
            hits += a.is_hit();
            other += a.is_hit() != b.is_hit() || (a.is_hit() && std::fabs(a.t.hi / b.t.hi - 1) > 1e-6);
        }
        INFO(name);
        CHECK(hits > 100);
        CHECK(other == 0);
        CHECK_FALSE(stretch(scene, Growth::radius, 2));
    }
}

TEST_CASE("a requirement holds at the edge of the margin and fails just beyond it") {
    const Scene scene = scene_named("near-benign");
    ChoiceRequest request = request_of(scene, 16);
    const TestedForm tested_form = row("sphere.schoolbook", "f32");
    const auto margins = find_margins(request, tested_form, 48 * 48);
    REQUIRE(margins.size() == 4);
    const GrowthMargin& distance = margins[0];
    REQUIRE(distance.end == MarginEnd::fails);
    CHECK(distance.holding_factor >= 1);
    CHECK(distance.end_factor / distance.holding_factor <= 1.02);
    request.tested_forms = {tested_form};
    const auto at = [&](double factor) {
        const auto there = stretch(scene, Growth::distance, factor);
        ChoiceRequest there_asked = request;
        there_asked.scene = &there->scene;
        return measure_quality(there_asked).front();
    };
    CHECK(at(distance.holding_factor).meets(request.requirement));
    CHECK_FALSE(at(distance.end_factor).meets(request.requirement));
    CHECK(at(distance.end_factor).kept_bits == distance.end_quality.kept_bits);
    CHECK(at(64 * distance.end_factor).kept_bits < 16);
}

TEST_CASE("the margin ends where two spheres that differ only in radius round to one radius") {
    const TestedForm tested_form = row("sphere.pythagoras", "f64");
    const auto edge = [&tested_form](const std::string& variant) {
        const Scene scene = scene_named("rtg-fig-7-4." + variant);
        const auto margins = find_margins(request_of(scene, 16), tested_form, 4096);
        const auto radius = std::ranges::find(margins, Growth::radius, &GrowthMargin::growth);
        REQUIRE(radius != margins.end());
        REQUIRE(radius->end == MarginEnd::fails);
        return radius->value;
    };
    CHECK(edge("r1e6") == Approx(edge("r6371000")).epsilon(0.05));
}

TEST_CASE("a margin ends where binary32 stores a different scene, even if all decisions are right there") {
    const Scene scene = scene_named("near-benign");
    const ChoiceRequest request = request_of(scene, 16);
    const TestedForm tested_form = row("sphere.unified", "f64");
    const auto margins = find_margins(request, tested_form, 48 * 48);
    const auto offset = std::ranges::find(margins, Growth::offset, &GrowthMargin::growth);
    REQUIRE(offset != margins.end());
    CHECK(offset->end == MarginEnd::other_scene);
    CHECK(offset->value > 1e5);
    CHECK(offset->value < 1e8);
    Scene own = scene;
    own.inputs = scene::file::InputRounding::own;
    ChoiceRequest of_own = request;
    of_own.scene = &own;
    const auto own_rooms = find_margins(of_own, tested_form, 24 * 24);
    CHECK(std::ranges::find(own_rooms, Growth::offset, &GrowthMargin::growth)->end != MarginEnd::other_scene);
}

TEST_CASE("a requirement that fails at once has no margin") {
    const Scene scene = scene_named("rtg-fig-7-3-4100-oblique");
    const auto margins = find_margins(request_of(scene, 20), row("sphere.schoolbook", "f32"), 1024);
    REQUIRE_FALSE(margins.empty());
    for (const GrowthMargin& margin : margins) {
        CHECK(margin.holding_factor == 0);
        CHECK(margin.end == MarginEnd::fails);
        CHECK(margin.end_quality.wrong_count > 0);
    }
}

}  // namespace lostbits::test::test_choice
