// Sweeps along axes: the values of an axis.
#include "scene/sweep/sweep_file.hpp"

#include <cmath>

#include "catch.hpp"
#include "scene/scene_text.hpp"

namespace test_sweep_file {

using namespace lostbits;
using namespace lostbits::scene::sweep;
using namespace lostbits::scene::test;

namespace {

SweepFile along(const std::string& from, const std::string& to) {
    const Scratch folder;
    return {folder.write("s.toml",
                         "schema = \"lostbits-sweep/1\"\ntitle = \"A test\"\nsource = \"-\"\nscene = "
                         "\"near-benign\"\nconvention = \"open\"\n[[axis]]\nname = \"x\"\nspacing = "
                         "\"every_float\"\nset = [\"sphere[0].centre[0]\"]\nfrom = \"" +
                             from + "\"\nto = \"" + to + "\"\n"),
            LOSTBITS_DATA_DIR};
}

}  // namespace

TEST_CASE("steps over every float are each a value of its own: both zeros are one") {
    const double least = 0x1p-149;
    const Axis across = along("-0x1p-148", "0x1p-148").axes.front();
    CHECK(across.values == std::vector<double>{-2 * least, -least, 0, least, 2 * least});
    CHECK_FALSE(std::signbit(across.values[2]));
    CHECK(across.middle(-2 * least, 2 * least) == 0);
    CHECK_FALSE(std::signbit(across.middle(-2 * least, 2 * least)));
    const Axis below = along("-0x1.000004p0", "-1").axes.front();
    CHECK(below.values == std::vector<double>{-0x1.000004p0, -0x1.000002p0, -1});
}

TEST_CASE("half way between two floats, in floats, lies between them until nothing does") {
    const SweepFile sweep = along("1", "0x1.00001p0");
    const Axis& axis = sweep.axes.front();
    CHECK(sweep.convention == intersect::Touching::miss);
    const double next = 0x1.000002p0;
    CHECK(axis.middle(1, 0x1.000004p0) == next);
    CHECK(axis.middle(0x1.000004p0, 1) == next);
    for (const auto& [a, b] :
         {std::pair{1.0, next}, {next, 1.0}, {0.0, 0x1p-149}, {-0x1p-149, 0.0}, {-0.0, 0x1p-149}}) {
        CAPTURE(a, b);
        const double middle = axis.middle(a, b);
        CHECK((middle == a || middle == b));
    }
    CHECK(axis.middle(0x1p-3, 0x1p5) == 2);
}

}  // namespace test_sweep_file
