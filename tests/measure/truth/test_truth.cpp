// Truth of spheres compared with exact integers, and of boxes compared with exact fractions: every ray of every
// distribution must agree, in any range, and for both values of `touching`.
#include <span>

#include "catch.hpp"
#include "counts.hpp"
#include "intersect/box/box_exact.hpp"
#include "measure/truth/box_distributions.hpp"
#include "measure/truth/enclose.hpp"
#include "measure/truth/exact_reference.hpp"
#include "measure/truth/ranges.hpp"
#include "measure/truth/ray_distributions.hpp"
#include "measure/truth/truth.hpp"

namespace test_truth {

using namespace lostbits;
using namespace lostbits::test;
using intersect::Touching;
using measure::truth::certified_tightness;
using measure::truth::CertifiedNumber;
using measure::truth::Length;
using measure::truth::Truth;

namespace {

using Side = std::function<int(const Dyadic&)>;

/// Exact result for the first t and the distance: for a hit, the sign of each minus a number.
struct Exact {
    bool hit = false;
    Side t = {}, distance = {};
};

Exact exactly(const RaySample& sample, const Range<double>& range, Touching touching) {
    const ExactHit e(sample.ray, sample.sphere, range);
    const bool touches = e.hit() && (e.is_tangent_line() || e.ends_at_entry(range));
    return {e.hit() && (touching == Touching::hit || !touches), [e](const Dyadic& x) { return e.side(x); },
            [e](const Dyadic& x) { return e.distance_side(x); }};
}

Exact exactly(const BoxSample& sample, const Range<double>& range, Touching touching) {
    test::BoxCase x = test::exactly(sample.ray, sample.box, range.tmax);
    x.tmin = test::Rational(range.tmin), x.open_ends = range.open_ends;
    const test::Span span = ray_in_box(x, touching == Touching::hit);
    if (span.is_empty()) return {};
    const test::Rational t = span.start(), squared = t * t * test::dot(x.direction, x.direction);
    return {true, [t](const Dyadic& m) { return t.compare(m.fraction()); },
            [squared](const Dyadic& m) { return m.sign() < 0 ? 1 : squared.compare((m * m).fraction()); }};
}

/// True if a ray keeps the promise of its distribution, so that a generator that misses its aim fails too.
bool keeps(RayDistribution::Promise promise, const RaySample& sample) {
    const ExactHit exact(sample.ray, sample.sphere);
    switch (promise) {
        case RayDistribution::Promise::tangent_line: return exact.is_tangent_line();
        case RayDistribution::Promise::on_surface: return exact.on_surface();
        case RayDistribution::Promise::inside: return exact.is_inside();
        case RayDistribution::Promise::none: return true;
    }
    return false;
}

bool keeps(BoxDistribution::Promise promise, const BoxSample& sample) {
    const test::BoxCase x = test::exactly(sample.ray, sample.box, sample.tmax),
                        begin = test::exactly(sample.ray, sample.box, 0);
    const bool in_closed = !ray_in_box(begin, true).is_empty(), in_open = !ray_in_box(begin, false).is_empty();
    const auto met = [&x](bool closed) { return !line_in_box(x, closed).is_empty(); };
    switch (promise) {
        case BoxDistribution::Promise::none: return true;
        case BoxDistribution::Promise::touches: return met(true) && !met(false);
        case BoxDistribution::Promise::inside: return in_open;
        case BoxDistribution::Promise::on_boundary: return in_closed && !in_open;
        case BoxDistribution::Promise::flat: return !met(false);
        case BoxDistribution::Promise::at_end: {
            const test::Span closed = ray_in_box(x, true);
            return !closed.is_empty() && ray_in_box(x, false).is_empty() && closed.start() == *x.tmax;
        }
    }
    return false;
}

Range<double> range_of(const RaySample&) { return {}; }
Range<double> range_of(const BoxSample& sample) { return sample.range(); }
Primitive<double> primitive_of(const RaySample& sample) { return sample.sphere; }
Primitive<double> primitive_of(const BoxSample& sample) { return sample.box; }
int ray_count_of(const RayDistribution& distribution, const FloatFormat& storage) {
    return storage == binary32 ? distribution.ray_count_binary32 : distribution.ray_count_binary64;
}
int ray_count_of(const BoxDistribution& distribution, const FloatFormat&) { return distribution.ray_count; }
std::string paste(const RaySample& sample) { return test::paste(sample.ray, sample.sphere); }

/// Describes the fault of a proved length; empty if it has none.
std::string trouble_with(const CertifiedNumber& x, const Side& side) {
    if (side(lower_end(x)) < 0 || side(upper_end(x)) > 0) return "is not within its bound";
    if (x.bound > certified_tightness * std::fabs(x.hi)) return "is not tight";
    return is_in_binade(x, side) ? "" : "is not in the binade that its ulp is taken of";
}

/// Describes the fault of the truth; empty if it has none. `escalated` says whether the truth took more than
/// double-double numbers. It ignores the question on which side of a power of two a length lies, which is separate.
std::string disagreement(const Ray<double>& ray, const Primitive<double>& primitive, const Exact& want,
                         const Range<double>& range, Touching touching, bool& escalated) {
    const Truth truth = measure::truth::find_truth(ray, primitive, {}, touching, range);
    const auto beside_power = [](const CertifiedNumber& x) {
        return x.hi == 1 && std::fabs(x.lo) <= certified_tightness;
    };
    escalated = truth.proof_bits > 106 && !beside_power(truth.t) && !beside_power(truth.distance);
    if (truth.decision == Truth::Decision::unresolved) return "unresolved";
    if (truth.is_hit() != want.hit) return truth.is_hit() ? "a hit that is none" : "a hit is missed";
    if (truth.primitive != (want.hit ? 0 : -1)) return "the object is another";
    if (!want.hit) return "";
    const std::pair<Length, const Side*> lengths[] = {{Length::parameter, &want.t}, {Length::distance, &want.distance}};
    for (const auto& [length, side] : lengths) {
        const std::string name = length == Length::parameter ? "t " : "the distance ";
        const std::string trouble = trouble_with(length == Length::parameter ? truth.t : truth.distance, *side);
        if (!trouble.empty()) return name + trouble;
        for (const FloatFormat& format : {binary64, binary32, binary16, bfloat16, FloatFormat{52, -1022, 1023}})
            if (!is_rounded(measure::truth::round_truth(truth, ray, primitive, format, length, touching, range), *side,
                            format))
                return name + "is not correctly rounded to " + std::to_string(format.precision) + " bits";
    }
    return "";
}

/// With too few bits the result may be open, but must not be wrong: the inputs themselves are intervals at these
/// precisions.
std::string contradiction(const Ray<double>& ray, const Primitive<double>& primitive, const Exact& closed, bool touches,
                          const Range<double>& range) {
    for (const long bits : {6, 20, 53, 120}) {
        const Interval::Precision precision(bits);
        const auto within = measure::truth::range_over<Interval>(range);
        const auto e = measure::truth::enclose(lift_ray<Interval>(ray), lift_primitive<Interval>(primitive),
                                               within ? &*within : nullptr, measure::truth::convention_in(range, {}));
        const std::string at = " at " + std::to_string(bits) + " bits";
        if (e.hit.is_unknown()) continue;
        if (e.hit.is_yes() != closed.hit) return "guessed" + at;
        if (!closed.hit) continue;
        if (e.touching != touches) return "touching guessed" + at;
        if (closed.t(Dyadic(e.t.lower())) < 0 || closed.t(Dyadic(e.t.upper())) > 0) return "t escapes" + at;
    }
    return "";
}

/// Findings about the rays of a distribution.
struct TruthCounts {
    int rays = 0, hits = 0, escalated = 0;
    std::string report;

