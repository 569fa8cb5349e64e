// Classes are told apart by every eye: between any two of one picture CIEDE2000 is at least 25, for an ordinary eye, a
// deuteranope's and a protanope's.
#include <array>
#include <string>

#include "catch.hpp"
#include "output/helpers.hpp"
#include "output/image/colour.hpp"
#include "output/image/eyes.hpp"
#include "output/map/metric_paint.hpp"
#include "output/map/needed_files.hpp"
#include "output/picture/render_pictures.hpp"

namespace test_class_colours {

using namespace lostbits::output;
using namespace lostbits::output::test;
using lostbits::measure::answer::Outcome;
using lostbits::output::image::outcome_colours;
using lostbits::output::image::Rgb8;

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

/// Of those that a legend lists.
std::vector<Rgb8> colours_of(const std::vector<pixel::Category>& categories) {
    std::vector<Rgb8> colours;
    for (const pixel::Category& category : categories)
        if (!category.name.empty()) colours.push_back(category.colour);
    return colours;
}

}  // namespace

TEST_CASE("CIEDE2000 is that of its authors' test data", "[colour]") {
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

TEST_CASE("every eye tells the classes of a picture apart", "[colour]") {
    const auto meshes = outcome_colours.begin() + lostbits::measure::answer::outcomes_without_mesh;
    check_apart("outcomes", {outcome_colours.begin(), meshes});
    // No colours are left that are as far from all of the ramp and from each other for all eyes.
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
    auto seen = colours_of(picture::seen_categories());
    seen.push_back(outcome_colours.front());
    check_apart("what is seen", seen);
    check_apart("shadows", colours_of(picture::shadow_categories()));
}

TEST_CASE("an outcome has a colour and a name, the last one too", "[colour]") {
    const auto& lost_bits = *lostbits::measure::metric::find_metric("lost_bits");
    const auto legend = map::MetricPaint(lost_bits, lostbits::binary32, backend()).look(true).widest_legend(1);
    REQUIRE(legend.size() == outcome_colours.size());
    CHECK(legend[legend.size() - 2].label == "out of order");
    CHECK(legend[legend.size() - 2].colour == outcome_colours.back());
    CHECK(map::plain_name(Outcome::agree_hit) == "correct hit");
}

}  // namespace test_class_colours
