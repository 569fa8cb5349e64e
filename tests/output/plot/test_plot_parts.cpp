#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <set>

#include "catch.hpp"
#include "output/helpers.hpp"
#include "output/image/canvas.hpp"
#include "output/image/pixels.hpp"
#include "output/plot/line_plot_parts.hpp"
#include "output/plot/plot_axis.hpp"

namespace test_plot_parts {

using namespace lostbits::output;
using namespace lostbits::output::image;
using namespace lostbits::output::plot;
using test::pixel_at;

namespace {

constexpr double inf = std::numeric_limits<double>::infinity();
constexpr double no_value = std::numeric_limits<double>::quiet_NaN();

std::vector<std::string> labels(const AxisRange& range, int most) {
    std::vector<std::string> out;
    for (const auto& tick : range.ticks(most)) {
        if (!tick.label.empty()) out.push_back(tick.label);
    }
    return out;
}

}  // namespace

TEST_CASE("ticks are round values at their positions", "[plot]") {
    using Scale = AxisSpec::Scale;
    using Labels = std::vector<std::string>;
    CHECK(labels(AxisRange({"", Scale::log2, 1.0, std::exp2(30)}, {}), 8) ==
          Labels{"2^0", "2^4", "2^8", "2^12", "2^16", "2^20", "2^24", "2^28"});
    CHECK(labels(AxisRange({"", Scale::log2, {}, {}}, {0.125, 4.0}), 8) ==
          Labels{"2^-3", "2^-2", "2^-1", "2^0", "2^1", "2^2"});
    CHECK(labels(AxisRange({"", Scale::log10, {}, {}}, {1e-3, 2e2}), 8) ==
          Labels{"10^-3", "10^-2", "10^-1", "10^0", "10^1", "10^2"});
    // Less than two powers between the ends: the ticks are plain numbers, at their positions on the log scale.
    const AxisRange narrow({"", Scale::log2, 2.2, 3.9}, {});
    CHECK(labels(narrow, 4) == Labels{"2.5", "3", "3.5"});
    CHECK(narrow.ticks(4)[1].position == Approx(narrow.position(3)));
    CHECK(labels(AxisRange({"", Scale::log10, 2e7, 6e7}, {}), 4).front().starts_with("10^"));
    CHECK(labels(AxisRange({"", Scale::linear, 0.0, 53.0}, {}), 8) == Labels{"0", "10", "20", "30", "40", "50"});
    CHECK(labels(AxisRange({"", Scale::linear, 1000000.0, 1000000.5}, {}), 5) ==
          Labels{"1000000", "1000000.1", "1000000.2", "1000000.3", "1000000.4", "1000000.5"});
    const AxisRange range({"", Scale::log2, 1.0, std::exp2(30)}, {});
    CHECK(range.position(std::exp2(15)) == 0.5);
    CHECK(range.ticks(8)[1].position == Approx(4.0 / 30));
    CHECK(range.position(inf) == 1);
    CHECK_FALSE(range.can_show(0));
    CHECK_FALSE(range.can_show(no_value));
}

TEST_CASE("on a log axis 0 has a position below the low end, and times are decimals", "[plot]") {
    using Scale = AxisSpec::Scale;
    using Labels = std::vector<std::string>;
    const AxisRange shares({"", Scale::log10, 1e-3, 1.0, true}, {0, 0.5});
    CHECK(shares.can_show(0));
    CHECK_FALSE(shares.can_show(-1e-9));
    CHECK_FALSE(shares.can_show(no_value));
    CHECK(shares.position(0) == 0);
    // The first miss of a thousand rays is visible: well above zero.
    CHECK(shares.position(1e-3) > 0.05);
    CHECK(shares.position(1) == 1);
    CHECK(labels(shares, 8) == Labels{"0", "10^-3", "10^-2", "10^-1", "10^0"});
    CHECK_FALSE(AxisRange({"", Scale::log10, 1e-3, 1.0}, {}).can_show(0));
    // The ends follow from what is positive.
    CHECK(AxisRange({"", Scale::log10, {}, {}, true}, {0, 0.01, 1}).position(0.01) == Approx(shares.position(1e-3)));

    CHECK(labels(AxisRange({"", Scale::log2, 0.25, 64.0, false, true}, {}), 12) ==
          Labels{"0.25", "0.5", "1", "2", "4", "8", "16", "32", "64"});
    CHECK(labels(AxisRange({"", Scale::log10, 0.01, 100.0, false, true}, {}), 8) ==
          Labels{"0.01", "0.1", "1", "10", "100"});
}

TEST_CASE("an axis fits its data, and reaches the largest possible value only if they come near", "[plot]") {
    using Labels = std::vector<std::string>;
    const AxisSpec bits{"", AxisSpec::Scale::linear, 0.0, {}, false, false, 24};
    const AxisRange low(bits, {0, 1, 3.5}), nothing(bits, {0, 0}), high(bits, {0, 20});
    CHECK(low.position(3.5) == 1);
    CHECK_FALSE(low.limit_position());
    CHECK(nothing.position(2) == Approx(1));  // a twelfth of all, so that a hundredth of a bit looks small
    CHECK(high.position(24) == 1);
    CHECK(high.limit_position() == 1.0);
    CHECK(labels(high, 8) == Labels{"0", "5", "10", "15", "20", "24"});
    // A round value that would touch the label of the limit is left out.
    CHECK(labels(AxisRange({"", AxisSpec::Scale::linear, 0.0, {}, false, false, 53}, {50}), 6) ==
          Labels{"0", "10", "20", "30", "40", "53"});
}

TEST_CASE("every range has distinct ticks that lie on it", "[plot]") {
    using Scale = AxisSpec::Scale;
    const double huge = std::numeric_limits<double>::max(), tiny = std::numeric_limits<double>::denorm_min();
    const std::vector<std::vector<double>> data{
        {},     {no_value, inf},           {7},          {0},       {-3, -3}, {huge, -huge}, {huge},
        {tiny}, {1, std::nextafter(1, 2)}, {tiny, huge}, {0, 1e-9}, {1e-20},  {5, 5.0001},   {0, 1, no_value}};
    for (const auto scale : {Scale::linear, Scale::log2, Scale::log10}) {
        for (const auto& values : data) {
            const AxisRange range({"", scale, {}, {}}, values);
            const auto text = labels(range, 6);
            INFO(static_cast<int>(scale) << ": " << (values.empty() ? 0 : values[0]));
            CHECK(text.size() >= 2);
            CHECK(text.size() <= 9);
            CHECK(std::set<std::string>(text.begin(), text.end()).size() == text.size());
            for (const auto& tick : range.ticks(6)) {
                CHECK(tick.position >= -1e-6);
                CHECK(tick.position <= 1 + 1e-6);
            }
        }
    }
    CHECK_THROWS_AS(AxisRange({"", Scale::log2, 0.0, {}}, {}), std::invalid_argument);
    CHECK_THROWS_AS(AxisRange({"", Scale::linear, 2.0, 2.0}, {}), std::invalid_argument);
    CHECK_THROWS_AS(AxisRange({"", Scale::linear, {}, inf}, {}), std::invalid_argument);
}

TEST_CASE("labels keep their order and do not overlap", "[plot]") {
    using Places = std::vector<double>;
    const Places tens(3, 10.0);
    CHECK(positions_near(Places{5, 40, 90}, tens, 0, 200) == Places{5, 40, 90});
    // Three labels that want the same position: the middle one gets it.
    CHECK(positions_near(Places{50, 50, 50}, tens, 0, 200) == Places{40, 50, 60});
    CHECK(positions_near(Places{0, 0, 100}, tens, 0, 200) == Places{0, 10, 100});
    CHECK(positions_near(Places{500, 500, 500}, tens, 0, 100) == Places{70, 80, 90});
    // Too little space for all: one below the other from the top.
    CHECK(positions_near(Places{3, 3, 3}, tens, 0, 20) == Places{0, 10, 20});
    CHECK(positions_near(Places{}, Places{}, 0, 20).empty());
}

namespace {

/// True if a black figure covers about half of a white pixel: Cairo samples a pixel on 15 lines.
bool is_half(Rgb8 p) { return p.r == p.g && p.g == p.b && std::abs(p.r - 128) <= 9; }

}  // namespace

TEST_CASE("coverage is exact on the pixel grid and not doubled at joints", "[plot]") {
    Canvas canvas(20, 9, {255, 255, 255});
    Stroke stroke({0, 0, 20, 9});
    const std::vector<Point> line{{-5, 4.5}, {10, 4.5}, {25, 4.5}};
    stroke.polyline(line, 2);
    stroke.paint(canvas, {});
    for (int x = 0; x < 20; ++x) {
        CHECK(pixel_at(canvas, x, 4) == Rgb8{});
        CHECK(is_half(pixel_at(canvas, x, 3)));
        CHECK(is_half(pixel_at(canvas, x, 5)));
        CHECK(pixel_at(canvas, x, 2) == Rgb8{255, 255, 255});
        CHECK(pixel_at(canvas, x, 3) == pixel_at(canvas, 0, 3));  // at the joint as elsewhere
    }
    // A second coat of nothing changes nothing.
    const std::vector<Rgb8> before = canvas.pixels();
    stroke.paint(canvas, {255, 0, 0});
    CHECK((before == canvas.pixels()));

    Canvas filled(4, 4, {255, 255, 255});
    Stroke area({0, 0, 4, 4});
    const std::vector<Point> above{{1, 1.5}, {2, 1.5}, {3, 1.5}}, below{{1, 9}, {2, 9}, {3, 9}};
    area.area(above, below);
    area.paint(filled, {});
    CHECK(pixel_at(filled, 1, 0) == Rgb8{255, 255, 255});
    CHECK(is_half(pixel_at(filled, 1, 1)));
    CHECK(pixel_at(filled, 2, 3) == Rgb8{});
    CHECK(pixel_at(filled, 0, 3) == Rgb8{255, 255, 255});
    CHECK(pixel_at(filled, 3, 3) == Rgb8{255, 255, 255});
}

TEST_CASE("a marker is visible where it is, and nothing is drawn outside the box", "[plot]") {
    const auto drawn = [](const PixelBox& box, double at) {
        Canvas canvas(40, 40, {255, 255, 255});
        Stroke stroke(box);
        stroke.disc({at, at}, 3);
        // Far outside, as a line beyond the end of an axis is.
        const std::array<Point, 2> away{{{at, at}, {at, 1e6}}};
        stroke.polyline(away, 1);
        const std::array<Point, 3> corner{{{30, 5}, {36, 5}, {33, 11}}};
        stroke.polygon(corner);
        stroke.paint(canvas, {}, 0.5);
        return canvas;
    };
    const Canvas whole = drawn({0, 0, 40, 40}, 10.5), part = drawn({0, 0, 40, 20}, 10.5);
    CHECK(is_half(pixel_at(whole, 10, 10)));  // by its opacity
    CHECK(is_half(pixel_at(whole, 10, 39)));
    CHECK(is_half(pixel_at(whole, 33, 7)));
    CHECK(pixel_at(whole, 38, 7) == Rgb8{255, 255, 255});
    const auto above = [](const Canvas& canvas) {
        auto pixels = canvas.pixels();
        pixels.resize(40 * 20);
        return pixels;
    };
    CHECK((above(whole) == above(part)));
    const auto all = part.pixels();
    CHECK(std::all_of(all.begin() + 40 * 20, all.end(), [](Rgb8 p) { return p == Rgb8{255, 255, 255}; }));
}

}  // namespace test_plot_parts
