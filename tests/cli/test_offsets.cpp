// `lostbits offsets` from the outside: its files, what it refuses, and that its tables say the same as its claims.
#include <algorithm>
#include <nlohmann/json.hpp>

#include "catch.hpp"
#include "program.hpp"

namespace test_offsets {

using namespace lostbits::test;

TEST_CASE("offsets writes a picture for each side and strategy, a sheet and a table") {
    const Scratch scratch;
    const auto r = must(
        "offsets near-benign --size 24x18 --strategy offset.bound,offset.none --pixels csv --along world "
        "--pictures all" +
        into(scratch, ""));
    const auto folder = scratch / "near-benign";
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
    check_refused(
        Scratch(), "offsets -o out",
        {{"near-benign --strategy offset.integr", "did you mean \"offset.integer\"?"},
         {"near-benign --strategy 'x.*'", "lostbits list strategies", 4},
         {"near-benign -i 'sdf.*'", "try -i 'sphere.*'", 4},
         {"near-benign --points nowhere", "computed"},
         {"near-benign --along time", "distance, radius, world"},
         {"sphereflake-near", "1000 is the most"},
         {"sdf-union -i 'sphere.*'", "it has spheres and boxes, and no selected form is for boxes; try -i sphere.", 4},
         {"raycast-course.pixels --along distance", "cannot move"}});
}

TEST_CASE("offsets: one table on standard output, and what a scene without points says") {
    const Scratch scratch;
    const auto table = must("offsets near-benign --size 8x6 --points computed --strategy offset.bound -o -");
    CHECK(table.out.starts_with("strategy,side,point,form,format,operations,points,"));
    CHECK(std::ranges::count(table.out, '\n') == 3);
    // `none` is the name of a strategy, so it cannot say that there is none.
    const auto bad =
        must("offsets near-benign --size 32x24 --points computed --strategy offset.none" + into(scratch, ""));
    CHECK(has(bad.out, "rays: no strategy\n"));
    const Scratch elsewhere;
    const auto empty = must("offsets near-benign --size 8x6 --set 'camera.look_at=[9,9,9]'" + into(elsewhere, ""));
    CHECK(has(empty.err, "no point to leave"));
    for (const auto& row : read_csv(elsewhere / "near-benign/summary.csv")) {
        CHECK(row.at("points") == "0");
        CHECK(row.at("self_hit_fraction").empty());
        CHECK(row.at("safe_max").empty());
    }
}

TEST_CASE("a sheet without thickness has no safe offset into it, and that is said in words") {
    const Scratch scratch;
    scratch.write("flat.toml",
                  "schema = \"lostbits-scene/1\"\ntitle = \"flat\"\ninputs = \"shared\"\n"
                  "size = [8, 8]\n[camera]\nkind = \"pinhole\"\nfov_deg = 40\n"
                  "eye = [0.3, 0.7, 6]\nlook_at = [0, 0, 0]\nup = [0, 1, 0]\n"
                  "[[box]]\nlo = [-1, -1, 0]\nhi = [1, 1, 0]\n");
    const auto r = must("offsets flat.toml --points computed --strategy offset.bound -o out", scratch.path());
    CHECK(has(r.out, "inside: no offset is safe at any of 16 points; right for all 288 rays: no strategy"));
    CHECK_FALSE(has(r.out, "nan"));
}

TEST_CASE("claims about offsets are measured, and those that are none are refused") {
    const Scratch scratch;
    const std::string box = "offsets = \"offset-thin-box\"\n" + tested("box.baseline"),
                      none = box + "strategy = \"offset.none\"\n", bad = metric_in("bad_fraction");
    const auto check = [&](const std::string& in) {
        scratch.write("c.toml", claims_of({{"c", box + "strategy = \"offset.epsilon\"\nside = \"inside\"\n",
                                            metric_in("bad_fraction", in)}}));
        return run("check c.toml --export-csv out.csv", scratch.path()).code;
    };
    CHECK(check("[0, 0.5]") == 1);
    CHECK(check("[0.99, 1]") == 0);
    const auto row = read_csv(scratch / "out.csv").front();
    CHECK(has(row.at("subject"), "rays inside"));
    CHECK(has(row.at("witness_explain"), "lostbits explain --box="));
    check_refused_claims(scratch, {{box, bad, "strategy"},
                                   {box + "strategy = \"offset.epsilo\"\n", bad, "did you mean \"offset.epsilon\"?"},
                                   {none + "side = \"insid\"\n", bad, "did you mean \"inside\"?"},
                                   {none + "points = \"exact\"\n", bad, "computed"},
                                   {none, metric_in("bad_fractio"), "did you mean \"bad_fraction\"?"},
                                   {none + "at = 3\n", bad, "leave it out"},
                                   {none + "scene = \"near-benign\"\n", bad, "write one of them"}});
}

}  // namespace test_offsets
