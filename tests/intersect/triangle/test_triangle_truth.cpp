// The sides of triangles compared with fractions, and their ties in packs.
#include <algorithm>
#include <array>
#include <map>
#include <string>
#include <vector>

#include "catch.hpp"
#include "counts.hpp"
#include "intersect/simd/packed.hpp"
#include "intersect/triangle/triangle_rays.hpp"
#include "measure/truth/band.hpp"
#include "measure/truth/truth.hpp"
#include "measure/truth/truth_columns.hpp"
#include "shapes/given_matrix.hpp"

namespace lostbits::test::test_triangle_truth {

using intersect::AtOrigin;
using intersect::Convention;
using intersect::Facing;
using intersect::Touching;
using measure::truth::find_truth;
using measure::truth::Truth;

namespace {

Rational power(std::int64_t e) {
    const Rational two(2);
    Rational p(1);
    for (std::int64_t i = 0; i < (e < 0 ? -e : e); ++i) p *= two;
    return e < 0 ? 1 / p : p;
}

/// True if the certified number encloses the fraction.
bool encloses(const measure::truth::CertifiedNumber& x, const Rational& t) {
    if (x.is_zero()) return t == 0;
    const Rational scaled = t / power(x.exponent);
    return abs(scaled - Rational(x.hi) - Rational(x.lo)) <= Rational(x.bound);
}

/// Rays with a triangle each, in columns.
class Floats {
public:
    explicit Floats(const std::vector<TriangleSample>& samples) {
        for (const auto& [ray, triangle] : samples) {
            std::size_t k = 0;
            for (const Vec<double>& v : {ray.origin, ray.direction, triangle.a, triangle.b, triangle.c})
                for (int i = 0; i < 3; ++i) numbers_[k++].push_back(static_cast<float>(v[i]));
        }
    }
    [[nodiscard]] measure::truth::ProblemColumns<float> get() const {
        measure::truth::ProblemColumns<float> p{
            .size = numbers_[0].size(), .ray = {}, .shape = Shape::triangle, .primitive = {}};
        for (std::size_t k = 0; k < 6; ++k) p.ray[k] = numbers_[k];
        for (std::size_t k = 0; k < 9; ++k) p.primitive[k] = numbers_[k + 6];
        return p;
    }

private:
    std::array<std::vector<float>, 15> numbers_;
};

}  // namespace

TEST_CASE("the side from which a ray meets a triangle agrees with rational arithmetic", "[truth][triangle]") {
    std::map<std::string, std::array<int, 2>> met;
    for_each_triangle(
        static_cast<int>(draws(3000)), [&](const TriangleDistribution& distribution, const TriangleSample& sample) {
            INFO(distribution.name);
            const TriangleAnswer right = answer_of(sample);
            for (const Facing facing : {Facing::front, Facing::back}) {
                intersect::Convention one_side;
                one_side.facing = facing;
                const Truth truth = find_truth(sample.ray, Primitive<double>(sample.triangle), {}, one_side);
                REQUIRE(truth.decision == (right.meets(facing) ? Truth::Decision::hit : Truth::Decision::miss));
                if (right.meets(facing)) REQUIRE(encloses(truth.t, right.t));
                met[distribution.name][facing == Facing::front ? 0 : 1] += truth.is_hit();
            }
        });
    for (const TriangleDistribution& distribution : triangle_distributions) {
        const bool some = std::string(distribution.name) != "in the plane";
        INFO(distribution.name << ": fronts " << met[distribution.name][0] << ", backs " << met[distribution.name][1]);
        CHECK((met[distribution.name][0] > 10) == some);
        CHECK((met[distribution.name][1] > 10) == some);
    }
}

TEST_CASE("the nearest of two triangles is chosen among those that face the ray", "[truth][triangle]") {
    const Triangle<double> near{{0, 0, 2}, {0, 4, 2}, {4, 0, 2}}, far{{0, 0, 1}, {4, 0, 1}, {0, 4, 1}};
    const std::vector<Primitive<double>> primitives{Primitive<double>(near), Primitive<double>(far)};
    const Ray<double> ray{{1, 1, 5}, {0, 0, -1}};
    const std::array<std::pair<Facing, int>, 3> first{{{Facing::both, 0}, {Facing::front, 1}, {Facing::back, 0}}};
    for (const auto& [facing, object] : first) {
        intersect::Convention convention;
        convention.facing = facing;
        CHECK(find_truth(ray, primitives, {}, convention).primitive == object);
        // A mirror does not change a side that is decided in the space of the primitive.
        Primitive<double> mirrored(far);
        mirrored.transform = transform_of(std::array<double, 12>{-1, 0, 0, 2, 0, 1, 0, 0, 0, 0, 1, 0});
        CHECK(find_truth(ray, mirrored, {}, convention).is_hit() == (facing != Facing::back));
    }
}

TEST_CASE("a batch of rays and single rays have the same truth for one-sided triangles", "[truth][triangle]") {
    Seeded rng(5);
    scene::rays::RayBlock rays;
    std::vector<Primitive<double>> primitives;
    for (int i = 0; i < 12; ++i) primitives.emplace_back(whole_sample(rng, 20).triangle);
    const int count = static_cast<int>(draws(4000));
    for (int i = 0; i < count; ++i) {
        TriangleSample s = whole_sample(rng, 20);
        const Triangle<double> at = primitives[static_cast<std::size_t>(i) % primitives.size()].triangle();
        // Half of them through a vertex, where triangles are touched.
        aim(s, i % 2 == 0 ? at.a : 0.25 * at.a + 0.25 * at.b + 0.5 * at.c, static_cast<double>(rng.integer(0, 3)));
        rays.push(s.ray);
    }
    rays.width = count, rays.y1 = 1;
    const measure::truth::Band band(rays, primitives);
    int different = 0;
    for (const Facing facing : {Facing::front, Facing::back}) {
        for (const AtOrigin at_origin : {AtOrigin::hit, AtOrigin::miss}) {
            intersect::Convention convention(at_origin);
            convention.facing = facing;
            for (std::size_t i = 0; i < rays.size(); ++i) {
                const Truth alone = find_truth(rays[i], primitives, {}, convention), there = band.truth(i, convention);
                INFO(i << ", facing " << static_cast<int>(facing));
                REQUIRE(there.decision == alone.decision);
                REQUIRE(there.primitive == alone.primitive);
                REQUIRE(compare(there.t, alone.t) == 0);
                different += there.primitive != band.truth(i, {}).primitive;
            }
        }
    }
    CHECK(different > 100);
}

TEST_CASE("rays through edges and vertices, and rays that start on a triangle, are settled in packs",
          "[truth][triangle]") {
    const auto before = intersect::simd::current_isa();
    std::map<std::string, std::vector<TriangleSample>> samples_by_distribution;
    for_each_triangle(static_cast<int>(draws(2000)),
                      [&](const TriangleDistribution& distribution, const TriangleSample& sample) {
                          samples_by_distribution[distribution.name].push_back(sample);
                      });
    for (const auto& [name, rays] : samples_by_distribution) {
        const Floats floats(rays);
        for (const Convention& convention : {Convention(), Convention(Touching::miss), Convention(AtOrigin::miss)}) {
            std::vector<Truth> right;
            for (const auto& [ray, triangle] : rays)
                right.push_back(find_truth(ray, Primitive<double>(triangle), {}, convention));
            const auto ties = static_cast<std::size_t>(
                std::ranges::count_if(right, [](const Truth& truth) { return truth.touches || truth.on_surface; }));
            for (const auto isa : intersect::simd::available_isas()) {
                intersect::simd::set_isa(isa);
                measure::truth::TruthColumns found;
                find_truth_columns(floats.get(), {.convention = convention}, found);
                INFO(name << ", " << intersect::simd::name_of(isa) << ": " << ties << " of " << rays.size());
                std::size_t different = 0;
                for (std::size_t i = 0; i < rays.size(); ++i) {
                    different += found.decision[i] != right[i].decision;
                    if (!right[i].is_hit()) continue;
                    const measure::truth::CertifiedNumber t =
                        measure::truth::make_certified(found.hi[i], found.lo[i], found.bound[i]);
                    different += compare(t, right[i].t) != 0;
                }
                CHECK(different == 0);
                // A ray is decided alone if it touches and a touch is a miss, or if it begins on the triangle; so are
                // needles, whose exponents are too far apart.
                const bool is_closed = convention == Convention();
                if (name != "a needle")
                    CHECK(found.single_truths.size() <= (is_closed ? rays.size() / 20 : ties + rays.size() / 20));
            }
        }
    }
    intersect::simd::set_isa(before);
}

TEST_CASE("three points on one line are refused as a triangle at any scale", "[truth][triangle]") {
    const Ray<double> ray{{0.5, 0.25, 3}, {0, 0, -1}};
    for (const double scale : {1.0, 0x1p-1074, 0x1p-600, 0x1p1000}) {
        CAPTURE(scale);
        const Triangle<double> flat{scale * Vec<double>(1, 2, 3), scale * Vec<double>(2, 4, 6),
                                    scale * Vec<double>(5, 10, 15)};
        REQUIRE(broken_limit(Primitive<double>(flat)));
        CHECK(broken_limit(Primitive<double>(flat))->key->name == "c");
        CHECK_FALSE(find_truth(ray, Primitive<double>(flat)).is_hit());
        const Triangle<double> wide{flat.a, flat.b, scale * Vec<double>(5, 10, 16)};
        CHECK_FALSE(broken_limit(Primitive<double>(wide)));
    }
    // One last place off the line, where differences round.
    const Triangle<double> nearly{{0, 0, 0}, {0x1p60, 0x1p60, 0}, {1, 1 + 0x1p-52, 0}};
    CHECK_FALSE(broken_limit(Primitive<double>(nearly)));
    CHECK(broken_limit(Primitive<double>(Triangle<double>{{0, 0, 0}, {0x1p60, 0x1p60, 0}, {1, 1, 0}})));
}

}  // namespace lostbits::test::test_triangle_truth
