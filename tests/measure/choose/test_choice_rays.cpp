// A choice for rays of files is the choice for the scene they come from, and the rays are stretched as a scene is.
// Storing the inputs in another format finds the obstacle to a requirement.
#include <algorithm>

#include "catch.hpp"
#include "measure/choose/file_rays.hpp"
#include "measure/choose/margin.hpp"
#include "measure/choose/obstacle.hpp"
#include "measure/evaluate/map.hpp"
#include "measure/rows.hpp"
#include "measure/study/study.hpp"
#include "number/error.hpp"
#include "number/real.hpp"
#include "scene/ray_file/ray_file_writer.hpp"

namespace lostbits::test::test_choice_rays {

using namespace lostbits::measure::choose;
using measure::evaluate::TestedForm;
using scene::file::Scene;
using scene::test::Columns;

namespace {

Scene scene_of_choice(const char* name, std::pair<int, int> size = {64, 48}) { return test::scene_named(name, size); }

Columns columns_of(const scene::rays::RayBlock& rays, std::size_t from, std::size_t to) {
    Columns columns;
    const char* const names[] = {"ox", "oy", "oz", "dx", "dy", "dz"};
    const std::vector<double>* const parts[] = {&rays.ox, &rays.oy, &rays.oz, &rays.dx, &rays.dy, &rays.dz};
    for (std::size_t k = 0; k < 6; ++k)
        columns.add(names[k], {parts[k]->begin() + static_cast<std::ptrdiff_t>(from),
                               parts[k]->begin() + static_cast<std::ptrdiff_t>(to)});
    return columns;
}

std::string written(const lostbits::test::Scratch& folder, const std::string& name, const Columns& columns) {
    return folder.write(name + ".csv", scene::test::to_csv(columns, [](double x) { return output::file::decimal(x); }));
}

std::unique_ptr<scene::ray_file::RayFile> opened(const std::string& path, bool primitives) {
    scene::ray_file::ReadOptions options;
    options.format = find_format("f32");
    if (!primitives) options.primitive = Shape::sphere;
    return scene::ray_file::open_ray_file(path, options);
}

ChoiceRequest requirement_of(double bits, std::vector<TestedForm> tested_forms) {
    ChoiceRequest request;
    request.tested_forms = std::move(tested_forms);
    request.requirement.bits = bits;
    request.plan = {.repetitions = 1, .min_seconds = 1e-6};
    return request;
}

void require_same(const FormQuality& a, const FormQuality& b) {
    CHECK(a.ray_count == b.ray_count);
    CHECK(a.true_hit_count == b.true_hit_count);
    CHECK(a.wrong_count == b.wrong_count);
    CHECK(a.main_fault == b.main_fault);
    CHECK(a.kept_bits == b.kept_bits);
}

/// A ray along z, from (0, 0, z), at a sphere of radius r whose centre is (0, 0, c).
Scene one_ray(const char* z, const char* c, const char* r) {
    Scene scene;
    scene.id = "one";
    scene.inputs = scene::file::InputRounding::own;
    scene.width = scene.height = 1;
    scene.camera.kind = scene::file::Camera::Kind::pinhole;
    scene.camera.eye = {Real(0), Real(0), Real(z)};
    scene.camera.look_at = {Real(0), Real(0), Real(c)};
    scene.camera.up = {Real(0), Real(1), Real(0)};
    scene.camera.fov_deg = Real(40);
    scene.camera.shift_right = scene.camera.shift_up = Real(0);
    scene.listed.emplace_back(Sphere<Real>{{Real(0), Real(0), Real(c)}, Real(r)});
    return scene;
}

}  // namespace

TEST_CASE("rays of files are judged as the scene that they come from, in one file or several") {
    const lostbits::test::Scratch folder;
    const Scene scene = scene_of_choice("near-benign");
    const auto rays = scene::rays::make_shared_rays(scene, 0, scene.height);
    ChoiceRequest request =
        requirement_of(16, {test::row("sphere.schoolbook", "f32"), test::row("sphere.unified", "f64")});
    request.scene = &scene;
    const auto expected = measure_quality(request);
    request.scene = nullptr;
    const FileOptions options{.result_name = "rays", .primitives = scene::rays::make_shared_primitives(scene)};
    const auto whole = opened(written(folder, "whole", columns_of(rays, 0, rays.size())), false);
    const FileRays one = judge_and_sample(*whole, options, request);
    CHECK(one.ray_count == rays.size());
    CHECK_FALSE(one.answers);
    std::vector<std::unique_ptr<scene::ray_file::RayFile>> parts;
    parts.push_back(opened(written(folder, "first", columns_of(rays, 0, 1000)), false));
    parts.push_back(opened(written(folder, "second", columns_of(rays, 1000, rays.size())), false));
    const FileRays two = judge_and_sample(*scene::ray_file::join_ray_files(std::move(parts)), options, request);
    CHECK(two.ray_count == rays.size());
    for (std::size_t r = 0; r < 2; ++r) {
        require_same(one.quality[r], expected[r]);
        require_same(two.quality[r], expected[r]);
    }
    CHECK(two.sample.rays.ox == one.sample.rays.ox);
    CHECK(two.sample.rays.dz == one.sample.rays.dz);
    // They are timed as candidates, with the scene's primitives.
    request.rays = &one;
    TimedRays timed;
    const auto all = measure_candidates(request, timed);
    REQUIRE(all.size() == 2);
    CHECK(timed.ray_count == rays.size());
    CHECK(timed.primitive_count == 3);  // one of the four is seen by no ray
    for (const Candidate& candidate : all) CHECK(candidate.time.median > 0);
}

TEST_CASE("the sample of a long file is every n-th ray") {
    const lostbits::test::Scratch folder;
    Columns columns;
    for (const char* name : {"ox", "oy", "oz", "dx", "dy", "dz", "cx", "cy", "cz", "radius"}) columns.add(name, {});
    constexpr int rays = 40000;
    for (int i = 0; i < rays; ++i) {
        const double numbers[] = {static_cast<double>(i), 0, 0, 0, 0, 1, static_cast<double>(i), 0, 5, 1};
        for (std::size_t k = 0; k < 10; ++k) columns.numbers[k].push_back(numbers[k]);
    }
    const auto ray_file = opened(written(folder, "long", columns), true);
    ChoiceRequest request = requirement_of(8, {test::row("sphere.schoolbook", "f32")});
    const FileRays judged = judge_and_sample(*ray_file, {.result_name = "long"}, request);
    CHECK(judged.ray_count == rays);
    CHECK(judged.quality.front().true_hit_count == rays);
    const auto& sample = judged.sample;
    REQUIRE(sample.rays.size() == 2500);  // of 40000 every 16th: of 8 there were 5000
    CHECK(sample.is_paired);
    REQUIRE(sample.primitives.size() == 2500);
    for (std::size_t i = 0; i < 2500; ++i) {
        CHECK(sample.rays.ox[i] == 16 * static_cast<double>(i));
        CHECK(sample.primitives[i].numbers[0] == sample.rays.ox[i]);
    }
}

TEST_CASE("files of different kinds are not read together") {
    const lostbits::test::Scratch folder;
    const Scene scene = scene_of_choice("near-benign", {8, 6});
    const auto rays = scene::rays::make_shared_rays(scene, 0, scene.height);
    Columns with_primitives = columns_of(rays, 0, 10);
    for (const char* name : {"cx", "cy", "cz", "radius"}) with_primitives.add(name, std::vector<double>(10, 1));
    std::vector<std::unique_ptr<scene::ray_file::RayFile>> files;
    files.push_back(opened(written(folder, "plain", columns_of(rays, 0, 10)), false));
    files.push_back(opened(written(folder, "paired", with_primitives), true));
    CHECK_THROWS_AS(scene::ray_file::join_ray_files(std::move(files)), InputError);
}

TEST_CASE("stretching rays by 1 changes nothing, and by more meets the same points from farther away") {
    const Scene scene = scene_of_choice("near-benign", {16, 12});
    const scene::rays::RayGroup group{scene::rays::make_shared_rays(scene, 0, 12),
                                      scene::rays::make_shared_primitives(scene)};
    const IdealRays ideal = make_ideal_rays(group);
    const measure::truth::Band here = ideal.band({});
    for (const Growth growth : {Growth::distance, Growth::radius, Growth::offset}) {
        INFO(growth_names[static_cast<std::size_t>(growth)]);
        const auto same = stretch(ideal, growth, 1);
        REQUIRE(same);
        const auto back = store_in_format(same->rays, binary32);
        CHECK(back.rays.ox == group.rays.ox);
        CHECK(back.rays.oz == group.rays.oz);
        for (std::size_t s = 0; s < 4; ++s) CHECK(back.primitives[s].numbers == group.primitives[s].numbers);
        // The primitive that is hit stays the same. From farther away the point does too, since the origin moves along
        // the ray.
        const auto there = stretch(ideal, growth, 4);
        REQUIRE(there);
        const measure::truth::Band band = there->rays.band({});
        std::size_t hits = 0;
        for (std::size_t i = 0; i < here.pixel_count() && growth != Growth::radius; ++i) {
            REQUIRE(band.truth(i, {}).primitive == here.truth(i, {}).primitive);
            if (!here.truth(i, {}).is_hit()) continue;
            ++hits;
            const auto point = [i](const IdealRays& rays, const measure::truth::Band& of) {
                const double t = of.rounded_truth(i, binary64, intersect::Direction::any, {});
                return rays.rays[i].origin + Real(t) * rays.rays[i].direction;
            };
            const Vec<Real> apart = point(there->rays, band) - point(ideal, here);
            if (growth == Growth::distance) CHECK(length(apart) < 1e-14);
        }
        CHECK((hits > 20 || growth == Growth::radius));
    }
    CHECK(stretch(ideal, Growth::distance, 8)->value ==
          Approx(8 * stretch(ideal, Growth::distance, 1)->value).epsilon(1e-14));
    CHECK_FALSE(stretch(ideal, Growth::view, 2));
    // One primitive for all rays becomes one for each, and its point nearest to the origin stays.
    IdealRays one = ideal;
    one.primitives.resize(1);
    const auto large = stretch(one, Growth::radius, 100);
    REQUIRE(large);
    CHECK(large->rays.is_paired);
    REQUIRE(large->rays.primitives.size() == one.rays.size());
    const auto gap = [](const IdealRays& rays, std::size_t i, std::size_t primitive) {
        const auto sphere = rays.primitives[primitive].sphere();
        return length(sphere.centre - rays.rays[i].origin) - sphere.radius;
    };
    CHECK(abs(gap(large->rays, 5, 5) - gap(one, 5, 0)) < 1e-40);
    CHECK(large->value == Approx(100).epsilon(1e-14));
}

TEST_CASE("a requirement on rays holds at the edge of the margin and fails just beyond it") {
    const Scene scene = scene_of_choice("near-benign", {32, 24});
    FileRays rays;
    rays.format = *find_format("f32");
    rays.sample = {scene::rays::make_shared_rays(scene, 0, 24), scene::rays::make_shared_primitives(scene)};
    const TestedForm row = test::row("sphere.schoolbook", "f32");
    ChoiceRequest request = requirement_of(14, {row});
    request.rays = &rays;
    const auto margins = find_margins(request, row);
    REQUIRE(margins.size() == 3);
    for (const GrowthMargin& margin : margins) {
        INFO(growth_names[static_cast<std::size_t>(margin.growth)]);
        CHECK(margin.holding_factor >= 1);
        if (margin.end != MarginEnd::fails) continue;
        CHECK(margin.end_factor / margin.holding_factor <= 1.02);
        const auto at = [&](double factor) {
            const auto there = stretch(make_ideal_rays(rays.sample), margin.growth, factor);
            return measure_quality_on(measure::truth::Band(store_in_format(there->rays, binary32)), row,
                                      request.requirement);
        };
        CHECK(at(margin.holding_factor).meets(request.requirement));
        CHECK_FALSE(at(margin.end_factor).meets(request.requirement));
    }
    CHECK(margins.front().end == MarginEnd::fails);
}

TEST_CASE("obstacles: the one input that is rounded far off is named") {
    // By hand (Python's fractions): binary32 has 1000000.03 as 1000000; t = 1000000.03 - 999990.5 - 1 = 8.53 becomes
    // 8.5, off by 0.03, in ulps of binary64 (2^-49 at 8.53) 2^43.94: 8.059 of 53 bits are left. A quantile of lost bits
    // is known to 2^-11 of itself.
    const Scene scene = one_ray("999990.5", "1000000.03", "1");
    const TestedForm row = test::row("sphere.unified", "f32");
    ChoiceRequest request = requirement_of(16, {row});
    request.scene = &scene;
    const Obstacle found = find_obstacle(request, row);
    CHECK(found.cause == Obstacle::Cause::inputs);
    CHECK(found.base_format == binary32);
    CHECK(found.exact.kept_bits == Approx(8.059).margin(0.025));
    REQUIRE(found.trials.size() == 16);
    REQUIRE(found.sufficient_trial);
    const InputTrial& enough = found.trials[*found.sufficient_trial];
    CHECK(enough.wide_inputs == 4);  // the centre alone
    CHECK(enough.exact.kept_bits > 30);
    REQUIRE(enough.form);
    CHECK(enough.form->meets(request.requirement));
    CHECK(found.trials[1].exact.kept_bits == found.exact.kept_bits);  // the origin is exact
    CHECK(found.min_precision == 32);  // with 31 bits of the centre 15.18 are left, with 32 18.06
}

TEST_CASE("obstacles: format, problem and formula are told apart") {
    const TestedForm row = test::row("sphere.unified", "f32");
    // Every number is one of binary32, and the ray starts far away: half an ulp in the centre costs bits all the same.
    const Scene far = one_ray("0", "1048576", "1048575");
    ChoiceRequest request = requirement_of(16, {row});
    request.scene = &far;
    const Obstacle problem = find_obstacle(request, row);
    CHECK(problem.cause == Obstacle::Cause::inherent);
    CHECK(problem.exact.kept_bits == 53);
    // t = 1 moves by half an ulp of 2^20, 2^-4, and of 2^20 - 1, 2^-5: 0.75·2^20 ulp, of which 20.585 bits are lost.
    CHECK(problem.inherent_kept == Approx(24 - 20.585).margin(0.001));
    CHECK(problem.inherent_kept_f64 == Approx(53 - 20.585).margin(0.001));
    request.requirement.bits = 30;
    CHECK(find_obstacle(request, row).cause == Obstacle::Cause::width);
    // Some 18 bits are kept where half an ulp in each input would leave 20: neither is 23, but the formula loses more.
    const Scene benign = scene_of_choice("near-benign");
    const TestedForm lossy = test::row("sphere.schoolbook", "f32");
    request = requirement_of(23, {lossy});
    request.scene = &benign;
    const Obstacle loses = find_obstacle(request, lossy);
    CHECK(loses.cause == Obstacle::Cause::formula);
    const Scene thin = with_smaller_picture(benign, 2048);
    const auto* const inherent = measure::metric::find_metric("inherent_bits");
    const auto map = measure::evaluate::run_map({.scene = &thin, .tested_forms = {lossy}, .metrics = {inherent}});
    CHECK(loses.inherent_kept == 24 - map.front().metrics[0].quantile(0.99));
    CHECK(loses.exact.kept_bits == 53);
    // Seen from 4100 radii, the quadratic formula decides wrongly what exact arithmetic decides correctly.
    const Scene oblique = scene_of_choice("rtg-fig-7-3-4100-oblique", {32, 32});
    const TestedForm schoolbook = test::row("sphere.schoolbook", "f32");
    request = requirement_of(4, {schoolbook});
    request.scene = &oblique;
    const Obstacle formula = find_obstacle(request, schoolbook);
    CHECK(formula.cause == Obstacle::Cause::formula);
    CHECK(formula.exact.wrong_count == 0);
    CHECK(formula.rounds_to_binary32_first);
}

TEST_CASE("obstacles: inputs that binary64 cannot hold need a wider format") {
    const Scene scene = one_ray("999990.5", "1000000.03", "1");
    const TestedForm row = test::row("sphere.unified", "f64");
    ChoiceRequest request = requirement_of(48, {row});
    request.scene = &scene;
    const Obstacle found = find_obstacle(request, row);
    CHECK(found.cause == Obstacle::Cause::inputs);
    CHECK(found.wide_inputs_are_exact);
    REQUIRE(found.sufficient_trial);
    CHECK(found.trials[*found.sufficient_trial].wide_inputs == 4);
    CHECK(found.min_precision == 62);  // with 61 bits of the centre 45.2 are left (fractions)
}

TEST_CASE("the safe offsets of a choice are those of the scene in fewer pixels") {
    const Scene scene = scene_of_choice("near-benign", {32, 24});
    const TestedForm row = test::row("sphere.double_inside", "f32");
    const auto safe = find_safe_offsets(scene, row);
    REQUIRE(safe);
    CHECK(safe->point_count > 100);
    REQUIRE_FALSE(safe->outside.empty());
    CHECK(safe->outside.front().operation_count == 0);  // the primitive is at least not tested
    CHECK(std::ranges::count(safe->outside, "offset.exclude", [](const auto& s) { return s.strategy->name; }) == 1);
    const measure::offset::OffsetStudy request{.scene = scene,
                                               .tested_forms = {{row}},
                                               .strategies = measure::offset::all_strategies(),
                                               .search_quiet_offset = false};
    const auto all = measure::offset::find_safe_strategies(measure::study::run_study(request).front(),
                                                           request.strategies, Shape::sphere);
    REQUIRE(safe->both_sides.size() == all.size());
    for (std::size_t k = 0; k < all.size(); ++k) CHECK(safe->both_sides[k].strategy == all[k].strategy);
    CHECK_FALSE(find_safe_offsets(scene_of_choice("sphereflake-near"), row));
}

}  // namespace lostbits::test::test_choice_rays
