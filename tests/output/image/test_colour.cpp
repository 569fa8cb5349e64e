// Colours: scales and their ticks, and classes that every eye can tell apart. Between any two classes of one picture,
// CIEDE2000 is at least 25 for an ordinary eye, a deuteranope's and a protanope's.
#include <array>
#include <cmath>
#include <limits>
#include <span>
#include <string>

#include "catch.hpp"
#include "measure/answer/outcome.hpp"
#include "number/error.hpp"
#include "output/helpers.hpp"
#include "output/image/colour.hpp"
#include "output/image/eyes.hpp"
#include "output/map/bits_needed_files.hpp"
#include "output/map/map_colour.hpp"
#include "output/render/render_files.hpp"

namespace test_colour {

using namespace lostbits::output;
using namespace lostbits::output::image;
using namespace lostbits::output::map;
using namespace lostbits::output::test;
using lostbits::measure::answer::Outcome;

namespace {

/// Ottosson's OKLab.
Vector oklab(const Vector& c) {
    const double l = std::cbrt(0.4122214708 * c[0] + 0.5363325363 * c[1] + 0.0514459929 * c[2]);
    const double m = std::cbrt(0.2119034982 * c[0] + 0.6806995451 * c[1] + 0.1073969566 * c[2]);
    const double s = std::cbrt(0.0883024619 * c[0] + 0.2817188376 * c[1] + 0.6299787005 * c[2]);
    return {0.2104542553 * l + 0.7936177850 * m - 0.0040720468 * s,
            1.9779984951 * l - 2.4285922050 * m + 0.4505937099 * s,
            0.0259040371 * l + 0.7827717662 * m - 0.8086757660 * s};
}

double distance(const Vector& a, const Vector& b) { return std::hypot(a[0] - b[0], a[1] - b[1], a[2] - b[2]); }

std::vector<Rgb8> grey_ramp() {
    std::vector<Rgb8> out;
    for (int i = 0; i < 101; ++i) out.push_back(Rgb8{static_cast<std::uint8_t>(i), 0, 0});
    return out;
}

}  // namespace

TEST_CASE("colour ramps rise from dark to light and match the published ones", "[colour]") {
    const auto viridis = backend().ramp("viridis", 256);
    REQUIRE(viridis.size() == 256);
    const auto near = [](Rgb8 a, Rgb8 b) {
        return std::abs(a.r - b.r) <= 2 && std::abs(a.g - b.g) <= 2 && std::abs(a.b - b.b) <= 2;
    };
    // matplotlib's ends and middle, in sRGB: a ramp left in linear light fails here.
    CHECK(near(viridis.front(), {68, 1, 84}));
    CHECK(near(viridis[128], {33, 145, 140}));
    CHECK(near(viridis.back(), {253, 231, 37}));
    for (const auto* name : {"viridis", "inferno", "magma", "plasma"}) {
        const auto ramp = backend().ramp(name, 64);
        for (std::size_t i = 1; i < ramp.size(); ++i) {
            INFO(name << " step " << i);
            CHECK(oklab(linear(ramp[i]))[0] > oklab(linear(ramp[i - 1]))[0]);
        }
    }
    CHECK(backend().ramp("turbo", 3)[0] != backend().ramp("turbo", 3)[1]);
    CHECK_THROWS_AS(backend().ramp("jet", 3), lostbits::InputError);
}

TEST_CASE("the colours of outcomes and of insufficient widths differ from those of values", "[colour]") {
    const auto drawn =
        std::span(outcome_colours).first(lostbits::measure::answer::outcome_count_without_mesh).subspan(1);
    const auto ramp = backend().ramp("viridis", 256);
    // 0.02 is a just noticeable difference in OKLab: five of them at the very least, for every eye.
    for (const auto& [eye, least] : {std::pair{&any_eye, 0.15}, {&deuteranope, 0.10}}) {
        const auto check_apart = [&, eye = eye, least = least](Rgb8 one, std::span<const Rgb8> others) {
            for (const Rgb8 other : others) {
                INFO(int(one.r) << ' ' << int(one.g) << ' ' << int(one.b) << " against " << int(other.r) << ' '
                                << int(other.g) << ' ' << int(other.b));
                CHECK(distance(oklab(eye(linear(one))), oklab(eye(linear(other)))) > least);
            }
        };
        for (const Rgb8 outcome : drawn) check_apart(outcome, ramp);
        check_apart(beyond_colour, ramp);
        check_apart(beyond_colour, outcome_colours);
    }
    // In grey the drawn outcomes still differ.
    for (const Rgb8& one : drawn)
        for (const Rgb8& other : drawn)
            CHECK((&one == &other || std::abs(oklab(linear(one))[0] - oklab(linear(other))[0]) > 0.07));
}

TEST_CASE("a thousand categories have distinct colours, the first of them the clearest", "[colour]") {
    std::vector<Vector> seen;
    for (const Rgb8 c : outcome_colours) seen.push_back(oklab(linear(c)));
    for (std::size_t i = 0; i < 1000; ++i) {
        const Vector mine = oklab(linear(distinct_colour(i)));
        // 0.02 is a just noticeable difference. Agreed hits have no colour of their own beside categories.
        const double least = i < 60 ? 0.06 : i < 200 ? 0.04 : 0.02;
        for (std::size_t j = 1; j < seen.size(); ++j) {
            INFO(i << " against " << j);
            if (distance(mine, seen[j]) <= least) FAIL_CHECK(distance(mine, seen[j]));
        }
        seen.push_back(mine);
    }
    CHECK(distinct_colour(1000) == distinct_colour(0));
}

TEST_CASE("a colour scale clamps its values and refuses a value that has no colour", "[colour]") {
    const double inf = std::numeric_limits<double>::infinity();
    const ColourScale scale("grey", grey_ramp(), 0, 24);
    CHECK(scale.colour_of_value(0) == Rgb8{0, 0, 0});
    CHECK(scale.colour_of_value(12) == Rgb8{50, 0, 0});
    CHECK(scale.colour_of_value(-1) == Rgb8{0, 0, 0});
    CHECK(scale.colour_of_value(inf) == Rgb8{100, 0, 0});
    CHECK(scale.colour_of_value(-inf) == Rgb8{0, 0, 0});
    CHECK_THROWS_AS(scale.colour_of_value(std::nan("")), std::invalid_argument);
    const ColourScale log("grey", grey_ramp(), 1, 16, Spacing::log2);
    CHECK(log.colour_of_value(4) == Rgb8{50, 0, 0});
    CHECK(log.colour_of_value(0) == Rgb8{0, 0, 0});
    CHECK(log.colour_of_value(-3) == Rgb8{0, 0, 0});
    const ColourScale wide("grey", grey_ramp(), -1.7e308, 1.7e308);
    CHECK(wide.colour_of_value(0) == Rgb8{50, 0, 0});
    CHECK_THROWS_AS(ColourScale("grey", grey_ramp(), 1, 1), std::invalid_argument);
    CHECK_THROWS_AS(ColourScale("grey", grey_ramp(), 0, inf), std::invalid_argument);
    CHECK_THROWS_AS(ColourScale("grey", grey_ramp(), 0, 1, Spacing::log2), std::invalid_argument);
    CHECK_THROWS_AS(ColourScale("grey", {Rgb8{}}, 0, 1), std::invalid_argument);
    const ColourScale root("grey", grey_ramp(), 0, 16, Spacing::root);
    CHECK(root.colour_of_value(4) == Rgb8{50, 0, 0});
    CHECK(root.colour_of_value(-1) == Rgb8{0, 0, 0});
    CHECK(root.colour_of_value(inf) == Rgb8{100, 0, 0});
    CHECK_THROWS_AS(ColourScale("grey", grey_ramp(), -1, 1, Spacing::root), std::invalid_argument);
    CHECK(root.is_same_scale(ColourScale("grey", grey_ramp(), 0, 16, Spacing::root)));
    CHECK_FALSE(root.is_same_scale(ColourScale("grey", grey_ramp(), 0, 16)));
}

TEST_CASE("ticks of a colour bar are round, within the range and few", "[colour]") {
    const auto labels = [](const ColourScale& scale, int most) {
        std::string out;
        for (const auto& tick : scale.ticks(most)) {
            CHECK(tick.position >= 0);
            CHECK(tick.position <= 1);
            out += tick.label + ' ';
        }
        return out;
    };
    CHECK(labels({"g", grey_ramp(), 0, 24}, 6) == "0 6 12 18 24 ");
    CHECK(labels({"g", grey_ramp(), 0, 1}, 6) == "0 0.2 0.4 0.6 0.8 1 ");
    CHECK(labels({"g", grey_ramp(), -3, 3}, 4) == "-3 0 3 ");
    CHECK(labels({"g", grey_ramp(), 0, 1e-12}, 3) == "0 5×10^-13 10^-12 ");
    CHECK(labels({"g", grey_ramp(), 0, 53}, 7) == "0 10 20 30 40 50 ");
    CHECK(labels({"g", grey_ramp(), 1.5, 1.6}, 2) == "1.5 1.6 ");
    CHECK(labels({"g", grey_ramp(), 1.5, 3, Spacing::log2}, 5) == "1.5 3 ");
    CHECK(labels({"g", grey_ramp(), 1, 16, Spacing::log2}, 9) == "1 2 4 8 16 ");
    CHECK(labels({"g", grey_ramp(), 0x1p-24, 0x1p24, Spacing::log2}, 5) == "2^-24 2^-12 1 2^12 2^24 ");
    CHECK(labels({"g", grey_ramp(), 0x1p-4, 1, Spacing::log2}, 9) == "2^-4 2^-3 2^-2 2^-1 1 ");
    CHECK(labels({"g", grey_ramp(), 0, 24, Spacing::root}, 6) == "0 1 4 8 16 24 ");
    CHECK(labels({"g", grey_ramp(), 0, 53, Spacing::root}, 9) == "0 1 4 8 16 32 53 ");
    CHECK(labels({"g", grey_ramp(), 0, 1, Spacing::root}, 9) == "0 1 ");
    for (int most = 2; most < 12; ++most) {
        for (const double hi : {0.3, 1.0, 7.0, 24.0, 53.0, 1e9}) {
            for (const Spacing spacing : {Spacing::linear, Spacing::root}) {
                INFO(most << ' ' << hi);
                const auto count = ColourScale("g", grey_ramp(), 0, hi, spacing).ticks(most).size();
                CHECK(count >= 2);
                CHECK(count <= static_cast<std::size_t>(most));
            }
        }
    }
}

TEST_CASE("converting to linear light and back returns the same byte", "[colour]") {
    for (int i = 0; i < 256; ++i) {
        CHECK(srgb_byte(linear_light(static_cast<std::uint8_t>(i))) == i);
    }
    CHECK(srgb_byte(0x8000) == 188);
}

namespace {

constexpr double least = 25;

struct Eye {
    const char* name;
    Vector (*see)(const Vector&);
};
const std::array eyes{Eye{"any", any_eye}, Eye{"deuteranope", deuteranope}, Eye{"protanope", protanope}};

double apart(const Eye& eye, Rgb8 a, Rgb8 b) {
    return ciede2000(cielab(eye.see(linear(a))), cielab(eye.see(linear(b))));
}

void check_apart(const std::string& what, const std::vector<Rgb8>& classes) {
    for (const Eye& eye : eyes) {
        for (std::size_t i = 0; i < classes.size(); ++i) {
            for (std::size_t j = 0; j < i; ++j) {
                INFO(what << ", " << eye.name << ": class " << i << " against " << j);
                CHECK(apart(eye, classes[i], classes[j]) >= least);
            }
        }
    }
}

/// Colours of the categories that a legend lists.
std::vector<Rgb8> colours_of(const std::vector<pixel::Category>& categories) {
    std::vector<Rgb8> colours;
    for (const pixel::Category& category : categories)
        if (!category.name.empty()) colours.push_back(category.colour);
    return colours;
}

}  // namespace

TEST_CASE("CIEDE2000 agrees with its authors' test data", "[colour]") {
    // Sharma, Wu and Dalal 2005, table 1: pairs 1, 4, 7, 9, 17, 20, 25 and 33.
    struct Pair {
        Vector one, other;
        double apart;
    };
    for (const auto& [one, other, apart] :
         {Pair{{50, 2.6772, -79.7751}, {50, 0, -82.7485}, 2.0425},
          Pair{{50, -1.3802, -84.2814}, {50, 0, -82.7485}, 1.0000}, Pair{{50, 0, 0}, {50, -1, 2}, 2.3669},
          Pair{{50, 2.49, -0.001}, {50, -2.49, 0.0009}, 7.1792}, Pair{{50, 2.5, 0}, {73, 25, -18}, 27.1492},
          Pair{{50, 2.5, 0}, {58, 24, 15}, 19.4535},
          Pair{{60.2574, -34.0099, 36.2677}, {60.4626, -34.1751, 39.4387}, 1.2644},
          Pair{{6.7747, -0.2908, -2.4247}, {5.8714, -0.0985, -2.2286}, 0.6377}}) {
        CHECK(std::fabs(ciede2000(one, other) - apart) < 6e-5);
        CHECK(std::fabs(ciede2000(other, one) - apart) < 6e-5);
    }
}

TEST_CASE("people with any kind of colour vision can tell the classes of a picture apart", "[colour]") {
    const auto meshes = outcome_colours.begin() + lostbits::measure::answer::outcome_count_without_mesh;
    check_apart("outcomes", {outcome_colours.begin(), meshes});
    // No colours are left that are as far from the whole ramp and from each other for all eyes.
    for (const Eye& eye : eyes) {
        const double near = eye.name == eyes.front().name ? 20 : 10;
        for (auto colour = meshes; colour != outcome_colours.end(); ++colour) {
            for (auto other = outcome_colours.begin(); other != colour; ++other)
                CHECK(apart(eye, *colour, *other) >= near);
            for (const Rgb8 value : backend().ramp("viridis", 64)) CHECK(apart(eye, *colour, value) >= near);
        }
    }
    check_apart("stops", {image::stop_colours.begin(), image::stop_colours.end()});
    check_apart("pairs", {image::against_colours.begin(), image::against_colours.end()});
    check_apart("bits needed", {map::beyond_colour, outcome_colours[static_cast<std::size_t>(Outcome::unresolved)]});
    auto seen = colours_of(render::seen_categories());
    seen.push_back(outcome_colours.front());
    check_apart("what is seen", seen);
    check_apart("shadows", colours_of(render::shadow_categories()));
}

TEST_CASE("every outcome has a colour and a name", "[colour]") {
    const auto& lost_bits = *lostbits::measure::metric::find_metric("lost_bits");
    const auto legend = map::MetricPaint(lost_bits, lostbits::binary32).look(true).widest_legend(1);
    REQUIRE(legend.size() == outcome_colours.size());
    CHECK(legend[legend.size() - 2].label == "out of order");
    CHECK(legend[legend.size() - 2].colour == outcome_colours.back());
    CHECK(map::outcome_in_words(Outcome::agree_hit) == "correct hit");
}

}  // namespace test_colour
