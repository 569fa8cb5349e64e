// Offsets over scenes: what the smallest safe one promises, what each strategy does, and what follows from both.
#include <algorithm>
#include <cmath>
#include <set>

#include "catch.hpp"
#include "measure/offset/along.hpp"
#include "measure/offset/cheapest.hpp"
#include "measure/offset/exact_sides.hpp"
#include "measure/offset/smallest.hpp"
#include "measure/rows.hpp"
#include "scene/rays/rays.hpp"

using namespace lostbits;
using namespace lostbits::measure::offset;
using testing::row;

namespace {

scene::file::Scene load(const std::string& name, int width = 12, int height = 9) {
    const auto found = scene::file::find_scene(name, LOSTBITS_DATA_DIR);
    return scene::file::load_scene(found.path, {.variant = found.variant, .size = std::pair{width, height}}).front();
}

/// Points of a scene as one form in one format finds them, and what to ask them.
struct Points {
    scene::file::Scene scene;
    measure::map::MapRow of;
    std::vector<Solid<double>> solids;
    std::vector<MetPoint> met;

    Points(const std::string& name, std::string_view form, std::string_view format)
        : scene(load(name)), of(row(form, format)) {
        const measure::truth::Band band(scene, 0, scene.height);
        const auto inputs = band.inputs(of.format, {});
        solids = inputs.solids.all();
        const auto answers = measure::answer::evaluate(*of.form, inputs);
        for (std::size_t i = 0; i < answers.t.size(); ++i) {
            if (answers.hit[i] != 0 && answers.t[i] > 0)
                met.push_back({inputs.rays[i], answers.t[i], static_cast<std::size_t>(answers.object[i])});
        }
    }
};

const std::vector<std::pair<std::string, std::string>> scenes{
    {"near-benign", "sphere.half_b"},          {"rtg-fig-7-3-4100-oblique", "sphere.double_inside"},
    {"offset-tiny", "sphere.schoolbook"},      {"rtg-fig-7-4.r6371000", "sphere.half_b"},
    {"offset-shells.inside", "sphere.half_b"}, {"offset-touching", "sphere.expanded"},
    {"offset-thin-box", "box.baseline"},       {"world-offset", "sphere.pbrt_factored"}};

/// `p + side·e·n`, each product and sum rounded once to float.
Vec<double> moved_in_float(const PointWork::Start& at, Side side, double e) {
    Vec<double> o(0, 0, 0);
    const float signed_e = static_cast<float>(side == Side::outside ? e : -e);
    for (int i = 0; i < 3; ++i) {
        const float step = signed_e * static_cast<float>(at.n[i]);
        o[i] = static_cast<float>(at.p[i]) + step;
    }
    return o;
}

}  // namespace

TEST_CASE("the smallest safe offset is safe and the float below it is not", "[measure][offset]") {
    int found = 0, none_needed = 0;
    for (const auto& [scene, form] : scenes) {
        for (const char* format : {"f32", "f64", "p14"}) {
            if (!testing::form_named(form).exists_in(*find_format(format))) continue;
            const Points points(scene, form, format);
            for (const HitPoint point : {HitPoint::computed, HitPoint::projected}) {
                const auto strategies = all_strategies();
                const PointWork work(points.of, point, points.solids, Vec<double>(3, 9, 4), strategies);
                for (std::size_t k = 0; k < points.met.size(); k += 7) {
                    std::array<SideOfPoint, 2> sides;
                    std::vector<StrategyAtPoint> at(2 * strategies.size());
                    if (!work.measure(points.met[k], sides, at)) continue;
                    for (const Side side : both_sides) {
                        const SideOfPoint& s = sides[static_cast<std::size_t>(side)];
                        for (const bool by_form : {false, true}) {
                            const double e = by_form ? s.quiet : s.safe;
                            CAPTURE(scene, format, name_of(point), name_of(side), by_form, k, e);
                            if (!std::isfinite(e)) continue;
                            REQUIRE(work.is_safe(points.met[k], side, e, by_form));
                            if (e == 0) {
                                ++none_needed;
                                continue;
                            }
                            ++found;
                            const auto place = measure::truth::ordinal(e, points.of.format.shape);
                            REQUIRE_FALSE(work.is_safe(points.met[k], side,
                                                       number_at(place - 1, points.of.format.shape), by_form));
                        }
                        // What is quiet is safe, and a place that is safe from 0 on needs nothing.
                        if (s.quiet == 0) CHECK(s.safe == 0);
                        CHECK(s.rays >= 17);
                    }
                }
            }
        }
    }
    CHECK(found > 300);
    CHECK(none_needed > 100);
}

