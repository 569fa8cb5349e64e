// Truth of rays and boxes against exact fractions: every ray of every family, closed box and open.
#include <cstdio>
#include <ctime>

#include "catch.hpp"
#include "counts.hpp"
#include "intersect/box/box_exact.hpp"
#include "measure/truth/box_families.hpp"
#include "measure/truth/enclose.hpp"
#include "measure/truth/ranges.hpp"
#include "measure/truth/truth.hpp"
#include "number/dual.hpp"

namespace test_box_truth {

using namespace lostbits;
using namespace lostbits::testing;
using lostbits::test::BoxCase;
using lostbits::test::Rational;
using lostbits::test::Span;

namespace {

struct Tally {
    int rays = 0, closed = 0, open = 0, escalated = 0, bits = 0, straddled = 0, decided_low = 0, asked_low = 0;
};

BoxCase exactly_in_range(const BoxSample& s) {
    BoxCase x = test::exactly(s.ray, s.box, s.tmax);
    x.tmin = Rational(s.tmin);
    x.open = s.open;
    return x;
}

/// A problem, and its exact answers.
struct Question {
    const BoxSample& sample;
    BoxCase exact;
    Span closed, open;
    explicit Question(const BoxSample& s)
        : sample(s), exact(exactly_in_range(s)), closed(ray_in_box(exact, true)), open(ray_in_box(exact, false)) {}
};

bool keeps(BoxFamily::Promise promise, const Question& q) {
    BoxCase at_origin = q.exact;
    at_origin.tmax = 0;
    const bool in_closed = !ray_in_box(at_origin, true).is_empty(), in_open = !ray_in_box(at_origin, false).is_empty();
    switch (promise) {
        case BoxFamily::Promise::none: return true;
        case BoxFamily::Promise::touches:
            return !line_in_box(q.exact, true).is_empty() && line_in_box(q.exact, false).is_empty();
        case BoxFamily::Promise::inside: return in_open;
        case BoxFamily::Promise::on_boundary: return in_closed && !in_open;
        case BoxFamily::Promise::flat: return line_in_box(q.exact, false).is_empty();
        case BoxFamily::Promise::at_end:
            return !q.closed.is_empty() && q.open.is_empty() && q.closed.start() == *q.exact.tmax;
    }
    return false;
}

Rational two_to(std::int64_t e) {
    using boost::multiprecision::mpz_int;
    const mpz_int power = mpz_int(1) << static_cast<unsigned long>(e < 0 ? -e : e);
    return e < 0 ? Rational(1, power) : Rational(power);
}

/// Whether x lies within the bound of c.
bool encloses(const measure::truth::Certified& c, const Rational& x) {
    const Rational unit = two_to(c.exponent), off = x - (Rational(c.hi) + Rational(c.lo)) * unit;
    return abs(off) <= Rational(c.bound) * unit;
}

/// The same for x = t·|d|, by squares: (middle − bound)² ≤ x² ≤ (middle + bound)².
bool encloses_root(const measure::truth::Certified& c, const Rational& squared) {
    const Rational unit = two_to(c.exponent), middle = (Rational(c.hi) + Rational(c.lo)) * unit,
                   bound = Rational(c.bound) * unit;
    const Rational low = middle - bound, high = middle + bound;
    return (low.sign() <= 0 || low * low <= squared) && high.sign() >= 0 && squared <= high * high;
}

/// Whether x (or, by `squares`, its square) is in the binade that the certified value is in: 2^k ≤ x < 2^(k + 1).
bool is_in_binade(const measure::truth::Certified& c, const Rational& x, bool squares = false) {
    if (c.is_zero()) return x == 0;
    const std::int64_t k = c.floor_log2(), times = squares ? 2 : 1;
    return two_to(times * k) <= x && x < two_to(times * (k + 1));
}

/// x rounded to nearest even by MPFR, subnormals and overflow included.
double rounded(const Rational& x, const FloatFormat& f) {
    const mpfr_exp_t emin = mpfr_get_emin(), emax = mpfr_get_emax();
    mpfr_set_emin(f.emin - f.precision + 2);
    mpfr_set_emax(f.emax + 1);
    mpfr_t r;
    mpfr_init2(r, f.precision);
    mpfr_subnormalize(r, mpfr_set_q(r, x.backend().data(), MPFR_RNDN), MPFR_RNDN);
    const double result = mpfr_get_d(r, MPFR_RNDN);
    mpfr_clear(r);
    mpfr_set_emin(emin);
    mpfr_set_emax(emax);
    return result;
}

bool contains(const Interval& x, const Rational& q) {
    return x.is_bounded() && mpfr_cmp_q(x.lower(), q.backend().data()) <= 0 &&
           mpfr_cmp_q(x.upper(), q.backend().data()) >= 0;
}

/// What is wrong with the proved answer, or nothing.
std::string disagreement(const Question& q, intersect::Touching convention, Tally& tally) {
    const BoxSample& s = q.sample;
    const Span& want = convention == intersect::Touching::hit ? q.closed : q.open;
    const measure::truth::Truth truth = measure::truth::find_truth(s.ray, s.box, {}, convention, s.range());
    tally.escalated += truth.bits > 106;
    tally.bits = std::max(tally.bits, truth.bits);
    if (truth.decision == measure::truth::Truth::Decision::unresolved) return "unresolved";
    if (truth.is_hit() == want.is_empty())
        return truth.is_hit() ? "a hit that fractions miss" : "a miss that fractions hit";
    if (truth.touches != (q.closed.is_empty() != q.open.is_empty())) return "the conventions differ otherwise";
    if (!truth.is_hit()) return truth.object == -1 ? "" : "a miss names an object";

    const Rational& t = want.start();
    if (truth.object != 0) return "a hit without object";
    if (!encloses(truth.t, t)) return "t is not within its bound";
    if (truth.t.is_zero() != (t == 0)) return "t is zero, or is not, wrongly";
    const Rational squared = t * t * test::dot(q.exact.direction, q.exact.direction);
    if (!encloses_root(truth.distance, squared)) return "the distance is not within its bound";
    if (!is_in_binade(truth.t, t)) return "t is not in the binade that its ulp is taken of";
    if (!is_in_binade(truth.distance, squared, true)) return "the distance is not in its binade";
    if (truth.t.bound > measure::truth::certified_tightness * std::fabs(truth.t.hi)) return "t is not tight";
    for (const FloatFormat& f : {binary64, binary32, binary16}) {
        if (measure::truth::round_truth(truth, s.ray, s.box, f, {}, convention, s.range()) != rounded(t, f))
            return "t is not correctly rounded to " + std::to_string(f.precision) + " bits";
        tally.straddled += !measure::truth::round_certified(truth.t, f);
    }
    return "";
}

/// Too few bits may leave open, and must not get wrong: the inputs themselves are intervals at these precisions.
std::string contradiction(const Question& q, intersect::Touching convention, Tally& tally) {
    const BoxSample& s = q.sample;
    const Span& want = convention == intersect::Touching::hit ? q.closed : q.open;
    for (const long bits : {6, 20, 53, 120}) {
        const Interval::Precision precision(bits);
        const Box<Interval> box{lift_vec<Interval>(s.box.lo), lift_vec<Interval>(s.box.hi)};
        const auto range = measure::truth::range_over<Interval>(s.range());
        const auto e =
            measure::truth::enclose(box.span(lift_ray<Interval>(s.ray)), range ? &*range : nullptr, convention);
        ++tally.asked_low;
        tally.decided_low += !e.hit.is_unknown();
        const std::string at = " at " + std::to_string(bits) + " bits";
        if (!e.hit.is_unknown() && e.hit.is_yes() == want.is_empty()) return "guessed" + at;
        if (e.hit.is_yes() && !contains(e.t, want.start())) return "t escapes" + at;
        if (e.hit.is_yes() && e.touching != (q.closed.is_empty() != q.open.is_empty())) return "touching guessed" + at;
    }
    return "";
}

void check(const BoxFamily& family, const FloatFormat& storage, std::uint64_t seed) {
    Seeded rng(seed);
    Tally tally;
    const std::clock_t start = std::clock();
    std::string report;
    int failures = 0;
    for (int i = 0; i < test::draws(family.rays); ++i) {
        const BoxSample s = family.make(rng, storage);
        const Question q(s);
        std::string what = keeps(family.promise, q) ? "" : "the generator missed its aim";
        for (const intersect::Touching convention : {intersect::Touching::hit, intersect::Touching::miss}) {
            if (what.empty()) what = disagreement(q, convention, tally);
            if (what.empty() && i % 4 == 0) what = contradiction(q, convention, tally);
        }
        ++tally.rays;
        tally.closed += !q.closed.is_empty();
        tally.open += !q.open.is_empty();
        if (what.empty() || ++failures > 3) continue;
        report += std::string(family.name) + ", seed " + std::to_string(seed) + ", index " + std::to_string(i) + ": " +
                  what + "\n    " + paste(s) + "\n";
    }
    std::printf(
        "%-16s f%d %6d rays %6d closed %6d open %6d escalated %5d bits %6d straddled %3.0f %% decided low %5.1f s\n",
        family.name, storage == binary32 ? 32 : 64, tally.rays, tally.closed, tally.open, tally.escalated, tally.bits,
        tally.straddled, 100.0 * tally.decided_low / tally.asked_low,
        static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC);
    std::fflush(stdout);
    INFO(failures << " of " << tally.rays << " rays disagree; the first:\n" << report);
    CHECK(failures == 0);
    // A family that only ever hits or only ever misses tests half of what it seems to.
    const bool always = family.promise == BoxFamily::Promise::inside ||
                        family.promise == BoxFamily::Promise::on_boundary ||
                        family.promise == BoxFamily::Promise::at_end;
    CHECK(tally.closed > tally.rays / 20);
    if (!always) CHECK(tally.closed < tally.rays);
}

}  // namespace

TEST_CASE("truth of boxes agrees with fractions on binary32 inputs", "[box][binary32]") {
    for (const BoxFamily& f : box_families) check(f, binary32, 1);
}

TEST_CASE("truth of boxes agrees with fractions on binary64 inputs", "[box][binary64]") {
    for (const BoxFamily& f : box_families) check(f, binary64, 2);
}

TEST_CASE("truth of boxes in a range: the first t of both, by fractions", "[box][range]") {
    for (const FloatFormat& storage : {binary32, binary64}) {
        for (const BoxFamily& family : box_families) {
            Seeded rng(4);
            Tally tally;
            std::string report;
            for (int i = 0; i < test::draws(300); ++i) {
                BoxSample s = family.make(rng, storage);
                BoxCase line = test::exactly(s.ray, s.box, HUGE_VAL);
                line.tmin = -two_to(3000);
                line.tmax = two_to(3000);
                const Span span = ray_in_box(line, true);
                const auto about = [](const Rational& t) {
                    return std::min(std::fabs(rounded(t, binary64)), 0x1p1000);
                };
                const std::array roots{span.is_empty() ? 1.0 : about(span.start()),
                                       span.is_empty() ? 2.0 : about(span.end())};
                const Range<double> range = range_about(rng, roots, storage);
                s.tmin = range.tmin, s.tmax = range.tmax, s.open = range.open;
                if (!range.holds_any()) {
                    CHECK_FALSE(measure::truth::find_truth(s.ray, s.box, {}, {}, range).is_hit());
                    continue;
                }
                const Question q(s);
                for (const intersect::Touching convention : {intersect::Touching::hit, intersect::Touching::miss}) {
                    std::string what = disagreement(q, convention, tally);
                    if (what.empty() && i % 4 == 0) what = contradiction(q, convention, tally);
                    if (what.empty() || report.size() > 2000) continue;
                    report += what + "\n    " + paste(range) + " " + paste(s) + "\n";
                }
            }
            INFO(family.name << ":\n" << report);
            CHECK(report.empty());
        }
    }
}

TEST_CASE("a ray without length, and one that ends before it starts", "[box]") {
    const Box<double> box{Vec<double>(-1), Vec<double>(1)};
    const auto shoot = [&](double x, double tmax, intersect::Touching convention) {
        return measure::truth::find_truth({{x, 0, 0}, {1, 0, 0}}, box, {}, convention, {.tmax = tmax}).is_hit();
    };
    for (const intersect::Touching convention : {intersect::Touching::hit, intersect::Touching::miss}) {
        const bool closed = convention == intersect::Touching::hit;
        CHECK(shoot(0, 0, convention));             // the origin inside is enough
        CHECK(shoot(-1, 0, convention) == closed);  // on the boundary it is for the closed box alone
        CHECK(shoot(-1, 0x1p-1074, convention));    // the least bit of length is inside
        CHECK(shoot(1, 5, convention) == closed);   // leaving
        CHECK_FALSE(shoot(0, -0x1p-1074, convention));
        CHECK_FALSE(shoot(0, -HUGE_VAL, convention));
        CHECK(shoot(0, HUGE_VAL, convention));
        CHECK(shoot(0, -0.0, convention));
    }
}

namespace {

/// ∂t/∂(inputs in the order origin, direction, lo, hi) of t = (plane − o)/d: −1/d, −t/d and 1/d on the entered axis,
/// else 0.
template <class E>
void check_gradient(const BoxSample& s) {
    using D = Dual<E, 12>;
    const auto vec = [](const Vec<double>& v, std::size_t first) {
        return Vec<D>(D::input(E(v.x), first), D::input(E(v.y), first + 1), D::input(E(v.z), first + 2));
    };
    const auto e = measure::truth::enclose<D>(Ray<D>{vec(s.ray.origin, 0), vec(s.ray.direction, 3)},
                                              Box<D>{vec(s.box.lo, 6), vec(s.box.hi, 9)});
    const Span want = ray_in_box(test::exactly(s.ray, s.box, HUGE_VAL), true);
    REQUIRE(e.hit.is_yes() == !want.is_empty());
    if (!e.hit.is_yes()) return;
    std::array<Rational, 12> gradient{};
    for (int axis = 0; axis < 3 && want.start() > 0; ++axis) {
        const auto i = static_cast<std::size_t>(axis);
        const Rational d(s.ray.direction[axis]);
        const double plane = s.ray.direction[axis] > 0 ? s.box.lo[axis] : s.box.hi[axis];
        if (d == 0 || Rational(plane) - Rational(s.ray.origin[axis]) != want.start() * d) continue;
        gradient[i] = -1 / d;
        gradient[3 + i] = -want.start() / d;
        gradient[(d > 0 ? 6 : 9) + i] = 1 / d;
    }
    const auto midpoint = [](const E& x) {
        if constexpr (std::same_as<E, Ball>) return x.hi();
        else return mpfr_get_d(x.lower(), MPFR_RNDN);
    };
    INFO(paste(s));
    for (std::size_t i = 0; i < 12; ++i) {
        CHECK(e.t.derivative(i).is_bounded());
        const double got = midpoint(e.t.derivative(i)), expected = rounded(gradient[i], binary64);
        CHECK(std::fabs(got - expected) <= 0x1p-50 * std::fabs(expected));
    }
}

}  // namespace

TEST_CASE("the enclosed t of a box differentiates", "[box][conditioning]") {
    Seeded rng(3);
    int hits = 0;
    for (int i = 0; i < 1500; ++i) {
        BoxSample s = box_families[0].make(rng, binary32);
        s.tmax = HUGE_VAL;
        hits += measure::truth::find_truth(s.ray, s.box, {}, intersect::Touching::hit).is_hit();
        check_gradient<Ball>(s);
        const Interval::Precision precision(300);
        check_gradient<Interval>(s);
    }
    CHECK(hits > 100);
}

}  // namespace test_box_truth
