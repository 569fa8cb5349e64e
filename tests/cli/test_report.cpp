// `lostbits report` from the outside: one file that needs nothing else, with the CSVs' numbers. tests/browser tests the
// page in a browser.
#include <algorithm>
#include <cctype>
#include <map>
#include <regex>

#include "catch.hpp"
#include "number/error.hpp"
#include "output/file/base64.hpp"
#include "output/report/pack.hpp"
#include "program.hpp"
#include "scene/check/report_file.hpp"
#include "scene/file/scene.hpp"
#include "scene/sweep/sweep_file.hpp"

namespace test_report {

using namespace lostbits::test;

namespace {

std::string in(const Scratch& scratch) { return "'" + scratch.path().string() + "'"; }

/// All first groups of a pattern.
std::vector<std::string> all_of(const std::string& text, const std::string& pattern) {
    std::vector<std::string> found;
    const std::regex regex(pattern);
    for (auto m = std::sregex_iterator(text.begin(), text.end(), regex); m != std::sregex_iterator(); ++m)
        found.push_back((*m)[1]);
    return found;
}

/// The page without its packed data, which patterns need not be matched against. (A pattern that matches a hundred
/// thousand letters uses up the stack.)
std::string without_blobs(const std::string& page) {
    const auto packed = [](unsigned char c) { return std::isalnum(c) || c == '+' || c == '/' || c == '='; };
    std::string text;
    for (auto at = page.begin(); at != page.end();) {
        const auto end = std::find_if_not(at, page.end(), packed);
        if (end - at < 200) text.append(at, end);
        const auto next = std::find_if(end, page.end(), packed);
        text.append(end, next);
        at = next;
    }
    return text;
}

std::string report_of(const std::string& arguments, const Scratch& scratch) {
    const auto r = must("report " + arguments + " -o " + in(scratch));
    CHECK(r.out == (scratch / "index.html").string() + "\n");
    CHECK(scratch.files() == std::vector<std::string>{"index.html", "manifest.json"});
    return contents(scratch / "index.html");
}

}  // namespace

TEST_CASE("a report is one file that loads no other") {
    const Scratch scratch;
    const std::string page =
        without_blobs(report_of("near-benign sphere-tilt extremes/contact -i sphere.schoolbook -i box.signs -f f32 "
                                "--size 48x48 --claims 'tilt.*'",
                                scratch));
    for (const std::string& target : all_of(page, R"re(\s(?:src|href|action|srcset|poster)="([^"]*)")re")) {
        INFO(target);
        CHECK((target.starts_with("#") || target.starts_with("data:")));
    }
    for (const char* fetching : {"@import", "url(", "<link rel=\"stylesheet", "<iframe", "<object", "<script src",
                                 "fetch(", "XMLHttpRequest", "import("}) {
        INFO(fetching);
        CHECK_FALSE(has(page, fetching));
    }
    const auto policy = all_of(page, R"re(http-equiv="Content-Security-Policy" content="([^"]*)")re");
    REQUIRE(policy.size() == 1);
    CHECK(policy.front().starts_with("default-src 'none'; script-src 'sha256-"));
    CHECK(policy.front().find("unsafe") == std::string::npos);
    CHECK_FALSE(has(page, " style=\""));  // the policy forbids them
    CHECK(std::regex_search(page, std::regex("<b>\\d+</b> hold")));
}

TEST_CASE("a report shows every scene that is named, or says that it is left out") {
    const Scratch scratch;
    const std::string named = "report near-benign mesh-tube-far --no-claims --size 8x8 -o out --force";
    // data/report.toml names no form for triangles.
    CHECK(must(named, scratch.path()).err.empty());
    CHECK(has(contents(scratch / "out/index.html"), "triangle.woop"));
    const auto left_out = must(named + " -i sphere.press", scratch.path());
    CHECK(has(left_out.err, "left out: no selected form handles mesh-tube-far: it has triangles; try -i 'triangle.*'"));
    CHECK_FALSE(has(contents(scratch / "out/index.html"), "mesh-tube-far</"));
}

TEST_CASE("the tables of a report are the CSVs' numbers") {
    const Scratch scratch, maps;
    const std::string what = "rtg-fig-7-3-4100-oblique -i 'sphere.*' -f f32 -f f64 --size 48x48 ";
    const std::string page = report_of(what + "--no-claims", scratch);
    must("map " + what + "--metric lost_bits --metric excess_bits -o " + in(maps));
    const auto summary = read_csv(maps / "rtg-fig-7-3-4100-oblique/summary.csv");
    std::size_t rows = 0, withheld_rows = 0;
    for (const auto& row : summary) {
        const std::string key = row.at("form") + "." + row.at("format"), start = "<tr data-row=\"" + key + "\">";
        const std::size_t at = page.find(start);
        INFO(key);
        REQUIRE(at != std::string::npos);
        const std::string cells = page.substr(at, page.find("</tr>", at) - at);
        std::vector<std::string> expected;
        for (const char* column : {"lost_bits_p50", "lost_bits_p99", "lost_bits_max", "excess_bits_p99"}) {
            if (!row.at(column).empty()) expected.push_back(row.at(column));
        }
        const auto number = [&row](const char* column) { return std::stod(row.at(column)); };
        const double agreed = number("agree_hit");
        const bool withheld =
            agreed < 0.1 * (agreed + number("false_miss") + number("wrong_primitive") + number("not_a_number"));
        withheld_rows += withheld;
        CHECK((cells.find("hits agree") != std::string::npos) == withheld);
        CHECK(all_of(cells, R"re(<data value="([^"]*)")re") == (withheld ? std::vector<std::string>{} : expected));
        const auto counts = all_of(cells, R"(<td class="n">(\d+)</td>)");
        REQUIRE(counts.size() >= 3);
        CHECK(counts[0] == row.at("false_hit"));
        CHECK(counts[1] == row.at("false_miss"));
        CHECK(counts[2] == row.at("not_a_number"));
        ++rows;
    }
    CHECK(withheld_rows > 0);
    CHECK(rows == all_of(page, "<tr data-row=\"([^\"]*)\"").size());
}

TEST_CASE("a report counts and lists the requested claims") {
    const Scratch scratch;
    const std::string page = report_of("rtg-fig-7-3-4100 -i sphere.schoolbook -f f32", scratch);
    const auto file = scratch / "claims.csv";
    must("check -q --filter 'rtg7.fig3.*-4100-axis*' --export-csv '" + file.string() + "'");
    const auto claims = read_csv(file);
    // Claims about a form that the page does not show are left out.
    std::map<std::string, std::size_t> counts;
    std::size_t shown = 0;
    for (const auto& row : claims) {
        if (row.at("form") != "sphere.schoolbook" || row.at("format") != "f32") continue;
        ++counts[row.at("verdict")];
        ++shown;
    }
    REQUIRE(counts["holds"] > 0);
    REQUIRE(counts["refuted"] > 0);
    REQUIRE(shown < claims.size());
    CHECK(all_of(page, R"(<b>(\d+)</b> hold<)") == std::vector{std::to_string(counts["holds"])});
    CHECK(all_of(page, R"(<b>(\d+)</b> refuted<)") == std::vector{std::to_string(counts["refuted"])});
    CHECK(all_of(page, R"(<b>(\d+)</b> qualified<)").size() == (counts["qualified"] > 0 ? 1 : 0));
    CHECK(all_of(page, "<tr id=\"claim-([^\"]*)\"").size() == shown);
    const auto links =
        all_of(page, "<a class=\"jump\" href=\"#scene-rtg-fig-7-3-4100\" data-view=\"([^\"]*)\">rtg-fig");
    CHECK(links.size() == 2);
    for (const auto& link : links) CHECK(has(link, "form=sphere.schoolbook&amp;format=f32"));
}

TEST_CASE("the offsets of a report are the CSV's numbers, and are there on request") {
    const Scratch scratch, table;
    const std::string what = "near-benign -i sphere.unified -f f32 --no-claims --size 24x18 ";
    CHECK(report_of(what, scratch).find("id=\"offsets\"") == std::string::npos);
    const std::string page = report_of(what + "--offsets offset-shells.outside --force", scratch);
    must("offsets offset-shells.outside --size 24x18 --points computed -o " + in(table));
    const auto summary = read_csv(table / "offset-shells.outside/summary.csv");
    const auto at = page.find("id=\"offsets-offset-shells.outside\"");
    REQUIRE(at != std::string::npos);
    const std::string part = page.substr(at, page.find("<img", at) - at);
    const auto cells = all_of(part, R"re(<data value="([^"]*)")re");
    std::vector<std::string> expected;
    for (const char* side : {"outside", "inside"}) {
        for (const auto& row : summary) {
            if (row.at("side") != side) continue;
            for (const char* column :
                 {"bad_fraction", "self_hit_fraction", "self_hit_by_form_fraction", "lost_occluder_fraction",
                  "lost_exit_fraction", "wrong_side_fraction", "oversize_p50", "oversize_p99"}) {
                if (!row.at(column).empty()) expected.push_back(row.at(column));
            }
        }
    }
    CHECK(expected.size() > 100);
    CHECK(cells == expected);
    CHECK(has(part, "right for all"));
    const std::string overview = page.substr(page.find("id=\"offsets\""), at - page.find("id=\"offsets\""));
    CHECK(all_of(overview, R"re(<data value="([^"]*)")re").size() == summary.size());
}

TEST_CASE("a report shows the choice for a scene and a requirement on request") {
    const Scratch scratch;
    const std::string what = "near-benign -i sphere.unified -i sphere.schoolbook -f f32 --no-claims --size 32x32 ";
    CHECK(report_of(what, scratch).find("id=\"choose\"") == std::string::npos);
    const std::string page =
        report_of(what + "--choose rtg-fig-7-3-4100-oblique:40:max --choose near-benign:8 --force", scratch);
    const auto at = page.find("id=\"choose\"");
    REQUIRE(at != std::string::npos);
    const std::string part = page.substr(at, page.find("</section>", at) - at);
    CHECK(has(part, "Another run measures other times"));
    CHECK(has(part, "rtg-fig-7-3-4100-oblique: 40 correct bits of every hit, no wrong decision\n"));
    CHECK(has(part, "The cheapest is sphere.unified in f64"));
    CHECK(all_of(part, "<th scope=\"row\">([^<]*)</th>").size() == 8);
    const auto chosen = all_of(part, "<tr class=\"chosen\"><th scope=\"row\">([^<]*)</th>");
    REQUIRE(chosen.size() == 2);
    CHECK(chosen.front() == "sphere.unified");
    CHECK(all_of(part, "(<figure class=.chart plotted)").size() == 2);
    // If nothing meets the requirement, the page says why, as the command does.
    const std::string none = report_of(what + "--choose near-benign:53 --force", scratch);
    CHECK(has(none, "What limits it: "));
}

TEST_CASE("a report shows what to change in a form on request, as mend does") {
    const Scratch scratch, mended;
    const std::string what = "near-benign -i sphere.unified -f f32 --no-claims --size 32x32 ";
    CHECK(report_of(what, scratch).find("id=\"mend\"") == std::string::npos);
    const auto section_of = [](const std::string& page) {
        const auto at = page.find("<section id=\"mend\">");
        REQUIRE(at != std::string::npos);
        return page.substr(at, page.find("</section>", at) - at);
    };
    const std::string part = section_of(report_of(what + "--mend near-benign:sphere.half_b:20 --force", scratch));
    CHECK(has(part, "sphere.half_b in f32: 20 correct bits of every hit, no wrong decision <code>near-benign</code>"));
    must("mend near-benign -i sphere.half_b --bits 20 --size 32x32 -o " + in(mended));
    CHECK(part == section_of(contents(mended / "near-benign/index.html")));
    // If nothing meets the requirement, the page says so.
    CHECK(has(section_of(report_of(what + "--mend near-benign:sphere.pythagoras:22:p99 --force", scratch)),
              "Even with all of its "));
}

TEST_CASE("data/report.toml names existing scenes, forms and sweeps") {
    const auto data = fs::path(LOSTBITS_DATA_DIR);
    const auto report = lostbits::scene::check::read_report_file(data / "report.toml");
    REQUIRE(report.scenes.size() >= 5);
    REQUIRE(report.sweeps.size() >= 5);
    CHECK_FALSE(report.mends.empty());
    auto scenes = report.scenes, forms = report.forms;
    scenes.insert(scenes.end(), report.offsets.begin(), report.offsets.end());
    for (const auto& word : report.mends) {  // SCENE:FORM:…
        const auto colon = word.find(':');
        scenes.push_back(word.substr(0, colon));
        forms.push_back(word.substr(colon + 1, word.find(':', colon + 1) - colon - 1));
    }
    for (const auto& name : scenes) {
        const auto found = lostbits::scene::file::find_scene(name, data);
        CHECK(lostbits::scene::file::load_scene(found.path, {.variant = found.variant}).size() == 1);
    }
    const std::string listed = run("list forms").out;
    for (const auto& form : forms) CHECK(has(listed, form + " "));
    for (const auto& name : report.sweeps) CHECK(fs::exists(lostbits::scene::sweep::find_sweep(name, data)));
    const ScratchFile file("report.toml",
                           "schema = \"lostbits-report/1\"\nscenes = [\"a\"]\nsweeps = [\"b\"]\nforms = "
                           "[\"*\"]\nformats = [\"f32\"]\nsceens = [\"a\"]\n");
    CHECK_THROWS_WITH(lostbits::scene::check::read_report_file(file.path()),
                      Catch::Contains("report.toml:6:1") && Catch::Contains("did you mean \"scenes\"?"));
}

TEST_CASE("data packed for a page keeps its numbers") {
    using namespace lostbits::output::report;
    for (const auto& [bytes, text] : {std::pair{"", ""},
                                      {"f", "Zg=="},
                                      {"fo", "Zm8="},
                                      {"foo", "Zm9v"},
                                      {"foob", "Zm9vYg=="},
                                      {"fooba", "Zm9vYmE="},
                                      {"foobar", "Zm9vYmFy"}})
        CHECK(lostbits::output::file::encode_base64(bytes) == text);
    // RFC 4648's examples above; below, differences in two's complement: 0, -1, 1, -2, 2 become 0, 1, 2, 3, 4.
    for (const int width : {4, 8}) {
        CHECK(lostbits::output::report::folded_difference(7, 7, width) == 0);
        CHECK(folded_difference(6, 7, width) == 1);
        CHECK(folded_difference(8, 7, width) == 2);
        CHECK(folded_difference(5, 7, width) == 3);
    }
    CHECK(lostbits::output::report::folded_difference(0, 1, 8) == 1);
    CHECK(folded_difference(0x80000000u, 0, 4) == 0xffffffffu);  // the farthest there is
    lostbits::output::report::Layer layer(4, 2);
    layer.set(0, std::uint64_t{0x04030201});
    layer.set(1, std::uint64_t{0x14131211});
    CHECK(layer.planes() == std::string("\x01\x11\x02\x12\x03\x13\x04\x14"));
}

}  // namespace test_report
