// What each box form says of itself, and the unit roundoff that paddings are made of.
#include <set>

#include "catch.hpp"
#include "intersect/catalogue.hpp"
#include "number/kinds.hpp"

namespace lostbits::test::test_box_contracts {

TEST_CASE("box forms have names, titles and sources", "[intersect][box][info]") {
    const char* order[] = {"box.baseline",   "box.exclusive",     "box.inclusive",     "box.signs",
                           "box.divide",     "box.ieee_minmax",   "box.pbrt_padded",   "box.max_mult",
                           "box.embree_fma", "box.embree_robust", "box.embree_padded", "box.bvh_robust",
                           "box.tinybvh",    "box.filtered"};
    std::set<std::string_view> titles, open;
    std::size_t i = 0;
    intersect::box::BoxForms::for_each([&]<class Form>() {
        const intersect::Info& info = Form::info;
        INFO(info.name);
        REQUIRE(i < std::size(order));
        CHECK(info.name == order[i++]);
        CHECK(titles.insert(info.title).second);
        CHECK_FALSE(info.source.empty());
        CHECK(info.direction == intersect::Direction::any);
        CHECK(info.roots == intersect::Roots::both);
        CHECK(info.formats == intersect::Formats::all);
        if (info.touching == intersect::Touching::miss) open.insert(info.name);
    });
    CHECK(i == std::size(order));
    CHECK(open == std::set<std::string_view>{"box.baseline", "box.exclusive"});
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
