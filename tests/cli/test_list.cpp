#include <algorithm>
#include <map>
#include <nlohmann/json.hpp>
#include <set>

#include "catch.hpp"
#include "intersect/bounding_box/box_methods.hpp"
#include "intersect/table/table.hpp"
#include "intersect/transform/transform_method.hpp"
#include "measure/consistency/consistency.hpp"
#include "measure/metric/metrics.hpp"
#include "measure/offset/strategy.hpp"
#include "program.hpp"
#include "scene/camera/ray_generators.hpp"
#include "scene_and_pixel.hpp"

namespace test_list {

using namespace lostbits;
using namespace lostbits::test;

TEST_CASE("list forms says how each form handles rays from inside and from behind") {
    const std::string text = must("list forms").out;
    for (const char* other : {"list", "list intersectors"}) CHECK(run(other).out == text);
    for (const auto& row : nlohmann::json::parse(run("list forms --json").out)) {
        const std::string name = row.at("name");
        CHECK(has(text, "\n" + name + " "));
        // No form of the catalogue has a property that is its own.
        const std::string shape = name.substr(0, name.find('.'));
        const bool is_flat = shape == "triangle" || shape == "disc" || shape == "plane";
        CHECK(row["inside"] == (shape == "box" ? "zero" : is_flat ? "none" : shape == "sdf" ? "by primitive" : "exit"));
        const bool culls = name == "triangle.moller_trumbore_culling";
        CHECK(row["facing"] == (!is_flat ? "none" : culls ? "front" : "both"));
    }
}

TEST_CASE("list shows the metrics of labels, and every form has labels to map") {
    const auto text = run("list metrics").out;
    for (const char* name : {"contribution:LABEL", "cancellation:LABEL", "tolerance:LENGTH", "enough_bits:BITS"})
        CHECK(has(text, name));
    CHECK(has(text, "lostbits list labels"));
    const auto array = nlohmann::json::parse(run("list labels --json").out);
    REQUIRE(array.size() == intersect::table::intersectors().size());
    const Scratch scratch;
    std::map<std::string, std::pair<std::string, std::size_t>> words;  // of a scene, and how many forms it names
    std::map<std::string, std::set<std::string>> labels_of;
    for (std::size_t i = 0; i < array.size(); ++i) {
        const intersect::table::Intersector& form = intersect::table::intersectors()[i];
        CHECK(array[i]["name"] == std::string(form.info->name));
        const std::string labels = array[i]["labels"];
        INFO(form.info->name << ": " << labels);
        CHECK_FALSE(labels.empty());
        const std::string scene = scene_of(form.shape);
        words[scene].first += " -i " + std::string(form.info->name);
        ++words[scene].second;
        labels_of[scene].insert(labels.substr(labels.rfind(' ') + 1));
        if (form.info->name == "sphere.schoolbook") CHECK(labels == "a b c disc t");
    }
    for (const auto& [scene, forms] : words) {  // the last label of each
        std::string metrics;
        for (const std::string& label : labels_of[scene]) metrics += " --metric 'contribution:" + label + "'";
        must("map " + scene + " --size 8x8 -f f32 -q -o out" + forms.first + metrics, scratch.path());
        CHECK(read_csv(scratch / ("out/" + scene + "/summary.csv")).size() == forms.second);
    }
}

TEST_CASE("list formats and list scenes show names that map accepts") {
    const auto formats = nlohmann::json::parse(run("list formats --json").out);
    CHECK(formats.size() == std::size(format_descriptions));
    std::set<std::string> listed, there;
    for (const auto& scene : nlohmann::json::parse(run("list scenes --json").out)) listed.insert(scene.at("name"));
    for (const auto& entry : test::fs::directory_iterator(LOSTBITS_DATA_DIR "/scenes"))
        there.insert(entry.path().stem().string());
    CHECK(listed == there);
}

namespace {

/// Checks that each word of a row of `list` starts below the name of its column.
void check_columns(const std::string& text, const nlohmann::json& array, const std::vector<std::string>& columns) {
    const std::string head = text.substr(0, text.find('\n'));
    std::size_t line = head.size() + 1;
    for (const auto& row : array) {
        const std::string words = text.substr(line, text.find('\n', line) - line);
        line += words.size() + 1;
        for (const auto& column : columns) {
            const std::string cell = row.at(column);
            const std::size_t at = head.find(column);
            INFO(words << ": " << column);
            REQUIRE(at != std::string::npos);
            if (!cell.empty()) CHECK(words.compare(at, cell.size(), cell) == 0);
        }
    }
    CHECK(line == text.size());
}

}  // namespace

TEST_CASE("list sweeps says what each sweep runs over") {
    const auto array = nlohmann::json::parse(run("list sweeps --json").out);
    const auto axis_of = [&](const std::string& name) -> std::string {
        for (const auto& row : array) {
            if (row.at("name") == name) return row.at("axis");
        }
        return "missing";
    };
    CHECK(axis_of("sphere-height") == "radius x height");
    CHECK(axis_of("sphere-direction") == "direction_length");
    CHECK(axis_of("extremes/contact").ends_with(" cases"));
    CHECK(axis_of("worst/near").starts_with("search for "));
    for (const auto& row : array) CHECK_FALSE(row.at("title").get<std::string>().empty());
    check_columns(run("list sweeps").out, array, {"name", "axis", "title"});
}

TEST_CASE("list claims shows every claim that check would measure, with its verdict") {
    const auto array = nlohmann::json::parse(run("list claims --json").out);
    std::size_t refuted = 0, results = 0;
    for (const auto& row : array) {
        refuted += row.at("verdict") == "refuted" && row.at("profile") == "results";
        results += row.at("profile") == "results";
    }
    const test::Scratch scratch;
    const auto file = scratch / "claims.json";
    must("check -q --filter 'float.*' --export-json '" + file.string() + "'");
    const auto measured = nlohmann::json::parse(test::contents(file));
    REQUIRE(measured.size() > 5);
    for (const auto& claim : measured) {
        const auto same = std::ranges::find_if(array, [&](const auto& row) { return row.at("id") == claim.at("id"); });
        REQUIRE(same != array.end());
        CHECK(same->at("verdict") == claim.at("verdict"));
        CHECK(same->at("statement") == claim.at("statement"));
    }
    CHECK(refuted > 10);
    CHECK(results > refuted);
    check_columns(run("list claims").out, array, {"id", "verdict", "profile", "subject", "statement"});
}

TEST_CASE("help and version are written to stdout and exit with 0") {
    for (const char* arguments : {"--help", "map --help", "list --help"}) {
        const auto r = must(arguments);
        CHECK(has(r.out, "Usage"));
    }
    CHECK(run("--version").out.find("lostbits ") == 0);
}

TEST_CASE("every sentence of a claim can be read by itself") {
    for (const auto& row : nlohmann::json::parse(run("list claims --json").out)) {
        const std::string statement = row.at("statement");
        INFO(row.at("id").get<std::string>() << ": " << statement);
        CHECK(statement.size() > 10);
        CHECK_FALSE(statement.starts_with("..."));
        CHECK_FALSE(statement.ends_with("..."));
        // Filtered, sorted or in a CI log, a statement stands without the statement before it.
        for (const char* leaning : {"and ", "but ", "The same"}) CHECK_FALSE(statement.starts_with(leaning));
    }
}

TEST_CASE("list shows every form, metric, transform, bounding-box method, ray generator, strategy and check") {
    // The list has more rows than the table: those with a label, a length or bits.
    const auto check = [](const std::string& what, const auto& rows, std::size_t more = 0) {
        CAPTURE(what);
        const auto listed = nlohmann::json::parse(run("list " + what + " --json").out);
        REQUIRE(listed.size() == rows.size() + more);
        for (std::size_t k = 0; k < rows.size(); ++k) {
            if constexpr (requires { rows[k].info; }) {
                CHECK(listed[k]["name"] == std::string(rows[k].info->name));
                CHECK_FALSE(listed[k]["source"].get<std::string>().empty());
            } else CHECK(listed[k]["name"] == std::string(rows[k].name));
            if constexpr (requires { rows[k].layer; }) CHECK(listed[k]["layer"] == std::string(rows[k].layer));
        }
    };
    check("forms", intersect::table::intersectors());
    check("metrics", measure::metric::metrics(), 5);
    check("transforms", intersect::transform::transform_methods());
    check("hulls", intersect::bounding_box::box_methods());
    check("makers", scene::camera::ray_generators());
    check("strategies", measure::offset::strategies());
    check("checks", measure::consistency::checks());
}

}  // namespace test_list
