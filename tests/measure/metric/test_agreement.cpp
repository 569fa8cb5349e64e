#include <cmath>

#include "catch.hpp"
#include "measure/metric/statistics.hpp"

namespace test_agreement {

using lostbits::measure::metric::Agreement;

TEST_CASE("a quantile stands for a form from a tenth of the true hits on", "[agreement]") {
    CHECK(Agreement{10, 100}.is_enough());
    CHECK_FALSE(Agreement{9, 100}.is_enough());
    CHECK(Agreement{100, 100}.is_enough());
    CHECK(Agreement{1, 10}.is_enough());
    CHECK_FALSE(Agreement{1, 11}.is_enough());
    // No hit at all is never enough, neither where there is none to find.
    CHECK_FALSE(Agreement{0, 0}.is_enough());
    CHECK_FALSE(Agreement{0, 5}.is_enough());
    CHECK(std::isnan(Agreement{0, 0}.share()));
    CHECK(Agreement{1, 4}.share() == 0.25);
}

TEST_CASE("the hits behind a quantile are counted in words", "[agreement]") {
    CHECK(Agreement{6860, 25600}.of_agreed_hits() == "of 6860 agreed hits");
    CHECK(Agreement{1, 3}.of_agreed_hits() == "of 1 agreed hit");
    CHECK(Agreement{55, 16384}.too_few() == "55 of 16384 hits agree");
    CHECK(Agreement{1, 1024}.too_few() == "1 of 1024 hits agrees");
    CHECK(Agreement{0, 1}.too_few() == "0 of 1 hit agree");
}

}  // namespace test_agreement
