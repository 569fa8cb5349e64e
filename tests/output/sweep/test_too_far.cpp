#include <cmath>

#include "catch.hpp"
#include "measure/rows.hpp"
#include "output/sweep/sweep_plots.hpp"

namespace test_too_far {

using namespace lostbits;

namespace {

/// A sphere of radius 1 along the distance in radii, or one of another axis.
std::string sweep_of(const std::string& family, const std::string& axis, const std::string& from,
                     const std::string& to) {
    return "schema = \"lostbits-sweep/1\"\ntitle = \"A test\"\nsource = \"-\"\n[family]\nviews = 2\nrays = 2\n" +
           family + "\n[[axis]]\nname = \"" + axis + "\"\nspacing = \"log2\"\nfrom = " + from + "\nto = " + to +
           "\nsteps = 9\nset = [\"" + axis + "\"]\n";
}

std::optional<output::sweep::AxisPart> part_of(const std::string& text, const FloatFormat& format) {
    const testing::TextFile file(text);
    return output::sweep::too_far(scene::sweep::SweepFile(file.path(), LOSTBITS_DATA_DIR), format);
}

}  // namespace

TEST_CASE("an ulp of the distance is as wide as a sphere from 2^p radii on", "[too_far]") {
    // In [2^24, 2^25) an ulp of a float is 2, the width of a unit sphere; before that it is 1.
    const std::string text = sweep_of("radius = 1", "distance", "4", "\"0x1p40\"");
    const auto single = part_of(text, binary32);
    REQUIRE(single.has_value());
    CHECK(std::fabs(single->from / 0x1p24 - 1) <= 0x1p-8);
    CHECK(single->to == 0x1p40);
    CHECK_FALSE(part_of(text, binary64).has_value());
    const auto brain = part_of(text, bfloat16);
    REQUIRE(brain.has_value());
    CHECK(std::fabs(brain->from / 0x1p8 - 1) <= 0x1p-5);
    CHECK_FALSE(part_of(sweep_of("radius = 1", "distance", "4", "1024"), binary32).has_value());
    const auto all = part_of(sweep_of("radius = 1", "distance", "\"0x1p30\"", "\"0x1p40\""), binary32);
    REQUIRE(all.has_value());
    CHECK((all->from == 0x1p30 && all->to == 0x1p40));
    // Which way the axis runs does not matter.
    const auto falling = part_of(sweep_of("radius = 1", "distance", "\"0x1p40\"", "4"), binary32);
    REQUIRE(falling.has_value());
    CHECK((falling->from == single->from && falling->to == single->to));
}

TEST_CASE("a quantile over too few agreed hits is a gap", "[too_far]") {
    measure::evaluate::FormSummary s;
    s.rays = s.true_hits = 100;
    s.metrics.resize(1);
    for (int k = 0; k < 10; ++k) s.metrics[0].add(3);
    s.metrics[0].seal();
    auto& agreed = s.outcomes[static_cast<std::size_t>(measure::answer::Outcome::agree_hit)];
    agreed = 10;
    CHECK(output::sweep::drawn_quantile(s, 0, 0.5) == 3);
    agreed = 9;
    CHECK(std::isnan(output::sweep::drawn_quantile(s, 0, 0.5)));
    CHECK(output::sweep::gap_means() == "no value where fewer than 10 % of the hits agree");
}

}  // namespace test_too_far
