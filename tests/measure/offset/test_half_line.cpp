// Sides and intersections of half-lines: the filter compared with enclosures, and both with rationals.
#include <array>

#include "catch.hpp"
#include "measure/offset/exact_sides.hpp"
#include "measure/offset/smallest.hpp"
#include "measure/seeded.hpp"

namespace test_half_line {

using namespace lostbits;
using measure::offset::find_meeting;
using measure::offset::HalfLine;
using measure::offset::Meeting;
using test::Seeded;

namespace {

/// Primitives and half-lines that start within some units in the last place of a surface, exactly on it, or anywhere;
/// into, out of and along it.
struct HostileLine {
    HalfLine line;
    Primitive<double> primitive;
};

HostileLine hostile(Seeded& random, bool box, const FloatFormat& format) {
    const auto stored = [&](const Vec<double>& v) { return test::stored(v, format); };
    const double size = random.magnitude(-12, 12), far = random.coin() ? random.magnitude(-4, 16) : 0;
    const Vec<double> centre = stored(far * random.vec(-1, 1));
    HostileLine h{{{{0, 0, 0}, {0, 0, 0}}, 0}, Sphere<double>{centre, test::stored(size, format)}};
    Vec<double> n = random.vec(-1, 1);
    if (box) {
        const Vec<double> half = stored(Vec<double>(random.magnitude(-3, 3), random.magnitude(-10, 3), size));
        h.primitive = Primitive<double>(Box<double>{stored(centre - half), stored(centre + half)});
    }
    const double long_n = length(n);
    n = Vec<double>(n.x / long_n, n.y / long_n, n.z / long_n);
    Vec<double> p = stored(centre + size * n);
    if (box) {
        const Box<double> b = h.primitive.box();
        for (int i = 0; i < 3; ++i) p[i] = test::stored(random.uniform(b.lo[i], b.hi[i]), format);
        const int axis = random.index(3);
        p[axis] = random.coin() ? b.lo[axis] : b.hi[axis];
    }
    for (int i = 0; i < 3; ++i) p[i] = test::nudge(p[i], random.coin() ? random.integer(-3, 3) : 0, format);
    Vec<double> w = random.vec(-1, 1);
    switch (random.index(4)) {
        case 0: w = w - dot(w, n) * n; break;                                // along the surface
        case 1: w = w - (dot(w, n) - random.magnitude(-20, -2)) * n; break;  // just out of it
        case 2: w[random.index(3)] = 0; break;
        default: break;
    }
    h.line.ray = {p, stored(w)};
    h.line.tmin = random.index(4) == 0 ? test::stored(random.magnitude(-20, 2), format) : 0;
    return h;
}

}  // namespace

TEST_CASE("half-lines: enclosures and rational arithmetic agree", "[measure][offset]") {
    Seeded random(20261);
    std::array<int, 4> kinds{};
    for (const FloatFormat& format : {binary32, binary64}) {
        for (int k = 0; k < 40000; ++k) {
            const HostileLine h = hostile(random, k % 2 == 1, format);
            if (!h.line.is_proper()) continue;
            const Meeting met = find_meeting(h.line, h.primitive);
            const auto exact = test::exact_meeting(h.line, h.primitive);
            INFO(k);
            REQUIRE(met.inside == exact.inside);
            REQUIRE(met.outside == exact.outside);
            REQUIRE(met.meets == exact.meets);
            ++kinds[met.inside ? 0 : !met.outside ? 1 : met.meets ? 2 : 3];
        }
    }
    for (const int n : kinds) CHECK(n > 500);  // inside, on the surface, entering, missing
}

TEST_CASE("the segment between two points passes through a primitive or does not", "[measure][offset]") {
    using measure::offset::passes_through;
    const Primitive<double> unit(Sphere<double>{{0, 0, 0}, 1}), pane(Box<double>{{-1, -1, 0}, {1, 1, 0x1p-40}});
    CHECK(passes_through({-2, 0, 0}, {2, 0, 0}, unit));
    CHECK_FALSE(passes_through({-2, 0, 0}, {-1, 0, 0}, unit));  // ends on the surface
    CHECK(passes_through({-2, 0, 0}, {-0x1.fffffffffffffp-1, 0, 0}, unit));
    CHECK_FALSE(passes_through({-2, 1, 0}, {2, 1, 0}, unit));  // touches
    CHECK(passes_through({-2, 0x1.fffffffffffffp-1, 0}, {2, 0x1.fffffffffffffp-1, 0}, unit));
    CHECK_FALSE(passes_through({2, 0, 0}, {3, 0, 0}, unit));
    CHECK(passes_through({0.5, 0, 0}, {0.5, 0, 0}, unit));
    CHECK_FALSE(passes_through({1, 0, 0}, {1, 0, 0}, unit));
    CHECK(passes_through({0.1, 0.2, -1e-12}, {0.1, 0.2, 1e-9}, pane));
    CHECK_FALSE(passes_through({0.1, 0.2, 0x1p-40}, {0.1, 0.2, 1}, pane));  // leaves its face
    CHECK_FALSE(passes_through({2, 0, -1}, {2, 0, 1}, pane));
}

TEST_CASE("a number with a given index has that index in every format", "[measure][offset]") {
    for (const FloatFormat& format : {binary32, binary64, binary16, bfloat16, FloatFormat{5, -1022, 1023}}) {
        Seeded random(7);
        for (int k = 0; k < 2000; ++k) {
            const std::int64_t infinity = measure::truth::ordinal(HUGE_VAL, format);
            const std::int64_t n = (static_cast<std::int64_t>(random.bits(62)) >> random.index(61)) % infinity;
            CAPTURE(n, format.precision);
            REQUIRE(measure::truth::ordinal(measure::truth::number_at(n, format), format) == n);
            REQUIRE(measure::truth::ordinal(measure::truth::number_at(-n, format), format) == -n);
        }
        CHECK(measure::truth::number_at(0, format) == 0);
        CHECK(measure::truth::number_at(1, format) == std::ldexp(1.0, format.emin - format.precision + 1));
    }
}

TEST_CASE("bisection finds the least float that is enough, or reports that none is", "[measure][offset]") {
    using measure::offset::find_smallest_enough;
    using measure::offset::OffsetVerdict;
    Seeded random(11);
    for (const FloatFormat& format : {binary32, binary64, bfloat16}) {
        for (int k = 0; k < 500; ++k) {
            const double least = random.magnitude(-60, 3), most = least * random.uniform(1, 3);
            const double start = random.magnitude(-70, -10);
            const auto verdict_of = [&](double e) {
                return e < least  ? OffsetVerdict::too_little
                       : e > most ? OffsetVerdict::too_much
                                  : OffsetVerdict::enough;
            };
            const double found = find_smallest_enough(format, start, 64, verdict_of);
            CAPTURE(least, most, start, found, format.precision);
            const std::int64_t place = measure::truth::ordinal(
                measure::truth::number_at(measure::truth::ordinal(rounding::to_format(least, 0, format), format),
                                          format),
                format);
            double expected = measure::truth::number_at(place, format);
            if (expected < least) expected = measure::truth::number_at(place + 1, format);
            if (expected > most) CHECK(std::isinf(found));
            else CHECK(found == expected);
        }
        const auto never = [](double) { return OffsetVerdict::too_little; };
        CHECK(std::isinf(find_smallest_enough(format, 0x1p-20, 64, never)));
        const auto always = [](double) { return OffsetVerdict::enough; };
        CHECK(find_smallest_enough(format, 0x1p-20, 64, always) == 0);
    }
}

TEST_CASE("half-lines meet a transformed primitive as they meet the moved primitive", "[measure][offset]") {
    // A quarter turn about z, a doubling and a shift: no number is rounded.
    const Vec<double> shift(16, -32, 8);
    const auto turned = [](const Vec<double>& v) { return Vec<double>(-2 * v.y, 2 * v.x, 2 * v.z); };
    Seeded random(42);
    int met = 0, inside = 0;
    for (const bool inverse : {false, true}) {
        for (int i = 0; i < 2000; ++i) {
            const auto small = [&] { return static_cast<double>(random.integer(-16, 16)) / 4; };
            const Vec<double> centre(small(), small(), small()), p(small(), small(), small());
            Vec<double> w(small(), small(), small());
            if (w == Vec<double>(0, 0, 0)) w.x = 1;
            const double r = std::max(0.25, std::fabs(small()));
            Primitive<double> transformed(Sphere<double>{centre, r}),
                moved(Sphere<double>{turned(centre) + shift, 2 * r});
            transformed.transform = Transform<double>{{0, -2, 0, 16, 2, 0, 0, -32, 0, 0, 2, 8}, false, 1};
            if (inverse)
                transformed.transform = Transform<double>{{0, 0.5, 0, 16, -0.5, 0, 0, 8, 0, 0, 0.5, -4}, true, 1};
            const HalfLine line{{turned(p) + shift, turned(w)}, random.coin() ? 0.5 : 0};
            const Meeting one = find_meeting(line, transformed), other = find_meeting(line, moved);
            REQUIRE(one == other);
            met += one.meets, inside += one.inside;
            const Vec<double> end = turned(p + w) + shift;
            REQUIRE(measure::offset::passes_through(line.ray.origin, end, transformed) ==
                    measure::offset::passes_through(line.ray.origin, end, moved));
        }
    }
    CHECK(met > 400);
    CHECK(inside > 200);
}

}  // namespace test_half_line
