// `lostbits offsets` from the outside: its files, what it refuses, and that its tables say the same as its claims.
#include <algorithm>
#include <nlohmann/json.hpp>
#include <set>

#include "catch.hpp"
#include "program.hpp"

namespace test_offsets {

using namespace lostbits::test;

TEST_CASE("offsets writes a picture for each side and strategy, a sheet and a table") {
    const Scratch scratch;
    const auto r =
        run("offsets near-benign --size 24x18 --strategy offset.bound,offset.none --pixels csv --along world "
            "--pictures all" +
            into(scratch, ""));
    INFO(r.err);
    REQUIRE(r.code == 0);
    const auto folder = scratch.path() / "near-benign";
    CHECK(has(r.out, (folder / "contact.png").string() + "\n"));
    CHECK(has(r.out, "right for all"));
    std::vector<std::string> expected{"along.world.csv", "contact.png", "datapackage.json", "manifest.json",
                                      "summary.csv"};
    for (const std::string point : {"computed", "projected"}) {
        const std::string row = "sphere.half_b.f32." + point;
        expected.push_back(row + ".csv");
        for (const std::string side : {".inside", ".outside"}) {
            for (const char* what : {".safe.png", ".none.png", ".bound.png"}) expected.push_back(row + side + what);
            for (const char* what : {".wrong.png", ".size.png"}) expected.push_back("along.world." + row + side + what);
        }
    }
    for (auto& name : expected) name = "near-benign/" + name;
    std::ranges::sort(expected);
    CHECK(scratch.files() == expected);

    const auto table = read_csv(folder / "summary.csv"), along = read_csv(folder / "along.world.csv"),
               pixels = read_csv(folder / "sphere.half_b.f32.computed.csv");
    CHECK(table.size() == 8);  // two strategies, two sides, two kinds of points
    CHECK(along.size() == 13 * table.size());
    const auto package = nlohmann::json::parse(contents(folder / "datapackage.json"));
    CHECK(package.at("resources").size() == 4);
    CHECK(package.at("resources").at(0).at("schema").at("fields").size() == table.front().size());
    CHECK(package.at("resources").at(1).at("schema").at("fields").size() == pixels.front().size());
    // A row a point, and the sums of the rows are the table's.
    const auto& none = *std::ranges::find_if(table, [](const auto& row) {
        return row.at("strategy") == "offset.none" && row.at("side") == "outside" && row.at("point") == "computed";
    });
    CHECK(std::to_string(pixels.size()) == none.at("points"));
    double rays = 0, hits = 0, safe = 0;
    for (const auto& row : pixels) {
        rays += number_in(row.at("rays_outside"));
        hits += number_in(row.at("none_self_hits_outside"));
        safe = std::max(safe, number_in(row.at("safe_outside")));
    }
    CHECK(rays == number_in(none.at("rays")));
    CHECK(hits / rays == Approx(number_in(none.at("self_hit_fraction"))));
    CHECK(safe == number_in(none.at("safe_max")));
    CHECK(none.at("offset_max") == "0");
    CHECK(none.at("operations") == "0");
}

TEST_CASE("offsets refuses what it cannot measure, and says what to try") {
    const Scratch scratch;
    struct Case {
        std::string words;
        int code;
        std::string says;
    };
    const std::string boxes = "'" + scratch.write("wall.toml", spoilt("[[sphere]]", "[[ball]]")) + "'";
    const Case cases[] = {
        {"near-benign --strategy offset.integr", 2, "did you mean \"offset.integer\"?"},
        {"near-benign --strategy 'x.*'", 4, "lostbits list strategies"},
        {"near-bening", 2, "did you mean \"near-benign\"?"},
        {"near-benign -i sphere.haf_b", 2, "did you mean"},
        {"near-benign -i 'sdf.*'", 4, "try -i 'sphere.*'"},
        {"near-benign -i 'box.*'", 4, "no selected form handles near-benign"},
        {"near-benign -f f33", 2, "f32"},
        {"near-benign --points nowhere", 2, "computed"},
        {"near-benign --along time", 2, "distance, radius, world"},
        {"near-benign --size 0x4", 2, "--size"},
        {"sphereflake-near", 2, "1000 is the most"},
        {"sdf-union -i 'sphere.*'", 4, "it has spheres and boxes, and no selected form is for boxes; try -i sphere."},
        {"raycast-course.pixels --along distance", 2, "cannot move"},
        {boxes, 2, "wall.toml:"},
        {"", 2, "SCENE"},
    };
    for (const Case& c : cases) {
        const auto r = run("offsets " + c.words + into(scratch));
        INFO(c.words << "\n" << r.err);
        CHECK(r.code == c.code);
        CHECK(has(r.err, c.says));
        CHECK_FALSE(std::filesystem::exists(scratch.path() / "out"));
    }
    CHECK(run("offsets near-benign").code == 2);        // no folder
    CHECK(run("offsets near-benign -o ''").code == 2);  // an empty one
}

TEST_CASE("offsets: one table on standard output, and what a scene without points says") {
    const Scratch scratch;
    const auto table = run("offsets near-benign --size 8x6 --points computed --strategy offset.bound -o -");
    REQUIRE(table.code == 0);
    CHECK(table.out.starts_with("strategy,side,point,form,format,operations,points,"));
    CHECK(std::ranges::count(table.out, '\n') == 3);
    // `none` is the name of a strategy, so it cannot say that there is none.
    const auto bad =
        run("offsets near-benign --size 32x24 --points computed --strategy offset.none" + into(scratch, ""));
    REQUIRE(bad.code == 0);
    CHECK(has(bad.out, "rays: no strategy\n"));
    const Scratch elsewhere;
    const auto empty = run("offsets near-benign --size 8x6 --set 'camera.look_at=[9,9,9]'" + into(elsewhere, ""));
    CHECK(empty.code == 0);
    CHECK(has(empty.err, "no point to leave"));
    for (const auto& row : read_csv(elsewhere.path() / "near-benign/summary.csv")) {
        CHECK(row.at("points") == "0");
        CHECK(row.at("self_hit_fraction").empty());
        CHECK(row.at("safe_max").empty());
    }
}

TEST_CASE("a sheet without thickness has no safe offset into it, and that is said in words") {
    const Scratch scratch;
    static_cast<void>(scratch.write("flat.toml",
                                    "schema = \"lostbits-scene/1\"\ntitle = \"flat\"\ninputs = \"shared\"\n"
                                    "size = [8, 8]\n[camera]\nkind = \"pinhole\"\nfov_deg = 40\n"
                                    "eye = [0.3, 0.7, 6]\nlook_at = [0, 0, 0]\nup = [0, 1, 0]\n"
                                    "[[box]]\nlo = [-1, -1, 0]\nhi = [1, 1, 0]\n"));
    const auto r = run("offsets flat.toml --points computed --strategy offset.bound -o out", scratch.path());
    INFO(r.err);
    CHECK(r.code == 0);
    CHECK(has(r.out, "inside: no offset is safe at any of 16 points; right for all 288 rays: no strategy"));
    CHECK_FALSE(has(r.out, "nan"));
}

TEST_CASE("strategies are listed with what they cost") {
    const auto array = nlohmann::json::parse(run("list strategies --json").out);
    std::set<std::string> names;
    for (const auto& o : array) names.insert(o["name"]);
    for (const char* name :
         {"none", "tmin", "epsilon", "direction", "ulp", "integer", "cycles", "relative", "bound", "exclude"})
        CHECK(names.contains("offset." + std::string(name)));
    CHECK(array[0]["operations_sphere"] == "0");
}

TEST_CASE("claims about offsets are measured, and those that are none are refused") {
    const Scratch scratch;
    const auto claim = [&](const std::string& given, const std::string& metric, const std::string& in) {
        static_cast<void>(
            scratch.write("c.toml",
                          "schema = \"lostbits-claims/1\"\n[[claim]]\nid = \"c\"\nstatement = \"s\"\nsource = \"-\"\n"
                          "verdict = \"holds\"\n[claim.given]\noffsets = \"offset-thin-box\"\nform = \"box.baseline\"\n"
                          "format = \"f32\"\n" +
                              given + "\n[claim.expect]\nmetric = \"" + metric + "\"\nin = " + in + "\n"));
        return run("check c.toml --export-csv out.csv", scratch.path());
    };
    const auto held = claim("strategy = \"offset.epsilon\"\nside = \"inside\"", "bad_fraction", "[0.99, 1]");
    INFO(held.err);
    CHECK(held.code == 0);
    const auto row = read_csv(scratch.path() / "out.csv").front();
    CHECK(has(row.at("subject"), "rays inside"));
    CHECK(has(row.at("witness_explain"), "lostbits explain --box="));
    CHECK(claim("strategy = \"offset.epsilon\"\nside = \"inside\"", "bad_fraction", "[0, 0.5]").code == 1);
    struct Case {
        std::string given, metric, says;
    };
    const Case cases[] = {
        {"", "bad_fraction", "strategy"},
        {"strategy = \"offset.epsilo\"", "bad_fraction", "did you mean \"offset.epsilon\"?"},
        {"strategy = \"offset.none\"\nside = \"insid\"", "bad_fraction", "did you mean \"inside\"?"},
        {"strategy = \"offset.none\"\npoints = \"exact\"", "bad_fraction", "computed"},
        {"strategy = \"offset.none\"", "bad_fractio", "did you mean \"bad_fraction\"?"},
        {"strategy = \"offset.none\"\nat = 3", "bad_fraction", "leave it out"},
        {"strategy = \"offset.none\"\nscene = \"near-benign\"", "bad_fraction", "write one of them"},
    };
    for (const Case& c : cases) {
        const auto r = claim(c.given, c.metric, "[0, 1]");
        INFO(c.given << "\n" << r.err);
        CHECK(r.code == 2);
        CHECK(has(r.err, "c.toml:"));
        CHECK(has(r.err, c.says));
    }
}

}  // namespace test_offsets
