#include <algorithm>
#include <cmath>
#include <limits>

#include "catch.hpp"
#include "output/helpers.hpp"
#include "output/image/pixels.hpp"
#include "output/plot/plane_plot.hpp"

namespace test_plane_plot {

using namespace lostbits::output;
using namespace lostbits::output::plot;
using namespace lostbits::output::test;

namespace {

constexpr double no_value = std::numeric_limits<double>::quiet_NaN();

/// Columns at 2^0, 2^1, ...; rows at 0, 1, ...; each cell a colour of its own.
PlanePlotSpec coloured(int columns, int rows) {
    PlanePlotSpec spec;
    spec.title = "A plane";
    spec.x_axis = {"distance", AxisSpec::Scale::log2, {}, {}};
    spec.y_axis = {"height", AxisSpec::Scale::linear, {}, {}};
    for (int i = 0; i < columns; ++i) spec.x.push_back(std::exp2(i));
    for (int j = 0; j < rows; ++j) spec.y.push_back(j);
    for (int j = 0; j < rows; ++j) {
        for (int i = 0; i < columns; ++i) {
            spec.cells.push_back(
                {no_value, image::Rgb8{static_cast<std::uint8_t>(i), static_cast<std::uint8_t>(j), 77}});
        }
    }
    return spec;
}

image::PngImage plotted(const Scratch& folder, const PlanePlotSpec& spec) {
    write_plane_plot(backend(), folder / "p.png", spec);
    return backend().read_png(folder / "p.png");
}

}  // namespace

TEST_CASE("a plane shows every cell, equal steps as equal rectangles, the first row at the foot", "[plane_plot]") {
    const Scratch folder;
    const auto image = plotted(folder, coloured(40, 30));
    for (int j = 0; j < 30; ++j) {
        for (int i = 0; i < 40; ++i) {
            CHECK(count_of(image, {static_cast<std::uint8_t>(i), static_cast<std::uint8_t>(j), 77}) == 14 * 14);
        }
    }
    const auto place = [&](image::Rgb8 colour) {
        return static_cast<int>(std::ranges::find(image.pixels, colour) - image.pixels.begin());
    };
    CHECK(place({0, 29, 77}) < place({0, 0, 77}));
    CHECK(place({0, 29, 77}) + 39 * 14 == place({39, 29, 77}));
    CHECK(rim_is_blank(image));
    write_plane_plot(backend(), folder / "again.png", coloured(40, 30));
    CHECK(contents(folder / "p.png") == contents(folder / "again.png"));
}

TEST_CASE("values take the ramp, outcomes their colour, and what is neither is hatched", "[plane_plot]") {
    const Scratch folder;
    auto spec = coloured(2, 2);
    const auto ramp = backend().ramp("viridis", 256);
    spec.scale.emplace("viridis", ramp, 0, 24);
    spec.unit = "lost bits";
    spec.cells = {{0.0}, {std::numeric_limits<double>::infinity()}, {5.0, image::outcome_colours[3]}, {12.0}};
    const auto image = plotted(folder, spec);
    const std::int64_t cell = 280 * 210;
    CHECK(count_of(image, ramp.front()) >= cell);
    CHECK(count_of(image, ramp.back()) >= cell);
    CHECK(count_of(image, spec.scale->map(12)) >= cell);
    CHECK(count_of(image, image::outcome_colours[3]) == cell);
    CHECK(rim_is_blank(image));
    spec.cells[0] = {};
    const auto hatched = plotted(folder, spec);
    CHECK(count_of(hatched, ramp.front()) < cell / 10);
    CHECK(hatched.height > image.height);  // the legend names it
    CHECK(rim_is_blank(hatched));
}

TEST_CASE("a line runs around outlined cells and between none of them", "[plane_plot]") {
    const Scratch folder;
    auto spec = coloured(4, 3);
    const auto bare = plotted(folder, spec);
    spec.cells[5].outlined = spec.cells[6].outlined = true;  // two neighbours in the middle
    const auto png = plotted(folder, spec);
    // A cell is 140 by 140: the line takes two pixels of an outlined one along the border, and a light one outside.
    const int w = 140, h = 140;
    const auto of = [&](int i) {
        return count_of(png, {static_cast<std::uint8_t>(i % 4), static_cast<std::uint8_t>(i / 4), 77});
    };
    CHECK(count_of(bare, {1, 1, 77}) == w * h);
    CHECK(of(5) == (w - 2) * (h - 4));
    CHECK(of(6) == (w - 2) * (h - 4));
    CHECK(of(4) == w * h - h);  // beside
    CHECK(of(1) == w * h - w);  // below
    CHECK(of(3) == w * h);      // a corner away
    CHECK(rim_is_blank(png));
}

TEST_CASE("planes of odd shapes, and those that are refused", "[plane_plot]") {
    const Scratch folder;
    for (const auto& [columns, rows] : {std::pair{1, 1}, {1, 30}, {200, 1}, {3, 700}}) {
        auto spec = coloured(columns, rows);
        spec.title = std::string(200, 'W');
        spec.legend = {{std::string(150, 'W'), image::outcome_colours[2], "1"}};
        CHECK(rim_is_blank(plotted(folder, spec)));
    }
    auto spec = coloured(2, 2);
    spec.x = {2, 2};
    CHECK_THROWS_AS(plotted(folder, spec), std::invalid_argument);
    spec.x = {0, 2};
    CHECK_THROWS_AS(plotted(folder, spec), std::invalid_argument);
    spec = coloured(2, 2);
    spec.cells.pop_back();
    CHECK_THROWS_AS(plotted(folder, spec), std::invalid_argument);
    spec = coloured(2, 2);
    spec.cells[0] = {1.0};
    CHECK_THROWS_AS(plotted(folder, spec), std::invalid_argument);
}

}  // namespace test_plane_plot
