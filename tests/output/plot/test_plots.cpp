#include <algorithm>
#include <cmath>
#include <limits>

#include "catch.hpp"
#include "output/helpers.hpp"
#include "output/image/figure.hpp"
#include "output/image/pixels.hpp"
#include "output/plot/line_plot.hpp"
#include "output/plot/line_plot_parts.hpp"
#include "output/plot/plot_axis.hpp"

namespace test_plots {

using namespace lostbits::output;
using namespace lostbits::output::plot;
using namespace lostbits::output::test;

namespace {

constexpr double inf = std::numeric_limits<double>::infinity();
constexpr double no_value = std::numeric_limits<double>::quiet_NaN();
constexpr image::Rgb8 first_colour{0, 114, 178}, second_colour{213, 94, 0};

/// The inside of the frame: the longest run of the frame's colour in a row is its upper edge, in a column its left.
PlotFrame frame_of(const image::PngImage& image) {
    PlotFrame out;
    int best = 0;
    for (int y = 0; y < image.height; ++y) {
        for (int x = 0, run = 0; x < image.width; ++x) {
            run = pixel_at(image, x, y) == image::style::line ? run + 1 : 0;
            if (run > best) {
                best = run;
                out.x = x - run + 2;
                out.y = y + 1;
                out.width = run - 2;
            }
        }
    }
    out.height = 0;
    while (pixel_at(image, out.x - 1, out.y + out.height + 1) == image::style::line) ++out.height;
    out.pad = 9;
    return out;
}

/// True if the first line is there; all other lines are grey.
bool tinted(image::Rgb8 p) { return p.b > p.r + 70; }

/// Tinted pixels within the frame.
std::int64_t drawn(const image::PngImage& image) {
    const auto frame = frame_of(image);
    std::int64_t n = 0;
    for (int y = frame.y; y < frame.y + frame.height; ++y) {
        for (int x = frame.x; x < frame.x + frame.width; ++x) n += tinted(pixel_at(image, x, y));
    }
    return n;
}

std::int64_t in_legend(const image::PngImage& image, image::Rgb8 colour) {
    const auto frame = frame_of(image);
    std::int64_t n = 0;
    for (int y = 0; y < image.height; ++y) {
        for (int x = frame.x + frame.width + 1; x < image.width; ++x) n += pixel_at(image, x, y) == colour;
    }
    return n;
}

/// A level line over 2^0 .. 2^n, of too many points to have markers.
Series level(const std::string& label, double y, int n = 40) {
    Series out{label, {}, {}, {}, {}};
    for (int i = 0; i <= n; ++i) out.x.push_back(std::exp2(i));
    out.y.assign(out.x.size(), y);
    return out;
}

LinePlotSpec spec_of(std::vector<Series> series) {
    LinePlotSpec spec;
    spec.title = "Lost bits";
    spec.x = {"distance", AxisSpec::Scale::log2, {}, {}};
    spec.y = {"lost bits", AxisSpec::Scale::linear, 0.0, 53.0};
    spec.series = std::move(series);
    return spec;
}

image::PngImage plotted(const Scratch& folder, const LinePlotSpec& spec) {
    save_figure(folder / "p.png", draw_line_plot(spec));
    return backend().read_png(folder / "p.png");
}

}  // namespace

TEST_CASE("a horizontal line has its colour in the row of its value", "[line_plot]") {
    const Scratch folder;
    int exact = 0;
    for (const double value : {0.0, 5.0, 10.0, 26.5, 31.0, 42.0, 53.0}) {
        const auto image = plotted(folder, spec_of({level("schoolbook", value)}));
        const auto frame = frame_of(image);
        // Without PlotFrame::pixel_y: its ends are the middles of the tenth pixels from the frame.
        const double place = frame.y + 9.5 + (1 - value / 53) * (frame.height - 19);
        const int row = static_cast<int>(std::floor(place));
        INFO(value << " in row " << row);
        // 1.8 pixels cover a pixel whole whose middle is at most 0.4 away.
        const bool full = std::fabs(place - row - 0.5) < 0.39;
        exact += full;
        int wrong = 0;
        // Except for its first and last pixel, whose corners a round end leaves out.
        for (int x = frame.x + frame.pad + 1; x < frame.x + frame.width - frame.pad - 1; ++x) {
            wrong += full && pixel_at(image, x, row) != first_colour;
            wrong += pixel_at(image, x, row - 2) == first_colour || pixel_at(image, x, row + 2) == first_colour;
        }
        CHECK(wrong == 0);
    }
    CHECK(exact >= 3);
}

TEST_CASE("a NaN leaves a gap in a line", "[line_plot]") {
    const Scratch folder;
    auto series = level("a", 21);
    series.y[20] = no_value;
    const auto image = plotted(folder, spec_of({series}));
    const auto frame = frame_of(image);
    const int row = static_cast<int>(std::floor(frame.pixel_y(21.0 / 53)));
    const auto missing = [&](double from, double to) {
        int n = 0;
        for (int x = static_cast<int>(frame.pixel_x(from / 40)) + 2; x < frame.pixel_x(to / 40) - 2; ++x) {
            n += !tinted(pixel_at(image, x, row));
        }
        return n;
    };
    CHECK(missing(19, 21) >= std::floor(frame.pixel_x(21.0 / 40) - frame.pixel_x(19.0 / 40)) - 4);
    CHECK(missing(10, 19) == 0);
    CHECK(missing(21, 30) == 0);
}

TEST_CASE("equal series share a line and a legend entry, and different ones have distinct styles", "[line_plot]") {
    const Scratch folder;
    auto broken = level("c", 10), twin = level("d", 10);
    broken.y[3] = twin.y[3] = no_value;
    const std::vector<Series> series{level("a", 10), broken, level("b", 10), twin, level("e", 11)};
    const auto lines = plot_lines(series);
    REQUIRE(lines.size() == 3);
    CHECK(lines[0].label == "2 alike: a, b");
    CHECK(lines[1].label == "2 alike: c, d");
    CHECK(lines[2].label == "e");
    CHECK(lines[0].colour == first_colour);
    CHECK(lines[1].colour == second_colour);

    const auto one = plotted(folder, spec_of({level("a", 10), level("a", 10)}));
    CHECK(drawn(one) > 400);
    CHECK(in_legend(one, first_colour) > 10);
    CHECK(in_legend(one, second_colour) == 0);
    CHECK(in_legend(plotted(folder, spec_of({level("a", 10), level("b", 12)})), second_colour) > 10);

    // A form in two formats.
    auto solid = level("f32", 3), dashed = level("f64", 4);
    solid.family = dashed.family = "form";
    dashed.is_dashed = true;
    const auto family = plot_lines(std::vector{level("a", 10), solid, level("b", 12), dashed});
    CHECK((family[1].colour == family[3].colour && family[1].marker == family[3].marker));
    CHECK(family[1].dashes.size() != family[3].dashes.size());
}

TEST_CASE("names are at the ends of their lines, moved as little as possible, with nameless lines last",
          "[line_plot]") {
    const Scratch folder;
    auto low = level("starts high, ends low", 3);
    low.y.front() = 50;
    const auto png = plotted(folder, spec_of({level("nothing", no_value), low, level("high", 50)}));
    const auto frame = frame_of(png);
    const auto sample_row = [&](image::Rgb8 colour) {
        for (int y = 0; y < png.height; ++y) {
            int n = 0;
            for (int x = frame.x + frame.width + 1; x < png.width; ++x) n += pixel_at(png, x, y) == colour;
            if (n > 20) return y;  // the sample of the legend, not the thin line that leads there
        }
        return -1;
    };
    constexpr image::Rgb8 third_colour{0, 158, 115};
    CHECK(std::fabs(sample_row(second_colour) - frame.pixel_y(3.0 / 53)) < 30);  // above the one without a line
    CHECK(std::fabs(sample_row(third_colour) - frame.pixel_y(50.0 / 53)) < 12);
    CHECK(sample_row(second_colour) < sample_row(first_colour));
    CHECK(rim_is_blank(png));
}

TEST_CASE("a shaded range is behind the lines on its part of the axis, and the legend names it", "[line_plot]") {
    const Scratch folder;
    auto spec = spec_of({level("a", 10)});
    const auto bare = plotted(folder, spec);
    spec.shades = {{std::exp2(24), std::exp2(40), "no use"}};
    const auto png = plotted(folder, spec);
    const auto frame = frame_of(png);
    const auto is_shaded = [&](double position) {
        return pixel_at(png, static_cast<int>(frame.pixel_x(position)), frame.y + frame.height / 3) == shade_fill;
    };
    CHECK_FALSE(is_shaded(22.5 / 40));
    CHECK(is_shaded(25.5 / 40));
    CHECK(pixel_at(png, frame.x + frame.width - 1, frame.y + frame.height / 3) == shade_fill);  // up to the frame
    CHECK(in_legend(png, shade_fill) > 100);
    CHECK(in_legend(bare, shade_fill) == 0);
    CHECK(drawn(png) > 400);
    // Notes below the plot take room from it.
    spec.notes = {"A gap in a line."};
    CHECK(frame_of(plotted(folder, spec)).height < frame.height);
}

TEST_CASE("marks are at their positions and their labels do not overlap", "[line_plot]") {
    const Scratch folder;
    std::vector<MarkLabels::Mark> marks;
    for (const double x : {100.0, 104.0, 130.0, 390.0, 150.0}) marks.push_back({x, "2^12: a label that is long"});
    const MarkLabels labels_of_marks(marks, 420);
    image::Canvas canvas(440, 400);
    labels_of_marks.draw(canvas, 300, 390);
    std::int64_t alone = 0;  // ink of the labels, each on a page of its own
    for (const auto& mark : marks) {
        image::Canvas one(440, 400);
        MarkLabels({mark}, 420).draw(one, 300, 390);
        const auto pixels = one.pixels();
        alone += std::ranges::count(pixels, image::style::ink);
    }
    const auto pixels = canvas.pixels();
    CHECK(std::ranges::count(pixels, image::style::ink) == alone);  // nothing is over anything
    for (const auto& mark : marks) {
        const int x = static_cast<int>(mark.x);
        CHECK(std::min(pixel_at(canvas, x, 386).r, pixel_at(canvas, x, 382).r) < 128);  // a dash, or its round end
    }

    auto spec = spec_of({level("a", 10)});
    spec.marks = {{std::exp2(12), "onset"}};
    const auto image = plotted(folder, spec);
    const auto frame = frame_of(image);
    const int x = static_cast<int>(std::floor(frame.pixel_x(12.0 / 40)));
    int dark = 0;
    for (int y = frame.y; y < frame.y + frame.height; ++y) dark += pixel_at(image, x, y) == image::style::soft_ink;
    CHECK(dark > frame.height / 3);
    CHECK(dark < frame.height * 9 / 10);
}

TEST_CASE("a line plot never cuts anything off, and its bytes are reproducible", "[line_plot]") {
    const Scratch folder;
    const std::string sentence = "a label with more words in it than any legend has room for, and then 2^10 more";
    for (const int count : {0, 1, 45, 120}) {
        INFO(count << " series");
        LinePlotSpec spec = spec_of({});
        spec.title = sentence + sentence;
        spec.subtitle = {sentence + sentence + sentence};
        spec.x.title = spec.y.title = sentence + sentence + sentence;
        for (int i = 0; i < count; ++i) spec.series.push_back(level(i % 3 == 0 ? sentence : "short", i / 2.0));
        spec.envelope = level(sentence, 3);
        spec.marks = {{1, sentence}, {std::exp2(12), sentence}, {std::exp2(39.9), sentence}, {std::exp2(40), "W"}};
        const auto image = plotted(folder, spec);
        CHECK(rim_is_blank(image));
        CHECK(image.width == spec.width);
        CHECK(image.height >= spec.height);
        save_figure(folder / "again.png", draw_line_plot(spec));
        CHECK(contents(folder / "p.png") == contents(folder / "again.png"));
    }
    CHECK(plotted(folder, spec_of({level("a", 3)})).height == 620);
}

TEST_CASE("the envelope is grey below its line and page-coloured above", "[line_plot]") {
    const Scratch folder;
    auto spec = spec_of({});
    spec.envelope = level("conditioning", 25);
    const auto image = plotted(folder, spec);
    const auto frame = frame_of(image);
    const int x = static_cast<int>(frame.pixel_x(0.52)), edge = static_cast<int>(frame.pixel_y(25.0 / 53));
    CHECK(pixel_at(image, x, edge - 5) == image::style::background);
    CHECK(pixel_at(image, x, edge + 5) == envelope_fill);
    CHECK(pixel_at(image, x, frame.y + frame.height - 1) == envelope_fill);
    CHECK(in_legend(image, envelope_fill) > 200);
}

TEST_CASE("degenerate series are drawn as far as possible", "[line_plot]") {
    const Scratch folder;
    using Scale = AxisSpec::Scale;
    const auto draw = [&](Series series, Scale x, Scale y) {
        LinePlotSpec spec;
        spec.x.scale = x;
        spec.y.scale = y;
        spec.series = {std::move(series)};
        const auto image = plotted(folder, spec);
        CHECK(rim_is_blank(image));
        return image;
    };
    for (const auto scale : {Scale::linear, Scale::log2, Scale::log10}) {
        const auto inked = [&](const Series& series) { return drawn(draw(series, scale, scale)); };
        CHECK(inked({"a point", {3}, {7}, {}, {}}) > 15);
        CHECK(inked({"one x", {3, 3}, {7, 9}, {}, {}}) > 200);
        CHECK(inked({"constant", {1, 2}, {7, 7}, {}, {}}) > 600);
        CHECK(inked({"nothing", {}, {}, {}, {}}) == 0);
        CHECK(inked({"all NaN", {1, 2}, {no_value, no_value}, {}, {}}) == 0);
        CHECK(inked({"no x", {no_value, inf}, {1, 2}, {}, {}}) == 0);
        CHECK(inked({"only infinite", {3}, {inf}, {}, {}}) > 10);
        CHECK(inked({"a band that leaves", {1, 2}, {7, 7}, {-inf, 0}, {inf, no_value}}) > 300);
        CHECK(inked({"extremes", {1, 2}, {1e308, 5e-324}, {}, {}}) > 100);
    }
    // A triangle at the edge; nothing of the kind for a finite value.
    const auto up = draw({"up", {1, 2, 3}, {1, inf, 1}, {}, {}}, Scale::linear, Scale::linear);
    const auto frame = frame_of(up);
    const int x = static_cast<int>(frame.pixel_x(0.5));
    CHECK(pixel_at(up, x, frame.y + 4) == first_colour);
    // A value that a log axis cannot show becomes a gap and a footnote, which makes the frame lower.
    const auto gap = draw({"zero", {1, 2, 3}, {1, 0, 1}, {}, {}}, Scale::linear, Scale::log2);
    CHECK(drawn(gap) < 100);
    const auto whole = draw({"none", {1, 2, 3}, {1, 1, 1}, {}, {}}, Scale::linear, Scale::log2);
    CHECK(frame_of(gap).height < frame_of(whole).height);

    CHECK_THROWS_AS(plotted(folder, spec_of({{"uneven", {1, 2}, {1}, {}, {}}})), std::invalid_argument);
    CHECK_THROWS_AS(plotted(folder, spec_of({{"half a band", {1}, {1}, {1}, {}}})), std::invalid_argument);
}

}  // namespace test_plots
