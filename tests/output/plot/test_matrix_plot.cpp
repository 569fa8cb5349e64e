#include "output/plot/matrix_plot.hpp"

#include "catch.hpp"
#include "number/error.hpp"
#include "output/helpers.hpp"
#include "output/image/pixels.hpp"

namespace test_matrix_plot {

using namespace lostbits::output;
using namespace lostbits::output::image;
using namespace lostbits::output::plot;
using namespace lostbits::output::test;

namespace {

Rgb8 colour(std::size_t row, std::size_t column) {
    return {static_cast<std::uint8_t>(40 + row), static_cast<std::uint8_t>(90 + column), 77};
}

/// Five columns in two groups, three rows, each cell a colour of its own.
MatrixPlotSpec coloured() {
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
    write_matrix_plot(backend(), folder / "m.png", spec);
    return backend().read_png(folder / "m.png");
}

}  // namespace

TEST_CASE("a matrix shows every cell in its place, groups apart", "[matrix_plot]") {
    const Scratch folder;
    const auto image = plotted(folder, coloured());
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
    write_matrix_plot(backend(), folder / "again.png", coloured());
    CHECK(contents(folder / "m.png") == contents(folder / "again.png"));
}

TEST_CASE("a word in a cell is dark on light and light on dark", "[matrix_plot]") {
    const Scratch folder;
    const auto plain = plotted(folder, coloured());
    const auto at = find_block(plain, colour(0, 0), 25, 21).value();
    for (const auto& [ground, dark_ink] : {std::pair{Rgb8{226, 238, 226}, true},
                                           {Rgb8{0, 0, 0}, false},
                                           {outcome_colours[3], true},
                                           {Rgb8{68, 1, 84}, false}}) {
        auto spec = coloured();
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

TEST_CASE("legend and colour bar stand beside the cells, long names and many rows fit", "[matrix_plot]") {
    const Scratch folder;
    auto spec = coloured();
    spec.legend = {{"false hit", outcome_colours[2], "3"}};
    const auto image = plotted(folder, spec);
    CHECK(count_of(image, outcome_colours[2]) > 50);
    const auto ramp = backend().ramp("viridis", 256);
    spec.scale.emplace("viridis", ramp, 0, 24);
    spec.unit = "lost bits";
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

TEST_CASE("not one cell a row and column is refused", "[matrix_plot]") {
    const Scratch folder;
    auto spec = coloured();
    spec.cells.pop_back();
    CHECK_THROWS_AS(plotted(folder, spec), std::invalid_argument);
    spec = coloured();
    spec.rows.push_back("fourth");
    CHECK_THROWS_AS(plotted(folder, spec), std::invalid_argument);
    spec = coloured();
    spec.rows.clear();
    spec.cells.clear();
    CHECK_THROWS_AS(plotted(folder, spec), std::invalid_argument);
    CHECK_THROWS_AS(plotted(folder, MatrixPlotSpec{}), std::invalid_argument);
    CHECK(folder.entries() == 0);
    plotted(folder, coloured());
    CHECK_THROWS_AS(write_matrix_plot(backend(), folder / "m.png/below.png", coloured()), lostbits::EnvironmentError);
}

}  // namespace test_matrix_plot
