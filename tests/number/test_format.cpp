// Names of formats, and the unit in the last place.
#include "catch.hpp"
#include "number/format.hpp"

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

TEST_CASE("any other name is no format", "[number][format]") {
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

}  // namespace lostbits::test