TEST_CASE("below the smallest safe offset hardly any is safe, and above it hardly any is not", "[measure][offset]") {
    int below = 0, safe_below = 0, above = 0, unsafe_above = 0;
    for (const auto& [scene, form] : scenes) {
        const Points points(scene, form, "f32");
        const auto strategies = all_strategies();
        const PointWork work(points.of, HitPoint::projected, points.solids, std::nullopt, strategies);
        for (std::size_t k = 0; k < points.met.size(); k += 3) {
            std::array<SideOfPoint, 2> sides;
            std::vector<StrategyAtPoint> at(2 * strategies.size());
            if (!work.measure(points.met[k], sides, at)) continue;
            const double e = sides[0].safe;
            if (!(e > 0) || !std::isfinite(e)) continue;
            const std::int64_t place = measure::truth::ordinal(e, binary32);
            for (std::int64_t step = 1; step < (std::int64_t{1} << 25); step *= 8) {
                below += 1;
                safe_below += work.is_safe(points.met[k], Side::outside, number_at(place - step, binary32), false);
                above += 1;
                unsafe_above += !work.is_safe(points.met[k], Side::outside, number_at(place + step, binary32), false);
            }
        }
    }
    CAPTURE(below, safe_below, above, unsafe_above);
    CHECK(below > 500);
    CHECK(safe_below * 100 < below);
    CHECK(unsafe_above * 100 < above);
}

TEST_CASE("rationals agree that the smallest safe offset is safe and the float below it is not", "[measure][offset]") {
    int checked = 0;
    for (const auto& [scene, form] : scenes) {
        const Points points(scene, form, "f32");
        const auto strategies = all_strategies();
        const PointWork work(points.of, HitPoint::computed, points.solids, std::nullopt, strategies);
        for (std::size_t k = 0; k < points.met.size(); k += 5) {
            const MetPoint& met = points.met[k];
            std::array<SideOfPoint, 2> sides;
            std::vector<StrategyAtPoint> at(2 * strategies.size());
            if (!work.measure(met, sides, at)) continue;
            const auto start = work.start(met).value();
            for (const Side side : both_sides) {
                const double e = sides[static_cast<std::size_t>(side)].safe;
                if (!std::isfinite(e) || e == 0) continue;
                const auto is_safe = [&](double offset) {
                    for (const NewRay& r : work.rays(met, *strategies.front(), side)) {
                        const Ray<double> ray{moved_in_float(start, side, offset), r.ray.direction};
                        const auto exact = testing::exact_meeting({ray, 0}, points.solids[met.own]);
                        if (side == Side::outside ? exact.meets : exact.outside || !exact.meets) return false;
                    }
                    return true;
                };
                CAPTURE(scene, k, name_of(side), e);
                CHECK(is_safe(e));
                CHECK_FALSE(is_safe(std::nextafter(static_cast<float>(e), 0.0F)));
                ++checked;
            }
        }
    }
    CHECK(checked > 60);
}

