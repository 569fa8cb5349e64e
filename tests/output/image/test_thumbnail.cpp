#include <algorithm>
#include <array>
#include <cmath>
#include <random>

#include "catch.hpp"
#include "output/image/contact_sheet.hpp"

namespace test_thumbnail {

using namespace lostbits::output;
using namespace lostbits::output::image;

TEST_CASE("a thumbnail averages in linear light, exactly and in any order of rows", "[thumbnail]") {
    std::vector<Rgb8> board;
    for (int y = 0; y < 320; ++y) {
        for (int x = 0; x < 640; ++x) board.push_back((x + y) % 2 == 0 ? Rgb8{255, 255, 255} : Rgb8{});
    }
    Thumbnail grey(640, 320);
    grey.add_rows(0, board);
    CHECK(grey.width() == 160);
    CHECK(grey.height() == 80);
    CHECK(std::ranges::all_of(grey.pixels(), [](Rgb8 p) { return p == Rgb8{188, 188, 188}; }));  // not 128

    std::mt19937 random(1);
    std::vector<Rgb8> noise(static_cast<std::size_t>(333 * 211));
    for (auto& p : noise) p = {static_cast<std::uint8_t>(random()), static_cast<std::uint8_t>(random()), 7};
    Thumbnail down(333, 211), up(333, 211);
    for (int y = 0; y < 211; ++y) down.add_rows(y, std::span(noise).subspan(static_cast<std::size_t>(y) * 333, 333));
    for (int y = 210; y >= 0; --y) up.add_rows(y, std::span(noise).subspan(static_cast<std::size_t>(y) * 333, 333));
    CHECK((down.pixels() == up.pixels()));
    // Against the definition: the mean over the pixel's exact area, in floating point.
    for (const auto& [i, j] : {std::pair{0, 0}, std::pair{159, 100}, std::pair{80, 50}}) {
        double sum = 0, weight = 0;
        for (int y = 0; y < 211; ++y) {
            for (int x = 0; x < 333; ++x) {
                const auto part = [](double a, double b, double c, double d) {
                    return std::max(0.0, std::min(b, d) - std::max(a, c));
                };
                const double w = part(x, x + 1, i * 333.0 / 160, (i + 1) * 333.0 / 160) *
                                 part(y, y + 1, j * 211.0 / down.height(), (j + 1) * 211.0 / down.height());
                sum += w * linear_light(noise[y * 333 + x].r);
                weight += w;
            }
        }
        const Rgb8 got = down.pixels()[j * 160 + i];
        CHECK(std::abs(got.r - srgb_byte(static_cast<std::uint16_t>(std::lround(sum / weight)))) <= 1);
        CHECK(got.b == 7);
    }
}

TEST_CASE("a thumbnail of categories has only colours of the field", "[thumbnail]") {
    const std::array<Rgb8, 3> names{Rgb8{200, 0, 0}, Rgb8{0, 0, 200}, Rgb8{0, 150, 0}};
    for (const auto& size : {std::pair{333, 211}, {161, 160}, {1024, 3}, {160, 400}}) {
        const int width = size.first, height = size.second;
        INFO(width << " x " << height);
        std::vector<Rgb8> field;
        for (int y = 0; y < height; ++y) {
            for (int x = 0; x < width; ++x) field.push_back(names[(7 * x + 5 * y) % 3]);
        }
        Thumbnail down(width, height, Thumbnail::Shrink::pick), up(width, height, Thumbnail::Shrink::pick);
        const auto row = [&](int y) {
            const auto w = static_cast<std::size_t>(width);
            return std::span(field).subspan(static_cast<std::size_t>(y) * w, w);
        };
        for (int y = 0; y < height; ++y) down.add_rows(y, row(y));
        for (int y = height - 1; y >= 0; --y) up.add_rows(y, row(y));
        CHECK((down.pixels() == up.pixels()));
        // Every pixel is the sample at its middle.
        for (int j = 0; j < down.height(); ++j) {
            for (int i = 0; i < down.width(); ++i) {
                const int x = (2 * i + 1) * width / (2 * down.width()), y = (2 * j + 1) * height / (2 * down.height());
                if (down.pixels()[j * down.width() + i] != field[y * width + x]) FAIL_CHECK(i << ", " << j);
            }
        }
    }
}

TEST_CASE("thumbnails of unusual shapes are right", "[thumbnail]") {
    const auto size = [](int w, int h) {
        Thumbnail t(w, h);
        t.add_rows(0, std::vector<Rgb8>(static_cast<std::size_t>(w) * static_cast<std::size_t>(h), Rgb8{9, 8, 7}));
        CHECK(std::ranges::all_of(t.pixels(), [](Rgb8 p) { return p == Rgb8{9, 8, 7}; }));
        return std::pair(t.width(), t.height());
    };
    CHECK(size(64, 64) == std::pair(128, 128));
    CHECK(size(1, 1) == std::pair(160, 160));
    CHECK(size(1024, 1) == std::pair(160, 1));
    CHECK(size(1, 5000) == std::pair(1, 160));
    CHECK(size(161, 160) == std::pair(160, 159));
    CHECK(size(256, 1024) == std::pair(40, 160));
    Thumbnail t(10, 10);
    CHECK_THROWS_AS(t.add_rows(0, std::vector<Rgb8>(11)), std::logic_error);
    CHECK_THROWS_AS(t.add_rows(9, std::vector<Rgb8>(20)), std::logic_error);
    CHECK_THROWS_AS(t.add_rows(-1, std::vector<Rgb8>(10)), std::logic_error);
    CHECK_THROWS_AS(t.pixels(), std::logic_error);
}

}  // namespace test_thumbnail
