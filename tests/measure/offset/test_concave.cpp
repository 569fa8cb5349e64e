// Offsets of primitives that a leaving ray may truly meet again, or that have no inside: a far wall is not a self-hit,
// and rays leave a flat primitive on either side.
#include <cmath>

#include "catch.hpp"
#include "intersect/exact.hpp"
#include "measure/offset/half_line.hpp"
#include "measure/offset/offsets.hpp"
#include "measure/offset/points.hpp"
#include "measure/seeded.hpp"

namespace test_concave {

using namespace lostbits;
using namespace lostbits::measure::offset;
using test::Rational;
using test::row;

namespace {

const Primitive<double> ring(Torus<double>{{0, 0, 0}, {0, 0, 1}, 139, 40});
const Primitive<double> pipe(Tube<double>{{0, 0, -4}, {0, 0, 4}, 1});

/// All measurements at the place where a form hits one primitive.
struct MeasuredPoint {
    std::array<SideOfPoint, 2> sides;
    std::vector<StrategyAtPoint> at = std::vector<StrategyAtPoint>(2 * all_strategies().size());

    MeasuredPoint(std::string_view form, const char* format, const Primitive<double>& primitive, const Ray<double>& ray,
                  double t, const std::optional<Vec<double>>& light = std::nullopt) {
        const measure::evaluate::TestedForm of = row(form, format);
        const scene::rays::PrimitiveList<double> primitives(std::vector{primitive});
        const auto strategies = all_strategies();
        const PointWork work(of, HitPointKind::computed, primitives, nullptr, light, strategies);
        REQUIRE(work.measure({ray, t, 0}, sides, at));
    }
    [[nodiscard]] const SideOfPoint& side_of_point(Side side) const { return sides[static_cast<std::size_t>(side)]; }
    [[nodiscard]] const StrategyAtPoint& by(std::string_view name, Side side) const {
        const auto all = strategies();
        const auto k = std::ranges::find(all, name, &Strategy::name) - all.begin();
        return at[static_cast<std::size_t>(side) * all.size() + static_cast<std::size_t>(k)];
    }
};

/// (p² + R² − r²)² − 4 R² (x² + y²) of the ring: negative inside.
Rational ring_at(const Ray<double>& ray, double t) {
    Rational p[3];
    for (int i = 0; i < 3; ++i) p[i] = Rational(ray.origin[i]) + Rational(t) * Rational(ray.direction[i]);
    const Rational across = p[0] * p[0] + p[1] * p[1], e = across + p[2] * p[2] + 139 * 139 - 40 * 40;
    return e * e - 4 * 139 * 139 * across;
}

}  // namespace

TEST_CASE("offsets: the far side of a torus begins outside it, between its two parts", "[measure][offset]") {
    test::Seeded random(66);
    int met = 0, passed = 0;
    for (int k = 0; k < 3000; ++k) {
        const double round = random.uniform(-3, 3), across = 139 + 40 * std::cos(round);
        Vec<double> w = random.vec(-1, 1);
        const Ray<double> ray{{across, 0, 40 * std::sin(round)}, w};
        const FarSide far = find_far_side(ray, ring);
        if (std::isinf(far.t_begin)) {
            CHECK(std::isinf(far.t_wall));
            continue;
        }
        CAPTURE(k, far.t_begin, far.t_wall);
        // The polynomial has a largest value there, and the ring is on the far side or only near it.
        const double step = 1e-5 * far.t_begin;
        CHECK(ring_at(ray, far.t_begin) > 0);
        CHECK(ring_at(ray, far.t_begin) > ring_at(ray, far.t_begin - step));
        CHECK(ring_at(ray, far.t_begin) > ring_at(ray, far.t_begin + step));
        CHECK(far.t_begin < far.t_wall);
        CHECK(meets_before({ray, far.t_begin}, 1e6 / length(w), ring) == std::isfinite(far.t_wall));
        ++(std::isinf(far.t_wall) ? passed : met);
    }
    CHECK(met > 100);
    CHECK(passed > 50);
}

TEST_CASE("offsets: the next wall of a torus is where the ray enters by rational arithmetic", "[measure][offset]") {
    CHECK(find_far_side({{99, 0, 0}, {-1, 0, 0}}, ring).t_wall == Approx(198));
    CHECK(find_far_side({{-99, 0, 0}, {2, 0, 0}}, ring).t_wall == Approx(99));
    CHECK(std::isinf(find_far_side({{179, 0, 0}, {1, 0, 0}}, ring).t_wall));  // from the rim that faces away
    CHECK(std::isinf(find_far_side({{99, 0, 0}, {1, 0, 0}}, ring).t_wall));   // into it
    test::Seeded random(65);
    int met = 0, free = 0;
    for (int k = 0; k < 3000; ++k) {
        // From the inner half, put onto the surface in doubles, and away from it.
        const double turn = random.uniform(-3, 3), round = random.uniform(1.6, 4.6);
        const double across = 139 + 40 * std::cos(round);
        const Vec<double> p(across * std::cos(turn), across * std::sin(turn), 40 * std::sin(round));
        const Vec<double> n(std::cos(round) * std::cos(turn), std::cos(round) * std::sin(turn), std::sin(round));
        Vec<double> w = random.vec(-1, 1);
        if (dot(w, n) < 0) w = -1.0 * w;
        if (dot(w, n) < 1e-3 * length(w)) continue;
        const Ray<double> ray{p, w};
        const double wall = find_far_side(ray, ring).t_wall, last = std::isinf(wall) ? 400 / length(w) : wall;
        CAPTURE(k, wall);
        bool clear = true;
        for (int i = 1; i < 40; ++i) clear = clear && ring_at(ray, last * (0.01 + 0.98 * i / 40)) > 0;
        CHECK(clear);
        if (std::isinf(wall)) ++free;
        else {
            const double e = 1e-9 * wall + 1e-10 / length(w);
            ++met;
            // Far enough from a tangent for doubles, the point before it is outside and the point behind it is inside.
            CHECK(ring_at(ray, wall - e) > 0);
            CHECK((ring_at(ray, wall + e) < 0 || ring_at(ray, wall + 2 * e) > 0));
            CHECK_FALSE(meets_before({ray, 1e-9 / length(w)}, wall - e, ring));
            CHECK(meets_before({ray, wall / 2}, 1e6 / length(w), ring));
        }
    }
    CHECK(met > 300);
    CHECK(free > 500);
}

TEST_CASE("offsets: the next wall of a tube is opposite, between the rims", "[measure][offset]") {
    // From (1, 0, z) along d: −2 p·d/d² = 6/25 t across.
    CHECK(find_far_side({{1, 0, 0}, {-3, 4, 0}}, pipe).t_wall == Approx(0.24).epsilon(1e-14));
    CHECK(find_far_side({{1, 0, 0}, {-3, 4, 16}}, pipe).t_wall == Approx(0.24).epsilon(1e-14));
    CHECK(std::isinf(find_far_side({{1, 0, 0}, {-3, 4, 17}}, pipe).t_wall));  // out of the open end
    CHECK(std::isinf(find_far_side({{1, 0, 0}, {3, 4, 0}}, pipe).t_wall));
    CHECK(meets_before({{{1, 0, 0}, {-3, 4, 0}}, 0}, 0.25, pipe));
    CHECK_FALSE(meets_before({{{1, 0, 0}, {-3, 4, 0}}, 0}, 0.23, pipe));
    CHECK_FALSE(meets_before({{{1, 0, 0}, {-3, 4, 0}}, 0.5}, 0.25, pipe));
    CHECK(find_far_side({{1, 0, 0}, {-1, 0, 0}}, Primitive<double>(Sphere<double>{{0, 0, 0}, 1})) == FarSide{});
    CHECK(find_far_side({{0, 0, 0}, {0, 0, 1}}, Primitive<double>(Disc<double>{{0, 0, 0}, {0, 0, 1}, 1, 0})) ==
          FarSide{});
}

TEST_CASE("offsets: the far wall of a torus is a true hit, and excluding the torus loses it", "[measure][offset]") {
    for (const char* format : {"f32", "f64"}) {
        const MeasuredPoint m("torus.closest_approach", format, ring, {{0, 0, 0}, {1, 0, 0}}, 99);
        INFO(format << ", safe " << m.side_of_point(Side::outside).safe_offset << " and "
                    << m.side_of_point(Side::inside).safe_offset);
        CHECK(m.side_of_point(Side::outside).safe_offset < 1e-4);
        CHECK(m.side_of_point(Side::inside).safe_offset < 1e-4);
        CHECK(m.by("offset.bound", Side::outside)[Fault::self_hit] == 0);
        CHECK(m.by("offset.bound", Side::outside)[Fault::lost_occluder] == 0);
        CHECK(m.by("offset.exclude", Side::outside)[Fault::lost_occluder] > 0);
        CHECK(m.by("offset.exclude", Side::outside).bad_ray_count ==
              m.by("offset.exclude", Side::outside)[Fault::lost_occluder]);
        CHECK(m.by("offset.exclude", Side::inside)[Fault::lost_exit] == m.side_of_point(Side::inside).ray_count);
    }
    // A point 2^-9 within the ring: all rays hit the ring that they leave, except those that are past it.
    const MeasuredPoint within("torus.closest_approach", "f64", ring, {{0, 0, 0}, {1, 0, 0}}, 99 + 0x1p-9);
    CHECK(within.by("offset.none", Side::outside)[Fault::self_hit] == within.side_of_point(Side::outside).ray_count);
    CHECK(within.side_of_point(Side::outside).safe_offset == Approx(0x1p-9).epsilon(1e-6));
}

TEST_CASE("offsets: the next wall is a true hit inside a tube, and rays leave on both sides of it",
          "[measure][offset]") {
    for (const char* format : {"f32", "f64"}) {
        const MeasuredPoint m("tube.framed", format, pipe, {{0, 0, 0}, {1, 0, 0}}, 1);
        CHECK(m.side_of_point(Side::outside).safe_offset < 1e-4);
        CHECK(m.side_of_point(Side::inside).safe_offset < 1e-4);
        CHECK(m.by("offset.bound", Side::outside).bad_ray_count == 0);
        CHECK(m.by("offset.bound", Side::inside).bad_ray_count == 0);
        CHECK(m.by("offset.exclude", Side::outside)[Fault::lost_occluder] > 0);
        CHECK(m.by("offset.exclude", Side::inside).bad_ray_count == 0);  // out of the tube, nothing of it lies ahead
    }
    // A pipe that is thinner than the move across it: the new origin is past the other wall.
    const Primitive<double> hair(Tube<double>{{0, 0, -4}, {0, 0, 4}, 0x1p-12});
    const MeasuredPoint past("tube.framed", "f64", hair, {{0, 0, 0}, {1, 0, 0}}, 0x1p-12);
    CHECK(past.by("offset.epsilon", Side::outside)[Fault::lost_occluder] > 0);
    CHECK(past.by("offset.bound", Side::outside).bad_ray_count == 0);
}

TEST_CASE("offsets: a far wall hit only by the moved ray is not a self-hit", "[measure][offset]") {
    // From (-115, 0, 32) out of the ring, and below its far part by `gap`: moved along the normal the ray is raised by
    // 0.935 e. The nearest line below that touches the far circle leaves by the angle asin(40/D) below its centre.
    const Ray<double> down{{-85, 0, 72}, {-3, 0, -4}};
    const Vec<double> p(-115, 0, 32), centre(139, 0, 0);
    const double away = length(Vec<double>(centre - p));
    const auto light_below = [&](double gap) {
        const double angle = std::atan2(-32, 254) - std::asin((40 + gap) / away);
        return Vec<double>(p + 400.0 * Vec<double>(std::cos(angle), 0, std::sin(angle)));
    };
    for (const char* format : {"f32", "f64"}) {
        INFO(format);
        const MeasuredPoint on("torus.closest_approach", format, ring, down, 10, light_below(4e-4));
        for (const char* const strategy : {"offset.epsilon", "offset.bound", "offset.ulp_16", "offset.relative"}) {
            INFO(strategy);
            CHECK(on.by(strategy, Side::outside)[Fault::self_hit] == 0);
            CHECK(on.by(strategy, Side::outside)[Fault::lost_occluder] == 0);
        }
    }
    // Out of the open end of a pipe, beside its rim: moved toward the axis the ray meets the wall below the rim.
    const MeasuredPoint pipe_end("tube.framed", "f64", pipe, {{0, 0, 0}, {1, 0, 0}}, 1, Vec<double>(-3, 0, 8.002));
    CHECK(find_far_side({{1, 0, 0}, {-2, 0, 4.001}}, pipe).t_begin == Approx(0.5));
    CHECK(std::isinf(find_far_side({{1, 0, 0}, {-2, 0, 4.001}}, pipe).t_wall));
    CHECK(meets_before({{{0.999, 0, 0}, {-2, 0, 4.001}}, 0}, 1, pipe));
    CHECK(pipe_end.by("offset.epsilon", Side::outside)[Fault::self_hit] == 0);
}

TEST_CASE("offsets: an exit skipped by t_min is lost, even if the ray then starts inside the ring again",
          "[measure][offset]") {
    // From the outer rim to the axis: out after 2^-11, in again after 2^-10, out after 3/2 of that.
    const Primitive<double> small(Torus<double>{{0, 0, 0}, {0, 0, 1}, 0x1p-11, 0x1p-12});
    const scene::rays::PrimitiveList<double> primitives(std::vector{small});
    const measure::evaluate::TestedForm of = row("torus.closest_approach", "f64");
    const auto strategies = all_strategies();
    const PointWork work(of, HitPointKind::computed, primitives, nullptr, std::nullopt, strategies);
    const double rim = 0x1p-11 + 0x1p-12;
    const auto tmin = std::ranges::find(strategies, "offset.tmin", &Strategy::name);
    bool has_checked_ray = false;
    for (const NewRay& ray : work.rays({{{1, 0, 0}, {-1, 0, 0}}, 1 - rim, 0}, **tmin, Side::inside)) {
        if (!(ray.ray.direction.x < -0.999)) continue;
        CHECK(find_meeting({ray.ray, ray.tmin}, small).inside);
        CHECK(ray.has(Fault::lost_exit));
        has_checked_ray = true;
    }
    CHECK(has_checked_ray);
}

TEST_CASE("offsets: rays leave a flat primitive on either side, and excluding it is right", "[measure][offset]") {
    const Ray<double> down{{0.25, 0.125, 3}, {0, 0, -1}};
    const std::pair<const char*, Primitive<double>> flat[] = {
        {"disc.framed", Primitive<double>(Disc<double>{{0, 0, 0}, {0, 0, 1}, 1, 0})},
        {"plane.quotient", Primitive<double>(Plane<double>{{0, 0, 0}, {0, 0, 1}})},
        {"triangle.moller_trumbore", Primitive<double>(Triangle<double>{{-1, -1, 0}, {3, -1, 0}, {-1, 3, 0}})}};
    for (const auto& [form, primitive] : flat) {
        for (const double t : {3.0, 3.0 - 0x1p-20, 3.0 + 0x1p-20}) {
            const MeasuredPoint m(form, "f32", primitive, down, t);
            for (const Side side : both_sides) {
                CAPTURE(form, t, name_of(side));
                CHECK(m.by("offset.exclude", side).bad_ray_count == 0);
                CHECK(m.by("offset.none", side)[Fault::lost_exit] == 0);
                CHECK(m.by("offset.epsilon", side).bad_ray_count == 0);
                // A point on the other side must move as far as it is off, and half a last place.
                const bool is_off = (t < 3) == (side == Side::inside) && t != 3;
                CHECK((m.by("offset.none", side)[Fault::self_hit] > 0) == is_off);
                CHECK(m.side_of_point(side).safe_offset == (is_off ? Approx(0x1p-20).epsilon(1e-6) : Approx(0)));
            }
        }
    }
}

TEST_CASE("offsets: every kind of primitive has a default form", "[measure][offset]") {
    for (const ShapeRow& shape : shape_rows) {
        const auto name = usual_forms()[static_cast<std::size_t>(shape.shape)];
        const auto& form = test::form_named(name);
        CHECK(form.shape == shape.shape);
        CHECK(can_measure_offsets(form));
        CHECK(form.exists_in(*find_format(std::string(usual_format))));
    }
}

}  // namespace test_concave
