// The filter of rays that start inside, compared with integers. It never denies that a ray starts in a primitive or on
// it, at sizes from the least subnormal number to the largest, with transforms too. Where doubles can decide, it
// detects such a start.
#include <algorithm>
#include <cmath>
#include <string>

#include "catch.hpp"
#include "counts.hpp"
#include "exact/primitives.hpp"
#include "exact/whole.hpp"
#include "measure/culling/box_tree.hpp"
#include "measure/seeded.hpp"
#include "measure/truth/band.hpp"
#include "scene/rays/rays.hpp"

namespace lostbits::test::test_start {

using exact::ObjectProblem;
using exact::Vector;
using exact::Whole;

namespace {

bool at_most(const Whole& a, const Whole& b) { return sign(a - b) <= 0; }

/// The point as seen from an axis: s = v·f, and v² f² − s², which is v² times the square of its distance from the axis.
struct PointFromAxis {
    Whole v2, s, aside;

    PointFromAxis(const Vector<Whole>& o, const Vector<Whole>& from, const Vector<Whole>& to) {
        const Vector<Whole> v = to - from, f = o - from;
        v2 = dot(v, v), s = dot(v, f), aside = v2 * dot(f, f) - s * s;
    }
    [[nodiscard]] bool is_between() const { return sign(s) >= 0 && at_most(s, v2); }
};

bool is_in_ball(const Vector<Whole>& o, const Vector<Whole>& centre, const Whole& r) {
    return at_most(dot(o - centre, o - centre), r * r);
}

/// Decides whether the closed primitive contains the origin, from the definition of each shape; flat shapes have no
/// inside.
bool holds(const std::string& shape, const ObjectProblem<Whole>& q) {
    const Vector<Whole>& o = q.o;
    const auto& n = q.n;
    if (shape == "sphere") return is_in_ball(o, q.point(0), n[3]);
    if (shape == "box") {
        const Whole at[3] = {o.x, o.y, o.z};
        for (std::size_t i = 0; i < 3; ++i)
            if (!at_most(n[i], at[i]) || !at_most(at[i], n[i + 3])) return false;
        return true;
    }
    if (shape == "ellipsoid") {
        const Vector<Whole> f = o - q.point(0);
        const Whole x = f.x * n[4] * n[5], y = f.y * n[3] * n[5], z = f.z * n[3] * n[4], r = n[3] * n[4] * n[5];
        return at_most(x * x + y * y + z * z, r * r);
    }
    if (shape == "torus") {
        const Vector<Whole> f = o - q.point(0), a = q.point(3);
        const Whole n2 = dot(a, a), f2 = dot(f, f), af = dot(a, f), R2 = n[6] * n[6], e = f2 + R2 - n[7] * n[7];
        return at_most(n2 * e * e, Whole(4) * R2 * (n2 * f2 - af * af));
    }
    if (shape == "cylinder" || shape == "capsule" || shape == "cone") {
        const PointFromAxis at(o, q.point(0), q.point(3));
        const Whole side = at.v2 * n[6] * n[6];
        if (shape == "cylinder") return at.is_between() && at_most(at.aside, side);
        if (shape == "capsule")
            return is_in_ball(o, q.point(0), n[6]) || is_in_ball(o, q.point(3), n[6]) ||
                   (at.is_between() && at_most(at.aside, side));
        const Whole r = n[6] * at.v2 + (n[7] - n[6]) * at.s;
        return at.is_between() && at_most(at.v2 * at.aside, r * r);
    }
    return false;
}

bool has_inside(const std::string& shape) {
    return shape != "triangle" && shape != "disc" && shape != "plane" && shape != "tube";
}

exact::Problem problem_of(const Ray<double>& ray, const Primitive<double>& primitive) {
    exact::Problem p{};
    for (int i = 0; i < 3; ++i) {
        p.ray[i] = ray.origin[i];
        p.ray[3 + i] = ray.direction[i];
    }
    std::ranges::copy(primitive.shape_numbers(), p.primitive.begin());
    if (primitive.transform)
        p.matrix = primitive.transform->matrix, p.has_transform = true, p.is_inverse = primitive.transform->is_inverse;
    return p;
}

/// A primitive of random numbers that its shape allows; half of them are whole numbers over 4.
std::optional<Primitive<double>> draw_primitive(Seeded& rng, Shape shape) {
    Primitive<double> primitive(shape);
    const double grid = rng.coin() ? 0.25 : 0x1p-40;
    for_each_key(shape, [&](const Key& key, std::size_t k) {
        for (std::size_t i = k; i < k + key.count(); ++i)
            primitive.numbers[i] =
                std::round((key.is_length() ? rng.uniform(0.05, 2) : rng.uniform(-2, 2)) / grid) * grid;
    });
    if (shape == Shape::torus && primitive.numbers[7] > primitive.numbers[6])
        std::swap(primitive.numbers[6], primitive.numbers[7]);
    for (std::size_t i = 0; i < 3 && shape == Shape::box; ++i)
        if (primitive.numbers[i] > primitive.numbers[i + 3]) std::swap(primitive.numbers[i], primitive.numbers[i + 3]);
    return broken_limit(primitive) ? std::nullopt : std::optional(primitive);
}

/// All lengths 2^e times as large, as doubles have them.
Primitive<double> scaled_by(const Primitive<double>& primitive, int e) {
    Primitive<double> to = primitive;
    for_each_key(primitive.shape, [&](const Key& key, std::size_t k) {
        for (std::size_t i = k; i < k + key.count(); ++i)
            if (key.kind != Key::Kind::direction) to.numbers[i] = std::ldexp(primitive.numbers[i], e);
    });
    return to;
}
Vec<double> scaled_by(const Vec<double>& v, int e) {
    return {std::ldexp(v.x, e), std::ldexp(v.y, e), std::ldexp(v.z, e)};
}

/// A point in the primitive, on it or near, on a coarse grid for half of them.
Vec<double> draw_point(Seeded& rng, const Primitive<double>& primitive) {
    const Vec<double> share(rng.uniform(0, 1), rng.uniform(0, 1), rng.uniform(0, 1));
    Vec<double> p = visit(primitive, [&](const auto& s) { return Vec<double>(s.point_at(share)); });
    p = p + std::exp2(rng.uniform(-60, 2)) * rng.vec(-1, 1);
    if (rng.coin())
        for (int i = 0; i < 3; ++i) p[i] = std::round(p[i] * 4) / 4;
    return p;
}

struct Tally {
    int held = 0, denied = 0;        ///< that start inside, and of which that is denied
    int outside = 0, undecided = 0;  ///< that do not, and of which that is not told

