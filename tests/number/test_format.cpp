// Names of formats, the unit in the last place, and the unit roundoff that bounds and paddings use.
#include "catch.hpp"
#include "geometry/rounding_bound.hpp"
#include "number/format.hpp"
#include "number/kinds.hpp"

namespace lostbits::test {

TEST_CASE("formats are found by name", "[number][format]") {
    using Engine = Format::Engine;
    CHECK(find_format("f32") == Format{"f32", {24, -126, 127}, Engine::native32});
    CHECK(find_format("f64") == Format{"f64", {53, -1022, 1023}, Engine::native64});
    CHECK(find_format("fp16") == Format{"fp16", {11, -14, 15}, Engine::rounded});
    CHECK(find_format("bf16") == Format{"bf16", {8, -126, 127}, Engine::rounded});
    CHECK(find_format("tf32") == Format{"tf32", {11, -126, 127}, Engine::rounded});
    for (int p = 2; p <= 53; ++p) {
        const std::string name = "p" + std::to_string(p);
        CHECK(find_format(name) == Format{name, {p, -1022, 1023}, Engine::rounded});
    }
}

TEST_CASE("any other name is refused as a format", "[number][format]") {
    for (const char* name :
         {"",    "p",  "p0",      "p1", "p02",          "p54", "p100", "p-3",  "p+5", "p5x",  "p5 ",
          " p5", "P5", "p5..p12", "pN", "p99999999999", "f16", "F32",  "f32 ", "f",   "half", "double"})
        CHECK_FALSE(find_format(name));
}

TEST_CASE("the unit in the last place stops shrinking at the subnormals", "[number][format]") {
    CHECK(ulp_exponent(binary32, 0) == -23);
    CHECK(ulp_exponent(binary32, 127) == 104);
    CHECK(ulp_exponent(binary32, -126) == -149);
    CHECK(ulp_exponent(binary32, -140) == -149);
    CHECK(ulp_exponent(binary64, -100000) == -1074);
    CHECK(ulp_exponent(binary16, 10) == 0);
}

TEST_CASE("the unit roundoff belongs to the format and does not exist in exact arithmetic", "[number]") {
    CHECK(unit_roundoff<float>() == 0x1p-24f);
    CHECK(unit_roundoff<double>() == 0x1p-53);
    CHECK(unit_roundoff<Half>().value() == 0x1p-11);
    CHECK(unit_roundoff<BFloat16>().value() == 0x1p-8);
    CHECK(unit_roundoff<Rounded<2>>().value() == 0x1p-2);
    CHECK(unit_roundoff<Dual<double, 2>>().value() == 0x1p-53);
    for (const int precision : {2, 11, 24, 37, 53}) {
        const CurrentFormat::Scope scope(FloatFormat{precision, -126, 127});
        CHECK(unit_roundoff<RoundedAny>().value() == std::ldexp(1.0, -precision));
    }
    CHECK(unit_roundoff<Real>() == 0);
    CHECK((unit_roundoff<Ball>().is_exact() && unit_roundoff<Ball>().hi() == 0));
    CHECK((unit_roundoff<Interval>().is_exact() && mpfr_zero_p(unit_roundoff<Interval>().lower()) != 0));
}

TEST_CASE("gamma(n) is n u/(1 - n u)", "[number]") {
    CHECK(gamma_bound<float>(3) == 3 * 0x1p-24f / (1 - 3 * 0x1p-24f));
    CHECK(gamma_bound<double>(3) == 3 * 0x1p-53 / (1 - 3 * 0x1p-53));
    CHECK(gamma_bound<Rounded<5>>(3).value() == 0.1015625);  // (3/32)/(29/32) = 26.48/256, in five bits
    CHECK(gamma_bound<Real>(3) == 0);
}

}  // namespace lostbits::test
