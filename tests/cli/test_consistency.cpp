// `lostbits consistency` and `lostbits offsets` from the outside: files, refused input, and agreement of commands with
// claims.
#include <algorithm>
#include <nlohmann/json.hpp>

#include "catch.hpp"
#include "program.hpp"
#include "run_explain.hpp"

namespace test_consistency {

using namespace lostbits::test;

namespace {

using Row = std::map<std::string, std::string>;

const Row& row_of(const std::vector<Row>& table, const std::string& check) {
    const auto found = std::ranges::find_if(table, [&](const Row& row) { return row.at("check") == check; });
    REQUIRE(found != table.end());
    return *found;
}

}  // namespace

TEST_CASE("consistency writes a picture for each check, a sheet and a table") {
    const Scratch scratch;
    const auto r =
        must("consistency near-benign --size 24x18 -i sphere.half_b --pixels csv --pictures all" + into(scratch, ""));
    const auto folder = scratch / "near-benign";
    CHECK(has(r.out, (folder / "contact.png").string() + "\n"));
    CHECK(has(r.out, "sphere.half_b f32 segment: decisions differ for "));
    CHECK(has(r.out, "sphere.half_b f32 gives the same answers: beyond, end, before, short, packs, placed\n"));
    CHECK(r.out.ends_with("`lostbits list checks` shows both questions\n"));
    std::vector<std::string> expected{"contact.png", "datapackage.json", "manifest.json", "sphere.half_b.f32.csv",
                                      "summary.csv"};
    const std::vector<std::string> checks{"beyond", "end", "before", "segment", "short", "packs", "reverse", "placed"};
    for (const auto& check : checks) expected.push_back("sphere.half_b.f32." + check + ".png");
    for (auto& name : expected) name = "near-benign/" + name;
    std::ranges::sort(expected);
    CHECK(scratch.files() == expected);

    const auto table = read_csv(folder / "summary.csv");
    const auto pixels = read_csv(folder / "sphere.half_b.f32.csv");
    CHECK(table.size() == checks.size());
    CHECK(pixels.size() == 24 * 18);
    const auto package = nlohmann::json::parse(contents(folder / "datapackage.json"));
    CHECK(package.at("resources").size() == 2);
    // The pixels of the table are those of the summary.
    for (const Row& row : table) {
        const std::string check = row.at("check");
        const bool numbers = check == "reverse" || check == "placed";
        int rays = 0, alike = 0;
        double most = 0;
        for (const Row& pixel : pixels) {
            rays += pixel.at(check) != "not_asked";
            alike += pixel.at(check) == "agree";
            if (numbers) most = std::fmax(most, number_in(pixel.at(check + "_excess")));  // nothing for NaN
        }
        INFO(check);
        CHECK(std::to_string(rays) == row.at("rays"));
        CHECK(std::to_string(alike) == row.at("agree"));
        if (numbers) CHECK(most == number_in(row.at("excess_max")));
    }
}

TEST_CASE("consistency: two rays that disagree still disagree when pasted") {
    const Scratch scratch;
    const auto pasted = [&scratch](const std::string& words, const std::string& scene) {
        must("consistency " + scene + " --size 32x24 " + words + " -q -o .", scratch.path());
        const auto row = read_csv(scratch / (scene + "/summary.csv")).front();
        return std::pair(run_explain(row.at("first_explain")), run_explain(row.at("second_explain")));
    };
    for (const std::string form : {"sphere.schoolbook", "sphere.pythagoras", "sphere.expanded"}) {
        INFO(form);
        const auto [one, other] = pasted("--check reverse -i " + form, "rtg-fig-7-3-4100-oblique");
        CHECK(one["hit"] != other["hit"]);
        // The origin of one is where the other ends, and the directions are opposite.
        for (const char* axis : {"d.x", "d.y", "d.z"})
            CHECK(one["inputs"][axis]["decimal"].get<double>() == -other["inputs"][axis]["decimal"].get<double>());
        // At least one of the two is wrong; otherwise the inputs would be to blame.
        const auto wrong = [](const nlohmann::json& j) {
            return j["outcome"] != "agree_hit" && j["outcome"] != "agree_miss";
        };
        CHECK((wrong(one) || wrong(other)));
    }
    // The form of a box takes the end of the ray: the same ray misses if it ends one float before its t, but is hit
    // here.
    const auto [closest, shadow] = pasted("--check before -i box.max_mult", "box-octree");
    CHECK(closest["hit"] == true);
    CHECK(shadow["hit"] == true);
    CHECK(shadow["inputs"]["ray.tmax"]["decimal"].get<double>() < closest["t"]["decimal"].get<double>());
}

TEST_CASE("consistency: a scene without hits is reported") {
    const Scratch scratch;
    must("consistency near-benign --size 8x6 -i sphere.unified --set 'camera.look_at=[9,9,9]' -o .", scratch.path());
    const auto rows = read_csv(scratch / "near-benign/summary.csv");
    CHECK(row_of(rows, "beyond").at("rays") == "0");
    CHECK(row_of(rows, "beyond").at("disagree_fraction").empty());
    CHECK(row_of(rows, "packs").at("rays") == "48");
}

TEST_CASE("claims about consistency are measured, and wrong ones are refused") {
    const Scratch scratch;
    const std::string octree = "consistency = \"box-octree\"\n" + form_keys("box.max_mult"),
                      before = octree + "check = \"before\"\n";
    const auto check = [&](const std::string& in) {
        scratch.write("c.toml", make_claim_file({{"c", before, metric_keys("disagree_fraction", in)}}));
        return run("check c.toml --export-csv out.csv", scratch.path()).code;
    };
    CHECK(check("[0, 0.5]") == 1);
    CHECK(check("[1, 1]") == 0);
    const auto out = read_csv(scratch / "out.csv").front();
    CHECK(has(out.at("subject"), "consistency, check before"));
    CHECK(has(out.at("witness_explain"), "lostbits explain --box="));
    const std::string fraction = metric_keys("disagree_fraction");
    check_refused_claims(scratch, {{octree, fraction, "check"},
                                   {octree + "check = \"befor\"\n", fraction, "did you mean \"before\"?"},
                                   {octree + "check = \"light\"\n", fraction, "none of these checks applies"},
                                   {before, metric_keys("disagree_fractio"), "did you mean \"disagree_fraction\"?"},
                                   {before + "at = 3\n", fraction, "leave it out"},
                                   {before + "scene = \"near-benign\"\n", fraction, "write one of them"},
                                   {"scene = \"box-octree\"\ncheck = \"before\"\n" + form_keys("box.max_mult"),
                                    metric_keys("false_hit_fraction"), "needs consistency"}});
}

TEST_CASE("a claim names a study, its options and a row of its summary") {
    const Scratch scratch;
    const auto given = [](const std::string& words) {
        return "study = \"consistency\"\nscene = \"near-benign\"\n" + words + form_keys("sphere.half_b");
    };
    const std::string fraction = metric_keys("disagree_fraction");
    for (const char* words : {"options = { check = \"beyond\" }\n", "where = { check = \"beyond\" }\n"}) {
        scratch.write("c.toml", make_claim_file({{"c", given(words), fraction}}));
        CHECK(run("check c.toml", scratch.path()).code == 0);
    }
    check_refused_claims(scratch,
                         {{given(""), fraction,
                           "several rows of the summary of consistency have form = \"sphere.half_b\", format = "
                           "\"f32\"; say which one is meant, by check"},
                          {given("options = { chek = \"beyond\" }\n"), fraction, "did you mean \"check\"?"},
                          {given("options = { check = 3 }\n"), fraction, "a string is expected"},
                          {given("where = { checks = \"beyond\" }\n"), fraction, "did you mean \"check\"?"},
                          {given("where = { check = \"beyon\" }\n"), fraction, "has no row with check = \"beyon\""},
                          {given("options = { check = \"beyond\" }\nstep = 3\n"), fraction, "step"},
                          {"study = \"consistenc\"\nscene = \"near-benign\"\n" + form_keys("sphere.half_b"), fraction,
                           "did you mean \"consistency\"?"},
                          {"study = \"consistency\"\n" + form_keys("sphere.half_b"), fraction, "A study needs a scene"},
                          {"scene = \"near-benign\"\nwhere = { check = \"beyond\" }\n" + form_keys("sphere.half_b"),
                           metric_keys("false_hit_fraction"), "needs study"}});
}

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
    // There is one row per point, and the sums of the rows are the numbers of the table.
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

TEST_CASE("offsets: a scene without hits is reported") {
    const Scratch scratch;
    // `none` is the name of a strategy, so it cannot mean that a strategy is missing.
    const auto bad =
        must("offsets near-benign --size 32x24 --points computed --strategy offset.none" + into(scratch, ""));
    CHECK(has(bad.out, "rays: no strategy\n"));
    const Scratch elsewhere;
    const auto empty = must("offsets near-benign --size 8x6 --set 'camera.look_at=[9,9,9]'" + into(elsewhere, ""));
    CHECK(has(empty.err, "no next ray can start anywhere"));
    for (const auto& row : read_csv(elsewhere / "near-benign/summary.csv")) {
        CHECK(row.at("points") == "0");
        CHECK(row.at("self_hit_fraction").empty());
        CHECK(row.at("safe_max").empty());
    }
}

TEST_CASE("offsets: a sheet without thickness has no safe offset into it, and the output says so") {
    const Scratch scratch;
    scratch.write("flat.toml",
                  scene_text("[[box]]\nlo = [-1, -1, 0]\nhi = [1, 1, 0]\n", "inputs = \"shared\"\nsize = [8, 8]\n",
                             "kind = \"pinhole\"\nfov_deg = 40\neye = [0.3, 0.7, 6]\n"));
    const auto r = must("offsets flat.toml --points computed --strategy bound -o out", scratch.path());
    CHECK(has(r.out, "inside: no offset is safe at any of 16 points; right for all 288 rays: no strategy"));
    CHECK_FALSE(has(r.out, "nan"));
}

TEST_CASE("claims about offsets are measured, and wrong ones are refused") {
    const Scratch scratch;
    const std::string box = "offsets = \"offset-thin-box\"\n" + form_keys("box.baseline"),
                      none = box + "strategy = \"offset.none\"\n", bad = metric_keys("bad_fraction");
    const auto check = [&](const std::string& in) {
        scratch.write("c.toml", make_claim_file({{"c", box + "strategy = \"offset.epsilon\"\nside = \"inside\"\n",
                                                  metric_keys("bad_fraction", in)}}));
        return run("check c.toml --export-csv out.csv", scratch.path()).code;
    };
    CHECK(check("[0, 0.5]") == 1);
    CHECK(check("[0.99, 1]") == 0);
    const auto row = read_csv(scratch / "out.csv").front();
    CHECK(has(row.at("subject"), "side inside"));
    CHECK(has(row.at("witness_explain"), "lostbits explain --box="));
    check_refused_claims(scratch, {{box, bad, "strategy"},
                                   {box + "strategy = \"offset.epsilo\"\n", bad, "did you mean \"offset.epsilon\"?"},
                                   {none + "side = \"insid\"\n", bad, "there is side = \"inside\", side = \"outside\""},
                                   {none + "points = \"exact\"\n", bad, "computed"},
                                   {none, metric_keys("bad_fractio"), "did you mean \"bad_fraction\"?"},
                                   {none + "at = 3\n", bad, "leave it out"},
                                   {none + "scene = \"near-benign\"\n", bad, "write one of them"}});
}

}  // namespace test_consistency
