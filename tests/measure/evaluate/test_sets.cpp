// Sets of one form per shape: they answer as their forms do, and each primitive is judged by the contract of its own
// form.
#include <array>
#include <cmath>
#include <optional>
#include <random>

#include "catch.hpp"
#include "counts.hpp"
#include "intersect/simd/packed.hpp"
#include "intersect/table/sets.hpp"
#include "measure/answer/answers.hpp"
#include "measure/rows.hpp"
#include "measure/truth/band.hpp"

namespace lostbits::test::test_sets {

using intersect::table::Intersector;
using measure::answer::Answers;
using measure::truth::Band;
using measure::truth::Truth;
using test::form_named;

namespace {

/// Three spheres and two boxes on a grid, and rays that start on it and go along it or nearly so: many rays touch,
/// start on surfaces or inside, or hit two primitives at one t.
struct MixedScene {
    scene::rays::RayBlock rays;
    std::vector<Primitive<double>> spheres, boxes, all;

    explicit MixedScene(unsigned seed) {
        std::mt19937 engine(seed);
        const auto whole = [&engine](int most) { return double(int(engine() % unsigned(2 * most + 1)) - most); };
        const auto point = [&](int most) {
            const double x = whole(most), y = whole(most), z = whole(most);
            return Vec<double>(x, y, z);
        };
        for (int k = 0; k < 3; ++k) spheres.emplace_back(Sphere<double>{point(4), 1.0 + double(engine() % 2)});
        for (int k = 0; k < 2; ++k) {
            const Vec<double> lo = point(4), size = point(2);
            boxes.emplace_back(Box<double>{lo, lo + Vec<double>(std::fabs(size.x), std::fabs(size.y), 1)});
        }
        all = spheres;
        all.insert(all.end(), boxes.begin(), boxes.end());
        const int count = 2000;
        for (int i = 0; i < count; ++i) {
            const Vec<double> from = point(6);
            Vec<double> way = point(2);
            if (way.x == 0 && way.y == 0 && way.z == 0) way.z = 1;
            if (i % 2 == 0) way.x += whole(3) / 1024;
            rays.push({from, way});
        }
        rays.width = count;
        rays.y1 = 1;
    }
};

Answers answers_of(const Intersector& form, const MixedScene& mixed, const std::vector<Primitive<double>>& primitives,
                   const Format& format, bool unit) {
    const Band band(mixed.rays, primitives);
    auto inputs = band.inputs(format, {.unit_rays = unit || form.info->direction == intersect::Direction::unit});
    // In a set for unit directions, every form receives unit directions.
    if (unit) inputs.rays = inputs.unit_rays;
    return measure::answer::evaluate(form, inputs);
}

/// The nearer of two answers: the first if they are equal, and a number before NaN.
bool comes_first(const Answers& a, const Answers& b, std::size_t i) {
    if (b.hit[i] == 0 || a.hit[i] == 0) return b.hit[i] == 0;
    if (std::isnan(a.t[i]) || std::isnan(b.t[i])) return !std::isnan(a.t[i]) || std::isnan(b.t[i]);
    return !(b.t[i] < a.t[i]);
}

const std::pair<const char*, const char*> pairs[] = {{"sphere.schoolbook", "box.inclusive"},
                                                     {"sphere.schoolbook_strict", "box.signs"},
                                                     {"sphere.unified_unit", "box.embree_robust"},
                                                     {"sphere.pbrt_interval", "box.exclusive"},
                                                     {"sphere.filtered", "box.filtered"}};

constexpr std::array<std::optional<intersect::Touching>, 3> judgements{std::nullopt, intersect::Touching::hit,
                                                                       intersect::Touching::miss};

}  // namespace

TEST_CASE("a set returns the nearest answer of its forms in every format and register width", "[sets]") {
    int from_boxes = 0, from_spheres = 0;
    for (unsigned seed = 0; seed < draws(30U); ++seed) {
        const MixedScene mixed(seed);
        for (const auto& [of_sphere, of_box] : pairs) {
            const Intersector &a = form_named(of_sphere), &b = form_named(of_box);
            const Intersector& set = intersect::table::find_or_add_set({&b, &a});
            const bool unit = set.info->direction == intersect::Direction::unit;
            for (const char* const name : {"f32", "f64", "p16"}) {
                const Format format = *find_format(name);
                const Answers of_a = answers_of(a, mixed, mixed.spheres, format, unit),
                              of_b = answers_of(b, mixed, mixed.boxes, format, unit);
                for (const auto isa : {intersect::simd::Isa::scalar, intersect::simd::best_isa()}) {
                    intersect::simd::set_isa(isa);
                    const Answers together = answers_of(set, mixed, mixed.all, format, false);
                    intersect::simd::set_isa(intersect::simd::best_isa());
                    INFO(set.info->name << " in " << name << ", seed " << seed);
                    std::size_t wrong = 0;
                    for (std::size_t i = 0; i < mixed.rays.size(); ++i) {
                        const bool first = comes_first(of_a, of_b, i);
                        const Answers& right = first ? of_a : of_b;
                        const bool same_t = together.t[i] == right.t[i] || (together.t[i] != together.t[i]);
                        const int object =
                            right.primitive[i] < 0 ? -1 : right.primitive[i] + (first ? 0 : int(mixed.spheres.size()));
                        wrong += together.hit[i] != right.hit[i] ||
                                 (right.hit[i] != 0 && (!same_t || together.primitive[i] != object));
                        (first ? from_spheres : from_boxes) += right.hit[i];
                    }
                    CHECK(wrong == 0);
                }
            }
        }
    }
    CHECK(from_spheres > 1000);
    CHECK(from_boxes > 1000);
}

TEST_CASE("each primitive in a set is judged by the contract of its own form", "[sets]") {
    int apart = 0;
    for (unsigned seed = 0; seed < draws(20U); ++seed) {
        const MixedScene mixed(seed);
        const Band band(mixed.rays, mixed.all);
        for (const auto& [of_sphere, of_box] : pairs) {
            const Intersector &a = form_named(of_sphere), &b = form_named(of_box);
            const Intersector& set = intersect::table::find_or_add_set({&a, &b});
            for (const std::optional<intersect::Touching> judged : judgements) {
                std::size_t wrong = 0;
                for (std::size_t i = 0; i < mixed.rays.size(); ++i) {
                    Truth right;
                    for (std::size_t s = 0; s < mixed.all.size(); ++s) {
                        const Intersector& form = mixed.all[s].shape == a.shape ? a : b;
                        measure::truth::merge_truth(
                            measure::truth::find_truth(mixed.rays[i], mixed.all[s], {}, form.info->convention(judged)),
                            static_cast<int>(s), right);
                    }
                    const Truth found = band.truth(i, set.info->convention(judged)), closed = band.truth(i, {});
                    wrong += found.decision != right.decision ||
                             (right.is_hit() && (compare(found.t, right.t) != 0 || found.primitive != right.primitive));
                    apart += closed.decision != right.decision;
                }
                INFO(set.info->name << ", seed " << seed);
                CHECK(wrong == 0);
            }
        }
    }
    CHECK(apart > 100);  // the properties make a difference
}

TEST_CASE("an impossible set is refused with the reason, and each set is made once", "[sets]") {
    using intersect::table::refusal_of_set;
    const Intersector &sphere = form_named("sphere.press"), &other = form_named("sphere.unified"),
                      &box = form_named("box.signs"), &march = form_named("sdf.sphere_trace");
    CHECK(refusal_of_set({&sphere, &box}).empty());
    CHECK(refusal_of_set({&sphere, &other}) ==
          "sphere.press and sphere.unified are both for spheres; name one form for each shape");
    CHECK(refusal_of_set({&sphere, &march}).find("marches") != std::string::npos);
    const Intersector& set = intersect::table::find_or_add_set({&box, &sphere});
    CHECK(&set == &intersect::table::find_or_add_set({&sphere, &box}));
    CHECK(set.info->name == "sphere.press+box.signs");
    CHECK(&set.form_for(box.shape) == &box);
    CHECK(set.info->by_shape == std::array<const intersect::Convention*, 3>{});
    const Intersector& strict = intersect::table::find_or_add_set({&form_named("sphere.two_step"), &box});
    CHECK(strict.info->convention().for_shape(sphere.shape).touching == intersect::Touching::miss);
    CHECK(strict.info->convention().for_shape(box.shape).touching == intersect::Touching::hit);
    CHECK(strict.info->convention(intersect::Touching::miss).by_shape == nullptr);
    const Intersector& narrow = intersect::table::find_or_add_set({&form_named("sphere.double_inside"), &box});
    CHECK(narrow.exists_in(*find_format("f32")));
    CHECK_FALSE(narrow.exists_in(*find_format("f64")));
}

}  // namespace lostbits::test::test_sets
