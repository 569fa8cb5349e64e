// Scenes and rays with primitives of several shapes, measured by sets of forms.

#include "catch.hpp"
#include "program.hpp"

namespace test_sets {

using namespace lostbits::test;

namespace {

const std::string floor_map = "map spheres-on-floor --size 16x8 -f f32";

}  // namespace

TEST_CASE("every combination of one form per shape is a set, and 200 sets are the limit") {
    const Scratch scratch;
    must(floor_map + " -i 'sphere.p*' -i 'box.e*' -i box.signs" + into(scratch));
    const auto rows = read_csv(scratch / "out/spheres-on-floor/summary.csv");
    REQUIRE(rows.size() == 4 * 5);
    CHECK(rows.front().at("form") == "sphere.press+box.exclusive");
    must(floor_map + " -i 'sphere.p*+box.[es]*'" + into(scratch, "word"));
    CHECK(read_csv(scratch / "word/spheres-on-floor/summary.csv") == rows);
}

TEST_CASE("shapes with the same number names share their columns") {
    const Scratch scratch;
    const std::string scene = scratch.write(
        "both.toml", scene_text("[[sphere]]\ncentre = [-2, 0.1, 0]\nradius = 1.25\n[[cylinder]]\nbase = [2, -1, "
                                "0]\ntop = [2.5, 1, 0]\nradius = 0.75\n",
                                "size = [16, 8]\n", "kind = \"orthographic\"\neye = [0, 0, 5]\nwidth = 8\n"));
    const std::string map = "map '" + scene + "' -f f32 -i sphere.schoolbook+cylinder.crossed";
    must(map + into(scratch));
    const auto row = read_csv(scratch / "out/both/summary.csv").at(0);
    CHECK(row.count("worst_radius_hex") == 1);
    const bool of_sphere = !row.at("worst_centre_x_hex").empty();
    CHECK(row.at("worst_radius_hex") == (of_sphere ? "0x1.4p+0" : "0x1.8p-1"));
    CHECK(row.at("worst_base_x_hex").empty() == of_sphere);
}

TEST_CASE("without -i a scene of several shapes is measured by the plain set, and the output says so") {
    const Scratch scratch;
    const auto r = must(floor_map + into(scratch));
    CHECK(has(r.err,
              "it has spheres and boxes, so it is measured with sets, one form for each shape; without -i the only set "
              "is sphere.schoolbook+box.inclusive."));
    CHECK(read_csv(scratch / "out/spheres-on-floor/summary.csv").size() == 1);
}

TEST_CASE("a hit of the wrong primitive reports the shape of that primitive") {
    const Scratch scratch;
    const std::string ray = "explain --sphere=0,0,0,1 --box=-2,-2,1,2,0.25,2 ";
    const std::string grazing = "--ray=0,0.9999999,-900,0,0,1 -f f32 ";
    const auto wrong = must(ray + grazing + "-i sphere.schoolbook+box.signs");
    CHECK(has(wrong.out, "It is a "));
    CHECK(has(run(ray + "--ray=0,0,-900,0,0,1 -i sphere.unified+box.signs").out,
              "It is a sphere, which the form sphere.unified answers."));
    must("map spheres-on-floor -f f32 --size 64x32 -i sphere.schoolbook+box.signs" + into(scratch));
    const auto row = read_csv(scratch / "out/spheres-on-floor/summary.csv").front();
    CHECK(row.at("fault_outcome") == "false_hit");
    CHECK(std::stoi(row.at("wrong_primitive")) > 0);
}

TEST_CASE("answers for spheres and boxes together are judged against the nearest of all") {
    const Scratch scratch;
    // Along the axes of both every t is exact: 9 to the sphere, 12 to the box behind it, 2 past the sphere.
    const std::string file = scratch.write("rays.csv",
                                           "ox,oy,oz,dx,dy,dz,hit,t\n0,0,-10,0,0,1,1,9\n0,1.5,-10,0,0,1,1,12\n"
                                           "1.5,0,-10,0,0,2,1,6\n0,9,-10,0,0,1,0,nan\n0,0,-10,0,0,1,1,12\n");
    const std::string primitives = " --sphere 0,0,0,1 --box=-2,-2,2,2,2,3 --sphere 0,0,8,1";
    must("judge '" + file + "'" + primitives + " -i sphere.unified+box.signs" + into(scratch));
    const auto rows = read_csv(scratch / "out/rays/summary.csv");
    REQUIRE(rows.size() == 2);
    CHECK(rows[0].at("agree_hit") == "4");
    CHECK(rows[0].at("agree_miss") == "1");
    CHECK(rows[0].at("ulp_error_p50") == "0");
    CHECK(std::stod(rows[0].at("relative_error_max")) == Approx(1.0 / 3));  // 12 where 9 is true
    CHECK(rows[1].at("form") == "sphere.unified+box.signs");
    CHECK(rows[1].at("ulp_error_max") == "0");
    // Its worst rays are a file of cases, of one shape or of both, which a sweep reads back.
    must("sweep '" + (scratch / "out/rays/worst.toml").string() + "' -i sphere.unified -i box.signs" +
         into(scratch, "again"));
}

}  // namespace test_sets
