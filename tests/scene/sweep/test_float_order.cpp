// The order of all floats: every bit pattern has one place, and the binades cut the places without a gap.
#include "scene/sweep/float_order.hpp"

#include <cmath>
#include <limits>
#include <set>

#include "catch.hpp"

namespace test_float_order {

using namespace lostbits::scene::sweep;

TEST_CASE("a place is that of one bit pattern, and places rise with values") {
    constexpr std::uint32_t stride = 65521;  // a prime, so that all mantissas and exponents get their turn
    float before = float_at(0);
    for (std::uint64_t p = 0; p < (std::uint64_t{1} << 32); p += stride) {
        const auto place = static_cast<std::uint32_t>(p);
        const float x = float_at(place);
        if (place_of(x) != place) FAIL("place " << place);
        if (!std::isnan(x) && !std::isnan(before) && !(before < x)) FAIL("not in order at " << place);
        before = x;
    }
    CHECK(place_of(0.0F) == place_of(-0.0F) + 1);
    CHECK(place_of(std::nextafter(1.0F, 2.0F)) == place_of(1.0F) + 1);
    CHECK(place_of(std::nextafter(-1.0F, -2.0F)) == place_of(-1.0F) - 1);
    CHECK(place_of(std::numeric_limits<float>::denorm_min()) == place_of(0.0F) + 1);
    const auto last = place_of(std::numeric_limits<float>::infinity());
    CHECK(float_at(last - 1) == std::numeric_limits<float>::max());
    CHECK(std::isnan(float_at(last + 1)));
    CHECK(std::isnan(float_at(0xffffffffU)));
    CHECK(std::isnan(float_at(0)));
}

TEST_CASE("516 binades hold all 2^32 floats, each once, and are named as they are") {
    std::set<std::string> names;
    std::uint64_t next = 0;
    while (next < (std::uint64_t{1} << 32)) {
        const float x = float_at(static_cast<std::uint32_t>(next));
        const Binade b = binade_of(x);
        REQUIRE(b.low == next);
        REQUIRE(b.high >= b.low);
        CHECK(b.negative == std::signbit(x));
        const float end = float_at(b.high);
        CHECK(binade_of(end).name() == b.name());
        if (b.kind == Binade::Kind::normal) {
            CHECK(std::ilogb(x) == b.exponent);
            CHECK(std::ilogb(end) == b.exponent);
        }
        CHECK(names.insert(b.name()).second);
        next = std::uint64_t{b.high} + 1;
    }
    CHECK(names.size() == 2 * (254 + 4));
    CHECK(binade_of(1.5F).name() == "+2^0");
    CHECK(binade_of(-0.0F).name() == "-0");
    CHECK(binade_of(1e-40F).name() == "+subnormal");
    CHECK(binade_of(-std::numeric_limits<float>::infinity()).name() == "-inf");
    CHECK(binade_of(std::nanf("")).name() == "+nan");
}

TEST_CASE("a range counts its floats in either direction") {
    const FloatRange up{place_of(-1.0F), place_of(1.0F)}, down{up.last, up.first};
    CHECK(up.size() == 2 * (std::uint64_t{127} << 23) + 2);
    CHECK(down.size() == up.size());
    CHECK(down.falls());
    CHECK(float_at(up.at(1)) == std::nextafter(-1.0F, 0.0F));
    CHECK(float_at(down.at(1)) == std::nextafter(1.0F, 0.0F));
    CHECK(down.steps_to(up.first) == down.size() - 1);
    CHECK(FloatRange{0, 0xffffffffU}.size() == std::uint64_t{1} << 32);
}

}  // namespace test_float_order
