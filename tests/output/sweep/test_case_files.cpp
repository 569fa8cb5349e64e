// The tables and the picture of named cases, and the files of a search, read back.
#include "output/image/figure.hpp"
#include "output/sweep/case_files.hpp"

#include <cmath>

#include "catch.hpp"
#include "measure/rows.hpp"
#include "output/file/read_csv.hpp"
#include "output/helpers.hpp"
#include "output/image/pixels.hpp"
#include "output/map/map_colour.hpp"
#include "output/sweep/worst_files.hpp"

namespace test_case_files {

using namespace lostbits;
using namespace lostbits::output;
using namespace lostbits::output::file;
using namespace lostbits::output::image;
using namespace lostbits::output::map;
using namespace lostbits::output::sweep;
using namespace lostbits::output::test;
using lostbits::test::row;
using lostbits::test::TextFile;

namespace {

/// Results of the schoolbook form here follow by hand: tests/measure/sweep/test_cases.cpp has the numbers.
const std::string cases_text = R"(schema = "lostbits-sweep/1"
title = "A test"
source = "-"
[[case]]
name = "exact, and \"quoted\""
spheres = [{ centre = [0, 0, 5], radius = 2 }]
rays = [{ origin = [0, 0, 0], direction = [0, 0, 1] }]
[[case]]
name = "radius lost"
spheres = [{ centre = [0, 0, 4097], radius = 1 }]
rays = [{ origin = [0, 0, 0], direction = [0, 0, 1] }]
[[case]]
name = "c overflows"
spheres = [{ centre = [0, 0, "0x1p66"], radius = "0x1p60" }]
rays = [{ origin = [0, 0, 0], direction = [0, 0, "0x1p-10"] }]
[[case]]
name = "c underflows"
spheres = [{ centre = ["0x1p-98", 0, "0x1p-98"], radius = "0x1p-100" }]
rays = [{ origin = [0, 0, 0], direction = [0, 0, 1] }]
[[case]]
name = "a overflows, once"
spheres = [{ centre = [0, 0, 5], radius = 2 }]
rays = [{ origin = [0, 0, 0], direction = [0, 0, "0x1p100"] }, { origin = [0, 0, 0], direction = [0, 0, 1] }]
)";

std::string cell(const output::file::CsvTable& table, const char* column, std::size_t row) {
    const output::file::CsvColumn* c = table.find(column);
    if (c == nullptr) throw std::logic_error(std::string("no column ") + column);
    return std::string(c->cells.at(row));
}

}  // namespace

