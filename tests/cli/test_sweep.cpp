// `lostbits sweep` from the outside: along axes, over named cases and, with --worst, over searches.
#include <cmath>

#include "catch.hpp"
#include "program.hpp"

namespace test_sweep {

using namespace lostbits::test;

TEST_CASE("a sweep writes one row per form, format and step, and the onsets between steps") {
    const Scratch scratch;
    const std::string file = scratch.write("s.toml", small_sweep);
    must("sweep '" + file + "' -i sphere.schoolbook -i sphere.hearn_baker -f f32 -f p16" + into(scratch, ""));
    for (const char* format : {"f32", "p16"}) {
        for (const char* plot : {"lost_bits_p50", "lost_bits_p99", "false_hit", "false_miss"})
            CHECK(fs::exists(scratch / "s" / (std::string(plot) + "." + format + ".png")));
    }
    const auto samples = read_csv(scratch / "s/samples.csv");
    REQUIRE(samples.size() == 2 * 2 * 20);
    for (const auto& row : samples) {
        CHECK(row.at("rays") == "64");
        CHECK(number_in(row.at("distance_radii_hex")) == number_in(row.at("distance_radii")));
    }
    std::size_t found = 0, spread = 0, backwards = 0, of_bits = 0;
    for (const auto& row : read_csv(scratch / "s/onsets.csv")) {
        if (row.at("found") != "1" || row.at("last_good_distance_radii").empty()) continue;
        ++found;
        const double good = number_in(row.at("last_good_distance_radii")),
                     bad = number_in(row.at("first_bad_distance_radii"));
        const bool last = row.at("read_from") == "last";
        CHECK((last ? bad < good : good < bad));
        backwards += last;
        CHECK(row.at("rays") == "64");
        CHECK(row.at("views") == "4");
        CHECK(row.at("draws") == "3");  // its own and two more
        const double low = number_in(row.at("first_bad_low")), high = number_in(row.at("first_bad_high")),
                     median = number_in(row.at("first_bad_median"));
        CHECK((low <= median && median <= high && low <= bad && bad <= high));
        spread += low < high;
        CHECK(std::fabs(bad - good) <= 0x1p-8 * bad);  // narrowed to 2^-9, or to the 12 bits that the axis has
        if (row.at("event") != "lost_bits") continue;
        ++of_bits;
        CHECK(number_in(row.at("value_at_first_bad")) >= number_in(row.at("threshold")));
    }
    CHECK(found > 8);
    CHECK(of_bits > 0);
    CHECK(spread > 4);
    CHECK(backwards > 0);
}

TEST_CASE("a sweep of culprits, cancellation and contributions gives columns, a long table and a plot per row") {
    const Scratch scratch;
    const std::string file = scratch.write("s.toml", small_sweep);
    const std::string what = "sweep '" + file +
                             "' -i sphere.schoolbook -i sphere.unified -f f32 --metric culprit --metric cancellation "
                             "--metric cancellation:c --metric contribution:c -q -o '";
    must(what + scratch.path().string() + "'");
    for (const char* name : {"samples.csv", "culprits.csv", "datapackage.json", "culprit.sphere.schoolbook.f32.png",
                             "culprit.sphere.unified.f32.png"}) {
        INFO(name);
        CHECK_FALSE(contents(scratch / "s" / name).empty());
    }
    std::map<std::pair<std::string, std::string>, std::pair<std::string, double>>
        steps;  // the first operation of each step, and all shares
    for (const auto& row : read_csv(scratch / "s/culprits.csv")) {
        auto& [first, shares] = steps[{row.at("form"), row.at("distance_radii")}];
        if (first.empty()) first = row.at("operation");
        shares += number_in(row.at("culprit_fraction"));
        CHECK(number_in(row.at("culprit_rays")) > 0);
    }
    CHECK(steps.size() == 40);
    for (const auto& row : read_csv(scratch / "s/samples.csv")) {
        const auto& [first, shares] = steps.at({row.at("form"), row.at("distance_radii")});
        CHECK(row.at("culprit") == first);
        CHECK(std::fabs(shares - 1) < 1e-12);
        CHECK_FALSE(row.at("contribution_c_p50").empty());
        CHECK_FALSE(number_in(row.at("cancellation_c_max")) > number_in(row.at("cancellation_max")));
    }
}

TEST_CASE("a sweep over a scene changes its numbers by the same overrides as --set") {
    const Scratch scratch;
    const std::string file = scratch.write(
        "s.toml",
        make_sweep_file("scene = \"near-benign\"\n" +
                        make_axis({"radius", "\"sphere[0].radius\", \"sphere[1].radius\"", "0.25", "1", 4, "linear"}) +
                        "factors = [1, 0.5]\n"));
    must("sweep '" + file + "' -i sphere.unified -f f32" + into(scratch, ""));
    const auto samples = read_csv(scratch / "s/samples.csv");
    REQUIRE(samples.size() == 4);
    // Larger spheres are hit by more rays; and 1 with 0.5 is what --set gives.
    CHECK(number_in(samples[0].at("agree_hit")) < number_in(samples[3].at("agree_hit")));
    must("map near-benign --set 'sphere[0].radius=1' --set 'sphere[1].radius=0.5' -i sphere.unified -f f32" +
         into(scratch, ""));
    CHECK(read_csv(scratch / "near-benign/summary.csv").front().at("agree_hit") == samples[3].at("agree_hit"));
}

TEST_CASE("two axes give the product of their steps, and every_float gives every float") {
    const Scratch scratch;
    const std::string second =
        "\n[[axis]]\nname = \"impact\"\nspacing = \"every_float\"\nfrom = \"0x1.fffff0p-1\"\nto = "
        "\"0x1.fffff8p-1\"\nset = [\"impact_to\"]\n";
    const std::string file = scratch.write("s.toml", small_sweep + second);
    must("sweep '" + file + "' -i sphere.unified -f f32" + into(scratch, ""));
    CHECK(read_csv(scratch / "s/samples.csv").size() == 20 * 5);
    CHECK(fs::exists(scratch / "s/sphere.unified.f32.exr"));
    CHECK(!fs::exists(scratch / "s/onsets.csv"));  // an onset is a place on one axis
}

namespace {

const std::string small_cases = make_sweep_file(R"([[case]]
name = "one, ahead"
spheres = [{ centre = [0, 0, 5], radius = 2 }]
rays = [{ origin = [0, 0, 0], direction = [0, 0, 1] }]
)");

}  // namespace

TEST_CASE("a length that becomes 0 or infinite in a format is reported on stderr") {
    const Scratch scratch;
    const std::string out = " -q" + into(scratch), loud = out.substr(3);
    const auto said = [&](const std::string& command) { return run(command + loud).err; };
    const std::string scene = "'" + scratch.write("s.toml", spoil_scene("radius = 1", "radius = 1e-9")) + "'";
    const std::string note = "lostbits: s in fp16: radius = 1e-09 rounds to 0 (sphere[0])\n";
    const std::string unseen =  // as small a sphere lies between the rays
        "lostbits: scene s: no ray of its camera meets a primitive, so every pixel is a miss; check its eye, look_at "
        "and width or fov\n";
    for (const std::string command : {"map ", "render "}) {
        const std::string whole_command = command + scene + " --size 8x8 -i sphere.press -f f32 -f fp16 -f bf16";
        CHECK(said(whole_command) == note + (command == "map " ? unseen : ""));
        CHECK(run(whole_command + out).err.empty());
    }
    CHECK(run("explain " + scene + " --pixel 1,1 -i sphere.press -f fp16").err == note);

    const std::string sweep =
        scratch.write("w.toml", make_sweep_file("[sphere_rays]\nviews = 2\nrays = 2\n" +
                                                make_axis({"size", "\"radius\"", "\"0x1p-30\"", "\"0x1p-22\"", 9})));
    // 2^-25 ties to 0, and the five steps below it are 0 as well; the two views of a step are one place.
    CHECK(said("sweep '" + sweep + "' -i sphere.press -f fp16 -f f32") ==
          "lostbits: w in fp16: radius = 9.31323e-10 rounds to 0 (size = 9.313225746154785e-10; 6 in all)\n");

    const auto cases = [&](const std::string& radius) {
        const std::string text = replace_text(small_cases, "radius = 2", "radius = " + radius);
        return said("sweep '" + scratch.write("c.toml", text) + "' -i sphere.press -f fp16 -f f32");
    };
    CHECK(cases("1e-9") == "lostbits: c in fp16: radius = 1e-09 rounds to 0 (case \"one, ahead\")\n");
    CHECK(cases("1e6") == "lostbits: c in fp16: radius = 1e+06 rounds to infinity (case \"one, ahead\")\n");
    for (const char* meant : {"\"tiny\"", "\"min\"", "\"max\""}) CHECK(cases(meant).empty());
}

}  // namespace test_sweep
