// The table of conventions: the truth follows it for every combination of properties, and docs/truth.md shows it.
#include <algorithm>
#include <array>
#include <fstream>
#include <sstream>
#include <string>
#include <string_view>
#include <vector>

#include "catch.hpp"
#include "intersect/conventions.hpp"
#include "measure/answer/answers.hpp"
#include "measure/rows.hpp"
#include "measure/truth/truth.hpp"

namespace test_conventions_table {

using namespace lostbits;
using intersect::RightAnswer, intersect::AtOrigin, intersect::Convention, intersect::Inside, intersect::Situation,
    intersect::Touching;
using measure::truth::find_truth;
using measure::truth::Truth;

namespace {

/// Names of the values of `Situation` and of `RightAnswer`.
constexpr std::array<std::string_view, 7> situation_names{"inside", "entering", "leaving", "tangent",
                                                          "along",  "touching", "ending"};
constexpr std::array<std::string_view, 4> answer_names{"0", "next", "miss", "-"};

/// A ray of whole numbers or short fractions in a situation; `ahead` is the t of its next crossing, by hand.
struct Example {
    Shape shape;
    Situation of;
    std::vector<double> numbers;
    Ray<double> ray;
    double ahead = 0, tmax = HUGE_VAL;
};

const std::vector<double> ball{0, 0, 0, 1}, ellipsoid{0, 0, 0, 1, 2, 1}, box{-1, -1, -1, 1, 1, 1},
    cylinder{0, 0, -1, 0, 0, 1, 1}, cone{0, 0, -1, 0, 0, 1, 1, 0.5}, disc{0, 0, 0, 0, 0, 1, 1, 0},
    plane{0, 0, 0, 0, 0, 1}, triangle{-1, -1, 0, 3, -1, 0, -1, 3, 0}, torus{0, 0, 0, 0, 0, 1, 3, 1};

const std::vector<Example> examples{
    {Shape::sphere, Situation::inside, ball, {{0, 0, 0}, {0, 0, 2}}, 0.5},
    {Shape::sphere, Situation::entering, ball, {{0, 0, 1}, {0, 0, -1}}, 2},
    {Shape::sphere, Situation::leaving, ball, {{0, 0, 1}, {0, 0, 1}}},
    {Shape::sphere, Situation::touching_at_origin, ball, {{1, 0, 0}, {0, 1, 0}}},
    {Shape::sphere, Situation::touching_ahead, ball, {{1, -2, 0}, {0, 1, 0}}, 2},
    {Shape::sphere, Situation::ending_at_surface, ball, {{0, 0, 3}, {0, 0, -1}}, 2, 2},
    {Shape::ellipsoid, Situation::inside, ellipsoid, {{0, 0, 0}, {0, 0, 2}}, 0.5},
    {Shape::ellipsoid, Situation::entering, ellipsoid, {{0, 2, 0}, {0, -2, 0}}, 2},
    {Shape::ellipsoid, Situation::leaving, ellipsoid, {{0, 2, 0}, {0, 1, 0}}},
    {Shape::ellipsoid, Situation::touching_at_origin, ellipsoid, {{1, 0, 0}, {0, 1, 0}}},
    {Shape::ellipsoid, Situation::touching_ahead, ellipsoid, {{1, -2, 0}, {0, 1, 0}}, 2},
    {Shape::ellipsoid, Situation::ending_at_surface, ellipsoid, {{0, 4, 0}, {0, -1, 0}}, 2, 2},
    {Shape::box, Situation::inside, box, {{0, 0, 0}, {0, 0, 2}}, 0.5},
    {Shape::box, Situation::entering, box, {{0, 0, 1}, {0, 0, -1}}, 2},
    {Shape::box, Situation::leaving, box, {{0, 0, 1}, {0, 0, 1}}},
    {Shape::box, Situation::touching_at_origin, box, {{1, 0, 1}, {1, 0, -1}}},
    {Shape::box, Situation::along, box, {{0, 0, 1}, {2, 0, 0}}, 0.5},
    {Shape::box, Situation::along, box, {{1, 0, 1}, {0, 2, 0}}, 0.5},
    {Shape::box, Situation::touching_ahead, box, {{-3, 0, 1}, {1, 0, 0}}, 2},
    {Shape::box, Situation::ending_at_surface, box, {{0, 0, 3}, {0, 0, -1}}, 2, 2},
    {Shape::cylinder, Situation::inside, cylinder, {{0, 0, 0}, {0, 0, 2}}, 0.5},
    {Shape::cylinder, Situation::entering, cylinder, {{0, 0, 1}, {0, 0, -1}}, 2},
    {Shape::cylinder, Situation::entering, cylinder, {{1, 0, 0}, {-1, 0, 0}}, 2},
    {Shape::cylinder, Situation::leaving, cylinder, {{0, 0, 1}, {0, 0, 1}}},
    {Shape::cylinder, Situation::touching_at_origin, cylinder, {{1, 0, 0}, {0, 1, 0}}},
    {Shape::cylinder, Situation::along, cylinder, {{0, 0, 1}, {2, 0, 0}}, 0.5},
    {Shape::cylinder, Situation::along, cylinder, {{1, 0, 0}, {0, 0, 2}}, 0.5},
    {Shape::cylinder, Situation::touching_ahead, cylinder, {{-3, 0, 1}, {1, 0, 0}}, 2},
    {Shape::cylinder, Situation::ending_at_surface, cylinder, {{0, 0, 3}, {0, 0, -1}}, 2, 2},
    {Shape::capsule, Situation::inside, cylinder, {{0, 0, 0}, {0, 0, 4}}, 0.5},
    {Shape::capsule, Situation::entering, cylinder, {{0, 0, 2}, {0, 0, -2}}, 2},
    {Shape::capsule, Situation::leaving, cylinder, {{0, 0, 2}, {0, 0, 1}}},
    {Shape::capsule, Situation::touching_at_origin, cylinder, {{1, 0, 0}, {0, 1, 0}}},
    {Shape::capsule, Situation::along, cylinder, {{1, 0, 0}, {0, 0, 1}}, 1},
    {Shape::capsule, Situation::along, cylinder, {{1, 0, -1}, {0, 0, 1}}, 2},
    {Shape::capsule, Situation::touching_ahead, cylinder, {{1, 0, -3}, {0, 0, 1}}, 2},
    {Shape::capsule, Situation::touching_ahead, cylinder, {{1, -2, 0}, {0, 1, 0}}, 2},
    {Shape::capsule, Situation::ending_at_surface, cylinder, {{0, 0, 4}, {0, 0, -1}}, 2, 2},
    {Shape::tube, Situation::entering, cylinder, {{1, 0, 0}, {-1, 0, 0}}, 2},
    {Shape::tube, Situation::leaving, cylinder, {{1, 0, 0}, {1, 0, 0}}},
    {Shape::tube, Situation::touching_at_origin, cylinder, {{1, 0, 0}, {0, 1, 0}}},
    {Shape::tube, Situation::along, cylinder, {{1, 0, 0}, {0, 0, 1}}},
    {Shape::tube, Situation::along, cylinder, {{1, 0, -1}, {0, 0, 1}}},
    {Shape::tube, Situation::along, cylinder, {{1, 0, 1}, {0, 0, -1}}},
    {Shape::tube, Situation::touching_ahead, cylinder, {{1, -2, 0}, {0, 1, 0}}, 2},
    {Shape::tube, Situation::ending_at_surface, cylinder, {{3, 0, 0}, {-1, 0, 0}}, 2, 2},
    {Shape::cone, Situation::inside, cone, {{0, 0, 0}, {0, 0, 2}}, 0.5},
    {Shape::cone, Situation::entering, cone, {{0, 0, -1}, {0, 0, 1}}, 2},
    {Shape::cone, Situation::leaving, cone, {{0, 0, 1}, {0, 0, 1}}},
    {Shape::cone, Situation::touching_at_origin, cone, {{0.75, 0, 0}, {0, 1, 0}}},
    {Shape::cone, Situation::along, cone, {{0, 0, -1}, {2, 0, 0}}, 0.5},
    {Shape::cone, Situation::along, cone, {{0.75, 0, 0}, {-0.25, 0, 1}}, 1},
    {Shape::cone, Situation::touching_ahead, cone, {{-3, 0, -1}, {1, 0, 0}}, 2},
    {Shape::cone, Situation::ending_at_surface, cone, {{0, 0, 3}, {0, 0, -1}}, 2, 2},
    {Shape::disc, Situation::entering, disc, {{0, 0, 0}, {0, 0, 1}}},
    {Shape::disc, Situation::along, disc, {{0, 0, 0}, {1, 0, 0}}},
    {Shape::disc, Situation::along, disc, {{1, 0, 0}, {0, 1, 0}}},
    {Shape::disc, Situation::touching_ahead, disc, {{1, 0, 2}, {0, 0, -1}}, 2},
    {Shape::disc, Situation::ending_at_surface, disc, {{0, 0, 2}, {0, 0, -1}}, 2, 2},
    {Shape::plane, Situation::entering, plane, {{0, 0, 0}, {0, 0, 1}}},
    {Shape::plane, Situation::along, plane, {{0, 0, 0}, {1, 0, 0}}},
    {Shape::plane, Situation::ending_at_surface, plane, {{0, 0, 2}, {0, 0, -1}}, 2, 2},
    {Shape::triangle, Situation::entering, triangle, {{0, 0, 0}, {0, 0, 1}}},
    {Shape::triangle, Situation::along, triangle, {{0, 0, 0}, {1, 0, 0}}},
    {Shape::triangle, Situation::along, triangle, {{-1, -1, 0}, {1, 0, 0}}},
    {Shape::triangle, Situation::touching_ahead, triangle, {{1, 1, 2}, {0, 0, -1}}, 2},
    {Shape::triangle, Situation::ending_at_surface, triangle, {{0, 0, 2}, {0, 0, -1}}, 2, 2},
    {Shape::torus, Situation::inside, torus, {{3, 0, 0}, {0, 0, 2}}, 0.5},
    {Shape::torus, Situation::entering, torus, {{3, 0, 1}, {0, 0, -1}}, 2},
    {Shape::torus, Situation::leaving, torus, {{3, 0, 1}, {0, 0, 1}}},
    {Shape::torus, Situation::touching_at_origin, torus, {{4, 0, 0}, {0, 1, 0}}},
    {Shape::torus, Situation::touching_ahead, torus, {{4, -2, 0}, {0, 1, 0}}, 2},
    {Shape::torus, Situation::ending_at_surface, torus, {{3, 0, 3}, {0, 0, -1}}, 2, 2}};

constexpr std::array touches{Touching::hit, Touching::miss};
constexpr std::array origins{AtOrigin::hit, AtOrigin::exit, AtOrigin::miss};
constexpr std::array insides{Inside::usual, Inside::exit, Inside::zero, Inside::miss};

Truth truth_of(const Example& example, const Convention& convention) {
    Primitive<double> primitive(example.shape);
    std::ranges::copy(example.numbers, primitive.numbers.begin());
    return find_truth(example.ray, primitive, {}, convention, {0, example.tmax});
}

/// Cells of docs/truth.md: the answers by each value of the property that decides.
template <class Values, class Member>
std::string cell(Shape shape, Situation of, const Values& values, Member Convention::*property, Inside inside) {
    std::string words;
    for (const auto value : values) {
        Convention convention;
        convention.inside = inside;
        convention.*property = value;
        const RightAnswer answer = intersect::right_answer(shape, of, convention);
        if (answer == RightAnswer::none) return "";
        words += (words.empty() ? "" : ", ") + std::string(answer_names[static_cast<std::size_t>(answer)]);
    }
    return words;
}

std::string row_of_table(Shape shape, Inside inside) {
    std::string text = "|";
    for (const Situation of : intersect::all_situations) {
        const std::string words = of == Situation::inside ? cell(shape, of, insides, &Convention::inside, inside)
                                  : of == Situation::touching_ahead || of == Situation::ending_at_surface
                                      ? cell(shape, of, touches, &Convention::touching, inside)
                                      : cell(shape, of, origins, &Convention::at_origin, inside);
        text += words.empty() ? " |" : " " + words + " |";
    }
    return text;
}

/// A line for all kinds with the same answers, in the order of the shapes: as usual, and with an answer from inside
/// that changes those from the surface.
std::string table() {
    struct Row {
        std::string kinds, with, cells;
    };
    std::vector<Row> rows;
    const auto add = [&rows](const ShapeRow& shape, Inside inside, const std::string& with) {
        const std::string cells = row_of_table(shape.shape, inside);
        const auto same =
            std::ranges::find_if(rows, [&](const Row& row) { return row.with == with && row.cells == cells; });
        if (same == rows.end()) rows.push_back({std::string(shape.name), with, cells});
        else same->kinds += ", " + std::string(shape.name);
    };
    for (const ShapeRow& shape : shape_rows) {
        add(shape, Inside::usual, "");
        if (shape.inside_returns_zero) add(shape, Inside::exit, " with `inside = exit`");
    }
    for (const ShapeRow& shape : shape_rows)
        if (has_inside(shape.shape)) add(shape, Inside::miss, " with `inside = miss`");
    std::string text;
    for (const Row& row : rows) text += "| " + row.kinds + row.with + " " + row.cells + "\n";
    return text;
}

}  // namespace

TEST_CASE("conventions: the truth answers each situation as the table says", "[measure][truth]") {
    std::size_t asked_of = 0, passed = 0;
    for (const Example& example : examples) {
        for (const Touching touching : touches) {
            for (const AtOrigin at_origin : origins) {
                for (const Inside inside : insides) {
                    Convention convention(touching, at_origin);
                    convention.inside = inside;
                    const Truth truth = truth_of(example, convention);
                    const RightAnswer right = intersect::right_answer(example.shape, example.of, convention);
                    INFO(name_of(example.shape)
                         << " " << situation_names[static_cast<std::size_t>(example.of)] << ", touching "
                         << static_cast<int>(touching) << ", at_origin "
                         << intersect::at_origin_names[static_cast<std::size_t>(at_origin)] << ", inside "
                         << intersect::inside_names[static_cast<std::size_t>(inside)] << ": right is "
                         << answer_names[static_cast<std::size_t>(right)] << ", hit " << truth.is_hit() << " at "
                         << truth.t.hi);
                    CHECK(right != RightAnswer::none);
                    CHECK(truth.is_hit() == (right != RightAnswer::miss));
                    if (truth.is_hit())
                        CHECK(std::ldexp(truth.t.hi, static_cast<int>(truth.t.exponent)) ==
                              (right == RightAnswer::origin ? 0 : example.ahead));
                    ++asked_of, passed += truth.is_hit();
                }
            }
        }
    }
    CHECK(asked_of == examples.size() * 24);
    CHECK(passed > asked_of / 4);
}

TEST_CASE("conventions: the table covers every situation of every kind", "[measure][truth]") {
    for (const ShapeRow& shape : shape_rows) {
        for (const Situation of : intersect::all_situations) {
            const bool has = std::ranges::any_of(
                examples, [&](const Example& example) { return example.shape == shape.shape && example.of == of; });
            INFO(shape.name << " " << situation_names[static_cast<std::size_t>(of)]);
            CHECK(has == (intersect::right_answer(shape.shape, of, {}) != RightAnswer::none));
        }
    }
}

TEST_CASE("conventions: the origin property matters except for boxes that return 0 inside", "[measure][truth]") {
    for (const ShapeRow& shape : shape_rows)
        for (const Inside inside : insides)
            CHECK(intersect::origin_matters(shape.shape, inside) !=
                  (shape.shape == Shape::box && intersect::answers_0_inside(shape.shape, inside)));
}

TEST_CASE("conventions: forms that return the next crossing find it where the range excludes the first",
          "[measure][truth]") {
    scene::file::Scene scene = test::load("consistency-on-surface", 8, 6);
    scene.range.open_ends.tmin = true;
    const measure::truth::Band band(scene, 0, scene.height);
    std::size_t tell = 0, lose = 0;
    for (const auto& form : intersect::table::catalogue()) {
        if (form.shape != Shape::sphere || !form.exists_in(*find_format("f32"))) continue;
        const auto answers = measure::answer::evaluate(form, band.inputs_for(*find_format("f32"), *form.info));
        const bool tells = intersect::yields_next_crossing(*form.info, form.shape);
        const auto hits = std::ranges::count(answers.hit, 1);
        INFO(form.info->name << " hits " << hits);
        CHECK(hits == (tells ? 48 : 0));
        ++(tells ? tell : lose);
    }
    CHECK(tell > 10);
    CHECK(lose == 4);
}

TEST_CASE("conventions: docs/truth.md shows the current table", "[measure][truth]") {
    std::ifstream file(std::string(LOSTBITS_DATA_DIR) + "/../docs/truth.md");
    std::ostringstream text;
    text << file.rdbuf();
    INFO(table());
    CHECK(text.str().find("|---|---|---|---|---|---|---|---|\n" + table() + "\n") != std::string::npos);
}

}  // namespace test_conventions_table