TEST_CASE("cases.csv and matrix.png show the result of each form for each case") {
    const Scratch folder;
    const TextFile text(cases_text);
    const scene::sweep::CaseFile file(text.path());
    // f64 stands between two rows of f32: the picture gathers a format's forms, the table keeps the order.
    const measure::sweep::CaseRequest request{
        .file = file,
        .tested_forms = {row("sphere.schoolbook", "f32"), row("sphere.schoolbook", "f64"),
                         row("sphere.schoolbook_strict", "f32")},
        .metrics = lostbits::test::case_metrics};
    static_cast<void>(backend());
    output::sweep::CaseWriter writer(request, folder.path(), "t.toml");
    CHECK_FALSE(fs::exists(folder / "cases.csv"));
    writer.finish(measure::sweep::run_cases(request));

    const output::file::CsvTable table = read_csv(folder / "cases.csv");
    REQUIRE(table.rows() == 5 * 3);
    const std::string expected[] = {"right", "wrong_value", "false_miss", "false_hit", "not_a_number"};
    for (std::size_t i = 0; i < 5; ++i) {
        for (std::size_t r = 0; r < 3; ++r) {
            CAPTURE(i, r);
            CHECK(cell(table, "case", 3 * i + r) == file.name(i));
            CHECK(cell(table, "form", 3 * i + r) == request.tested_forms[r].form->info->name);
            CHECK(cell(table, "format", 3 * i + r) == request.tested_forms[r].format.name);
            CHECK(cell(table, "rays", 3 * i + r) == (i == 4 ? "2" : "1"));
            if (r == 1) CHECK(cell(table, "verdict", 3 * i + r) == "right");
            if (r == 0) CHECK(cell(table, "verdict", 3 * i + r) == expected[i]);
        }
    }
    CHECK(cell(table, "case", 0) == "exact, and \"quoted\"");
    CHECK(cell(table, "lost_bits_max", 3) == "12");
    CHECK(cell(table, "lost_bits_max", 0) == "0");
    CHECK(cell(table, "lost_bits_max", 6).empty());
    CHECK(cell(table, "worst_t_hex", 3) == "0x1.001p+12");
    CHECK(cell(table, "worst_radius_hex", 3) == "0x1p+0");
    // 4097 in place of 4096, where an ulp is 2^-11.
    CHECK(cell(table, "worst_t", 3) == "4097");
    CHECK(cell(table, "worst_truth", 3) == "4096");
    CHECK(cell(table, "worst_truth_hex", 3) == "0x1p+12");
    CHECK(cell(table, "worst_ulp_error", 3) == "2048");
    CHECK(cell(table, "worst_explain", 3) ==
          "lostbits explain t.toml --case 'radius lost:0' -i sphere.schoolbook -f f32");
    CHECK(cell(table, "fault_outcome", 3).empty());
    CHECK(cell(table, "fault_outcome", 6) == "false_miss");
    CHECK(cell(table, "fault_t", 6).empty());
    // The near root of a ray through the middle: (2^66 - 2^60)/2^-10.
    CHECK(cell(table, "fault_truth_hex", 6) == "0x1.f8p+75");
    CHECK(cell(table, "fault_outcome", 9) == "false_hit");
    CHECK(cell(table, "fault_t_hex", 9) == "0x1p-98");
    CHECK(cell(table, "fault_truth_hex", 9).empty());
    CHECK(cell(table, "fault_explain", 12).find(" --case 'a overflows, once:0' ") != std::string::npos);
    CHECK(cell(table, "not_a_number", 12) == "1");
    CHECK(cell(table, "agree_hit", 12) == "1");
    CHECK(cell(table, "false_miss_fraction", 6) == "1");
    CHECK(contents(folder / "datapackage.json").find("\"cases.csv\"") != std::string::npos);

    const auto image = backend().read_png(folder / "matrix.png");
    CHECK(rim_is_blank(image));
    const LostBitsScale scale(request.tested_forms);  // rows in float and in double
    const auto in_float = metric_scale(*measure::metric::find_metric("lost_bits"), binary32);
    CHECK(scale.unit() == "% of the significand lost");
    for (const double bits : {0.0, 6.0, 24.0}) CHECK(scale.colour(bits, binary32) == in_float.colour_of_value(bits));
    CHECK(scale.colour(53, binary64) == in_float.colour_of_value(24));
    CHECK(LostBitsScale(std::span(request.tested_forms).first(1)).unit() == "lost bits");
    int pitch = 26;  // of a column: as wide as the widest text
    while (find_block(image, {226, 238, 226}, pitch, 21)) ++pitch;
    const auto first = find_block(image, {226, 238, 226}, pitch - 1, 21);
    REQUIRE(first.has_value());
    const auto corner = [&](int column, int line) {
        return pixel_at(image, first->first + column, first->second + 22 * line);
    };
    const output::image::Rgb8 colours[] = {
        {226, 238, 226}, scale.colour(12, binary32), outcome_colours[3], outcome_colours[2], outcome_colours[4]};
    CHECK(in_float.colour_of_value(12) != in_float.colour_of_value(0));
    for (int i = 0; i < 5; ++i) {
        CAPTURE(i);
        CHECK(corner(0, i) == colours[i]);
        CHECK(corner(2 * pitch + 14, i) == colours[0]);  // f64, in a group of its own
    }
    // If all rays are alike, only the colour is shown. For one of two, or a value, a number is in the cell.
    const auto flat = [&](int line) {
        for (int y = 0; y < 21; ++y) {
            for (int x = 0; x < pitch - 1; ++x) {
                if (pixel_at(image, first->first + x, first->second + 22 * line + y) != colours[line]) return false;
            }
        }
        return true;
    };
    CHECK((flat(0) && flat(2) && flat(3)));
    CHECK_FALSE(flat(1));
    CHECK_FALSE(flat(4));

    output::image::save_figure(folder / "alone.png",
                               output::sweep::draw_case_matrix(request, measure::sweep::run_cases(request)));
    CHECK(contents(folder / "alone.png") == contents(folder / "matrix.png"));
}

