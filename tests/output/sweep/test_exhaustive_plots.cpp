// Pictures of sweeps over every float: what is drawn, and what is left out.
#include "output/sweep/exhaustive_files.hpp"

#include <algorithm>

#include "catch.hpp"
#include "measure/rows.hpp"

namespace test_exhaustive_plots {

using namespace lostbits;
using namespace lostbits::output::sweep;
using lostbits::output::plot::AxisSpec;
using lostbits::output::plot::Series;
using lostbits::test::row;
using lostbits::test::TextFile;
using measure::evaluate::TestedForm;

namespace {

std::string sweep_text(const std::string& set, const std::string& range, const std::string& primitive) {
    return "schema = \"lostbits-sweep/1\"\ntitle = \"A test\"\nsource = \"-\"\n[axis]\nname = \"x\"\nunit = "
           "\"r\"\nspacing = \"every_float\"\nset = \"" +
           set + "\"\n" + range + "\n[[ray]]\nname = \"a\"\norigin = [0, 0, 16]\ndirection = [0, 0, -1]\n" + primitive;
}
const std::string sphere = "[sphere]\ncentre = [0, 0, 0]\nradius = 1\n";
const std::string box = "[box]\nlo = [-1, -1, -1]\nhi = [1, 1, 1]\n";

/// A sweep that was run.
struct FinishedSweep {
    FinishedSweep(const std::string& text, const std::vector<TestedForm>& tested_forms)
        : written(text), file(written.path(), LOSTBITS_DATA_DIR), request{.sweep = file, .tested_forms = tested_forms} {
        measure::sweep::run_exhaustive(request, state);
    }
    [[nodiscard]] auto plots() const { return exhaustive_plots(request, state); }

    TextFile written;
    scene::sweep::ExhaustiveFile file;
    measure::sweep::ExhaustiveRequest request;
    measure::sweep::ExhaustiveState state;
};

std::vector<std::string> labels(const std::vector<Series>& series) {
    std::vector<std::string> all;
    for (const Series& one : series) all.push_back(one.label);
    return all;
}

}  // namespace

TEST_CASE("a plot has one flat segment per binade, limited to what was tried, and 64 wrong floats are visible") {
    const FinishedSweep ran(sweep_text("ray.origin.x", "from = \"0x1.fp-1\"\nto = \"0x1.08p0\"", sphere),
                            {row("sphere.schoolbook", "f32"), row("sphere.hearn_baker", "f32")});
    const auto plots = ran.plots();
    REQUIRE(plots.has_value());
    const auto& wrong = plots->wrong.series;
    CHECK(labels(wrong) == std::vector<std::string>{"schoolbook", "hearn_baker"});
    CHECK(wrong[0].x == std::vector<double>{0x1.fp-1, 0x1.fffffep-1, 1, 0x1.08p0});
    CHECK(wrong[0].y == std::vector<double>{0, 0, 64.0 / 262145, 64.0 / 262145});
    CHECK(wrong[1].y == std::vector<double>(4, 0));
    // One wrong float in a whole binade is visible above the base line.
    CHECK(plots->wrong.y.shows_zero);
    CHECK(plots->wrong.y.low == 0x1p-23);
    CHECK(plots->wrong.y.scale == AxisSpec::Scale::log2);
    const auto& lost = plots->lost_bits.series;
    CHECK(lost[0].y[0] > 12);
    CHECK(lost[0].y[2] == 0);
    // Powers of two would give this axis one tick.
    CHECK(plots->wrong.x.scale == AxisSpec::Scale::linear);
    CHECK(plots->wrong.x.title == "x, in radii");
    CHECK(plots->wrong.subtitle.front() == "A test");
    const std::string below = sweep_text("ray.origin.x", "from = \"-0x1.00001p0\"\nto = \"-0x1.ffffp-1\"", sphere);
    const FinishedSweep open("convention = \"open\"\n" + below, {row("sphere.schoolbook", "f32")});
    CHECK(open.plots()->wrong.x.title == "x, in radii, below 0, in size");
    CHECK(open.plots()->wrong.subtitle.front() == "A test, judged by the open primitive");
}

TEST_CASE("both signs are drawn apart, subnormal numbers have a place, and missing numbers are reported") {
    const std::string around_zero = "from = \"-0x1.00002p-126\"\nto = \"0x1.00002p-126\"";
    for (const bool falls : {false, true}) {
        std::string range = around_zero;
        if (falls) range = "to = \"-0x1.00002p-126\"\nfrom = \"0x1.00002p-126\"";
        const FinishedSweep ran(sweep_text("ray.origin.x", range, box), {row("box.signs", "f32")});
        const auto plots = ran.plots();
        REQUIRE(plots.has_value());
        CHECK(labels(plots->wrong.series) == std::vector<std::string>{"signs (x > 0)", "signs (x < 0)"});
        for (const Series& series : plots->wrong.series) {
            CHECK(series.x == std::vector<double>{0x1p-149, 0x1.fffffcp-127, 0x1p-126, 0x1.00002p-126});
            CHECK(series.y.size() == series.x.size());
        }
        CHECK(plots->wrong.x.title == "x, in radii, in size");
        CHECK(plots->wrong.x.scale == AxisSpec::Scale::log2);
        CHECK(std::ranges::any_of(plots->wrong.subtitle, [](const std::string& line) {
            return line.find("zeros, infinities and NaNs are only in the tables") != std::string::npos;
        }));
    }
}

TEST_CASE("a sweep within one binade has no plots") {
    const FinishedSweep narrow(sweep_text("ray.origin.x", "from = 1\nto = \"0x1.00001p0\"", sphere),
                               {row("sphere.schoolbook", "f32")});
    CHECK_FALSE(narrow.plots().has_value());
}

}  // namespace test_exhaustive_plots
