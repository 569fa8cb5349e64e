// Offsets over scenes: the smallest safe one, the effect of each strategy, and consequences of both.
#include <algorithm>
#include <cmath>
#include <set>

#include "catch.hpp"
#include "measure/offset/along.hpp"
#include "measure/offset/exact_sides.hpp"
#include "measure/offset/offsets.hpp"
#include "measure/offset/points.hpp"
#include "measure/offset/smallest.hpp"
#include "measure/study/study.hpp"
#include "scene/rays/rays.hpp"

namespace test_offsets {

using namespace lostbits;
using namespace lostbits::measure::offset;
using test::load;
using test::row;
using test::ScenePoints;

namespace {

const std::vector<std::pair<std::string, std::string>> scenes{
    {"near-benign", "sphere.half_b"},          {"rtg-fig-7-3-4100-oblique", "sphere.double_inside"},
    {"offset-tiny", "sphere.schoolbook"},      {"rtg-fig-7-4.r6371000", "sphere.half_b"},
    {"offset-shells.inside", "sphere.half_b"}, {"offset-touching", "sphere.expanded"},
    {"offset-thin-box", "box.baseline"},       {"world-offset", "sphere.pbrt_factored"}};

/// `p + side·e·n`, each product and sum rounded once to float.
Vec<double> moved_in_float(const PointWork::HitPoint& hit_point, Side side, double e) {
    Vec<double> o(0, 0, 0);
    const float signed_e = static_cast<float>(side == Side::outside ? e : -e);
    for (int i = 0; i < 3; ++i) {
        const float step = signed_e * static_cast<float>(hit_point.n[i]);
        o[i] = static_cast<float>(hit_point.p[i]) + step;
    }
    return o;
}

/// Exact check of a float offset, by rationals.
bool is_truly_safe(const PointWork& work, const ScenePoints& points, std::size_t k, Side side, double e) {
    const PointWork::HitPoint hit_point = work.hit_point(points.met[k]).value();
    for (const NewRay& new_ray : work.rays(points.met[k], *all_strategies().front(), side)) {
        const Ray<double> ray{moved_in_float(hit_point, side, e), new_ray.ray.direction};
        const auto exact = test::exact_meeting({ray, 0}, points.primitives[points.met[k].primitive]);
        if (side == Side::outside ? exact.meets : exact.outside || !exact.meets) return false;
    }
    return true;
}

}  // namespace

TEST_CASE("the smallest safe offset is safe and the float below it is not, also by rational arithmetic",
          "[measure][offset]") {
    int found = 0, none_needed = 0, by_rationals = 0;
    for (const auto& [scene, form] : scenes) {
        for (const char* format : {"f32", "f64", "p14"}) {
            if (!test::form_named(form).exists_in(*find_format(format))) continue;
            const ScenePoints points(scene, form, format);
            for (const HitPointKind point : {HitPointKind::computed, HitPointKind::projected}) {
                const auto strategies = all_strategies();
                const PointWork work(points.of, point, points.primitives, nullptr, Vec<double>(3, 9, 4), strategies);
                for (std::size_t k = 0; k < points.met.size(); k += 7) {
                    std::array<SideOfPoint, 2> sides;
                    std::vector<StrategyAtPoint> at(2 * strategies.size());
                    if (!work.measure(points.met[k], sides, at)) continue;
                    for (const Side side : both_sides) {
                        const SideOfPoint& s = sides[static_cast<std::size_t>(side)];
                        for (const bool by_form : {false, true}) {
                            const double e = by_form ? s.quiet_offset : s.safe_offset;
                            CAPTURE(scene, format, name_of(point), name_of(side), by_form, k, e);
                            if (!std::isfinite(e)) continue;
                            REQUIRE(work.is_safe(points.met[k], side, e, by_form));
                            if (e == 0) {
                                ++none_needed;
                                continue;
                            }
                            ++found;
                            const FloatFormat& f = points.of.format.parameters;
                            const double below = measure::truth::number_at(measure::truth::ordinal(e, f) - 1, f);
                            REQUIRE_FALSE(work.is_safe(points.met[k], side, below, by_form));
                            if (by_form || f != binary32) continue;
                            ++by_rationals;
                            CHECK(is_truly_safe(work, points, k, side, e));
                            CHECK_FALSE(is_truly_safe(work, points, k, side, below));
                        }
                        // A quiet offset is safe, and a point that is safe from 0 on needs no offset.
                        if (s.quiet_offset == 0) CHECK(s.safe_offset == 0);
                        CHECK(s.ray_count >= 17);
                    }
                }
            }
        }
    }
    CHECK(found > 300);
    CHECK(none_needed > 100);
    CHECK(by_rationals > 60);
}

TEST_CASE("faults of next rays agree with rational arithmetic", "[measure][offset]") {
    std::array<int, fault_names.size()> seen{};
    for (const auto& [scene, form] : scenes) {
        const ScenePoints points(scene, form, "f32");
        const auto strategies = all_strategies();
        const PointWork work(points.of, HitPointKind::computed, points.primitives, nullptr, std::nullopt, strategies);
        for (std::size_t k = 0; k < points.met.size(); k += 9) {
            const Primitive<double> own = points.primitives[points.met[k].primitive];
            for (const Strategy* s : strategies) {
                for (const Side side : both_sides) {
                    for (const NewRay& new_ray : work.rays(points.met[k], *s, side)) {
                        for (std::size_t f = 0; f < seen.size(); ++f) seen[f] += (new_ray.faults >> f) & 1U ? 1 : 0;
                        const auto ahead = test::exact_meeting({new_ray.ray, new_ray.tmin}, own);
                        const auto there = test::exact_meeting({new_ray.ray, 0}, own);
                        const bool out = side == Side::outside;
                        CAPTURE(scene, k, s->name, name_of(side));
                        CHECK(new_ray.has(Fault::wrong_side) == (out ? there.inside : there.outside));
                        CHECK(new_ray.has(Fault::self_hit) ==
                              (new_ray.tests_departed_primitive && ahead.meets && (out || ahead.outside)));
                        CHECK(new_ray.has(Fault::lost_exit) ==
                              (!out && (!new_ray.tests_departed_primitive || !ahead.meets)));
                    }
                }
            }
        }
    }
    for (const Fault f : {Fault::self_hit, Fault::self_hit_by_form, Fault::lost_occluder, Fault::lost_exit,
                          Fault::lost_exit_by_form, Fault::wrong_side}) {
        INFO(fault_names[static_cast<std::size_t>(f)]);
        CHECK(seen[static_cast<std::size_t>(f)] > 0);
    }
}

TEST_CASE("the strategies reported as cheapest are safe, and those left out are not", "[measure][offset]") {
    const scene::file::Scene scene = load("near-benign", 24, 18);
    const OffsetForm of{row("sphere.half_b", "f32"), HitPointKind::computed};
    const OffsetStudy request{.scene = scene, .tested_forms = {of}, .strategies = all_strategies()};
    const auto summaries = measure::study::run_study(request);
    const OffsetSummary& summary = summaries.front();
    const auto both = find_safe_strategies(summary, request.strategies, Shape::sphere);
    REQUIRE_FALSE(both.empty());
    CHECK(std::ranges::is_sorted(both, {}, &SafeStrategy::operation_count));
    std::set<const Strategy*> safe;
    for (const SafeStrategy& s : both) safe.insert(s.strategy);
    for (std::size_t k = 0; k < request.strategies.size(); ++k) {
        const bool right = summary.side_summary(Side::outside).strategies[k].bad_ray_count == 0 &&
                           summary.side_summary(Side::inside).strategies[k].bad_ray_count == 0;
        INFO(request.strategies[k]->name);
        CHECK(right == safe.contains(request.strategies[k]));
    }
    // If no ray goes into the primitive, it is enough to leave the primitive out.
    const auto out = find_safe_strategies(summary, request.strategies, Shape::sphere, std::array{Side::outside});
    CHECK(out.front().strategy->name == "offset.exclude");
    CHECK(out.front().operation_count == 0);
    CHECK(find_safe_strategies(OffsetSummary{}, {}, Shape::sphere).empty());
}

TEST_CASE("a scene moved along an axis is unchanged at 1 and keeps its picture", "[measure][offset]") {
    const scene::file::Scene scene = load("near-benign", 24, 18);
    const auto rays = scene::rays::make_shared_rays(scene, 0, 18);
    for (const SceneAxis along : {SceneAxis::distance, SceneAxis::radius}) {
        const auto same = scene::rays::make_shared_rays(move_along(scene, along, 1), 0, 18);
        CHECK(same.dx == rays.dx);
        CHECK(same.oz == rays.oz);
    }
    const auto far = scene::rays::make_shared_rays(move_along(scene, SceneAxis::distance, 1024), 0, 18);
    // Along the view (-0.3, -0.9, -5.1) the mean of the centres, (-0.575, 0, -4.225), lies 28.2/26.91 views away.
    CHECK(far.oz[0] - 1.1 == Approx(1023 * 28.2 / 26.91 * 5.1).epsilon(1e-6));
    const auto moved = move_along(scene, SceneAxis::world, 16);
    CHECK(moved.listed[1].sphere().centre.y == scene.listed[1].sphere().centre.y + 11);
    CHECK(moved.listed[1].sphere().radius == scene.listed[1].sphere().radius);
    CHECK(move_along(scene, SceneAxis::radius, 8).listed[1].sphere().radius == 8 * scene.listed[1].sphere().radius);
    CHECK(move_along(load("near-benign", 480, 360), SceneAxis::world, 1).width == 48);
    CHECK_THROWS(move_along(load("sphereflake-near"), SceneAxis::world, 1));
    CHECK_THROWS(move_along(load("raycast-course.pixels"), SceneAxis::distance, 1));
}

}  // namespace test_offsets
