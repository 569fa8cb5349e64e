// Sweeps over every float: the order of floats, valid files, and errors of other files.
#include <cmath>
#include <limits>
#include <set>

#include "catch.hpp"
#include "scene/scene_text.hpp"
#include "scene/sweep/exhaustive_file.hpp"
#include "scene/sweep/float_order.hpp"

namespace test_exhaustive_file {

using namespace lostbits;
using namespace lostbits::scene;
using namespace lostbits::scene::sweep;
using namespace lostbits::scene::test;

namespace {

/// Keep the line numbers.
const std::string good_sweep = sweep_head + R"([axis]
name = "distance"
unit = "r"
spacing = "every_float"
set = "ray.origin.z"
from = 1
to = "0x1.8p+1"
[[ray]]
name = "a"
origin = [0.5, -0.25, 0]
direction = [0, -0.0, -1]
[sphere]
centre = [0, 0, 0]
radius = 1
)";

const std::string good_box = replace_text(replace_text(good_sweep, "[sphere]\ncentre = [0, 0, 0]\nradius = 1\n",
                                                       "[box]\nlo = [-1, -1, -1]\nhi = [1, 1, 1]\n"),
                                          "direction = [0, -0.0, -1]\n", "direction = [0, -0.0, -1]\ntmax = 9\n");

ExhaustiveFile swept(const std::string& text) { return read_as<ExhaustiveFile>("s.toml", text, LOSTBITS_DATA_DIR); }

std::string error(const std::string& what, const std::string& by, const std::string& in = good_sweep) {
    return error_as<ExhaustiveFile>("s.toml", replace_text(in, what, by), LOSTBITS_DATA_DIR);
}

}  // namespace

TEST_CASE("a sweep over every float between two sets its ray and primitive to each float") {
    const ExhaustiveFile sweep = swept(good_sweep);
    CHECK(sweep.ranges().size() == 1);
    CHECK(sweep.float_count() == (1 << 23) + (1 << 22) + 1);
    CHECK(sweep.accepts(Shape::sphere));
    CHECK_FALSE(sweep.accepts(Shape::box));
    const Ray<float> ray = sweep.ray_at(0, 2.5F);
    CHECK((ray.origin.x == 0.5F && ray.origin.y == -0.25F && ray.origin.z == 2.5F));
    CHECK(std::signbit(ray.direction.y));
    const auto group = sweep.group_at(0, 0x1.000002p0F);
    CHECK(group.rays[0].origin.z == 0x1.000002p0);
    CHECK(group.rays.tmax.empty());
    CHECK(group.primitives.front().numbers[3] == 1);
    const ExhaustiveFile box = swept(good_box);
    CHECK(box.group_at(0, 1).rays.tmax == std::vector<double>{9});
    CHECK(swept(replace_text(good_sweep, "[axis]", "[[axis]]")).ranges() == sweep.ranges());
}

TEST_CASE("all = true visits every bit pattern, from each zero outwards") {
    const ExhaustiveFile sweep = swept(replace_text(good_sweep, "from = 1\nto = \"0x1.8p+1\"", "all = true"));
    CHECK(sweep.float_count() == std::uint64_t{1} << 32);
    REQUIRE(sweep.ranges().size() == 2);
    CHECK(float_at(sweep.ranges()[0].first) == 0);
    CHECK(std::signbit(float_at(sweep.ranges()[1].first)));
    CHECK(sweep.ranges()[1].falls());
}

TEST_CASE("a sweep moves several numbers together, a range may fall, and -0 differs from 0") {
    const ExhaustiveFile both = swept(
        replace_text(good_sweep, "\"ray.origin.z\"", "[\"ray.origin.z\", \"ray.direction.x\", \"sphere.radius\"]"));
    CHECK(both.ray_indices == std::vector<std::size_t>{2, 3});
    CHECK(both.primitive_indices == std::vector<std::size_t>{3});
    CHECK(both.primitive_at(3).numbers[3] == 3);
    CHECK(both.ray_at(0, 3).direction.x == 3);
    const ExhaustiveFile falls =
        swept(replace_text(replace_text(good_sweep, "from = 1", "from = 1.5"), "\"0x1.8p+1\"", "-0.0"));
    REQUIRE(falls.ranges().front().falls());
    CHECK(falls.ranges().front().last == index_of(-0.0F));
}

TEST_CASE("a narrowed sweep visits the floats between two others") {
    ExhaustiveFile sweep = swept(good_sweep);
    const toml::SourcePosition where{"c.toml", 3, 4};
    sweep.narrow(real("0x1.8p0"), real("0x1.80001p0"), where);
    CHECK(sweep.float_count() == 9);
    CHECK(has(error_of([&] { sweep.narrow(real("1"), real("2"), where); }), "c.toml:3:4: \"0x1p+0\" lies outside"));
    CHECK(has(error_of([&] { sweep.narrow(real("0.1"), real("2"), where); }), "not representable in binary32"));
}

