// The manners of the command line: one value an option, several between commas, names from any folder.
#include "catch.hpp"
#include "program.hpp"

namespace test_manners {

using namespace lostbits::test;

namespace {

/// Without $LOSTBITS_DATA: as from a fresh shell.
constexpr const char* fresh = "unset LOSTBITS_DATA;";

}  // namespace

TEST_CASE("an option takes one value, and the scene may follow it") {
    const Scratch scratch;
    scratch.write("mine.toml", good_scene);
    for (const char* words :
         {"map -i sphere.unified mine.toml --size 8x8", "map --set sphere[0].radius=0.5 mine.toml --size 8x8 -f f32",
          "map --metric lost_bits mine.toml --size 8x8 -f f32",
          "render --stage visible raycast-course.small --size 8x6",
          "sweep -f f32 -i sphere.press sphere-tilt --seeds 0 --steps 4",
          "report --claims 'rtg7.fig6.schoolbook-near-*' -i sphere.press -f f32 near-benign --size 8x8"})
        must(std::string(words) + " -o out --force", scratch.path());
}

TEST_CASE("several values are separated by commas, and options may be repeated") {
    const Scratch scratch;
    scratch.write("mine.toml", good_scene);
    const auto rows = [&](const std::string& options) {
        must("map mine.toml --size 8x8 " + options + " -o out", scratch.path());
        std::string text;
        for (const auto& row : read_csv(scratch / "out/mine/summary.csv"))
            text += row.at("form") + " " + row.at("format") + "\n";
        return text;
    };
    const std::string both = rows("-i sphere.press -i sphere.unified -f f32 -f f64");
    CHECK(both == "sphere.press f32\nsphere.press f64\nsphere.unified f32\nsphere.unified f64\n");
    CHECK(rows("-i sphere.press,sphere.unified -f f32,f64") == both);
    CHECK(rows("-i 'sphere.press, sphere.unified ' -f 'f32, f64'") == both);
    must("render raycast-course.small --stage 'visible, diffuse' --size 8x6" + into(scratch));
    // A comma inside brackets is the vector's own.
    const auto title = [&](const std::string& set) {
        must("map mine.toml --size 8x8 -i sphere.press -f f32 " + set + " -o out", scratch.path());
        return contents(scratch / "out/mine/datapackage.json");
    };
    const std::string changed = title("--set 'sphere[0].centre=[0.1,0.2,0],sphere[0].radius=0.5'");
    CHECK(has(changed, "sphere[0].centre=[0.1,0.2,0], sphere[0].radius=0.5"));
    must("check --measure --filter 'float.*,box.no-such-*' -q");
}

TEST_CASE("a missing file is named once, without a needless extra line") {
    const Scratch scratch;
    for (const char* words :
         {"map nofile.toml -o o", "map sub/nofile.toml -o o", "sweep nofile.toml -o o", "sweep sub/nofile.toml -o o",
          "check nofile.toml", "explain nofile.toml --pixel 1,1 -i sphere.press", "render nofile.toml -o o",
          "report nofile.toml -o o", "judge nofile.csv -o o"}) {
        for (const char* before : {"", fresh}) {
            const auto r = run(words, scratch.path(), before);
            INFO(words << "\n" << r.err);
            CHECK(r.code == 2);
            CHECK(has(r.err, "nofile."));
            CHECK_FALSE(has(r.err, ":1:1"));
            CHECK_FALSE(r.err.ends_with("; \n"));
        }
    }
    for (const char* what : {"scenes", "sweeps", "claims"}) {
        const auto r = run("list " + std::string(what) + " --data /nowhere");
        CHECK(r.code == 2);
        CHECK(has(r.err, "/nowhere/" + std::string(what) + ": this folder does not exist"));
        CHECK(has(r.err, "LOSTBITS_DATA"));
    }
}

TEST_CASE("a sweep and a claim find a scene in their own folder") {
    const Scratch scratch;
    scratch.write("own/ball.toml", good_scene);
    scratch.write("own/grow.toml",
                  make_sweep_file("scene = \"ball.toml\"\n" +
                                  make_axis({"radius", "\"sphere[0].radius\"", "0.5", "1", 2, "linear"})));
    scratch.write("own/claims.toml",
                  make_claim_file({{"own.ball", "scene = \"ball.toml\"\n" + form_keys("sphere.press"),
                                    metric_keys("false_miss_fraction", "[0, 0]")}}));
    for (const std::string own : {"own/", ""}) {
        const auto folder = scratch.path() / (own.empty() ? "own" : "");
        must("sweep " + own + "grow.toml -i sphere.press -f f32 -o out", folder);
        must("check " + own + "claims.toml", folder);
    }
}

TEST_CASE("an option that would do nothing is reported or refused") {
    const Scratch scratch;
    scratch.write("m.toml", good_scene + "\n[march]\nhit_eps = 1e-4\n");
    const auto mapped =
        must("map m.toml --set march.hit_eps=1e-3 -i sphere.press -f f32 --size 8x8 -o out", scratch.path());
    CHECK(has(mapped.err, "--set march.hit_eps=1e-3: changes nothing in m"));
}

TEST_CASE("a path is printed on a line of its own beside a progress bar") {
    const Scratch scratch;
    scratch.write("a.toml", good_scene);
    scratch.write("b.toml", good_scene);
    const auto r = must("map a.toml b.toml -i sphere.press -f f32 --progress bar -o out 2>&1", scratch.path());
    std::size_t paths = 0;
    for (auto at = r.out.find("out/"); at != std::string::npos; at = r.out.find("out/", at + 1), ++paths) {
        REQUIRE(at > 0);
        // A line begins at a line break, or where the bar was wiped out: blanks, then back to the first column.
        CHECK((r.out[at - 1] == '\n' || r.out[at - 1] == '\r'));
        if (r.out[at - 1] == '\r') CHECK(r.out[at - 2] == ' ');
    }
    CHECK(paths == 2);
}

}  // namespace test_manners