TEST_CASE("faults of respawned rays are those that rationals find", "[measure][offset]") {
    std::array<int, fault_names.size()> seen{};
    for (const auto& [scene, form] : scenes) {
        const Points points(scene, form, "f32");
        const auto strategies = all_strategies();
        const PointWork work(points.of, HitPoint::computed, points.solids, std::nullopt, strategies);
        for (std::size_t k = 0; k < points.met.size(); k += 9) {
            const Solid<double>& own = points.solids[points.met[k].own];
            for (const Strategy* s : strategies) {
                for (const Side side : both_sides) {
                    for (const NewRay& r : work.rays(points.met[k], *s, side)) {
                        for (std::size_t f = 0; f < seen.size(); ++f) seen[f] += (r.faults >> f) & 1U ? 1 : 0;
                        const auto ahead = testing::exact_meeting({r.ray, r.tmin}, own);
                        const auto there = testing::exact_meeting({r.ray, 0}, own);
                        const bool out = side == Side::outside;
                        CAPTURE(scene, k, s->name, name_of(side));
                        CHECK(r.has(Fault::wrong_side) == (out ? there.inside : there.outside));
                        CHECK(r.has(Fault::self_hit) == (r.asks_own && ahead.meets && (out || ahead.outside)));
                        CHECK(r.has(Fault::lost_exit) == (!out && (!r.asks_own || !ahead.meets)));
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

TEST_CASE("strategies: none moves nothing, exclude meets nothing of its own, constants are those published",
          "[measure][offset]") {
    std::set<std::string_view> names;
    for (const Strategy& s : strategies()) {
        CHECK(s.name.starts_with("offset."));
        CHECK(names.insert(s.name).second);
        CHECK_FALSE(s.source.empty());
        CHECK((s.operations(Shape::sphere) == 0) == s.keeps_point);
    }
    const auto rule = [](std::string_view name) { return *std::ranges::find(strategies(), name, &Strategy::name); };
    Leaving<float> l{.ray = {{0, 0, 9}, {0, 0, -1}},
                     .t = 8,
                     .solid = Sphere<float>{{0, 0, 0}, 1},
                     .p = {0.01F, -3, 1},
                     .n = {0.5F, -0.5F, 0.70710678F},
                     .w = {0, 0, 1},
                     .side = 1,
                     .reach = 7};
    CHECK(rule("offset.none").in_float(l).origin == l.p);
    CHECK_FALSE(rule("offset.exclude").in_float(l).asks_own);
    CHECK(rule("offset.tmin").in_float(l).tmin == 1e-3F);
    CHECK(rule("offset.epsilon").in_float(l).origin == Vec<float>(0.01F + 5e-4F, -3 - 5e-4F, 1 + 1e-3F * 0.70710678F));
    const auto integer = rule("offset.integer").in_float(l).origin;
    CHECK(integer.x == 0.01F + 0.5F / 65536);
    CHECK(integer.y == std::bit_cast<float>(std::bit_cast<std::int32_t>(-3.0F) + 128));
    CHECK(integer.z == std::bit_cast<float>(std::bit_cast<std::int32_t>(1.0F) + 181));  // 256·0.7071 is 181.02
    const auto cycles = rule("offset.cycles").in_float(l).origin;
    CHECK(cycles.x == 0.01F + 1e-5F * 0.5F);
    CHECK(cycles.y == std::bit_cast<float>(std::bit_cast<std::int32_t>(-3.0F) + 32));
    const auto relative = rule("offset.relative").in_float(l);
    CHECK(relative.origin.y == -3 - 4 * (1500 * 0x1p-24F) * 0.5F);
    CHECK(relative.tmax == Approx(7 * (1 - 15000 * 0x1p-24)).epsilon(1e-7));
    l.side = -1;
    CHECK(rule("offset.integer").in_float(l).origin.y ==
          std::bit_cast<float>(std::bit_cast<std::int32_t>(-3.0F) - 128));
    // One float further than the bound, away from the surface on either side.
    const auto in = rule("offset.bound").in_float(l).origin;
    l.side = 1;
    const auto out = rule("offset.bound").in_float(l).origin;
    CHECK(length(in) < length(l.p) / std::sqrt(1 + 8.0F));
    CHECK(dot(Vec<float>(out - in), l.n) > 0);

    const scene::file::Scene scene = load("near-benign", 24, 18);
    const OffsetRequest request{
        .scene = &scene, .rows = {{row("sphere.half_b", "f32"), HitPoint::computed}}, .strategies = all_strategies()};
    const auto summaries = run_offsets(request);
    const OffsetSummary& summary = summaries.front();
    CHECK(summary.points > 100);
    for (const Side side : both_sides) {
        CHECK(summary.on(side).strategies.front().size.quantile(1) == 0);
        CHECK(summary.on(side).strategies.back()[Fault::self_hit] == 0);
    }
    CHECK(summary.on(Side::inside).strategies.back()[Fault::lost_exit] == summary.on(Side::inside).rays);
}

TEST_CASE("the constants of double are those of float, as its u is to that of float", "[measure][offset]") {
    Leaving<double> l{.ray = {{0, 0, 9}, {0, 0, -1}},
                      .t = 8,
                      .solid = Sphere<double>{{0, 0, 0}, 1},
                      .p = {0.01, -3, 1},
                      .n = {0.5, -0.5, 0.7},
                      .w = {0, 0, 1},
                      .side = 1,
                      .reach = 7};
    const auto at = [&](std::string_view name) {
        return std::ranges::find(strategies(), name, &Strategy::name)->in_double(l).origin;
    };
    CHECK(at("offset.integer").x == 0.01 + 256 * 0x1p-53 * 0.5);
    CHECK(at("offset.cycles").x == Approx(0.01 + 1e-5 * 0x1p-29 * 0.5).epsilon(0x1p-52));
    CHECK(at("offset.relative").y == -3 - 4 * (1500 * 0x1p-53) * 0.5);
    CHECK(at("offset.epsilon").y == -3 - 1e-3 * 0.5);
}

TEST_CASE("the cheapest safe strategies are safe, and those left out are not", "[measure][offset]") {
    const scene::file::Scene scene = load("near-benign", 24, 18);
    const OffsetRow of{row("sphere.half_b", "f32"), HitPoint::computed};
    const OffsetRequest request{.scene = &scene, .rows = {of}, .strategies = all_strategies()};
    const auto summaries = run_offsets(request);
    const OffsetSummary& summary = summaries.front();
    const auto both = safe_strategies(scene, of);
    REQUIRE_FALSE(both.empty());
    CHECK(std::ranges::is_sorted(both, {}, &SafeStrategy::operations));
    std::set<const Strategy*> safe;
    for (const SafeStrategy& s : both) safe.insert(s.strategy);
    for (std::size_t k = 0; k < request.strategies.size(); ++k) {
        const bool right =
            summary.on(Side::outside).strategies[k].bad == 0 && summary.on(Side::inside).strategies[k].bad == 0;
        INFO(request.strategies[k]->name);
        CHECK(right == safe.contains(request.strategies[k]));
    }
    // Where nothing has to go into the solid, it is enough not to ask it.
    const auto out = safe_strategies(scene, of, std::array{Side::outside});
    CHECK(out.front().strategy->name == "offset.exclude");
    CHECK(out.front().operations == 0);
    CHECK(safe_strategies(OffsetSummary{}, {}, Shape::sphere).empty());
}

TEST_CASE("a scene moved along an axis starts as it is, and keeps its picture", "[measure][offset]") {
    const scene::file::Scene scene = load("near-benign", 24, 18);
    const auto rays = scene::rays::make_shared_rays(scene, 0, 18);
    for (const Along along : {Along::distance, Along::radius}) {
        const auto same = scene::rays::make_shared_rays(moved_along(scene, along, 1), 0, 18);
        CHECK(same.dx == rays.dx);
        CHECK(same.oz == rays.oz);
    }
    const auto far = scene::rays::make_shared_rays(moved_along(scene, Along::distance, 1024), 0, 18);
    CHECK(far.oz[0] - -4 == Approx(1024 * (1.1 + 4)).epsilon(1e-4));
    const auto moved = moved_along(scene, Along::world, 16);
    CHECK(moved.spheres[1].centre.y == scene.spheres[1].centre.y + 11);
    CHECK(moved.spheres[1].radius == scene.spheres[1].radius);
    CHECK(moved_along(scene, Along::radius, 8).spheres[1].radius == 8 * scene.spheres[1].radius);
    CHECK(moved_along(load("near-benign", 480, 360), Along::world, 1).width == 48);
    CHECK_THROWS(moved_along(load("sphereflake-near"), Along::world, 1));
    CHECK_THROWS(moved_along(load("raycast-course.pixels"), Along::distance, 1));
}

TEST_CASE("the rays that leave a point: to the light, mirrored, refracted by Snell's law, over both hemispheres",
          "[measure][offset]") {
    const Vec<double> n(0.48, -0.6, 0.64), p(1, 2, 3);
    const auto angle = [&](const Vec<double>& w) { return dot(n, w) / length(w); };
    const auto ways_of = [&](const Vec<double>& d, const std::optional<Vec<double>>& light) {
        return ways_from<double>({p, d}, p, n, HUGE_VAL, light);
    };
    const Vec<double> along(0.8, 0, -0.6);  // perpendicular to n
    REQUIRE(dot(along, n) == Approx(0).margin(1e-15));
    for (const double slope : {0.1, 1.0, 5.0}) {
        const Vec<double> d = along - slope * n;  // from outside, of no unit length
        const auto ways = ways_of(d, std::nullopt);
        REQUIRE(ways.size() == 36);
        CHECK(angle(ways[0].w) == Approx(-angle(d)));
        CHECK(dot(along, ways[0].w) == Approx(dot(along, d) / length(d)));
        // sin θ' = 2/3 sin θ, on the other side, in the same plane.
        CHECK(dot(along, ways[1].w) == Approx(2.0 / 3 * dot(along, d) / length(d)));
        CHECK(ways[1].side == -1);
        for (const auto& way : ways) {
            CHECK(length(way.w) == Approx(1).epsilon(1e-14));
            CHECK(way.side == (angle(way.w) > 0 ? 1 : -1));
            CHECK(std::isinf(way.reach));
        }
        for (std::size_t k = 0; k < 17; ++k) {
            const double cosine = k == 0 ? 1 : 1.0 / cosine_denominators[(k + 3) / 4];
            CHECK(angle(ways[2 + k].w) == Approx(cosine));
            CHECK(angle(ways[19 + k].w) == Approx(-cosine));
        }
    }
    // From inside: out of the glass where that is possible, mirrored totally where it is not.
    CHECK(ways_of(along + 5.0 * n, std::nullopt).size() == 36);
    CHECK(dot(along, ways_of(along + 5.0 * n, std::nullopt)[1].w) == Approx(1.5 / std::sqrt(26.0)));
    CHECK(ways_of(along + 0.1 * n, std::nullopt).size() == 35);
    // The light comes first, where it is above the surface.
    const auto lit = ways_of(along - n, p + 2.5 * n);
    REQUIRE(lit.size() == 37);
    CHECK(lit[0].reach == Approx(2.5));
    CHECK(angle(lit[0].w) == Approx(1));
    CHECK(ways_of(along - n, p - 2.5 * n).size() == 36);
}

TEST_CASE("a bead above a sphere: jumped over, started in, or kept in sight", "[measure][offset]") {
    const measure::map::MapRow of = row("sphere.half_b", "f32");
    const auto strategies = all_strategies();
    const auto named = [](std::string_view name) -> const Strategy& {
        return *std::ranges::find(measure::offset::strategies(), name, &Strategy::name);
    };
    // At the pole of a unit sphere; t is exact, and so is the point.
    const MetPoint pole{{{0, 0, 5}, {0, 0, -1}}, 4, 0};
    const auto count = [&](double above, double radius, std::string_view name, Fault fault) {
        const std::vector<Solid<double>> solids{Sphere<double>{{0, 0, 0}, 1}, Sphere<double>{{0, 0, above}, radius}};
        const PointWork work(of, HitPoint::computed, solids, std::nullopt, strategies);
        const auto rays = work.rays(pole, named(name), Side::outside);
        CHECK(rays.size() == 18);
        return std::ranges::count_if(rays, [&](const NewRay& r) { return r.has(fault); });
    };
    // From 3 to 5 ten-thousandths above: the ray along the normal, twice (mirrored and up), meets it.
    const double above = 1 + 0x1.a36e2ep-12, radius = 0x1.a36e2ep-14;
    CHECK(count(above, radius, "offset.epsilon", Fault::lost_occluder) == 2);
    CHECK(count(above, radius, "offset.tmin", Fault::lost_occluder) == 2);
    CHECK(count(above, radius, "offset.epsilon", Fault::begins_in_neighbour) == 0);
    CHECK(count(above, radius, "offset.epsilon_1e-4", Fault::lost_occluder) == 0);
    CHECK(count(above, radius, "offset.integer", Fault::lost_occluder) == 0);
    CHECK(count(above, radius, "offset.exclude", Fault::lost_occluder) == 0);
    // A bead that holds the place a thousandth above: every ray starts in it.
    CHECK(count(1 + 0x1p-10, 0x1p-12, "offset.epsilon", Fault::begins_in_neighbour) == 18);
    CHECK(count(1 + 0x1p-10, 0x1p-12, "offset.epsilon", Fault::lost_occluder) == 2);
    CHECK(count(1 + 0x1p-10, 0x1p-12, "offset.epsilon_1e-4", Fault::begins_in_neighbour) == 0);
}

TEST_CASE("a shell 4e-5 away is lost by every offset that is longer", "[measure][offset]") {
    const scene::file::Scene scene = load("offset-shells.outside", 24, 18);
    const OffsetRequest request{.scene = &scene,
                                .rows = {{row("sphere.double_inside", "f32"), HitPoint::projected}},
                                .strategies = all_strategies()};
    const auto summaries = run_offsets(request);
    const OffsetSummary& summary = summaries.front();
    REQUIRE(summary.points > 50);
    for (std::size_t k = 0; k < request.strategies.size(); ++k) {
        const StrategySummary& s = summary.on(Side::inside).strategies[k];
        if (request.strategies[k]->keeps_point) continue;
        INFO(request.strategies[k]->name);
        if (request.strategies[k]->name == "offset.direction") continue;  // grazing rays stay between the shells
        CHECK((s[Fault::lost_occluder] == 0) == (s.size.quantile(1) < 3.9e-5));
        if (s.size.quantile(0.5) > 4.2e-5) CHECK(s[Fault::lost_occluder] > summary.on(Side::inside).rays / 2);
    }
}
