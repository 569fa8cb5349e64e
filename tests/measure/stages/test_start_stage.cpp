// Rays that begin near or on a torus: packs settle nearly all of them, with the truth of each ray alone.
#include <algorithm>
#include <cmath>
#include <vector>

#include "catch.hpp"
#include "counts.hpp"
#include "measure/seeded.hpp"
#include "measure/stages/hard_problems.hpp"
#include "measure/truth/truth_columns.hpp"
#include "scene/rays/primitive_list.hpp"

namespace test_start_stage {

using namespace lostbits;
using namespace lostbits::test;
using measure::truth::find_truth;
using measure::truth::Truth;

namespace {

/// Directions of a ray in units of the surface at its origin: any, or along the tangent plane.
enum class Way { any, tangent };

struct Problems {
    scene::rays::RayBlock rays;
    std::vector<Primitive<double>> primitives;

    void add(const Ray<double>& ray, const Torus<double>& torus) {
        rays.push(ray);
        primitives.emplace_back(torus);
    }
};

/// Compares the truths of all rays, each at its own torus, with those of each ray alone. Returns the share that packs
/// settled.
double settled_share(const Problems& problems) {
    measure::truth::RayTruths found;
    const scene::rays::PrimitiveList<double> list(problems.primitives);
    const auto counts =
        find_truths(measure::truth::RaysAndPrimitives<double>{problems.rays, list, nullptr, true}, {}, found);
    std::size_t different = 0;
    for (std::size_t i = 0; i < problems.primitives.size(); ++i) {
        Truth alone = find_truth(problems.rays[i], problems.primitives[i]);
        if (alone.is_hit()) alone.primitive = static_cast<int>(i);
        different += !agree(found[i], alone);
    }
    CHECK(different == 0);
    return static_cast<double>(counts.double_double) / static_cast<double>(problems.primitives.size());
}

/// A torus of any place, axis and size, whose radii are between 1 to 2^-8 and 1 to 15/16.
Torus<double> any_torus(Seeded& rng) {
    const double major = rng.magnitude(-20, 20);
    return {major * rng.vec(-4, 4), rng.vec(-1, 1), major, major * std::ldexp(rng.uniform(0.5, 0.94), -rng.index(8))};
}

template <class F>
Vec<double> as(const Vec<double>& v) {
    return {static_cast<double>(static_cast<F>(v.x)), static_cast<double>(static_cast<F>(v.y)),
            static_cast<double>(static_cast<F>(v.z))};
}

/// Rays from a rounded point of the surface of a torus, and one in eight from a little beside it.
template <class F>
Problems rays_from_surface(Seeded& rng, int count, Way way) {
    Problems problems;
    while (static_cast<int>(problems.primitives.size()) < count) {
        Torus<double> torus = any_torus(rng);
        torus.centre = as<F>(torus.centre), torus.axis = as<F>(torus.axis);
        torus.major_radius = static_cast<F>(torus.major_radius),
        torus.minor_radius = static_cast<F>(torus.minor_radius);
        const Vec<double> near = torus.point_at({rng.unit(), rng.unit(), rng.unit()});
        const Vec<double> p = torus.project_onto_surface({}, near), n = torus.outward_normal({}, p);
        Vec<double> d = rng.vec(-1, 1);
        if (way == Way::tangent) d = d - dot(d, n) * n;
        const double aside = rng.index(8) == 0 ? torus.minor_radius * rng.sign() * std::ldexp(1.0, -rng.index(30)) : 0;
        const Vec<double> o = as<F>(p + aside * n);
        if (std::isfinite(o.x + o.y + o.z)) problems.add({o, as<F>(d)}, torus);
    }
    return problems;
}

/// Rays from (39, 52, 20) and its mirror images, which lie exactly on the torus of the radii 50 and 25, scaled by a
/// power of two. Its tangent plane there is spanned by (-4, 3, 0) and (-12, -16, 15).
Problems rays_from_exact_points(Seeded& rng, int count, Way way) {
    Problems problems;
    for (int i = 0; i < count; ++i) {
        const double scale = std::ldexp(1.0, rng.index(81) - 40);
        const auto whole = [&] { return static_cast<double>(rng.integer(-20, 20)); };
        const Vec<double> mirror(rng.sign(), rng.sign(), rng.sign()), any(whole(), whole(), whole());
        const Vec<double> tangent = whole() * Vec<double>(-4, 3, 0) + whole() * Vec<double>(-12, -16, 15);
        const Vec<double> d = way == Way::tangent ? tangent : any;
        if (d == Vec<double>(0, 0, 0)) continue;
        const Vec<double> centre(whole(), whole(), whole());
        problems.add({scale * (centre + mirror * Vec<double>(39, 52, 20)), mirror * d},
                     {scale * centre, {0, 0, whole() + 20.5}, 50 * scale, 25 * scale});
    }
    return problems;
}

}  // namespace

TEST_CASE("packs settle rays that begin at a torus, with the answer of each ray alone", "[torus]") {
    const int count = static_cast<int>(draws(4000));
    Seeded rng(70);
    CHECK(settled_share(rays_from_surface<float>(rng, count, Way::any)) > 0.995);
    CHECK(settled_share(rays_from_surface<double>(rng, count, Way::any)) > 0.995);
    CHECK(settled_share(rays_from_surface<float>(rng, count, Way::tangent)) > 0.98);
    CHECK(settled_share(rays_from_surface<double>(rng, count, Way::tangent)) > 0.98);
}

TEST_CASE("packs prove that a ray begins exactly on a torus, and whether it touches", "[torus]") {
    const int count = static_cast<int>(draws(2000));
    Seeded rng(71);
    for (const Way way : {Way::any, Way::tangent}) {
        const Problems problems = rays_from_exact_points(rng, count, way);
        CHECK(settled_share(problems) > 0.99);
        measure::truth::RayTruths found;
        const scene::rays::PrimitiveList<double> list(problems.primitives);
        find_truths(measure::truth::RaysAndPrimitives<double>{problems.rays, list, nullptr, true}, {}, found);
        std::size_t at_origin = 0, touches = 0;
        for (std::size_t i = 0; i < problems.primitives.size(); ++i)
            at_origin += found[i].is_hit() && found[i].t.is_zero() && found[i].on_surface, touches += found[i].touches;
        CHECK(at_origin == problems.primitives.size());
        const double share = static_cast<double>(touches) / static_cast<double>(problems.primitives.size());
        if (way == Way::tangent) CHECK(share > 0.95);
        else CHECK(share < 0.1);
    }
}

}  // namespace test_start_stage
