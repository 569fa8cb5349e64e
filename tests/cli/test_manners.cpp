// The manners of the command line: one value an option, sentences for what is not understood, names from any folder.
#include <nlohmann/json.hpp>
#include <regex>

#include "catch.hpp"
#include "program.hpp"

namespace test_manners {

using namespace lostbits::test;

namespace {

/// Without $LOSTBITS_DATA: as from a fresh shell.
constexpr const char* fresh = "unset LOSTBITS_DATA;";

}  // namespace

TEST_CASE("an option takes one value, and the scene may stand behind it") {
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

TEST_CASE("several values stand between commas, and options may be repeated") {
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

TEST_CASE("what is not understood is said in a sentence, with what may have been meant") {
    const Scratch scratch;
    scratch.write("mine.toml", good_scene);
    scratch.write("r.csv", "x\n");
    const std::string one = "explain near-benign --pixel 1,1 -i sphere.press";
    const std::vector<Refused> rows{
        {"map mine.toml -i unified -o out", "-i unified: unknown form; did you mean \"sphere.unified\"?"},
        {"map mine.toml -i sphere.press -o out --set 'sphere[0].centre=9,9,9'",
         "--set sphere[0].centre=9,9,9: what stands after the comma is not an assignment; write several numbers in "
         "brackets"},
        {"map mine.toml --metrik lost_bits -o out",
         "--metrik: is not an option of `lostbits map`; did you mean --metric?"},
        {"map mine.toml -metrix lost_bits -o out",
         "-metrix: is not an option of `lostbits map`; did you mean --metric?"},
        {"map mine.toml --out", "--out: its value is missing: Folder for the results"},
        {"map mine.toml", "--out is missing: Folder for the results"},
        {"map -o out", "SCENE is missing: Scene files"},
        {"map mine.toml --pixels cvs -o out", "--pixels cvs: is not one of none, csv; did you mean csv?"},
        {"map mine.toml -j 0 -o out", "--threads 0: is not a number from 1 to 1024"},
        {"map mine.toml --progress sometimes -o out", "--progress sometimes: is not one of auto, bar, none"},
        {"map mine.toml --size 4x4 --size 8x8 -o out", "--size: is given 2 times, and takes one value"},
        {"trade -i sphere.press sphere.unified -o out", "sphere.unified: `lostbits trade` takes no such word"},
        {"list scene", "is not one of forms"},
        {"list scene", "did you mean scenes?"},
        {"mapp", "\"mapp\" is not a command; did you mean \"map\"?"},
        {"completion foo", "completion foo: is not one of bash, zsh, fish"},
        {"plugin foo", "plugin foo: is not one of check, serve"},
        {"plugin check a b", "b: `lostbits plugin check` takes no such word"},
        {"plugin check a b", "see `lostbits plugin check --help`"},
        {one + " --fpcor", "did you mean --fpcore?"},
        {"map mine.toml --metric ulps -o out", "did you mean \"ulp_error\"?"},
        {"help map", "help is not a command; write `lostbits map --help`"},
        {"help", "write `lostbits --help`"},
        {"version", "write `lostbits --version`"},
        {"map mine.toml -f f32,,f64 -o out", "-f f32,,f64: has nothing before, between or after its commas"},
        {"map mine.toml -i sphere.press, -o out", "-i sphere.press,: has nothing"},
        {"map mine.toml --metric '' -o out", "--metric: its value is empty"},
        {"map mine.toml -f float -o out", "-f float: unknown format; here it is \"f32\""},
        {"map mine.toml -f f32,double -o out", "-f double: unknown format; here it is \"f64\""},
        {"render raycast-course.small --stage visible,shadow -o out", "--stage shadow: is not one of visible"},
        {one + ",sphere.unified", "names 2 forms, and explain looks at one ray in one form; name one"},
        {one + " -f f32,f64", "names 2 formats, and explain looks at one ray in one format; name one"},
        {"map mine -o out", "did you mean \"mine.toml\"?"},
        {"map ./mine.tmol -o out", "did you mean \"./mine.toml\"?"},
        {"sweep min.toml -o out", "did you mean \"mine.toml\"?"},
        {"", "name a command: check"},
        {"plugin", "name a command: check, serve"},
        {"judge r.csv --skip abc -o out", "--skip abc: is not a whole number"},
        {"map mine.toml --against unifid -o out", "--against unifid: unknown form"},
        {one + " --json --c", "only one of them can be given"},
        {"judge '" LOSTBITS_DATA_DIR "/dumps/far-sphere.csv' --format f32 --sphere 0,0,0,1 --pictures all -o out",
         "--pictures all: rays in a list are no picture"}};
    check_refused(scratch, "", rows);
    for (const Refused& row : rows) {
        const std::string said = run(row.words, scratch.path()).err;
        for (const char* raw :
             {"were not expected", "was not expected", " is required", "not in {", "TEXT", "Could not"})
            CHECK_FALSE(has(said, raw));
    }
}

TEST_CASE("forms have one word, and the older one works") {
    const auto forms = must("list forms"), older = run("list intersectors");
    CHECK(forms.out == older.out);
    CHECK(run("list").out == forms.out);
}

TEST_CASE("every list is there as JSON") {
    const auto help = run("list --help").out;
    std::smatch all;
    REQUIRE(std::regex_search(help, all, std::regex(R"(\{([a-z,]+)\})")));
    std::istringstream words(all[1]);
    int lists = 0;
    for (std::string what; std::getline(words, what, ','); ++lists) {
        INFO(what);
        const auto array = nlohmann::json::parse(run("list --json " + what).out);
        CHECK(array.is_array());
        CHECK_FALSE(array.empty());
    }
    CHECK(lists >= 7);
}

TEST_CASE("a file that is not there is named, without a line that nobody read") {
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
        CHECK(has(r.err, "/nowhere/" + std::string(what) + ": is not a folder of " + what));
        CHECK(has(r.err, "LOSTBITS_DATA"));
    }
}

TEST_CASE("a sweep and a claim find a scene beside themselves") {
    const Scratch scratch;
    scratch.write("own/ball.toml", good_scene);
    scratch.write("own/grow.toml", sweep_of("scene = \"ball.toml\"\n" +
                                            axis_of({"radius", "\"sphere[0].radius\"", "0.5", "1", 2, "linear"})));
    scratch.write("own/claims.toml", claims_of({{"own.ball", "scene = \"ball.toml\"\n" + tested("sphere.press"),
                                                 metric_in("false_miss_fraction", "[0, 0]")}}));
    for (const std::string own : {"own/", ""}) {
        const auto folder = scratch.path() / (own.empty() ? "own" : "");
        must("sweep " + own + "grow.toml -i sphere.press -f f32 -o out", folder);
        must("check " + own + "claims.toml", folder);
    }
}

TEST_CASE("an option that would do nothing is said, where it is not refused") {
    const Scratch scratch;
    scratch.write("m.toml", good_scene + "\n[march]\nhit_eps = 1e-4\n");
    const auto mapped =
        must("map m.toml --set march.hit_eps=1e-3 -i sphere.press -f f32 --size 8x8 -o out", scratch.path());
    CHECK(has(mapped.err, "--set march.hit_eps=1e-3: changes nothing in m"));
}

TEST_CASE("a camera that sees nothing says so") {
    const Scratch scratch;
    const std::string away =
        "'" + scratch.write("away.toml", spoilt("look_at = [0, 0, 0]", "look_at = [0, 0, 90]")) + "'";
    const auto r = must("map " + away + " -i sphere.press -f f32" + into(scratch));
    CHECK(has(r.err, "scene away: no ray of its camera meets a solid"));
    const std::string there = "'" + scratch.write("there.toml", good_scene) + "'";
    CHECK_FALSE(has(run("map " + there + " -i sphere.press -f f32" + into(scratch)).err, "meets a solid"));
}

TEST_CASE("a path stands on a line of its own, beside a bar on the same terminal") {
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