TEST_CASE("results of a search can be run again: hard.toml has the rays bit for bit") {
    const Scratch folder;
    const TextFile text(R"(schema = "lostbits-sweep/1"
title = 'Rays that are "hard" \ wrong'
source = "-"
[search]
origin = [-8, 8]
direction = [-1, 1]
centre = [-1, 1]
radius = [0.5, 2]
)");
    const scene::sweep::SearchFile search(text.path());
    const measure::sweep::WorstRequest request{
        .search = search,
        .tested_forms = {row("sphere.schoolbook", "f32"), row("sphere.press", "f64"), row("sphere.unified", "bf16")},
        .metrics = lostbits::test::case_metrics};
    const Ray<double> ray{{0x1.79c78ap+2, -0x1.3d574ap-1, 0}, {-0x1.e0c60cp-1, 0x1p-149, -1}};
    const Sphere<double> sphere{{0x1.921fb54442d18p+0, -0.0, 0x1p-1074}, 0x1.fffffffffffffp+0};
    const std::vector<std::optional<measure::sweep::WorstResult>> found{
        measure::sweep::WorstResult{.outcome = measure::answer::Outcome::agree_hit,
                                    .value = 6.400023458,
                                    .ray = ray,
                                    .primitive = sphere,
                                    .t = 5.5,
                                    .truth = 5.25,
                                    .evaluation_count = 640},
        measure::sweep::WorstResult{.outcome = measure::answer::Outcome::false_hit,
                                    .value = HUGE_VAL,
                                    .ray = {{1, 2, 3}, {0, 0, 1}},
                                    .primitive = sphere,
                                    .t = 0x1p-3,
                                    .truth = std::nan(""),
                                    .evaluation_count = 32},
        std::nullopt};
    output::sweep::write_worst(folder.path(), request, found);

    const output::file::CsvTable table = read_csv(folder / "worst.csv");
    REQUIRE(table.rows() == 3);
    CHECK((cell(table, "form", 0) == "sphere.schoolbook" && cell(table, "format", 0) == "f32" &&
           cell(table, "found", 0) == "1"));
    CHECK((cell(table, "outcome", 0) == "agree_hit" && cell(table, "lost_bits", 0) == "6.400023458" &&
           cell(table, "evaluations", 0) == "640"));
    CHECK((cell(table, "t_hex", 0) == "0x1.6p+2" && cell(table, "truth_hex", 0) == "0x1.5p+2"));
    CHECK((cell(table, "origin_x_hex", 0) == "0x1.79c78ap+2" && cell(table, "direction_y_hex", 0) == "0x1p-149" &&
           cell(table, "radius_hex", 0) == "0x1.fffffffffffffp+0"));
    CHECK((cell(table, "outcome", 1) == "false_hit" && cell(table, "lost_bits", 1).empty() &&
           cell(table, "truth_hex", 1).empty()));
    CHECK((cell(table, "found", 2) == "0" && cell(table, "outcome", 2).empty() &&
           cell(table, "origin_x_hex", 2).empty()));

    const scene::sweep::CaseFile hard(folder / "hard.toml");
    CHECK(hard.title == "The worst rays of each form: Rays that are \"hard\" \\ wrong");
    CHECK(hard.source == "lostbits sweep t --worst: seed 1, 16 starts of 64 generations of 32, largest lost_bits");
    REQUIRE(hard.size() == 2);
    CHECK(hard.name(0) == "sphere.schoolbook in f32: lost_bits 6.40002");
    CHECK(hard.name(1) == "sphere.press in f64: false_hit");
    const scene::rays::RayGroup group = hard.rays(0, binary64).at(0);
    CHECK(group.rays[0].origin == ray.origin);
    CHECK(group.rays[0].direction == ray.direction);
    CHECK(group.primitives.at(0).numbers == Primitive<double>(sphere).numbers);
    CHECK(std::signbit(group.primitives[0].numbers[1]));
    CHECK(hard.rays(1, binary32).at(0).rays[0].origin == Vec<double>(1, 2, 3));
    CHECK(folder.entries() == 3);
}

}  // namespace test_case_files
