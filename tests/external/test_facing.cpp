// Contracts of one-sided triangles: they are tested, respected by every command, and refused for shapes without a
// front.
#include <algorithm>
#include <nlohmann/json.hpp>
#include <string>

#include "catch.hpp"
#include "cli/program.hpp"
#include "external/libraries.hpp"

namespace test_facing {

using namespace lostbits::test;

namespace {

const std::string facing = std::string(LOSTBITS_LIBRARIES) + "/facing.so";

const std::string camera = "kind = \"pinhole\"\nfov_deg = 60\neye = [0, 0, 5]\n";

/// A scene of the vertices of a triangle, `a` to `c`, each a list of numbers.
std::string of_triangle(const std::string& a, const std::string& b, const std::string& c) {
    return "[[triangle]]\na = " + a + "\nb = " + b + "\nc = " + c + "\n";
}

}  // namespace

TEST_CASE("facing: plugin check names the missing property, and accepts a form with the right one", "[external]") {
    const Scratch folder;
    const Outcome o = run("plugin check " + facing, folder.path());
    CHECK(o.code == 1);
    const auto finding = [&o](const std::string& form) { return find_output_of(o, form); };
    for (const std::string form : {"front", "back", "both", "ahead", "disc", "plane", "open_plane"}) {
        INFO(finding("word." + form));
        CHECK(has(finding("word." + form), ": keeps its contract"));
    }
    for (const auto& [form, says] : std::initializer_list<std::array<std::string, 2>>{
             {"front", "say LB_FACING_FRONT (facing_front, facing=front)"},
             {"back", "say LB_FACING_BACK (facing_back, facing=back)"},
             {"both", "the other side is met as well; leave facing out"},
             {"ahead", "say LB_MISS (origin_misses, at_origin=miss)"},
             {"plane", "a ray in its plane hits at t = 0; it should miss, since it does not cross it"},
             {"other", "the back is met, not the front as stated; say LB_FACING_BACK (facing_back, facing=back)"}}) {
        INFO(finding("bad." + form));
        CHECK(has(finding("bad." + form), says));
    }
}

TEST_CASE("facing: map, mesh and judge compare each form with its own side", "[external]") {
    const Scratch folder;
    folder.write("near.toml", scene_text(of_triangle("[-1, -1, 1]", "[0, 1, 1]", "[1, -1, 1]") +
                                             of_triangle("[-2, -2, 0]", "[2, -2, 0]", "[0, 2, 0]"),
                                         "", camera));
    folder.write("ball.toml", scene_text("[[mesh]]\nmake = \"icosphere\"\nlevels = 2\nradius = 2\ncentre = [0, 0, 0]\n",
                                         "", camera));
    const auto row = [&](const std::string& name, const std::string& form) {
        return row_of(folder / ("out/" + name + "/summary.csv"), form);
    };
    for (const std::string name : {"near", "ball"}) {
        must("map " + name +
                 ".toml --size 64x64 -f f32 -o out -i triangle.moller_trumbore_culling "
                 "-i triangle.filtered -i 'word.*' -i 'bad.*' --plugin " +
                 facing,
             folder.path());
        for (const std::string form : {"word.front", "word.back", "word.both", "triangle.moller_trumbore_culling"}) {
            auto each = row(name, form);
            INFO(name << ' ' << form);
            CHECK(std::stoi(each["agree_hit"]) > 300);
            for (const char* wrong : {"false_hit", "false_miss", "wrong_primitive"}) CHECK(each[wrong] == "0");
        }
        auto mute = row(name, "bad.back");
        CHECK(std::stoi(mute["false_miss"]) + std::stoi(mute["wrong_primitive"]) + std::stoi("0" + mute["crack"]) >
              300);
    }
    // The front of a ball's triangles is outside: a form that culls back faces hits it as a form that culls nothing
    // does.
    CHECK(row("ball", "word.front")["agree_hit"] == row("ball", "triangle.filtered")["agree_hit"]);

    folder.write("rays.csv", "ox,oy,oz,dx,dy,dz,hit,t\n0,0,5,0,0,-1,0,0\n0,0,-5,0,0,1,1,5\n");
    const auto judged = [&](const std::string& side) {
        must("judge rays.csv --triangle=-1,-1,0,0,1,0,1,-1,0 --facing " + side + " -o " + side, folder.path());
        return read_csv(folder.path() / side / "rays/summary.csv").front();
    };
    CHECK(judged("front")["agree_hit"] == "1");
    CHECK(judged("front")["agree_miss"] == "1");
    CHECK(judged("back")["false_hit"] == "1");
    CHECK(judged("back")["false_miss"] == "1");
    CHECK(judged("both")["false_miss"] == "1");
    const Outcome refused = run("judge rays.csv --sphere 0,0,0,1 --facing front -o out", folder.path());
    CHECK(refused.code == 2);
    CHECK(has(refused.err, "facing is only for shapes with a front and a back (triangles, discs, planes)"));
}

TEST_CASE("facing: a pipe can declare it, and a sphere cannot", "[external]") {
    const std::string first = "roots=first\\n";
    const Outcome front = list_by_pipe(first + "shape=triangle\\nfacing=front", " --json");
    INFO(front.err);
    CHECK(front.code == 0);
    const auto forms = nlohmann::json::parse(front.out);
    const auto found = std::find_if(forms.begin(), forms.end(), [](const auto& form) { return form["name"] == "a.x"; });
    REQUIRE(found != forms.end());
    CHECK((*found)["facing"] == "front");
    check_refused_headers({{first + "shape=sphere\\nfacing=front", "leave it out for a sphere"},
                           {first + "shape=tube\\nfacing=back", "leave it out for a tube"},
                           {first + "shape=triangle\\nfacing=ahead", "it must be one of both, front, back"}});
}

}  // namespace test_facing