    void take(const Ray<double>& ray, const Primitive<double>& primitive) {
        const std::string shape(row_of(primitive.shape).name);
        const bool may = measure::culling::may_start_inside(ray, primitive);
        const bool in = has_inside(shape) && holds(shape, ObjectProblem<Whole>(problem_of(ray, primitive)));
        held += in, denied += in && !may, outside += !in, undecided += !in && may;
    }
};

}  // namespace

TEST_CASE("a ray that starts in a primitive is never said to start outside, at any size", "[culling]") {
    for (const ShapeRow& row : shape_rows) {
        Seeded rng(0x57a27 + static_cast<std::uint64_t>(row.shape));
        Tally wide, usual;
        for (int i = 0; i < test::draws(4000); ++i) {
            const auto drawn = draw_primitive(rng, row.shape);
            if (!drawn) continue;
            const bool is_usual = i % 2 == 0;
            const int e = static_cast<int>(is_usual ? rng.integer(-20, 20) : rng.integer(-1074, 1020));
            const Primitive<double> primitive = scaled_by(*drawn, e);
            if (broken_limit(primitive)) continue;
            const Vec<double> direction = std::exp2(rng.uniform(-8, 8)) * rng.vec(-1, 1);
            (is_usual ? usual : wide).take({scaled_by(draw_point(rng, *drawn), e), direction}, primitive);
        }
        INFO(row.name);
        CHECK(wide.denied + usual.denied == 0);
        if (has_inside(std::string(row.name))) CHECK(std::min(wide.held, usual.held) > 20);
        CHECK(usual.outside > 10);
        CHECK(usual.undecided * 10 <= usual.outside);
    }
}

TEST_CASE("a ray that starts in a transformed primitive is never said to start outside", "[culling]") {
    for (const ShapeRow& row : shape_rows) {
        Seeded rng(0x9147 + static_cast<std::uint64_t>(row.shape));
        Tally wide, usual;
        for (int i = 0; i < test::draws(4000); ++i) {
            const auto drawn = draw_primitive(rng, row.shape);
            if (!drawn) continue;
            const bool is_usual = i % 2 == 0, is_inverse = rng.coin();
            const int most = is_usual ? 4 : 500, e = static_cast<int>(rng.integer(-most, most)),
                      stretch = static_cast<int>(rng.integer(-most, most));
            Primitive<double> primitive = scaled_by(*drawn, e);
            std::array<double, 12> m{};
            for (std::size_t k = 0; k < 12; ++k)
                m[k] = std::ldexp(rng.uniform(-2, 2), k % 4 == 3 ? stretch + e : stretch);
            primitive.transform = convert_numbers(Transform<double>{m, is_inverse, 1}, [](double x) { return x; });
            if (broken_limit(primitive) || !primitive.transform->is_proper()) continue;
            const Vec<double> p = draw_point(rng, *drawn);
            const Affine<double> map = primitive.transform->map();
            // For an inverse, any origin near the primitive will do.
            const Vec<double> origin = is_inverse ? scaled_by(rng.vec(-2, 2), e) : map.point(scaled_by(p, e));
            (is_usual ? usual : wide).take({origin, rng.vec(-1, 1)}, primitive);
        }
        INFO(row.name);
        CHECK(wide.denied + usual.denied == 0);
        CHECK(usual.outside > 10);
        CHECK(usual.undecided * 10 <= usual.outside);
    }
}

TEST_CASE("a ray that starts in a cone is found to do so where products overflow double", "[culling]") {
    // axis × (o − base) is 2^513.
    for (const int e : {258, -258}) {
        scene::rays::RayGroup group;
        const double size = std::ldexp(1.0, e);
        group.primitives.emplace_back(Cone<double>{{0, 0, -size}, {0, 0, size}, size, size / 4});
        group.rays.push({{size / 16, size / 32, 0}, {0, 1, 0}});
        group.rays.width = group.rays.y1 = 1;
        const measure::truth::Band band(group);
        const auto of = [&band](intersect::Inside inside) {
            intersect::Convention convention;
            convention.inside = inside;
            return band.truth(0, convention);
        };
        const auto truth = of(intersect::Inside::zero);
        CHECK(truth.is_hit());
        CHECK(truth.t.is_zero());
        CHECK_FALSE(of(intersect::Inside::miss).is_hit());
    }
}

TEST_CASE("a tree of boxes finds every primitive that a ray meets where squares overflow double", "[culling]") {
    using measure::culling::BoxTree;
    std::size_t met = 0, trees = 0;
    for (int round = 0; round < 60; ++round) {
        Seeded rng(0x7ee + static_cast<std::uint64_t>(round));
        // Lengths as small as possible, and primitives that a matrix enlarges by as much as they are small.
        const bool has_transform = round % 2 == 1;
        const int own = static_cast<int>(has_transform ? rng.integer(-900, 900) : rng.integer(-1060, 100)),
                  stretch = has_transform ? -own + static_cast<int>(rng.integer(-4, 4)) : 0;
        std::vector<Primitive<double>> primitives;
        while (primitives.size() < 96) {
            const auto drawn = draw_primitive(rng, shape_rows[primitives.size() % shape_rows.size()].shape);
            if (!drawn) continue;
            Primitive<double> primitive = scaled_by(*drawn, own);
            if (has_transform) {
                std::array<double, 12> m{};
                for (const std::size_t k : {0, 5, 10}) m[k] = std::ldexp(rng.uniform(0.5, 1), stretch);
                for (const std::size_t k : {3, 7, 11}) m[k] = rng.uniform(-8, 8);
                primitive.transform = convert_numbers(Transform<double>{m, false, 1}, [](double x) { return x; });
            }
            if (!broken_limit(primitive)) primitives.push_back(primitive);
        }
        scene::rays::RayBlock rays;
        for (int i = 0; i < 40; ++i) {
            const Vec<double> to =
                primitives[2 * i].transform ? primitives[2 * i].transform->map().shift : scaled_by(rng.vec(-2, 2), own);
            const Vec<double> direction = rng.vec(-1, 1);
            const double away = has_transform ? 16 : std::ldexp(8.0, i % 2 == 0 ? own : 0);
            rays.push({to - away * direction, direction});
        }
        rays.width = 40, rays.y1 = 1;
        const scene::rays::PrimitiveList<double> list(primitives);
        const auto tree = BoxTree::make(list, measure::culling::bounds_of(rays), nullptr);
        if (!tree) continue;
        ++trees;
        std::vector<std::uint32_t> found;
        for (std::size_t i = 0; i < rays.size(); ++i) {
            tree->find_candidates(rays[i], found);
            for (std::uint32_t s = 0; s < primitives.size(); ++s) {
                if (!measure::truth::find_truth(rays[i], primitives[s]).is_hit()) continue;
                ++met;
                INFO("round " << round << ", ray " << i << ", solid " << s);
                CHECK(std::ranges::binary_search(found, s));
            }
        }
    }
    CHECK(met > 500);
    CHECK(trees > 10);
}

}  // namespace lostbits::test::test_start