TEST_CASE("errors in a sweep over every float are reported with their line and advice") {
    // An axis that does not fit the format, and a range without floats.
    CHECK(has(
        error("from = 1", "from = 1.1"),
        "s.toml:9:8: axis.from is not representable in binary32, and rounding it would test another value; the nearest "
        "below and above are \"0x1.199998p+0\" and \"0x1.19999ap+0\""));
    CHECK(has(error("0x1.8p+1", "0x1.80000001p+1"), "s.toml:10:6: axis.to is not representable in binary32"));
    CHECK(has(error("from = 1\nto = \"0x1.8p+1\"", "from = 1.00000001\nto = 1.00000002"),
              "axis.from and to have no number of binary32 between them"));
    CHECK(has(error("\"0x1.8p+1\"", "1"), "s.toml:10:6: axis.to equals from"));
    CHECK(has(error("\"0x1.8p+1\"", "1e39"),
              "s.toml:10:6: axis.to is not representable in binary32, and rounding it would test another value; the "
              "largest is \"0x1.fffffep+127\""));
    CHECK(has(error("from = 1", "from = -1e39"), "the lowest is \"-0x1.fffffep+127\""));
    CHECK(has(error("0.5, -0.25", "0.5, 0.1"),
              "s.toml:13:10: ray[0].origin holds a number that is not representable in binary32, at index 1"));
    CHECK(has(error("radius = 1", "radius = 0.1"), "s.toml:17:10: sphere.radius is not representable in binary32"));
    CHECK(has(error("ray.origin.z", "ray.orgin.z"), "did you mean \"ray.origin.z\""));
    CHECK(has(error("ray.origin.z", "box.lo.x"), "not a number of the ray or of its sphere"));
    CHECK(has(error("\"ray.origin.z\"", "[\"ray.origin.z\", \"ray.origin.z\"]"), "twice"));
    CHECK(has(error("\"ray.origin.z\"", "[]"), "s.toml:8:"));
    CHECK(has(error("every_float", "linear"), "s.toml:7:11: axis.spacing must be \"every_float\""));
    CHECK(has(error("to = \"0x1.8p+1\"", "to = 2\nall = true"), "cannot be combined with all = true"));
    CHECK(has(error("name = \"distance\"", "name = \"Distance\""), "lower-case"));
    CHECK(has(error("tmax = 9", "tmax = -1", good_box), "ray[0].tmax is below 0"));
    CHECK(has(error("direction =", "tmax = 3\ndirection ="), "tmax ends a ray only for the forms of boxes"));
    CHECK(has(error("[[ray]]\nname = \"a\"",
                    "[[ray]]\nname = \"a\"\norigin = [0, 0, 0]\ndirection = [0, 0, 1]\n"
                    "[[ray]]\nname = \"a\""),
              "also the name of another ray"));
    CHECK(has(error("[sphere]", "[box]\nlo = [0, 0, 0]\nhi = [1, 1, 1]\n[sphere]"), "one primitive"));
    CHECK(has(error("[[ray]]", "[[axis]]\n[[ray]]", replace_text(good_sweep, "[axis]", "[[axis]]")),
              "s.toml:4:1: axis must be one [[axis]] table"));
    // Invalid primitives: those of the file, and those that the axis makes invalid.
    CHECK(has(error("radius = 1", "radius = 0"), "s.toml:17:10: sphere.radius is not greater than 0"));
    CHECK(has(error("hi = [1, 1, 1]", "hi = [1, -2, 1]", good_box),
              ": box.hi is below lo in y; a box needs lo <= hi in x, y and z"));
    CHECK(
        has(error("ray.origin.z\"\nfrom = 1", "sphere.radius\"\nfrom = -1"), "s.toml:9:8: axis.from leaves a sphere"));
    CHECK(has(error("ray.origin.z\"\nfrom = 1\nto = \"0x1.8p+1\"", "sphere.radius\"\nall = true"),
              "not valid for a primitive"));
    CHECK(has(error("ray.origin.z", "box.lo.x", good_box), "s.toml:10:6: axis.to leaves a box whose hi is below lo"));
}

TEST_CASE("each bit pattern has one index, and indices rise with values") {
    constexpr std::uint32_t stride = 65521;  // a prime, so that all mantissas and exponents occur
    float before = float_at(0);
    for (std::uint64_t p = 0; p < (std::uint64_t{1} << 32); p += stride) {
        const auto place = static_cast<std::uint32_t>(p);
        const float x = float_at(place);
        if (index_of(x) != place) FAIL("place " << place);
        if (!std::isnan(x) && !std::isnan(before) && !(before < x)) FAIL("not in order at " << place);
        before = x;
    }
    CHECK(index_of(0.0F) == index_of(-0.0F) + 1);
    CHECK(index_of(std::nextafter(1.0F, 2.0F)) == index_of(1.0F) + 1);
    CHECK(index_of(std::nextafter(-1.0F, -2.0F)) == index_of(-1.0F) - 1);
    CHECK(index_of(std::numeric_limits<float>::denorm_min()) == index_of(0.0F) + 1);
    const auto last = index_of(std::numeric_limits<float>::infinity());
    CHECK(float_at(last - 1) == std::numeric_limits<float>::max());
    CHECK(std::isnan(float_at(last + 1)));
    CHECK(std::isnan(float_at(0xffffffffU)));
    CHECK(std::isnan(float_at(0)));
}

TEST_CASE("516 named binades hold all 2^32 floats once each") {
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
    const FloatRange up{index_of(-1.0F), index_of(1.0F)}, down{up.last, up.first};
    CHECK(up.size() == 2 * (std::uint64_t{127} << 23) + 2);
    CHECK(down.size() == up.size());
    CHECK(down.falls());
    CHECK(float_at(up.at(1)) == std::nextafter(-1.0F, 0.0F));
    CHECK(float_at(down.at(1)) == std::nextafter(1.0F, 0.0F));
    CHECK(down.steps_to(up.first) == down.size() - 1);
    CHECK(FloatRange{0, 0xffffffffU}.size() == std::uint64_t{1} << 32);
}

}  // namespace test_exhaustive_file
