// Bounds over ranges of a form's inputs, compared with rays in these ranges: hostile rays over all exponents, and the
// rays of scenes.
#include <tbb/global_control.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <string>
#include <vector>

#include "catch.hpp"
#include "counts.hpp"
#include "intersect/hostile_rays.hpp"
#include "intersect/triangle/triangle_rays.hpp"
#include "measure/apriori/ranges.hpp"
#include "measure/rows.hpp"
#include "measure/tape/tape_form.hpp"
#include "number/rounded.hpp"
#include "output/attribution/explain_text.hpp"
#include "scene/file/scene.hpp"
#include "scene/sweep/sweep_file.hpp"

namespace test_ranges {

using namespace lostbits;
using intersect::table::Intersector;
using measure::apriori::bound_over_ranges;
using measure::apriori::BoxSubdivision;
using measure::apriori::InputBox;
using measure::apriori::observe_errors;
using measure::apriori::ObservedErrors;
using measure::apriori::RangesBound;
using measure::apriori::RangesRequest;
using measure::apriori::TapeBound;
using test::form_named;
using test::Random;

namespace {

constexpr std::array spheres{"sphere.schoolbook", "sphere.half_b",   "sphere.press",      "sphere.hearn_baker",
                             "sphere.unified",    "sphere.two_step", "sphere.pythagoras", "sphere.factored_c"};
constexpr std::array boxes{"box.signs", "box.max_mult", "box.pbrt_padded", "box.embree_fma"};
constexpr std::array triangles{"triangle.moller_trumbore", "triangle.undivided", "triangle.baldwin_weber"};

/// Numbers of the format on either side of some of the inputs, near or far.
InputBox around(const std::vector<double>& inputs, Random& random, const FloatFormat& format) {
    InputBox box;
    for (const double x : inputs) {
        box.push_back({x, x});
        if (std::isinf(x) || random.one_in(2)) continue;
        const double reach = std::ldexp(std::fabs(x), -static_cast<int>(random.between(1, 26)));
        box.back() = {rounding::to_format(x - reach, 0, format), rounding::to_format(x + reach, 0, format)};
    }
    return box;
}

/// A box around a hostile ray, in up to eight parts.
void check_box(const Intersector& form, const Format& format, const test::HostileRay& x, Random& random,
               ObservedErrors& all) {
    static const intersect::process::StopToken never;
    const auto inputs = measure::tape::inputs_of(x.ray, x.primitive, x.tmax);
    const Tape tape = measure::tape::record_tape(form, format);
    const TapeBound bound(tape);
    const InputBox box = around(inputs, random, format.parameters);
    const BoxSubdivision parts(bound, box, 8, never);
    std::vector<std::vector<double>> rays{inputs};
    for (int k = 0; k < 16; ++k) {
        rays.emplace_back();
        for (const auto& [low, high] : box) {
            const double between = low == high ? low : low + (high - low) * random.unit();
            rays.back().push_back(random.one_in(3)   ? low
                                  : random.one_in(2) ? high
                                                     : rounding::to_format(between, 0, format.parameters));
        }
    }
    const ObservedErrors seen = observe_errors({form, format, parts, x.primitive, never}, rays);
    INFO(form.info->name << " in " << format.name);
    CHECK(seen.largest_ratio <= 1 + 0x1p-40);
    all.append(seen);
}

template <class Draw>
void check_form(const char* name, std::size_t distributions, const Draw& draw) {
    for (const char* const format_name : {"f32", "f64"}) {
        const Format format = *find_format(format_name);
        Random random(7);
        ObservedErrors all;
        for (int i = 0; i < test::draws(40, 20); ++i)
            for (std::size_t distribution = 0; distribution < distributions; ++distribution)
                check_box(form_named(name), format, draw(format, distribution, random), random, all);
        INFO(name << " in " << format_name);
        CHECK(all.hit_count > 0);
        CHECK(all.bounded_hit_count > 0);
    }
}

/// Rays of one kind in the numbers of a format, one after the other.
template <class Make>
test::HostileRay hostile(const Format& format, Random& random, const Make& make) {
    const std::uint64_t seed = random.bits();
    if (format.engine == Format::Engine::native32) return make(test::HostileRays<float>(seed));
    return make(test::HostileRays<double>(seed));
}

}  // namespace

TEST_CASE("errors over ranges of rays stay within the bound - spheres", "[apriori]") {
    for (const char* const name : spheres)
        check_form(name, test::sphere_distributions.size(),
                   [](const Format& format, std::size_t distribution, Random& random) {
                       return hostile(format, random, [distribution](auto rays) { return rays.sphere(distribution); });
                   });
}

TEST_CASE("errors over ranges of rays stay within the bound - boxes", "[apriori]") {
    for (const char* const name : boxes)
        check_form(name, test::hostile_box_distributions.size(),
                   [](const Format& format, std::size_t distribution, Random& random) {
                       return hostile(format, random, [distribution](auto rays) { return rays.box(distribution); });
                   });
}

TEST_CASE("errors over ranges of rays stay within the bound - triangles", "[apriori]") {
    for (const char* const name : triangles)
        check_form(name, std::size(test::triangle_distributions),
                   [](const Format&, std::size_t distribution, Random& random) {
                       test::Seeded rng(random.bits());
                       const auto s = test::in_floats(test::triangle_distributions[distribution].draw(rng));
                       return test::HostileRay{s.ray, s.triangle, HUGE_VAL};
                   });
}

namespace {

scene::file::Scene scene_named(const std::string& id) { return test::scene_named(id, std::pair{24, 24}); }

RangesBound bound_of(const char* form, const scene::file::Scene& scene, std::size_t count = 1024) {
    return bound_over_ranges(
        {.rays = scene, .form = &form_named(form), .format = *find_format("f32"), .max_box_count = count});
}

}  // namespace

TEST_CASE("a bound over the ranges of a scene exceeds the errors of its rays and of random rays", "[apriori]") {
    const auto check = [](const char* form, const char* id) {
        const auto scene = scene_named(id);
        const RangesBound r = bound_of(form, scene);
        INFO(form << " on " << id);
        for (const ObservedErrors& seen : {r.errors_of_given_rays, r.errors_of_drawn_rays}) {
            CHECK(seen.bounded_hit_count > 0);
            CHECK(seen.largest_ratio <= 1 + 0x1p-40);
            CHECK(seen.largest_error <= r.largest);
        }
        CHECK(r.quantiles[0].error <= r.quantiles[1].error);
        CHECK(r.quantiles[1].error <= r.quantiles[2].error);
        CHECK((r.missed_fraction >= 0 && r.unknown_fraction >= 0 && r.missed_fraction + r.unknown_fraction < 1));
        // The checks above would also pass if most of the ranges had no bound.
        CHECK(r.unknown_fraction < 0.5);
    };
    for (const char* const form : {"sphere.schoolbook", "sphere.unified"}) check(form, "near-benign");
    const std::size_t step = test::is_long() ? 1 : 2;
    for (std::size_t i = 0; i < std::size(boxes); i += step) check(boxes[i], "box-one");
    for (std::size_t i = 0; i < std::size(triangles); i += step) check(triangles[i], "triangle-far");
}

TEST_CASE("the ranges of a sweep step cover its rays at all of its primitives", "[apriori]") {
    const auto data = std::filesystem::path(LOSTBITS_DATA_DIR);
    for (const char* const views : {"1", "4"}) {
        scene::sweep::SweepChanges changes;
        for (const std::string& set : {std::string("views=") + views, std::string("rays=64")})
            changes.set.push_back(scene::toml::parse_override(set));
        const scene::sweep::SweepFile sweep(data / "sweeps/sphere-distance.toml", data, changes);
        const measure::apriori::StepRays step{"step", sweep.rays({4})};
        const RangesBound r = bound_over_ranges({.rays = step,
                                                 .form = &form_named("sphere.unified"),
                                                 .format = *find_format("f32"),
                                                 .max_box_count = 1024});
        INFO(views);
        REQUIRE(r.ranges.size() == 1);
        CHECK(r.ray_count == 64 * step.groups.size());
        InputBox hull = r.ranges.front();
        for (auto& [low, high] : hull) low = HUGE_VAL, high = -HUGE_VAL;
        for (const auto& group : step.groups)
            for (std::size_t i = 0; i < group.rays.size(); ++i) {
                const auto inputs = measure::tape::inputs_of(group.rays[i], group.primitives.front(), HUGE_VAL);
                for (std::size_t k = 0; k < hull.size(); ++k) {
                    hull[k].low = std::min(hull[k].low, inputs[k]);
                    hull[k].high = std::max(hull[k].high, inputs[k]);
                }
            }
        for (std::size_t k = 0; k < hull.size(); ++k) {
            CHECK(r.ranges.front()[k].low == hull[k].low);
            CHECK(r.ranges.front()[k].high == hull[k].high);
        }
        CHECK(r.errors_of_given_rays.hit_count > 0);
        CHECK(r.errors_of_given_rays.largest_ratio <= 1 + 0x1p-40);
        if (step.groups.size() > 1) continue;  // spheres on all sides have hardly any bound
        CHECK(r.errors_of_given_rays.bounded_hit_count > 0);
        CHECK(r.errors_of_given_rays.largest_error <= r.largest);
    }
}

TEST_CASE("splitting ranges into more boxes bounds more rays, and the number of threads changes nothing", "[apriori]") {
    const auto scene = scene_named("near-benign");
    const RangesBound few = bound_of("sphere.unified", scene, 128), many = bound_of("sphere.unified", scene, 512);
    CHECK(many.unknown_fraction < few.unknown_fraction);
    CHECK(many.missed_fraction >= few.missed_fraction);
    CHECK(many.quantiles[0].error <= few.quantiles[0].error);
    const RangesRequest request{
        .rays = scene, .form = &form_named("sphere.unified"), .format = *find_format("f32"), .max_box_count = 128};
    const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
    CHECK(output::attribution::ranges_json(request, bound_over_ranges(request)) ==
          output::attribution::ranges_json(request, few));
}

TEST_CASE("a form that uses the sign of a value that is zero without rounding has no bound", "[apriori]") {
    const RangesBound r = bound_of("sphere.closest_approach", scene_named("near-benign"), 64);
    CHECK(r.missed_fraction + r.unknown_fraction == 1);
    CHECK(r.errors_of_given_rays.bounded_hit_count == 0);
}

TEST_CASE("a form without a bound over ranges reports why", "[apriori]") {
    const auto scene = scene_named("near-benign");
    CHECK_THROWS_WITH(bound_of("sphere.filtered", scene), Catch::Contains("filters"));
    RangesRequest request{.rays = scene, .form = &form_named("sphere.press"), .format = *find_format("f32")};
    request.given_ranges = {{"d.w", {0, 1}}};
    CHECK_THROWS_WITH(bound_over_ranges(request), Catch::Contains("no input of that name"));
}

}  // namespace test_ranges