    template <class Sample>
    void ask(const Sample& sample, const Range<double>& range, bool few_bits) {
        const Ray<double>& ray = sample.ray;
        const Primitive<double> primitive = primitive_of(sample);
        ++rays;
        if (!range.holds_any()) {
            if (measure::truth::find_truth(ray, primitive, {}, {}, range).is_hit())
                add("a hit in a range of none", sample, range);
            return;
        }
        const Exact closed = exactly(sample, range, Touching::hit), open = exactly(sample, range, Touching::miss);
        const bool touches = closed.hit != open.hit;
        hits += closed.hit;
        bool more = false;
        std::string what = disagreement(ray, primitive, closed, range, Touching::hit, more);
        escalated += more;
        if (what.empty()) what = disagreement(ray, primitive, open, range, Touching::miss, more);
        for (const Touching touching : {Touching::hit, Touching::miss})
            if (what.empty() && measure::truth::find_truth(ray, primitive, {}, touching, range).touches != touches)
                what = "the conventions differ otherwise";
        if (what.empty() && few_bits) what = contradiction(ray, primitive, closed, touches, range);
        if (!what.empty()) add(what, sample, range);
    }
    template <class Sample>
    void add(const std::string& what, const Sample& sample, const Range<double>& range) {
        if (report.size() < 2000) report += what + "\n    " + test::paste(range) + " " + paste(sample) + "\n";
    }
};

template <class Distribution>
void check(const Distribution& distribution, const FloatFormat& storage, std::uint64_t seed) {
    Seeded rng(seed);
    TruthCounts found;
    for (int i = 0; i < test::draws(ray_count_of(distribution, storage)); ++i) {
        const auto s = distribution.draw(rng, storage);
        if (!keeps(distribution.promise, s)) found.add("the generator missed its aim", s, range_of(s));
        found.ask(s, range_of(s), i % 4 == 0);
    }
    INFO(distribution.name << ", seed " << seed << ", " << storage.precision << " bits:\n" << found.report);
    CHECK(found.report.empty());
    if constexpr (requires { distribution.max_escalated_count; }) {
        if (storage == binary32) CHECK(found.escalated <= distribution.max_escalated_count);
    } else {
        // A distribution that only hits or only misses tests half of what it seems to test.
        using Promise = BoxDistribution::Promise;
        const bool always = distribution.promise == Promise::inside || distribution.promise == Promise::on_boundary ||
                            distribution.promise == Promise::at_end;
        CHECK(found.hits > found.rays / 20);
        if (!always) CHECK(found.hits < found.rays);
    }
}

/// Every distribution, each ray in three ranges.
template <class Families>
void check_in_ranges(const Families& distributions, const FloatFormat& storage, std::uint64_t seed) {
    for (const auto& distribution : distributions) {
        Seeded rng(seed);
        TruthCounts found;
        for (int i = 0; i < test::draws(400); ++i) {
            const auto s = distribution.draw(rng, storage);
            for (int k = 0; k < 3; ++k)
                found.ask(s, range_about_primitive(rng, s.ray, primitive_of(s), storage), (i + k) % 4 == 0);
        }
        INFO(distribution.name << ":\n" << found.report);
        CHECK(found.report.empty());
    }
}

}  // namespace

TEST_CASE("truth in a range: it is the first root in the range, by exact integers", "[range]") {
    for (const FloatFormat& storage : {binary32, binary64}) {
        check_in_ranges(narrow_distributions, storage, 7);
        check_in_ranges(power_distributions, storage, 8);
        check_in_ranges(wide_distributions, storage, 9);
    }
}

TEST_CASE("truth in a range: for boxes it is the first of entry and exit, by fractions", "[box][range]") {
    for (const FloatFormat& storage : {binary32, binary64}) check_in_ranges(box_distributions, storage, 4);
}

TEST_CASE("truth agrees with exact integers on binary32 inputs", "[near][binary32]") {
    for (const RayDistribution& distribution : narrow_distributions) check(distribution, binary32, 1);
}

TEST_CASE("truth agrees with exact integers on binary64 inputs", "[near][binary64]") {
    for (const RayDistribution& distribution : narrow_distributions) check(distribution, binary64, 2);
}

TEST_CASE("the binade of t and of the distance is decided exactly at powers of two and on both sides", "[power]") {
    for (const RayDistribution& distribution : power_distributions)
        check(distribution, binary32, 5), check(distribution, binary64, 6);
}

TEST_CASE("truth agrees with exact integers where exponents are wide and where t is a tie", "[wide]") {
    for (const RayDistribution& distribution : wide_distributions)
        check(distribution, binary32, 3), check(distribution, binary64, 4);
}

TEST_CASE("truth of boxes agrees with fractions", "[box]") {
    for (const BoxDistribution& distribution : box_distributions)
        check(distribution, binary32, 1), check(distribution, binary64, 2);
}

TEST_CASE("truth decides rays without length and rays that end before they start", "[box]") {
    const Box<double> box{Vec<double>(-1), Vec<double>(1)};
    for (const Touching touching : {Touching::hit, Touching::miss}) {
        const auto shoot = [&](double x, double tmax) {
            return measure::truth::find_truth({{x, 0, 0}, {1, 0, 0}}, box, {}, touching, {.tmax = tmax}).is_hit();
        };
        const bool closed = touching == Touching::hit;
        CHECK(shoot(0, 0));             // the origin inside is enough
        CHECK(shoot(-1, 0) == closed);  // on the boundary it is for the closed box alone
        CHECK(shoot(-1, 0x1p-1074));    // the smallest length reaches inside
        CHECK(shoot(1, 5) == closed);   // leaving
        CHECK_FALSE(shoot(0, -0x1p-1074));
        CHECK_FALSE(shoot(0, -HUGE_VAL));
        CHECK(shoot(0, HUGE_VAL));
        CHECK(shoot(0, -0.0));
    }
}

}  // namespace test_truth
