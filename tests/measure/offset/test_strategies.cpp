// Strategies by themselves: their constants, their set of rays, and neighbours in the way.
#include <algorithm>
#include <bit>
#include <cmath>
#include <set>

#include "catch.hpp"
#include "measure/offset/points.hpp"

namespace test_strategies {

using namespace lostbits;
using namespace lostbits::measure::offset;
using test::row;

TEST_CASE("strategies: none moves nothing, exclude skips its own primitive, constants are as published",
          "[measure][offset]") {
    std::set<std::string_view> names;
    for (const Strategy& strategy : strategies()) {
        CHECK(strategy.name.starts_with("offset."));
        CHECK(names.insert(strategy.name).second);
        CHECK_FALSE(strategy.source.empty());
        CHECK((strategy.operation_count(Shape::sphere) == 0) == strategy.keeps_point);
    }
    const auto rule = [](std::string_view name) { return *std::ranges::find(strategies(), name, &Strategy::name); };
    StrategyInput<float> l{.ray = {{0, 0, 9}, {0, 0, -1}},
                           .t = 8,
                           .primitive = Sphere<float>{{0, 0, 0}, 1},
                           .point = {0.01F, -3, 1},
                           .normal = {0.5F, -0.5F, 0.70710678F},
                           .new_direction = {0, 0, 1},
                           .side_sign = 1,
                           .target_distance = 7};
    CHECK(rule("offset.none").respawn_in_float(l).origin == l.point);
    CHECK_FALSE(rule("offset.exclude").respawn_in_float(l).tests_departed_primitive);
    CHECK(rule("offset.tmin").respawn_in_float(l).tmin == 1e-3F);
    CHECK(rule("offset.epsilon").respawn_in_float(l).origin ==
          Vec<float>(0.01F + 5e-4F, -3 - 5e-4F, 1 + 1e-3F * 0.70710678F));
    const auto integer = rule("offset.integer").respawn_in_float(l).origin;
    CHECK(integer.x == 0.01F + 0.5F / 65536);
    CHECK(integer.y == std::bit_cast<float>(std::bit_cast<std::int32_t>(-3.0F) + 128));
    CHECK(integer.z == std::bit_cast<float>(std::bit_cast<std::int32_t>(1.0F) + 181));  // 256·0.7071 is 181.02
    const auto cycles = rule("offset.cycles").respawn_in_float(l).origin;
    CHECK(cycles.x == 0.01F + 1e-5F * 0.5F);
    CHECK(cycles.y == std::bit_cast<float>(std::bit_cast<std::int32_t>(-3.0F) + 32));
    const auto relative = rule("offset.relative").respawn_in_float(l);
    CHECK(relative.origin.y == -3 - 4 * (1500 * 0x1p-24F) * 0.5F);
    CHECK(relative.tmax == Approx(7 * (1 - 15000 * 0x1p-24)).epsilon(1e-7));
    l.side_sign = -1;
    CHECK(rule("offset.integer").respawn_in_float(l).origin.y ==
          std::bit_cast<float>(std::bit_cast<std::int32_t>(-3.0F) - 128));
    // One float beyond the bound, away from the surface on either side.
    const auto in = rule("offset.bound").respawn_in_float(l).origin;
    l.side_sign = 1;
    const auto out = rule("offset.bound").respawn_in_float(l).origin;
    CHECK(length(in) < length(l.point) / std::sqrt(1 + 8.0F));
    CHECK(dot(Vec<float>(out - in), l.normal) > 0);
}

TEST_CASE("strategies: constants for double scale those for float by the unit roundoff", "[measure][offset]") {
    StrategyInput<double> l{.ray = {{0, 0, 9}, {0, 0, -1}},
                            .t = 8,
                            .primitive = Sphere<double>{{0, 0, 0}, 1},
                            .point = {0.01, -3, 1},
                            .normal = {0.5, -0.5, 0.7},
                            .new_direction = {0, 0, 1},
                            .side_sign = 1,
                            .target_distance = 7};
    const auto at = [&](std::string_view name) {
        return std::ranges::find(strategies(), name, &Strategy::name)->respawn_in_double(l).origin;
    };
    CHECK(at("offset.integer").x == 0.01 + 256 * 0x1p-53 * 0.5);
    // Away from zero, below it too.
    CHECK(at("offset.integer").y == std::bit_cast<double>(std::bit_cast<std::int64_t>(-3.0) + 128));
    CHECK(at("offset.cycles").x == Approx(0.01 + 1e-5 * 0x1p-29 * 0.5).epsilon(0x1p-52));
    CHECK(at("offset.relative").y == -3 - 4 * (1500 * 0x1p-53) * 0.5);
    CHECK(at("offset.epsilon").y == -3 - 1e-3 * 0.5);
}

TEST_CASE("next rays leave a point to the light, mirrored, refracted by Snell's law, and over both hemispheres",
          "[measure][offset]") {
    const Vec<double> n(0.48, -0.6, 0.64), p(1, 2, 3);
    const auto angle = [&](const Vec<double>& w) { return dot(n, w) / length(w); };
    const auto ways_of = [&](const Vec<double>& d, const std::optional<Vec<double>>& light) {
        return make_departures<double>({p, d}, p, n, HUGE_VAL, light);
    };
    const Vec<double> along(0.8, 0, -0.6);  // perpendicular to n
    REQUIRE(dot(along, n) == Approx(0).margin(1e-15));
    for (const double slope : {0.1, 1.0, 5.0}) {
        const Vec<double> d = along - slope * n;  // from outside, of no unit length
        const auto ways = ways_of(d, std::nullopt);
        REQUIRE(ways.size() == 36);
        CHECK(angle(ways[0].new_direction) == Approx(-angle(d)));
        CHECK(dot(along, ways[0].new_direction) == Approx(dot(along, d) / length(d)));
        // sin θ' = 2/3 sin θ, on the other side, in the same plane.
        CHECK(dot(along, ways[1].new_direction) == Approx(2.0 / 3 * dot(along, d) / length(d)));
        CHECK(ways[1].side_sign == -1);
        for (const auto& way : ways) {
            CHECK(length(way.new_direction) == Approx(1).epsilon(1e-14));
            CHECK(way.side_sign == (angle(way.new_direction) > 0 ? 1 : -1));
            CHECK(std::isinf(way.target_distance));
        }
        for (std::size_t k = 0; k < 17; ++k) {
            const double cosine = k == 0 ? 1 : 1.0 / cosine_denominators[(k + 3) / 4];
            CHECK(angle(ways[2 + k].new_direction) == Approx(cosine));
            CHECK(angle(ways[19 + k].new_direction) == Approx(-cosine));
        }
    }
    // From inside: out of the glass where that is possible, mirrored totally where it is not.
    CHECK(ways_of(along + 5.0 * n, std::nullopt).size() == 36);
    CHECK(dot(along, ways_of(along + 5.0 * n, std::nullopt)[1].new_direction) == Approx(1.5 / std::sqrt(26.0)));
    CHECK(ways_of(along + 0.1 * n, std::nullopt).size() == 35);
    // The light comes first, where it is above the surface.
    const auto lit = ways_of(along - n, p + 2.5 * n);
    REQUIRE(lit.size() == 37);
    CHECK(lit[0].target_distance == Approx(2.5));
    CHECK(angle(lit[0].new_direction) == Approx(1));
    CHECK(ways_of(along - n, p - 2.5 * n).size() == 36);
}

TEST_CASE("a small sphere above another is skipped, entered or seen, depending on the offset", "[measure][offset]") {
    const measure::evaluate::TestedForm of = row("sphere.half_b", "f32");
    const auto strategies = all_strategies();
    const auto named = [](std::string_view name) -> const Strategy& {
        return *std::ranges::find(measure::offset::strategies(), name, &Strategy::name);
    };
    // At the pole of a unit sphere; t is exact, and so is the point.
    const FormHit pole{{{0, 0, 5}, {0, 0, -1}}, 4, 0};
    const auto count = [&](double above, double radius, std::string_view name, Fault fault) {
        const scene::rays::PrimitiveList<double> primitives(
            std::vector<Primitive<double>>{Sphere<double>{{0, 0, 0}, 1}, Sphere<double>{{0, 0, above}, radius}});
        const PointWork work(of, HitPointKind::computed, primitives, nullptr, std::nullopt, strategies);
        const auto rays = work.rays(pole, named(name), Side::outside);
        CHECK(rays.size() == 18);
        return std::ranges::count_if(rays, [&](const NewRay& new_ray) { return new_ray.has(fault); });
    };
    // From 3 to 5 ten-thousandths above: the ray along the normal, twice (mirrored and up), meets it.
    const double above = 1 + 0x1.a36e2ep-12, radius = 0x1.a36e2ep-14;
    CHECK(count(above, radius, "offset.epsilon", Fault::lost_occluder) == 2);
    CHECK(count(above, radius, "offset.tmin", Fault::lost_occluder) == 2);
    CHECK(count(above, radius, "offset.epsilon", Fault::begins_in_neighbour) == 0);
    CHECK(count(above, radius, "offset.epsilon_1e-4", Fault::lost_occluder) == 0);
    CHECK(count(above, radius, "offset.integer", Fault::lost_occluder) == 0);
    CHECK(count(above, radius, "offset.exclude", Fault::lost_occluder) == 0);
    // A bead that contains the point a thousandth above: every ray starts in it.
    CHECK(count(1 + 0x1p-10, 0x1p-12, "offset.epsilon", Fault::begins_in_neighbour) == 18);
    CHECK(count(1 + 0x1p-10, 0x1p-12, "offset.epsilon", Fault::lost_occluder) == 2);
    CHECK(count(1 + 0x1p-10, 0x1p-12, "offset.epsilon_1e-4", Fault::begins_in_neighbour) == 0);
}

}  // namespace test_strategies
