// The bound that a form states for its own error, compared with the same formula without rounding: the bound is never
// below the error, and a decision that the bounds prove is never wrong.
//
//   LOSTBITS_RAYS=100000000 build/test_filtered "[long-bounds]"
#include <tbb/parallel_for.h>

#include <atomic>
#include <cstdlib>

#include "catch.hpp"
#include "counts.hpp"
#include "intersect/hostile_rays.hpp"
#include "intersect/table/table.hpp"
#include "measure/answer/without_rounding.hpp"
#include "measure/truth/unit_direction.hpp"
#include "number/bounded.hpp"

namespace lostbits::test {
namespace {
using intersect::table::Intersector;

struct Tally {
    std::atomic<std::uint64_t> ray_count = 0, hits = 0, finite = 0, proved = 0, known = 0;
    std::atomic<std::uint64_t> other_bits = 0, below = 0, wrong = 0;
};

/// The form in exact arithmetic on the format's own inputs, enclosed from both sides, as narrowly as this many bits
/// allow.
Hit<Interval> without_rounding(const Intersector& form, const HostileRay& x) {
    const Interval::Precision precision(700);
    const auto lift = [](double v) { return Interval(v); };
    const auto vec = [&](const Vec<double>& v) { return Vec<Interval>(lift(v.x), lift(v.y), lift(v.z)); };
    const Primitive<Interval> primitive = convert_numbers(x.primitive, lift);
    return form.interval(Ray<Interval>{vec(x.ray.origin), vec(x.ray.direction)},
                         intersect::Target<Interval>(primitive));
}

/// True if t is farther than `error` from every point of the interval.
bool is_farther(double t, double error, const Interval& from) {
    const Interval::Precision precision(700);
    return (abs(from - Interval(t)) > Interval(error)).is_yes();
}

template <class S>
void check_ray(const Intersector& form, const HostileRay& x, Tally& tally) {
    const Format format = *find_format(sizeof(S) == 4 ? "f32" : "f64");
    const auto own = form.bounded(format, x.ray, intersect::Target<double>(x.primitive), HUGE_VAL);
    ++tally.ray_count;
    const auto stored = [](double v) { return static_cast<S>(v); };
    const Primitive<S> primitive = convert_numbers(x.primitive, stored);
    const S o[6] = {stored(x.ray.origin.x),    stored(x.ray.origin.y),    stored(x.ray.origin.z),
                    stored(x.ray.direction.x), stored(x.ray.direction.y), stored(x.ray.direction.z)};
    S t, near, far;
    std::uint8_t hit;
    const auto column = [&o](int k) { return std::span<const S>(o + k, 1); };
    const intersect::table::RayBatch<S> rays{column(0), column(1), column(2), column(3), column(4), column(5)};
    const intersect::table::HitBatch<S> hits{{&t, 1}, {&near, 1}, {&far, 1}, {&hit, 1}};
    if constexpr (sizeof(S) == 4) form.native32(rays, intersect::Target<S>(primitive), hits);
    else form.native64(rays, intersect::Target<S>(primitive), hits);
    const bool both_nan = std::isnan(t) && std::isnan(own->t);
    tally.other_bits += own->hit != (hit != 0) || !(own->t == static_cast<double>(t) || both_nan);

    const Hit<Interval> exact = without_rounding(form, x);
    tally.proved += own->proved;
    if (exact.hit.is_unknown()) return;
    ++tally.known;
    tally.wrong += own->proved && own->hit != exact.hit.is_yes();
    if (!own->hit || !exact.hit.is_yes() || !exact.t.is_bounded()) return;
    ++tally.hits;
    if (!(own->error < HUGE_VAL)) return;
    ++tally.finite;
    tally.below += is_farther(own->t, own->error, exact.t);
}

template <class S>
void check_form(const Intersector& form, std::uint64_t rays, std::uint64_t seed, Tally& tally, bool any_scale) {
    constexpr std::uint64_t block = 1024;
    tbb::parallel_for(std::uint64_t{0}, (rays + block - 1) / block, [&](std::uint64_t b) {
        HostileRays<S> draw(seed << 32 | b);
        Random scales(seed << 32 | b);
        for (std::uint64_t i = 0; i < std::min(block, rays - b * block); ++i) {
            const bool as_box = form.shape == Shape::box || form.shape == Shape::triangle;
            HostileRay x = as_box ? draw.box((b + i) % hostile_box_distributions.size())
                                  : draw.sphere((b + i) % sphere_distributions.size());
            // Rays that are hostile to a sphere are hostile to a primitive around the same centre.
            if (!as_box && form.shape != Shape::sphere)
                x.primitive =
                    convert_numbers(primitive_around<double>(form.shape, x.primitive.point(0), x.primitive.numbers[3]),
                                    [](double v) { return static_cast<double>(static_cast<S>(v)); });
            if (any_scale) x = at_any_scale<S>(x, scales);
            if (form.info->direction == intersect::Direction::unit)
                x.ray.direction = measure::truth::unit_direction(x.ray.direction, sizeof(S) == 4 ? binary32 : binary64);
            // At any scale the ends of an axis may meet, and a normal vanish.
            if (as_box || form.shape == Shape::sphere || !broken_limit(x.primitive)) check_ray<S>(form, x, tally);
        }
    });
}

/// Every form of spheres and boxes in every format that it has.
void check_bounds(std::uint64_t rays, std::uint64_t seed, bool any_scale = false) {
    std::uint64_t rows = 0;
    for (const Intersector& form : intersect::table::catalogue())
        if (form.shape != Shape::sdf) rows += 1 + static_cast<bool>(form.native64);
    for (const Intersector& form : intersect::table::catalogue()) {
        if (form.shape == Shape::sdf) continue;
        for (const bool narrow : {true, false}) {
            if (!narrow && !form.native64) continue;
            Tally tally;
            if (narrow) check_form<float>(form, rays / rows, seed, tally, any_scale);
            else check_form<double>(form, rays / rows, seed, tally, any_scale);
            INFO(form.info->name << (narrow ? " f32: " : " f64: ") << tally.ray_count << " rays, " << tally.proved
                                 << " decisions proved, " << tally.known << " known exactly, " << tally.hits
                                 << " hits, " << tally.finite << " with a bound");
            CHECK(tally.other_bits == 0);
            CHECK(tally.wrong == 0);
            CHECK(tally.below == 0);
            if (any_scale) continue;  // if most numbers over- or underflow, little is known
            // A bound that adds up what operations lose does not see that a second word holds what the first has lost.
            // A solver of tori divides by numbers that may be 0 within their bounds.
            if (form.shape != Shape::torus)
                CHECK(tally.proved > tally.ray_count / (form.info->name == "ellipsoid.two_words" ? 64 : 8));
            // Some forms have no bound: closest_approach uses the sign of a number that is zero without rounding.
            if (form.info->name == "sphere.schoolbook") CHECK(tally.finite > tally.hits / 3);
            if (form.info->name == "box.signs") CHECK(tally.finite > tally.hits * 9 / 10);
        }
    }
}

}  // namespace

TEST_CASE("a running error bound of a form covers its error, and its proved decisions are right",
          "[intersect][bounded]") {
    check_bounds(draws(std::uint64_t{1} << 20, 20), 1);
}

TEST_CASE("running error bounds hold over all exponents of the format", "[intersect][bounded]") {
    check_bounds(draws(std::uint64_t{1} << 19, 20), 3, true);
}

TEST_CASE("running error bounds hold over a chosen number of rays", "[.][long-bounds]") {
    const char* const ray_count_text = std::getenv("LOSTBITS_RAYS");
    const char* const seed = std::getenv("LOSTBITS_SEED");
    check_bounds(ray_count_text ? std::strtoull(ray_count_text, nullptr, 10) : 10000000,
                 seed ? std::strtoull(seed, nullptr, 10) : 2);
    check_bounds(ray_count_text ? std::strtoull(ray_count_text, nullptr, 10) : 10000000,
                 seed ? std::strtoull(seed, nullptr, 10) : 2, true);
}

TEST_CASE("a bound proves only what its error allows", "[number][bounded]") {
    using B = Bounded<float>;
    const B third = B(1) / B(3);
    CHECK(third.error() > 0);
    CHECK(third.error() < 0x1p-24F);
    CHECK((B(1) - third * B(3)).error() >= 0x1p-25F);
    CHECK((B(2) < B(3)).is_proved());
    CHECK_FALSE((third < third * B(1)).is_proved());
    CHECK((third < B(1)).is_proved());
    // Both sides count if a decision is open.
    const B chosen = select(third <= third * B(1), B(10), B(20));
    CHECK(chosen.value() == 10);
    CHECK(chosen.error() >= 10);
    // The root of a number that may be negative has no bound; an exact infinity is exact.
    CHECK(sqrt(third - third).error() == HUGE_VALF);
    CHECK((B(1) / B(0)).error() == 0);
    CHECK((B(1) / (third - third)).error() == HUGE_VALF);
    CHECK((B(1) / B(0) * third).error() == 0);
}

}  // namespace lostbits::test
