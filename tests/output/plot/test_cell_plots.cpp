// Plots of cells: tables of rows and columns, and planes of two parameters.
#include <algorithm>
#include <cmath>
#include <limits>

#include "catch.hpp"
#include "number/error.hpp"
#include "output/helpers.hpp"
#include "output/image/figure.hpp"
#include "output/image/pixels.hpp"
#include "output/plot/cell_plots.hpp"

namespace test_cell_plots {

using namespace lostbits::output;
using namespace lostbits::output::image;
using namespace lostbits::output::plot;
using namespace lostbits::output::test;

namespace {

Rgb8 colour(std::size_t row, std::size_t column) {
    return {static_cast<std::uint8_t>(40 + row), static_cast<std::uint8_t>(90 + column), 77};
}

/// Five columns in two groups, three rows, each cell a colour of its own.
MatrixPlotSpec matrix() {
    MatrixPlotSpec spec;
    spec.title = "A matrix";
    spec.groups = {{"f32", {"one", "two", "three"}}, {"f64", {"one", "a much longer name"}}};
    spec.rows = {"first", "second, a longer one", "third"};
    for (std::size_t r = 0; r < 3; ++r) {
        for (std::size_t c = 0; c < 5; ++c) spec.cells.push_back({colour(r, c)});
    }
    return spec;
}

PngImage plotted(const Scratch& folder, const MatrixPlotSpec& spec) {
    save_figure(folder / "m.png", draw_matrix_plot(spec));
    return backend().read_png(folder / "m.png");
}

}  // namespace

TEST_CASE("a matrix plot shows every cell in its place, with groups apart", "[matrix_plot]") {
    const Scratch folder;
    const auto image = plotted(folder, matrix());
    const auto first = find_block(image, colour(0, 0), 25, 21);
    REQUIRE(first.has_value());
    constexpr int places[] = {0, 26, 52, 78 + 14, 104 + 14};
    for (std::size_t r = 0; r < 3; ++r) {
        for (std::size_t c = 0; c < 5; ++c) {
            CHECK(count_of(image, colour(r, c)) == 25 * 21);
            CHECK(find_block(image, colour(r, c), 25, 21) ==
                  std::pair{first->first + places[c], first->second + 22 * static_cast<int>(r)});
        }
    }
    CHECK(rim_is_blank(image));
    save_figure(folder / "again.png", draw_matrix_plot(matrix()));
    CHECK(contents(folder / "m.png") == contents(folder / "again.png"));
}

TEST_CASE("text in a cell is dark on light and light on dark", "[matrix_plot]") {
    const Scratch folder;
    const auto plain = plotted(folder, matrix());
    const auto at = find_block(plain, colour(0, 0), 25, 21).value();
    for (const auto& [ground, dark_ink] : {std::pair{Rgb8{226, 238, 226}, true},
                                           {Rgb8{0, 0, 0}, false},
                                           {outcome_colours[3], true},
                                           {Rgb8{68, 1, 84}, false}}) {
        auto spec = matrix();
        spec.cells[0] = {ground, "12"};
        const auto image = plotted(folder, spec);
        int darker = 0, lighter = 0, same = 0;
        for (int y = 0; y < 21; ++y) {
            for (int x = 0; x < 25; ++x) {
                const Rgb8 p = pixel_at(image, at.first + x, at.second + y);
                same += p == ground;
                darker += p.g < ground.g;
                lighter += p.g > ground.g;
            }
        }
        CHECK(same > 25 * 21 / 2);
        CHECK((dark_ink ? darker : lighter) > 10);
        CHECK((dark_ink ? lighter : darker) == 0);
        CHECK(rim_is_blank(image));
        CHECK(pixel_at(image, at.first, at.second) == ground);
        CHECK(pixel_at(image, at.first + 24, at.second + 20) == ground);
    }
}

TEST_CASE("legend and colour bar are beside the cells, and long names and many rows fit", "[matrix_plot]") {
    const Scratch folder;
    auto spec = matrix();
    spec.legend = {{"false hit", outcome_colours[2], "3"}};
    const auto image = plotted(folder, spec);
    CHECK(count_of(image, outcome_colours[2]) > 50);
    const auto ramp = backend().ramp("viridis", 256);
    spec.scale.emplace("viridis", ramp, 0, 24);
    spec.bar_label = "lost bits";
    const auto wide = plotted(folder, spec);
    CHECK(wide.width > image.width);
    CHECK(count_of(wide, ramp.back()) > 0);
    CHECK(count_of(wide, colour(2, 4)) == 25 * 21);
    spec.title = std::string(300, 'W');
    spec.rows[1] = std::string(120, 'W');
    spec.groups[1].columns[1] = std::string(90, 'W');
    spec.cells[3].text = "123456789";
    CHECK(rim_is_blank(plotted(folder, spec)));
}

TEST_CASE("a matrix plot with missing or extra cells is refused", "[matrix_plot]") {
    const Scratch folder;
    auto spec = matrix();
    spec.cells.pop_back();
    CHECK_THROWS_AS(plotted(folder, spec), std::invalid_argument);
    spec = matrix();
    spec.rows.push_back("fourth");
    CHECK_THROWS_AS(plotted(folder, spec), std::invalid_argument);
    spec = matrix();
    spec.rows.clear();
    spec.cells.clear();
    CHECK_THROWS_AS(plotted(folder, spec), std::invalid_argument);
    CHECK_THROWS_AS(plotted(folder, MatrixPlotSpec{}), std::invalid_argument);
    CHECK(folder.entries() == 0);
    plotted(folder, matrix());
    CHECK_THROWS_AS(save_figure(folder / "m.png/below.png", draw_matrix_plot(matrix())), lostbits::EnvironmentError);
}

namespace {

constexpr double no_value = std::numeric_limits<double>::quiet_NaN();

/// Columns at 2^0, 2^1, ...; rows at 0, 1, ...; each cell a colour of its own.
PlanePlotSpec plane(int columns, int rows) {
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
    save_figure(folder / "p.png", draw_plane_plot(spec));
    return backend().read_png(folder / "p.png");
}

}  // namespace

TEST_CASE("a plane plot shows every cell, equal steps as equal rectangles, with the first row at the bottom",
          "[plane_plot]") {
    const Scratch folder;
    const auto image = plotted(folder, plane(40, 30));
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
    save_figure(folder / "again.png", draw_plane_plot(plane(40, 30)));
    CHECK(contents(folder / "p.png") == contents(folder / "again.png"));
}

TEST_CASE("values have ramp colours, outcomes their own, and other cells are hatched", "[plane_plot]") {
    const Scratch folder;
    auto spec = plane(2, 2);
    const auto ramp = backend().ramp("viridis", 256);
    spec.scale.emplace("viridis", ramp, 0, 24);
    spec.bar_label = "lost bits";
    spec.cells = {{0.0}, {std::numeric_limits<double>::infinity()}, {5.0, image::outcome_colours[3]}, {12.0}};
    const auto image = plotted(folder, spec);
    const std::int64_t cell = 280 * 210;
    CHECK(count_of(image, ramp.front()) >= cell);
    CHECK(count_of(image, ramp.back()) >= cell);
    CHECK(count_of(image, spec.scale->colour_of_value(12)) >= cell);
    CHECK(count_of(image, image::outcome_colours[3]) == cell);
    CHECK(rim_is_blank(image));
    spec.cells[0] = {};
    const auto hatched = plotted(folder, spec);
    CHECK(count_of(hatched, ramp.front()) < cell / 10);
    CHECK(hatched.height > image.height);  // the legend names it
    CHECK(rim_is_blank(hatched));
}

TEST_CASE("an outline runs around marked cells and not between them", "[plane_plot]") {
    const Scratch folder;
    auto spec = plane(4, 3);
    const auto bare = plotted(folder, spec);
    spec.cells[5].is_outlined = spec.cells[6].is_outlined = true;  // two neighbours in the middle
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

TEST_CASE("planes of unusual shapes are drawn, and impossible ones are refused", "[plane_plot]") {
    const Scratch folder;
    for (const auto& [columns, rows] : {std::pair{1, 1}, {1, 30}, {200, 1}, {3, 700}}) {
        auto spec = plane(columns, rows);
        spec.title = std::string(200, 'W');
        spec.legend = {{std::string(150, 'W'), image::outcome_colours[2], "1"}};
        CHECK(rim_is_blank(plotted(folder, spec)));
    }
    auto spec = plane(2, 2);
    spec.x = {2, 2};
    CHECK_THROWS_AS(plotted(folder, spec), std::invalid_argument);
    spec.x = {0, 2};
    CHECK_THROWS_AS(plotted(folder, spec), std::invalid_argument);
    spec = plane(2, 2);
    spec.cells.pop_back();
    CHECK_THROWS_AS(plotted(folder, spec), std::invalid_argument);
    spec = plane(2, 2);
    spec.cells[0] = {1.0};
    CHECK_THROWS_AS(plotted(folder, spec), std::invalid_argument);
}

}  // namespace test_cell_plots
