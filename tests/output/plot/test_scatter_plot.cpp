#include "output/image/figure.hpp"
#include "output/plot/scatter_plot.hpp"

#include <cmath>
#include <limits>
#include <random>

#include "catch.hpp"
#include "output/helpers.hpp"
#include "output/image/pixels.hpp"
#include "output/plot/label_placement.hpp"

namespace test_scatter_plot {

using namespace lostbits::output;
using namespace lostbits::output::image;
using namespace lostbits::output::plot;
using namespace lostbits::output::test;

namespace {

constexpr Rgb8 first{0, 114, 178}, second{213, 94, 0}, grey{186, 186, 188};

ScatterPlotSpec small() {
    ScatterPlotSpec spec;
    spec.title = "A trade";
    spec.x = {"time", AxisSpec::Scale::log2, {}, {}};
    spec.y = {"bits", AxisSpec::Scale::linear, 0.0, {}};
    spec.points = {
        {.x = 1, .y = 10, .x_low = 0.9, .x_high = 1.1, .marker = 1, .label = "one"},
        {.x = 4, .y = 20, .x_low = 3.5, .x_high = 5, .marker = 3, .colour = 1, .is_hollow = true, .label = "four"},
        {.x = 6, .y = 5, .x_low = 6, .x_high = 6, .is_faint = true}};
    spec.pareto_front = {{1, 10, true}, {4, 20, false}};
    spec.legend = {{"f32", 0, 0}, {"dominated", 0, 0, true}};
    return spec;
}

PngImage plotted(const Scratch& folder, const ScatterPlotSpec& spec) {
    save_figure(folder / "s.png", draw_scatter_plot(spec));
    return backend().read_png(folder / "s.png");
}

/// The leftmost column that has at least this many pixels of a colour, above the legend.
int column_of(const PngImage& image, Rgb8 colour, int least) {
    for (int x = 0; x < image.width; ++x) {
        int n = 0;
        for (int y = 0; y < image.height - 60; ++y) n += pixel_at(image, x, y) == colour;
        if (n >= least) return x;
    }
    return -1;
}

}  // namespace

TEST_CASE("labels never cover other labels or occupied space", "[scatter_plot]") {
    std::mt19937_64 random(1);
    const auto unit = [&random] { return static_cast<double>(random() >> 11) * 0x1p-53; };
    std::size_t placed = 0, requested = 0;
    for (int round = 0; round < 200; ++round) {
        std::vector<LabelRequest> requests;
        std::vector<LabelBox> taken, avoided;
        for (int i = 0; i < 12; ++i) {
            // Half of them crowded into a corner.
            const double reach = i % 2 == 0 ? 600 : 60;
            const Point at{20 + reach * unit(), 20 + reach * unit()};
            requests.push_back({at, 40 + 60 * unit(), 14});
            taken.push_back({at.x - 5, at.y - 5, 10, 10});
            avoided.push_back({600 * unit(), 600 * unit(), 10, 10});
        }
        const LabelBox limits{0, 0, 640, 640};
        const auto places = place_labels(requests, {limits, taken, avoided});
        REQUIRE(places.size() == requests.size());
        requested += requests.size();
        for (std::size_t i = 0; i < places.size(); ++i) {
            if (!places[i]) continue;
            ++placed;
            CHECK(places[i]->width == requests[i].width);
            CHECK(limits.contains(*places[i]));
            for (const LabelBox& t : taken) CHECK_FALSE(places[i]->overlaps(t));
            for (std::size_t j = 0; j < i; ++j) CHECK_FALSE((places[j] && places[i]->overlaps(*places[j])));
        }
    }
    CHECK(placed > requested * 9 / 10);
}

TEST_CASE("a line to a label crosses another one only if it must", "[scatter_plot]") {
    // The first label fits only into a corridor, 130 to the right. The second is nearer to the upper end of the
    // occupied space than to the lower one, but the line upwards would cross that of the first.
    const std::vector<LabelBox> taken{{24, -20, 116, 260}, {140, -20, 260, 114}, {140, 106, 260, 134}};
    const std::vector<LabelRequest> requests{{{20, 100}, 40, 10}, {{80, 104}, 30, 10}};
    const LabelBox limits{10, -100, 400, 500};
    const auto both = place_labels(requests, {limits, taken, {}});
    REQUIRE((both[0] && both[1]));
    CHECK(both[0]->x == Approx(150));
    CHECK(both[1]->y > 240);
    const auto second = place_labels({&requests[1], 1}, {limits, taken, {}});
    REQUIRE(second[0].has_value());
    CHECK(second[0]->y < -20);
}

TEST_CASE("a label is beside its point where it covers least, and left out where there is no space", "[scatter_plot]") {
    const LabelBox limits{0, 0, 300, 100};
    const LabelRequest request{{150, 50}, 50, 14};
    const auto free = place_labels({&request, 1}, {limits, {}, {}});
    REQUIRE(free[0].has_value());
    const Point near = free[0]->nearest(request.point);
    CHECK(std::hypot(near.x - 150, near.y - 50) == Approx(6));
    const LabelBox right{151, 0, 149, 100};
    const auto left = place_labels({&request, 1}, {limits, {}, {&right, 1}});
    REQUIRE(left[0].has_value());
    CHECK_FALSE(left[0]->overlaps(right));
    // A grey point everywhere within 60 pixels: the name goes to a free place, however far away.
    std::vector<LabelBox> points;
    for (int x = 60; x < 240; x += 8) points.push_back({static_cast<double>(x), 0, 8, 100});
    const LabelRequest narrow{{150, 50}, 20, 14};
    const auto far = place_labels({&narrow, 1}, {limits, {}, points});
    REQUIRE(far[0].has_value());
    for (const auto& point : points) CHECK_FALSE(far[0]->overlaps(point));
    const auto none = place_labels({&request, 1}, {limits, {&limits, 1}, {}});
    CHECK_FALSE(none[0].has_value());
    const auto nowhere = place_labels({&request, 1}, {{0, 0, 40, 100}, {}, {}});
    CHECK_FALSE(nowhere[0].has_value());
}

TEST_CASE("a scatter plot shows points, names and the Pareto front where they belong", "[scatter_plot]") {
    const Scratch folder;
    const auto image = plotted(folder, small());
    CHECK(rim_is_blank(image));
    // Time runs from left to right: the first colour's square, the other's diamond, the grey disc.
    const int blue = column_of(image, first, 5), red = column_of(image, second, 4), faint = column_of(image, grey, 4);
    REQUIRE((blue > 0 && red > 0 && faint > 0));
    CHECK(blue < red);
    CHECK(red < faint);
    save_figure(folder / "again.png", draw_scatter_plot(small()));
    CHECK(contents(folder / "s.png") == contents(folder / "again.png"));
    auto without = small();
    for (auto& p : without.points) p.label.clear();
    CHECK(count_of(plotted(folder, without), first) < count_of(image, first));
    without.pareto_front.clear();
    const auto bare = plotted(folder, without);
    CHECK(bare.width == image.width);
    CHECK(count_of(bare, {120, 120, 126}) < count_of(image, {120, 120, 126}));
}

TEST_CASE("a point without a value is left out and counted", "[scatter_plot]") {
    const Scratch folder;
    auto spec = small();
    const auto with = plotted(folder, spec);
    spec.points.push_back(
        {.x = 3, .y = std::numeric_limits<double>::quiet_NaN(), .x_low = 3, .x_high = 3, .colour = 1, .label = "lost"});
    const auto image = plotted(folder, spec);
    CHECK(image.width == with.width);
    CHECK(image.pixels != with.pixels);
    CHECK(count_of(image, second) == count_of(with, second));
    spec.points.clear();
    spec.pareto_front.clear();
    CHECK(plotted(folder, spec).width == with.width);
}

}  // namespace test_scatter_plot
