// Numbers and exponents in units of a format.
#include "scene/toml/quantity.hpp"

#include <cmath>
#include <limits>

#include "catch.hpp"
#include "scene/scene_text.hpp"

namespace test_quantity {

using namespace lostbits;
using namespace lostbits::scene;
using namespace lostbits::scene::toml;
using namespace lostbits::scene::test;

namespace {

constexpr FloatFormat p5{5, -1022, 1023};
constexpr FloatFormat every_format[] = {binary16, bfloat16, tensor_float32, binary32, binary64, p5};
constexpr double infinity = std::numeric_limits<double>::infinity();

const SourcePosition here{"t.toml", 3, 7};
Node word(const std::string& text) { return Node::of_string(text, here); }

int exponent(const std::string& text, const FloatFormat& format) { return Exponent(word(text)).value_in(format); }
double quantity(const std::string& text, const FloatFormat& format, int scale = 0) {
    return Quantity(word(text), true).value_in(format, scale);
}

std::string exponent_error(const std::string& text) {
    return error_of([&] { Exponent{word(text)}; });
}
std::string primitive_error(const std::string& text) {
    return error_of([&] { Quantity(word(text), false); });
}
std::string ray_error(const std::string& text) {
    return error_of([&] { Quantity(word(text), true); });
}

}  // namespace

TEST_CASE("an exponent can be a sum of integers and properties of the format, with quotients rounded down") {
    for (const FloatFormat& format : every_format) {
        CAPTURE(format.precision, format.emax);
        CHECK(Exponent{}.value_in(format) == 0);
        CHECK(exponent("-60", format) == -60);
        CHECK(Exponent(Node::of_integer(-60, here)).value_in(format) == -60);
        CHECK(exponent("emax", format) == format.emax);
        CHECK(exponent("emin", format) == format.emin);
        CHECK(exponent("p", format) == format.precision);
        CHECK(exponent(" - emin + p - 3 ", format) == -format.emin + format.precision - 3);
        CHECK(exponent("emin-p+1+2+4", format) == format.emin - format.precision + 7);
    }
    // By hand: ⌊127/2⌋ = 63, ⌊−126/4⌋ = −32, ⌊5/2⌋ = 2.
    CHECK(exponent("emax/2 + 1", binary32) == 64);
    CHECK(exponent("emin/4", binary32) == -32);
    CHECK(exponent("emin/2 - p/2", binary64) == -511 - 26);
    CHECK(exponent("p/2 + 7/2", p5) == 2 + 3);
    CHECK(exponent("10000", binary32) == 10000);
    CHECK(exponent_error(std::string(17, '1').replace(1, 16, "+1+1+1+1+1+1+1+1+1+1+1+1+1+1+1+1")) != "no error");
}

TEST_CASE("a wrong exponent is refused with its position") {
    for (const std::string text :
         {"",          "+",   "emx",       "max",          "emax/3", "emax/", "emax/22", "emax*2",
          "2emax",     "p3",  "emax emin", "1.5",          "0x10",   "1e3",   "10001",   "99999999999999999999",
          "emax + -3", "--3", "3 + + 4",   "--2147483648", "emax+",  "(emax)"}) {
        CAPTURE(text);
        const std::string error = exponent_error(text);
        CHECK(error.starts_with("t.toml:3:7: "));
    }
    CHECK(exponent_error("emax/3") ==
          "t.toml:3:7: \"emax/3\" is not an exponent; write a sum of whole numbers, emax, emin and p, each "
          "optionally divided by 2 or 4, such as \"emax/2 + 1\"");
    CHECK(exponent_error("e max") == "t.toml:3:7: \"e max\" contains a space inside a number or word; remove it");
    Node flag;
    flag.kind = Node::Kind::boolean;
    flag.where = here;
    CHECK(error_of([&] { Exponent{flag}; }) ==
          "t.toml:3:7: is " + flag.describe() + " where a number or a string is expected");
    CHECK(error_of([&] { Quantity(flag, true); }) ==
          "t.toml:3:7: is " + flag.describe() + " where a number or a string is expected");
}

TEST_CASE("named quantities are numbers of the format for every scale and sign") {
    for (const FloatFormat& format : every_format) {
        CAPTURE(format.precision, format.emax);
        for (const int scale : {0, 40, -40}) {
            CHECK(quantity("max", format, scale) ==
                  std::ldexp(2, format.emax - 1) * (2 - std::ldexp(1, 1 - format.precision)));
            CHECK(quantity("min", format, scale) == std::ldexp(1, format.emin));
            CHECK(quantity("tiny", format, scale) == std::ldexp(1, format.emin - format.precision + 1));
            CHECK(quantity("inf", format, scale) == infinity);
            CHECK(std::isnan(quantity("nan", format, scale)));
        }
        for (const std::string name : {"max", "min", "tiny", "inf"}) {
            CHECK(quantity("-" + name, format) == -quantity(name, format));
            CHECK(quantity("+" + name, format) == quantity(name, format));
            CHECK(quantity(" - " + name, format) == -quantity(name, format));
        }
    }
    CHECK(quantity("max", binary64) == std::numeric_limits<double>::max());
    CHECK(quantity("tiny", binary16) == 0x1p-24);
}

TEST_CASE("a number is scaled exactly and rounded once") {
    for (const FloatFormat& format : every_format) {
        const std::string half_way = "0x1.08p0";  // 1 + 2^-5: half way in five bits, to even below
        CHECK(quantity(half_way, format) == (format.precision == 5 ? 1 : 1.03125));
        CHECK(quantity("3", format, 2) == 12);
        CHECK(quantity("-3", format, 0) == -3);
        CHECK(quantity("+0x1.8p1", format) == 3);
        CHECK(quantity("3e0", format) == 3);
    }
    CHECK(Quantity(Node::of_integer(-3, here), false).value_in(binary32, -1) == -1.5);
    CHECK(quantity("0.1", binary32) == 0.1f);
    CHECK(quantity("0.1", binary64) == 0.1);
    CHECK(quantity("0.1", bfloat16) == 0x1.9ap-4);
    CHECK(!std::signbit(quantity("0", binary32, 99)));
    CHECK(std::signbit(quantity("-0", binary32, -99)));
    // Into the subnormals: tiny is the last place there, and a tie rounds to even.
    for (const FloatFormat& format : every_format) {
        const double tiny = quantity("tiny", format);
        const int last = format.emin - format.precision + 1;
        CHECK(quantity("1", format, last) == tiny);
        CHECK(quantity("1", format, last - 1) == 0);
        CHECK(quantity("1.5", format, last) == 2 * tiny);
        CHECK(quantity("2.5", format, last) == 2 * tiny);
        CHECK(quantity("0.50001", format, last) == tiny);
        CHECK(std::signbit(quantity("-1", format, last - 5)));
        CHECK(quantity("1.75", format, format.emax) < infinity);
        CHECK(quantity("2", format, format.emax) == infinity);
        CHECK(quantity("-2", format, format.emax) == -infinity);
        CHECK(quantity("1", format, 5000) == infinity);
        CHECK(quantity("1", format, -5000) == 0);
        // Half a last place above max rounds to infinity, less does not.
        CHECK(quantity("0x1.ffffffffffffffp0", format, format.emax) == infinity);
        CHECK(quantity(format.precision == 53 ? "0x1.fffffffffffff7p0" : "0x1.8p0", format, format.emax) < infinity);
    }
}

TEST_CASE("an offset of one ulp gives the neighbour, also across binades, at zero and at both ends") {
    CHECK(quantity("3 + ulp", binary32) == std::nextafter(3.0f, 4.0f));
    CHECK(quantity("3+ulp", binary64) == std::nextafter(3.0, 4.0));
    for (const FloatFormat& format : every_format) {
        CAPTURE(format.precision, format.emax);
        const double ulp = std::ldexp(1, 1 - format.precision), tiny = quantity("tiny", format);
        CHECK(quantity("1 + ulp", format) == 1 + ulp);
        CHECK(quantity("1 - ulp", format) == 1 - ulp / 2);
        CHECK(quantity("-1 - ulp", format) == -1 - ulp);
        CHECK(quantity("-1 + ulp", format) == -1 + ulp / 2);
        CHECK(quantity("1 + ulp", format, 2) == 4 + 4 * ulp);  // scaled first
        CHECK(quantity("0 + ulp", format) == tiny);
        CHECK(quantity("0 - ulp", format) == -tiny);
        CHECK(quantity("tiny - ulp", format) == 0);
        CHECK(quantity("tiny + ulp", format) == 2 * tiny);
        CHECK(quantity("-tiny + ulp", format) == 0);
        CHECK(quantity("min - ulp", format) == std::ldexp(1, format.emin) - tiny);
        CHECK(quantity("min + ulp", format) == std::ldexp(1, format.emin) + tiny);
        CHECK(quantity("-max - ulp", format) == -infinity);
        CHECK(quantity("max - ulp", format) ==
              quantity("max", format) - std::ldexp(1, format.emax - format.precision + 1));
        CHECK(quantity("inf - ulp", format) == quantity("max", format));
        CHECK(quantity("inf + ulp", format) == infinity);
        CHECK(std::isnan(quantity("nan + ulp", format)));
    }
}

TEST_CASE("a wrong quantity is refused with its position, and a primitive must be finite") {
    for (const std::string text : {"", "big", "max2", "2max", "maximum", "ulp", "+ ulp", "3 + 2 ulp", "3 + ulp + ulp",
                                   "--3", "3 +", "nan nan", "MAX", "1e400"}) {
        CAPTURE(text);
        CHECK(ray_error(text).starts_with("t.toml:3:7: "));
    }
    CHECK(ray_error("1 2") == "t.toml:3:7: \"1 2\" contains a space inside a number or word; remove it");
    CHECK(has(ray_error("big"), "max, min, tiny, nan or inf"));
    CHECK(primitive_error("nan") == "t.toml:3:7: is nan, which is allowed in rays only; write a finite number");
    CHECK(primitive_error("-inf") == "t.toml:3:7: is inf, which is allowed in rays only; write a finite number");
    CHECK(primitive_error("inf - ulp").starts_with("t.toml:3:7: is inf"));
    CHECK(primitive_error("max") == "no error");
    CHECK(ray_error("-nan") == "no error");
    // TOML's own words for infinity and NaN are read as floats.
    const Scratch folder;
    const Node root = read_toml(folder.write("t.toml", "a = [nan, -inf, inf, 1e-3]\n"));
    const std::vector<Node>& items = root.find("a")->items;
    CHECK(std::isnan(Quantity(items[0], true).value_in(binary32, 0)));
    CHECK(Quantity(items[1], true).value_in(binary32, 0) == -infinity);
    CHECK(error_in(folder, [&] { Quantity(items[2], false); }) ==
          "t.toml:1:17: is inf, which is allowed in rays only; write a finite number");
    CHECK(Quantity(items[3], false).value_in(binary64, 0) == 1e-3);
}

}  // namespace test_quantity
