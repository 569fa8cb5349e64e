// Truth against two independent computations: exact integers and Arb. Every ray of every family must agree.
#include <array>
#include <cstdio>
#include <ctime>
#include <span>

#include "catch.hpp"
#include "counts.hpp"
#include "measure/truth/arb_reference.hpp"
#include "measure/truth/exact_reference.hpp"
#include "measure/truth/ranges.hpp"
#include "measure/truth/ray_families.hpp"
#include "measure/truth/truth.hpp"

namespace test_truth {

using namespace lostbits;
using namespace lostbits::testing;
using measure::truth::Length;

namespace {

/// What a family's run is known by afterwards.
struct Tally {
    int rays = 0, hits = 0, escalated = 0, bits = 0, ties = 0;
    long arb_bits = 0;
};

bool keeps(RayFamily::Promise promise, const ExactHit& exact) {
    switch (promise) {
        case RayFamily::Promise::tangent_line: return exact.is_tangent_line();
        case RayFamily::Promise::on_surface: return exact.on_surface();
        case RayFamily::Promise::inside: return exact.is_inside();
        case RayFamily::Promise::none: return true;
    }
    return false;
}

/// Empty where everything agrees, else what does not.
std::string disagreement(const RaySample& s, const ExactHit& exact, const Range<double>& range, Tally& tally,
                         const ArbReference::Answer* ball = nullptr) {
    const measure::truth::Truth truth = measure::truth::find_truth(s.ray, s.sphere, {}, {}, range);

    // Which side of a power of two a length lies on is a question of its own, and more bits are the answer to it.
    const auto beside_power = [](const measure::truth::Certified& x) {
        return x.hi == 1 && std::fabs(x.lo) <= measure::truth::certified_tightness;
    };
    tally.escalated += truth.bits > 106 && !beside_power(truth.t) && !beside_power(truth.distance);
    tally.bits = std::max(tally.bits, truth.bits);
    if (ball) tally.arb_bits = std::max(tally.arb_bits, ball->bits);
    if (truth.decision == measure::truth::Truth::Decision::unresolved) return "unresolved";
    if (ball && ball->decision == ArbReference::Decision::undecided) return "Arb did not decide";
    if (truth.is_hit() != exact.hit())
        return truth.is_hit() ? "a hit that exact integers miss" : "a miss that exact integers hit";
    if (ball && truth.is_hit() != (ball->decision == ArbReference::Decision::hit)) return "Arb decides otherwise";
    if (!truth.is_hit()) return truth.object == -1 ? "" : "a miss names an object";

    ++tally.hits;
    if (truth.object != 0) return "a hit without object";
    if (!encloses(truth.t, exact)) return "t is not within its bound";
    if (!encloses_distance(truth.distance, exact)) return "the distance is not within its bound";
    if (truth.t.bound > measure::truth::certified_tightness * std::fabs(truth.t.hi)) return "t is not tight";
    if (truth.distance.bound > measure::truth::certified_tightness * std::fabs(truth.distance.hi))
        return "the distance is not tight";
    const auto side = [&](const Dyadic& x) { return exact.side(x); };
    const auto distance_side = [&](const Dyadic& x) { return exact.distance_side(x); };
    if (!is_in_binade(truth.t, side)) return "t is not in the binade that its ulp is taken of";
    if (!is_in_binade(truth.distance, distance_side)) return "the distance is not in its binade";
    for (const FloatFormat& f : {binary64, binary32, binary16, bfloat16, FloatFormat{52, -1022, 1023}}) {
        const double rounded = measure::truth::round_truth(truth, s.ray, s.sphere, f, Length::parameter, {}, range);
        if (!is_rounded(rounded, side, f))
            return "t is not correctly rounded to " + std::to_string(f.precision) + " bits";
        if (f == binary64 && ball && ball->rounded && rounded != ball->t) return "Arb rounds otherwise";
        const double distance = measure::truth::round_truth(truth, s.ray, s.sphere, f, Length::distance, {}, range);
        if (!is_rounded(distance, distance_side, f))
            return "the distance is not correctly rounded to " + std::to_string(f.precision) + " bits";
        tally.ties += !measure::truth::round_certified(truth.t, f);
    }
    if (ball && !ball->rounded) return "Arb could not round";
    return "";
}

void check(const RayFamily& family, const FloatFormat& storage, int rays, std::uint64_t seed) {
    Seeded rng(seed);
    ArbReference arb;
    Tally tally;
    const std::clock_t start = std::clock();
    std::string report;
    int failures = 0;
    for (int i = 0; i < rays; ++i) {
        const RaySample s = family.make(rng, storage);
        const ExactHit exact(s.ray, s.sphere);
        const ArbReference::Answer ball = arb.find(s.ray, s.sphere);
        const std::string what =
            keeps(family.promise, exact) ? disagreement(s, exact, {}, tally, &ball) : "the generator missed its aim";
        if (what.empty() || ++failures > 3) continue;
        report += std::string(family.name) + ", seed " + std::to_string(seed) + ", index " + std::to_string(i) + ": " +
                  what + "\n    " + paste(s.ray, s.sphere) + "\n";
    }
    tally.rays = rays;
    std::printf("%-17s f%d  %7d rays  %7d hits  %6d escalated  %5d bits  %6d straddled  %6ld bits in Arb  %5.1f s\n",
                family.name, storage == binary32 ? 32 : 64, tally.rays, tally.hits, tally.escalated, tally.bits,
                tally.ties, tally.arb_bits, static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC);
    std::fflush(stdout);
    INFO(failures << " of " << rays << " rays disagree; the first:\n" << report);
    CHECK(failures == 0);
    if (storage == binary32) CHECK(tally.escalated <= family.most_escalated);
}

/// Both roots, or where none are what stands in their place, to a double.
std::array<double, 2> roots_of(const RaySample& s) {
    const Vec<double> f = s.ray.origin - s.sphere.centre;
    const double a = dot(s.ray.direction, s.ray.direction), h = dot(f, s.ray.direction);
    const measure::truth::Truth truth = measure::truth::find_truth(s.ray, s.sphere);
    const double first = truth.is_hit() ? measure::truth::round_truth(truth, s.ray, s.sphere, binary64) : -h / a;
    const double other = -2 * (h / a) - first;
    return {std::fabs(first), std::isfinite(other) ? std::fabs(other) : 1.0};
}

/// Every family, each ray in three ranges.
void check_in_ranges(std::span<const RayFamily> families, const FloatFormat& storage, std::uint64_t seed) {
    for (const RayFamily& family : families) {
        Seeded rng(seed);
        Tally tally;
        std::string report;
        for (int i = 0; i < test::draws(400); ++i) {
            const RaySample s = family.make(rng, storage);
            const auto roots = roots_of(s);
            for (int k = 0; k < 3; ++k, ++tally.rays) {
                const Range<double> range = range_about(rng, roots, storage);
                const std::string what = disagreement(s, ExactHit(s.ray, s.sphere, range), range, tally);
                if (what.empty() || report.size() > 2000) continue;
                report += what + "\n    " + paste(range) + " " + paste(s.ray, s.sphere) + "\n";
            }
        }
        INFO(family.name << ":\n" << report);
        CHECK(report.empty());
    }
}

}  // namespace

TEST_CASE("truth in a range: the first root in it, by exact integers", "[range]") {
    for (const FloatFormat& storage : {binary32, binary64}) {
        check_in_ranges(near_families, storage, 7);
        check_in_ranges(power_families, storage, 8);
        check_in_ranges(wide_families, storage, 9);
    }
}

TEST_CASE("truth agrees with exact integers and with Arb on binary32 inputs", "[near][binary32]") {
    for (const RayFamily& f : near_families) check(f, binary32, test::draws(f.rays_binary32), 1);
}

TEST_CASE("truth agrees with exact integers and with Arb on binary64 inputs", "[near][binary64]") {
    for (const RayFamily& f : near_families) check(f, binary64, test::draws(f.rays_binary64), 2);
}

TEST_CASE("the binade of t and of the distance is decided at powers of two, on them and from both sides", "[power]") {
    for (const RayFamily& f : power_families) {
        check(f, binary32, test::draws(f.rays_binary32), 5);
        check(f, binary64, test::draws(f.rays_binary64), 6);
    }
}

TEST_CASE("truth agrees where exponents are wide and where t is a tie", "[wide]") {
    for (const RayFamily& f : wide_families) {
        check(f, binary32, test::draws(f.rays_binary32), 3);
        check(f, binary64, test::draws(f.rays_binary64), 4);
    }
}

}  // namespace test_truth
