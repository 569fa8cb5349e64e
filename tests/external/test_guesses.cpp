// A guess of what is wrong must explain hits and misses, on rays that did not suggest it.
#include <cmath>
#include <string>
#include <vector>

#include "catch.hpp"
#include "cli/program.hpp"
#include "measure/contract/suspect.hpp"

namespace test_guesses {

using namespace lostbits::test;
using namespace lostbits;

namespace {

/// Rays along z at distances of 0 to `reach` from the middle of a sphere of this radius. `answer` returns a t, or
/// NaN for a miss.
template <class Answer>
std::vector<measure::contract::AnswerSample> beside(double radius, double reach, const Answer& answer) {
    std::vector<measure::contract::AnswerSample> all;
    for (int i = 0; i < 400; ++i) {
        const double side = reach * i / 400, from = 4 * radius, left = radius * radius - side * side;
        measure::contract::AnswerSample j{.ray = {{side, 0, -from}, {0, 0, 1}},
                                          .primitive = Primitive<double>(Sphere<double>{{0, 0, 0}, radius}),
                                          .truly_hits = left >= 0};
        if (j.truly_hits) j.true_t = j.other_t = from - std::sqrt(left);
        j.t = answer(side, from);
        j.hit = !std::isnan(j.t);
        all.push_back(j);
    }
    return all;
}

/// Returns the t of a sphere of another radius.
auto of_radius(double radius) {
    return [radius](double side, double from) { return from - std::sqrt(radius * radius - side * side); };
}

}  // namespace

TEST_CASE("suspicion: a guess must explain hits and misses, and more than all-miss answers", "[external]") {
    using measure::contract::suspicion_text;
    // A form that never hits allows no conclusion, however thin or large the primitive that it misses.
    const auto never = [](double, double) { return std::nan(""); };
    for (const double radius : {0x1p-10, 0.001, 0.1, 0.5, 1.0, 50.0, 1e6}) {
        for (const double reach : {0.9, 1.0, 3.0}) {
            const std::string words = suspicion_text(beside(radius, reach * radius, never));
            INFO(radius << ' ' << reach << ": " << words);
            CHECK(has(words, "miss what they should hit; no known mistake"));
            CHECK_FALSE(has(words, "seem"));
        }
    }
    for (const ShapeRow& shape : shape_rows) {
        std::vector<measure::contract::AnswerSample> all;
        const Primitive<double> primitive = primitive_around<double>(shape.shape, {0, 0, 0}, 0.01);
        for (int i = 0; i < 50; ++i)
            all.push_back(
                {.ray = {{1e-4 * i, 0, -5}, {0, 0, 1}}, .primitive = primitive, .truly_hits = true, .true_t = 4.99});
        INFO(shape.name);
        CHECK_FALSE(has(suspicion_text(all), "seem"));
    }
    // A form that hits a sphere of another radius is recognised by its hits and its misses.
    CHECK(has(suspicion_text(beside(9, 18, of_radius(3))), "the intersector seems to expect the square of the radius"));
    CHECK(has(suspicion_text(beside(3, 18, of_radius(9))), "the radius seems to be squared once too often"));
    CHECK(has(suspicion_text(beside(2.5, 7.5, of_radius(5))),
              "the intersector seems to get a diameter instead of the radius"));
    // Hits that fit a sphere twice as large, but stop at the rim of the sphere itself, do not suggest the larger one:
    // rays between the two are missed.
    CHECK_FALSE(
        has(suspicion_text(beside(
                2, 6, [](double side, double from) { return side > 2 ? std::nan("") : of_radius(4)(side, from); })),
            "seem"));
    // Two hits in the middle of 400 misses do not suggest it either.
    CHECK_FALSE(has(suspicion_text(beside(50, 49, [](double side, double) { return side < 0.2 ? 1e9 : std::nan(""); })),
                    "seem"));
}

TEST_CASE("suspicion: a guess is tested on rays that did not suggest it", "[external]") {
    using measure::contract::suspicion_text;
    // One wrong answer, for which a factor or a sign could always be found.
    auto all = beside(3, 1, of_radius(3));
    all.resize(1);
    for (const double factor : {-1.0, 1000.0, 7.5}) {
        all[0].t = factor * all[0].true_t;
        CHECK(
            has(suspicion_text(all), "wrong on the only ray that hits or should hit: its t is off by more than 0.4%"));
    }
}

TEST_CASE("suspicion: a factor is not guessed from a sum, from one answer or from false hits", "[external]") {
    using measure::contract::suspicion_text;
    const auto scaled = [](double from, double to, const auto& answer) {
        auto all = beside(3, 1, of_radius(3));
        for (std::size_t i = 0; i < all.size(); ++i) {
            all[i].true_t = all[i].other_t = from + (to - from) * static_cast<double>(i) / 400;
            all[i].t = answer(all[i].true_t);
        }
        return all;
    };
    CHECK_FALSE(has(suspicion_text(scaled(95, 105, [](double t) { return t + 1; })), "units"));
    CHECK_FALSE(has(suspicion_text(scaled(99, 99.2, [](double) { return 1.0; })), "units"));
    CHECK_FALSE(has(suspicion_text(scaled(99, 99.2, [](double t) { return 1.5 * t; })), "units"));
    CHECK_FALSE(has(suspicion_text(scaled(1, 1, [](double) { return 1000.0; })), "units"));
    CHECK(has(suspicion_text(scaled(90, 110, [](double t) { return 1.5 * t; })), "it is 1.5 times what is right"));
    CHECK(has(suspicion_text(scaled(99, 99.2, [](double t) { return 1000 * t; })), "1000 times what is right"));
    auto with_false_hits = scaled(90, 110, [](double t) { return 1.5 * t; });
    for (std::size_t i = 0; i < with_false_hits.size(); i += 5) with_false_hits[i].truly_hits = false;
    CHECK_FALSE(has(suspicion_text(with_false_hits), "units"));
}

TEST_CASE("suspicion: a file of rays that all miss a large sphere is not explained by its radius", "[external]") {
    const Scratch folder;
    std::string rays = "ox,oy,oz,dx,dy,dz,hit,t\n";
    for (int i = 0; i < 39; ++i)
        rays += std::to_string(7.5 + i) + "," + std::to_string(0.25 * i - 5) + ",200,0,0,-1,0,\n";
    folder.write("rays.csv", rays);
    const Outcome o = must("judge rays.csv --sphere 0,0,0,50 -o out", folder.path());
    INFO(o.err);
    CHECK(has(o.err, "miss what they should hit"));
    CHECK_FALSE(has(o.err, "seem"));
}

}  // namespace test_guesses
