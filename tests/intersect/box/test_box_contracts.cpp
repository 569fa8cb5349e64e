// The order of box forms, and the unit roundoff that paddings are made of.
#include "catch.hpp"
#include "intersect/catalogue.hpp"
#include "number/kinds.hpp"

namespace lostbits::test::test_box_contracts {

TEST_CASE("box forms come in the order of the columns of test_box_known", "[intersect][box][info]") {
    const char* order[] = {"box.baseline",   "box.exclusive",     "box.inclusive",     "box.signs",
                           "box.divide",     "box.ieee_minmax",   "box.pbrt_padded",   "box.max_mult",
                           "box.embree_fma", "box.embree_robust", "box.embree_padded", "box.bvh_robust",
                           "box.tinybvh",    "box.filtered"};
    std::size_t i = 0;
    intersect::box::BoxForms::for_each([&]<class Form>() { CHECK(Form::info.name == order[i++]); });
    CHECK(i == std::size(order));
}

TEST_CASE("the unit roundoff is that of the format, and none in exact arithmetic", "[number]") {
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

TEST_CASE("gamma(n) is n u/(1 - n u)", "[intersect][box][known]") {
    CHECK(gamma_bound<float>(3) == 3 * 0x1p-24f / (1 - 3 * 0x1p-24f));
    CHECK(gamma_bound<double>(3) == 3 * 0x1p-53 / (1 - 3 * 0x1p-53));
    CHECK(gamma_bound<Rounded<5>>(3).value() == 0.1015625);  // (3/32)/(29/32) = 26.48/256, in five bits
    CHECK(gamma_bound<Real>(3) == 0);
}

}  // namespace lostbits::test::test_box_contracts
