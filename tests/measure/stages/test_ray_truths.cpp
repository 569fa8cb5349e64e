// Truths of many rays among primitives equal the truth of each ray alone, in doubles and in numbers that double cannot
// hold.
#include <optional>

#include "catch.hpp"
#include "measure/stages/hard_problems.hpp"
#include "measure/truth/ranges.hpp"
#include "measure/truth/truth_columns.hpp"
#include "number/real.hpp"

namespace test_ray_truths {

using namespace lostbits;
using namespace lostbits::test;
using measure::truth::find_truth;
using measure::truth::StageCounts;
using measure::truth::Truth;

namespace {

/// A number that no double can hold: two words, and a rest behind them.
Real between_doubles(Seeded& rng, double x) {
    if (rng.index(4) == 0 || std::fabs(x) < 0x1p-800) return Real(x);
    const double second = x * rng.uniform(-0x1p-54, 0x1p-54), rest = second * rng.uniform(-0x1p-54, 0x1p-54);
    return Real(x) + Real(second) + Real(rest);
}

/// Rays of such numbers, each with its own primitive.
struct Ideal {
    scene::rays::BasicRayBlock<Real> rays;
    std::vector<Primitive<Real>> primitives;

    Ideal(std::span<const HardRay> problems, std::optional<OpenEnds> ranged) {
        Seeded rng(16);
        const auto moved = [&rng](double x) { return between_doubles(rng, x); };
        const auto vec = [&](const Vec<double>& v) {
            const Real x = moved(v.x), y = moved(v.y), z = moved(v.z);
            return Vec<Real>(x, y, z);
        };
        for (const HardRay& hard_ray : problems) {
            const Vec<Real> origin = vec(hard_ray.ray.origin), direction = vec(hard_ray.ray.direction);
            rays.push({origin, direction});
            primitives.push_back(convert_numbers(hard_ray.primitive, moved));
            const Range<double> range =
                ranged ? range_about_primitive(rng, hard_ray.ray, hard_ray.primitive, binary64) : hard_ray.range;
            rays.tmin.push_back(range.tmin), rays.tmax.push_back(range.tmax);
        }
        rays.open_ends = ranged.value_or(OpenEnds{});
    }
    StageCounts find(measure::truth::RayTruths& found) const {
        const scene::rays::PrimitiveList<Real> list(primitives);
        return find_truths(measure::truth::RaysAndPrimitives<Real>{rays, list, nullptr, true}, {}, found);
    }
};

}  // namespace

TEST_CASE("truth columns: numbers beyond double give the same truth as ray by ray, with and without ranges") {
    std::vector<std::optional<OpenEnds>> ranges{std::nullopt};
    for (const auto& [name, open] : open_ends_names) ranges.emplace_back(open);
    for (const Shape shape : {Shape::sphere, Shape::box}) {
        const auto random = random_problems(shape, binary64);
        measure::truth::RayTruths settled;
        const double share = shape == Shape::sphere ? 0.999 : 0.99, count = static_cast<double>(random.size());
        CHECK(static_cast<double>(Ideal(random, {}).find(settled).double_double) >= share * count);
        for (const auto& ranged : ranges) {
            const Ideal ideal(problems_of(shape, binary64, ranged ? 60 : rays_per_distribution), ranged);
            measure::truth::RayTruths found;
            const StageCounts counts = ideal.find(found);
            CHECK(counts.double_double > ideal.primitives.size() / 4);
            std::size_t different = 0;
            for (std::size_t i = 0; i < ideal.primitives.size(); ++i) {
                Truth alone = find_truth(ideal.rays[i], ideal.primitives[i], {}, {}, ideal.rays.range(i));
                if (alone.is_hit()) alone.primitive = static_cast<int>(i);
                different += !agree(found[i], alone);
            }
            CHECK(different == 0);
        }
    }
}

TEST_CASE("truths of rays among spheres and boxes equal those of each ray alone") {
    std::vector<HardRay> problems = problems_of(Shape::sphere, binary32, 40);
    for (const HardRay& hard_ray : problems_of(Shape::box, binary32, 40)) problems.push_back(hard_ray);
    std::vector<Primitive<double>> primitives;
    for (std::size_t i = 0; i < problems.size(); i += 97) primitives.push_back(problems[i].primitive);
    // Several primitives that no ray can distinguish, and one that does not exist.
    primitives.push_back(primitives[2]);
    primitives.insert(primitives.begin() + 1, Primitive<double>(Sphere<double>{{0, 0, 0}, -1}));
    scene::rays::RayBlock rays;
    for (const HardRay& hard_ray : problems) {
        rays.push(hard_ray.ray);
        rays.tmin.push_back(hard_ray.range.tmin);
        rays.tmax.push_back(hard_ray.range.tmax);
    }
    measure::truth::RayTruths found;
    const scene::rays::PrimitiveList<double> list(primitives);
    const StageCounts counts = find_truths(measure::truth::RaysAndPrimitives<double>{rays, list}, {}, found);
    CHECK(counts.ray_count() == problems.size() * primitives.size());
    std::size_t different = 0, hits = 0;
    for (std::size_t i = 0; i < problems.size(); ++i) {
        const Truth alone =
            find_truth(problems[i].ray, std::span<const Primitive<double>>(primitives), {}, {}, problems[i].range);
        hits += alone.is_hit();
        const Truth there = found[i];
        different += !agree(there, alone);
        if (alone.proof_bits > 106) continue;
        different += there.t.hi != alone.t.hi || there.t.lo != alone.t.lo || there.t.exponent != alone.t.exponent ||
                     there.distance.hi != alone.distance.hi || there.distance.lo != alone.distance.lo;
    }
    CHECK(different == 0);
    CHECK(hits > problems.size() / 8);
}

}  // namespace test_ray_truths
