// `lostbits consistency` from the outside: its files, what it refuses, and that its commands and claims say the same.
#include <algorithm>
#include <nlohmann/json.hpp>

#include "catch.hpp"
#include "output/file/read_csv.hpp"
#include "program.hpp"

namespace test_consistency {

using namespace lostbits::test;
using lostbits::output::file::CsvTable;

namespace {

std::string cell_of(const CsvTable& table, const std::string& column, std::size_t row) {
    const auto* const found = table.find(column);
    INFO(column);
    REQUIRE(found != nullptr);
    return std::string(found->cells.at(row));
}

std::size_t place_of(const CsvTable& table, const std::string& check) {
    for (std::size_t i = 0; i < table.rows(); ++i) {
        if (cell_of(table, "check", i) == check) return i;
    }
    FAIL("no row of " + check);
    return 0;
}

}  // namespace

TEST_CASE("consistency writes a picture for each check, a sheet and a table") {
    const Scratch scratch;
    const auto r =
        run("consistency near-benign --size 24x18 -i sphere.half_b --pixels csv --pictures all" + into(scratch, ""));
    INFO(r.err);
    REQUIRE(r.code == 0);
    const auto folder = scratch.path() / "near-benign";
    CHECK(has(r.out, (folder / "contact.png").string() + "\n"));
    CHECK(has(r.out, "sphere.half_b f32 segment: decisions differ for "));
    CHECK(has(r.out, "sphere.half_b f32 answers alike: beyond, end, before, short, packs, placed\n"));
    std::vector<std::string> expected{"contact.png", "datapackage.json", "manifest.json", "sphere.half_b.f32.csv",
                                      "summary.csv"};
    const std::vector<std::string> checks{"beyond", "end", "before", "segment", "short", "packs", "reverse", "placed"};
    for (const auto& check : checks) expected.push_back("sphere.half_b.f32." + check + ".png");
    for (auto& name : expected) name = "near-benign/" + name;
    std::ranges::sort(expected);
    CHECK(scratch.files() == expected);

    const auto table = lostbits::output::file::read_csv(folder / "summary.csv");
    const auto pixels = lostbits::output::file::read_csv(folder / "sphere.half_b.f32.csv");
    CHECK(table.rows() == checks.size());
    CHECK(pixels.rows() == 24 * 18);
    const auto package = nlohmann::json::parse(contents(folder / "datapackage.json"));
    CHECK(package.at("resources").size() == 2);
    // The pixels of the table are those of the summary.
    for (std::size_t i = 0; i < table.rows(); ++i) {
        const std::string check = cell_of(table, "check", i);
        int rays = 0, alike = 0;
        double most = 0;
        for (std::size_t p = 0; p < pixels.rows(); ++p) {
            const std::string accord = cell_of(pixels, check, p);
            rays += accord != "not_asked";
            alike += accord == "agree";
            if (check != "reverse" && check != "placed") continue;
            const double excess = number_in(cell_of(pixels, check + "_excess", p));
            if (!std::isnan(excess)) most = std::max(most, excess);
        }
        INFO(check);
        CHECK(std::to_string(rays) == cell_of(table, "rays", i));
        CHECK(std::to_string(alike) == cell_of(table, "agree", i));
        if (check == "reverse" || check == "placed") CHECK(most == number_in(cell_of(table, "excess_max", i)));
    }
}

TEST_CASE("consistency: the two rays of a disagreement, pasted, disagree") {
    const Scratch scratch;
    const auto explained = [&scratch](const std::string& command) {
        INFO(command);
        REQUIRE(command.starts_with("lostbits explain "));
        const auto r = run(command.substr(9) + " --json -q", scratch.path());
        INFO(r.err);
        REQUIRE(r.code == 0);
        return nlohmann::json::parse(r.out);
    };
    const auto made = [&scratch](const std::string& words, const std::string& scene) {
        REQUIRE(run("consistency " + scene + " " + words + " -q" + into(scratch, "")).code == 0);
        return lostbits::output::file::read_csv(scratch.path() / scene / "summary.csv");
    };
    int pasted = 0;
    for (const std::string form : {"sphere.schoolbook", "sphere.pythagoras", "sphere.expanded"}) {
        const auto table = made("--size 32x24 --check reverse -i " + form, "rtg-fig-7-3-4100-oblique");
        const auto one = explained(cell_of(table, "first_explain", 0));
        const auto other = explained(cell_of(table, "second_explain", 0));
        INFO(form);
        CHECK(one["hit"] != other["hit"]);
        // The origin of one is where the other ends, and the directions are opposite.
        for (const char* axis : {"d.x", "d.y", "d.z"})
            CHECK(one["inputs"][axis]["decimal"].get<double>() == -other["inputs"][axis]["decimal"].get<double>());
        // At least one of them is wrong: else the inputs would be to blame.
        const auto wrong = [](const nlohmann::json& j) {
            return j["outcome"] != "agree_hit" && j["outcome"] != "agree_miss";
        };
        CHECK((wrong(one) || wrong(other)));
        ++pasted;
    }
    CHECK(pasted == 3);
    // A box is told the end: the same ray is hit with one float less of it than its own t.
    const auto box = made("--size 32x24 --check before -i box.max_mult", "box-octree");
    const auto closest = explained(cell_of(box, "first_explain", 0)),
               shadow = explained(cell_of(box, "second_explain", 0));
    CHECK(closest["hit"] == true);
    CHECK(shadow["hit"] == true);
    CHECK(shadow["inputs"]["limit"]["decimal"].get<double>() < closest["t"]["decimal"].get<double>());
}

TEST_CASE("consistency refuses what it cannot measure, and says what to try") {
    const Scratch scratch;
    struct Case {
        std::string words;
        int code;
        std::string says;
    };
    const Case cases[] = {
        {"near-benign --check revers", 2, "did you mean \"reverse\"?"},
        {"near-benign --check 'x*'", 4, "lostbits list checks"},
        {"near-benign --check light", 2, "light needs a [light]"},
        {"near-benign --check short -i sphere.unit_half_b", 2, "directions of any length"},
        {"near-bening", 2, "did you mean \"near-benign\"?"},
        {"near-benign -i sphere.haf_b", 2, "did you mean"},
        {"near-benign -i 'sdf.*'", 4, "try -i 'sphere.*'"},
        {"near-benign -i 'box.*'", 4, "no selected form handles near-benign"},
        {"near-benign -f f33", 2, "f32"},
        {"near-benign --size 0x4", 2, "--size"},
        {"sphereflake-near", 2, "1000 is the most"},
        {"", 2, "SCENE"},
    };
    for (const Case& c : cases) {
        const auto r = run("consistency " + c.words + into(scratch));
        INFO(c.words << "\n" << r.err);
        CHECK(r.code == c.code);
        CHECK(has(r.err, c.says));
        CHECK_FALSE(std::filesystem::exists(scratch.path() / "out"));
    }
    CHECK(run("consistency near-benign").code == 2);        // no folder
    CHECK(run("consistency near-benign -o ''").code == 2);  // an empty one
}

TEST_CASE("consistency: one table on standard output, and a scene in which nothing is met") {
    const Scratch scratch;
    const auto table = run("consistency near-benign --size 8x6 -i sphere.unified --check packs -o -");
    REQUIRE(table.code == 0);
    CHECK(table.out.starts_with("check,form,format,rays,"));
    CHECK(std::ranges::count(table.out, '\n') == 2);
    const auto empty =
        run("consistency near-benign --size 8x6 -i sphere.unified --set 'camera.look_at=[9,9,9]'" + into(scratch, ""));
    CHECK(empty.code == 0);
    const auto rows = lostbits::output::file::read_csv(scratch.path() / "near-benign/summary.csv");
    const std::size_t beyond = place_of(rows, "beyond");
    CHECK(cell_of(rows, "rays", beyond) == "0");
    CHECK(cell_of(rows, "disagree_fraction", beyond).empty());
    CHECK(cell_of(rows, "rays", place_of(rows, "packs")) == "48");
}

TEST_CASE("checks are listed") {
    const auto array = nlohmann::json::parse(run("list checks --json").out);
    CHECK(array.size() == 9);
    CHECK(array[0]["name"] == "beyond");
}

TEST_CASE("claims about consistency are measured, and those that are none are refused") {
    const Scratch scratch;
    const auto claim = [&](const std::string& given, const std::string& metric, const std::string& in) {
        static_cast<void>(
            scratch.write("c.toml",
                          "schema = \"lostbits-claims/1\"\n[[claim]]\nid = \"c\"\nstatement = \"s\"\nsource = \"-\"\n"
                          "verdict = \"holds\"\n[claim.given]\nform = \"box.max_mult\"\nformat = \"f32\"\n" +
                              given + "\n[claim.expect]\nmetric = \"" + metric + "\"\nin = " + in + "\n"));
        return run("check c.toml --export-csv out.csv", scratch.path());
    };
    const std::string octree = "consistency = \"box-octree\"\n";
    const auto held = claim(octree + "check = \"before\"", "disagree_fraction", "[1, 1]");
    INFO(held.err);
    CHECK(held.code == 0);
    const auto out = lostbits::output::file::read_csv(scratch.path() / "out.csv");
    CHECK(has(cell_of(out, "subject", 0), "consistency, before"));
    CHECK(has(cell_of(out, "witness_explain", 0), "lostbits explain --box="));
    CHECK(claim(octree + "check = \"before\"", "disagree_fraction", "[0, 0.5]").code == 1);
    struct Case {
        std::string given, metric, says;
    };
    const Case cases[] = {
        {octree, "disagree_fraction", "check"},
        {octree + "check = \"befor\"", "disagree_fraction", "did you mean \"before\"?"},
        {octree + "check = \"light\"", "disagree_fraction", "cannot be asked of box.max_mult"},
        {octree + "check = \"before\"", "disagree_fractio", "did you mean \"disagree_fraction\"?"},
        {octree + "check = \"before\"\nat = 3", "disagree_fraction", "leave it out"},
        {octree + "check = \"before\"\nscene = \"near-benign\"", "disagree_fraction", "write one of them"},
        {"scene = \"box-octree\"\ncheck = \"before\"", "false_hit_fraction", "goes with consistency"},
    };
    for (const Case& c : cases) {
        const auto r = claim(c.given, c.metric, "[0, 1]");
        INFO(c.given << "\n" << r.err);
        CHECK(r.code == 2);
        CHECK(has(r.err, "c.toml:"));
        CHECK(has(r.err, c.says));
    }
}

}  // namespace test_consistency
