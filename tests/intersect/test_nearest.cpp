// Distances and nearest points of shapes: one test over the closed list, with random primitives.
#include <algorithm>
#include <cmath>

#include "catch.hpp"
#include "measure/seeded.hpp"
#include "number/format.hpp"
#include "number/real.hpp"
#include "shapes/primitive.hpp"

namespace lostbits::test::test_nearest {
namespace {

const Real tolerance = ldexp(Real(1), -200);

template <class T>
Vec<T> lifted(const Vec<double>& v) {
    return {static_cast<T>(v.x), static_cast<T>(v.y), static_cast<T>(v.z)};
}

Primitive<double> random_primitive(const ShapeRow& row, Seeded& rng) {
    Primitive<double> primitive(row.shape);
    std::size_t k = 0;
    for (const Key& key : row.keys) {
        using Limit = Key::Limit;
        for (const std::size_t end = k + key.count(); k < end; ++k) {
            double& x = primitive.numbers[k];
            if (!key.is_length()) x = rng.uniform(-1, 1);
            else if (key.limit == Limit::positive) x = rng.uniform(0.1, 1);
            else if (key.limit == Limit::not_negative) x = rng.coin() ? 0 : rng.uniform(0, 1);
            else
                x = (key.limit == Limit::non_negative_below_previous && rng.coin() ? 0 : rng.uniform(0.1, 0.99)) *
                    primitive.numbers[k - 1];
        }
    }
    return primitive;
}

/// True if it is an apex, where there is no normal.
template <class S>
bool is_apex(const S&, const Vec<double>&) {
    return false;
}
bool is_apex(const Cone<double>& cone, const Vec<double>& on) {
    return cone.top_radius == 0 && length(Vec<double>(on - cone.top)) < 0x1p-30;
}

/// The point is on the surface, at most as far as `distance` says; its normal has length one and points away from the
/// inside.
template <template <class> class S>
void check_nearest_point(const S<Real>& s, const Vec<double>& q) {
    const Vec<Real> p = lifted<Real>(q);
    const Ray<Real> ray{p, p};
    const Vec<Real> on = s.project_onto_surface(ray, p), n = s.outward_normal(ray, on);
    const Real d = s.distance(p);
    REQUIRE(abs(s.relative_distance(on)) * s.unit() <= tolerance);
    REQUIRE(abs(Real(length(n) - Real(1))) <= tolerance);
    REQUIRE(abs(s.distance(on + ldexp(Real(1), -20) * n)) > 0);
    if (s.name == "ellipsoid") return;  // whose `distance` is a bound, and whose projection runs along a radius
    REQUIRE(abs(s.relative_distance(p)) * s.unit() <= abs(d) + tolerance);
    if (s.name == "cone" || s.name == "disc") return;  // put back across the axis, and onto the plane
    REQUIRE(abs(Real(abs(d) - length(Vec<Real>(p - on)))) <= tolerance);
    REQUIRE(abs(s.distance(on)) <= tolerance);
}

/// A point put onto the surface in float lies within its bound; returns the fraction of the bound that it uses.
template <template <class> class S>
double share_of_bound(const Primitive<double>& primitive, const Vec<double>& at) {
    const Primitive<float> rounded = convert_numbers(primitive, [](double x) { return static_cast<float>(x); });
    const S<float> s = rounded.template as<S>();
    const S<Real> same = convert_numbers(rounded, [](float x) { return Real(x); }).template as<S>();
    // A point near the surface, as hits are, is put back after rounding moved it.
    const Vec<Real> p = lifted<Real>(at), on = same.project_onto_surface(Ray<Real>{p, p}, p);
    const Vec<float> near(static_cast<float>(on.x), static_cast<float>(on.y), static_cast<float>(on.z));
    const BoundedPoint<float> b = s.bounded_point(Ray<float>{near, {1, 0, 0}}, 0, near);
    double allowed = 0;
    for (int i = 0; i < 3; ++i) allowed += static_cast<double>(b.delta[i]) * static_cast<double>(b.delta[i]);
    const Vec<Real> there(Real(b.p.x), Real(b.p.y), Real(b.p.z));
    return static_cast<double>(abs(same.distance(there))) / std::sqrt(allowed);
}

/// The largest of primitives of all sizes, near the origin and far.
template <template <class> class S>
double largest_share_of_bound(const ShapeRow& row, Seeded& rng) {
    double largest = 0;
    for (int i = 0; i < 2000; ++i) {
        Primitive<double> primitive = scaled(random_primitive(row, rng), rng.magnitude(-6, 6));
        const Vec<double> off = rng.magnitude(-6, 6) * rng.vec(-1, 1);
        std::size_t k = 0;
        for (const Key& key : row.keys) {
            if (key.kind == Key::Kind::point) primitive.set_point(k, primitive.point(k) + off);
            k += key.count();
        }
        const double x = rng.unit(), y = rng.unit(), z = rng.unit();
        const Vec<double> at = primitive.template as<S>().point_at({x, y, z});
        if (!broken_limit(convert_numbers(primitive, [](double v) { return static_cast<float>(v); })))
            largest = std::max(largest, share_of_bound<S>(primitive, at));
    }
    return largest;
}

}  // namespace

TEST_CASE("distance, normal, nearest point and bounded point of a shape agree with each other", "[shapes]") {
    Seeded rng(0x7a7);
    Primitives::each([&]<template <class> class S>() {
        const ShapeRow& row = row_of(shape_as<S>);
        if (row.name == "box" || row.name == "triangle") return;  // test_primitives
        INFO(row.name);
        int inside = 0;
        for (int i = 0; i < 500; ++i) {
            const Primitive<double> primitive = random_primitive(row, rng);
            const S<double> plain = primitive.as<S>();
            const S<Real> s = convert_numbers(primitive, [](double x) { return Real(x); }).template as<S>();
            const Vec<double> q = rng.vec(-1.5, 1.5);
            const Real d = s.distance(lifted<Real>(q));
            if (!is_apex(plain, plain.project_onto_surface({}, q))) check_nearest_point(s, q);
            // The distance is at most that to any point of the surface.
            for (int k = 0; k < 20; ++k) {
                const Vec<Real> u = lifted<Real>(rng.vec(-2, 2)), share(abs(u.x) / 2, abs(u.y) / 2, abs(u.z) / 2);
                const Vec<Real> other = row.name == "disc" ? s.point_at(share) : s.project_onto_surface({}, u);
                REQUIRE(length(Vec<Real>(lifted<Real>(q) - other)) >= abs(d) * (1 - tolerance));
            }
            inside += d < 0;
        }
        CHECK((inside > 2) == !(row.is_flat || row.name == "tube"));
        const double share = largest_share_of_bound<S>(row, rng);
        CHECK(share < 1);
        CHECK(share > 0.01);
    });
}

/// Among sampled points of the surface, some are hardly farther than `distance` says, so it is a good bound.
TEST_CASE("the distance field of an ellipsoid is close to the true distance", "[shapes]") {
    Seeded rng(0x7a4);
    double closest = HUGE_VAL;
    for (int i = 0; i < 300; ++i) {
        const Ellipsoid<double> e{rng.vec(-1, 1), rng.vec(0.05, 2)};
        const Vec<double> p = rng.vec(-3, 3);
        const double field = e.distance(p);
        for (int k = 0; k < 300; ++k) {
            const Vec<double> u = rng.vec(-1, 1), on = e.centre + (1 / length(u)) * (u * e.radii);
            const double there = length(Vec<double>(p - on));
            REQUIRE(std::fabs(field) <= there * (1 + 1e-12));
            closest = std::min(closest, there / std::fabs(field));
        }
    }
    CHECK(closest < 1.1);
}

}  // namespace lostbits::test::test_nearest
