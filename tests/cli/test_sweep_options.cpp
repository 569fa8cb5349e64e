// `lostbits sweep`: how options change its file, where forms become good again, and the files after an interrupt.
#include <cstdlib>

#include "catch.hpp"
#include "program.hpp"

namespace test_sweep_options {

using namespace lostbits::test;

namespace {

std::string with_steps(int n) { return replace_text(small_sweep, "steps = 20", "steps = " + std::to_string(n)); }

}  // namespace

TEST_CASE("a sweep reports where a form becomes good again after its first failure, as its steps show") {
    const Scratch scratch;
    const std::string file = scratch.write("s.toml", with_steps(60));
    must("sweep '" + file + "' -i sphere.schoolbook -f f32 -q" + into(scratch, ""));
    const auto samples = read_csv(scratch / "s/samples.csv");
    std::size_t recovered = 0, for_good = 0;
    for (const auto& onset : read_csv(scratch / "s/onsets.csv")) {
        if (onset.at("read_from") != "first") continue;
        if (onset.at("found") != "1") {
            CHECK(onset.at("recovers") == "0");
            continue;
        }
        const bool count = onset.at("statistic") == "count";
        const std::string column = count ? onset.at("event") : "lost_bits_" + onset.at("statistic");
        std::size_t first = samples.size(), good = samples.size();  // the first bad step, the last good one after it
        for (std::size_t i = 0; i < samples.size(); ++i) {
            const double value = number_in(samples[i].at(column));
            if (first == samples.size() && value >= number_in(onset.at("threshold"))) first = i;
            if (first < i && value < number_in(onset.at("threshold"))) good = i;
        }
        INFO(onset.at("event") << " " << onset.at("statistic") << " " << onset.at("threshold"));
        REQUIRE(first < samples.size());
        CHECK((onset.at("recovers") == "1") == (good < samples.size()));
        if (good == samples.size()) {
            CHECK(onset.at("last_good_after_distance_radii").empty());
            CHECK(onset.at("bad_again_hex").empty());
            ++for_good;
            continue;
        }
        ++recovered;
        const double last = number_in(onset.at("last_good_after_distance_radii"));
        CHECK(last == number_in(onset.at("last_good_after_hex")));
        CHECK(last >= number_in(samples[good].at("distance_radii")));
        CHECK(onset.at("bad_again_distance_radii").empty() == (good + 1 == samples.size()));
        if (good + 1 == samples.size()) continue;
        const double again = number_in(onset.at("bad_again_distance_radii"));
        CHECK(last < again);
        CHECK(again <= number_in(samples[good + 1].at("distance_radii")));
        CHECK(again - last <= 0x1p-8 * again);
    }
    CHECK(recovered > 1);  // past 2^12 radii a float of the schoolbook form hits nothing, and then by chance again
    CHECK(for_good > 2);
}

TEST_CASE("an onset read from the last step equals that of the reversed sweep") {
    const Scratch scratch;
    scratch.write("s.toml", small_sweep);
    // A step of the axis is an octave, so that both orders have the same values.
    const auto onsets = [&](const std::string& out, const std::string& options) {
        must("sweep s.toml -i 'sphere.*' -f f32 -q -o " + out + options, scratch.path());
        return read_csv(scratch.path() / out / "s/onsets.csv");
    };
    const auto up = onsets("up", ""), down = onsets("down", " --set 'axis[0].from=1048576' --set 'axis[0].to=2'");
    REQUIRE(up.size() == down.size());
    std::size_t found = 0, inside = 0;
    for (std::size_t i = 0; i < up.size(); ++i) {
        auto here = up[i];
        auto there = down[i % 2 == 0 ? i + 1 : i - 1];  // an onset and the same from the other end
        REQUIRE(here.at("read_from") == (i % 2 == 0 ? "first" : "last"));
        CHECK(there.at("read_from") != here.at("read_from"));
        there["read_from"] = here.at("read_from");
        CHECK(here == there);
        if (here.at("read_from") == "last" && here.at("found") == "1") {
            ++found;
            inside += here.at("last_good_hex") != "";
        }
    }
    CHECK(found > 20);
    CHECK(inside > 3);  // of those some are good again at 2^20 radii, where they are seen to end
}

TEST_CASE("a sweep reports where a form first hits the wrong primitive, as its steps show") {
    const Scratch scratch;
    scratch.write("two.toml", good_scene + "[[sphere]]\ncentre = [0, 0, 0.0078125]\nradius = 1\n");
    scratch.write(
        "s.toml",
        make_sweep_file("scene = \"two.toml\"\n" + make_axis({"eye_z", "\"camera.eye[2]\"", "4", "1024", 9}) +
                        "[[mark]]\nat = 8\nlabel = \"the wrong one\"\nmeasured = { form = \"sphere.schoolbook\", "
                        "event = \"wrong_primitive\", threshold = 1 }\n"));
    must("sweep s.toml -i sphere.schoolbook -f f32,f64 -q -o .", scratch.path());
    double first = 0;  // the first step with a wrong primitive
    for (const auto& step : read_csv(scratch / "s/samples.csv")) {
        if (first == 0 && step.at("format") == "f32" && number_in(step.at("wrong_primitive")) > 0)
            first = number_in(step.at("eye_z"));
        if (step.at("format") == "f64") CHECK(step.at("wrong_primitive") == "0");
    }
    REQUIRE(first > 4);
    int rows = 0;
    for (const auto& onset : read_csv(scratch / "s/onsets.csv")) {
        if (onset.at("event") != "wrong_primitive" || onset.at("read_from") != "first") continue;
        ++rows;
        CHECK((onset.at("found") == "1") == (onset.at("format") == "f32"));
        if (onset.at("found") != "1") continue;
        CHECK(number_in(onset.at("first_bad_eye_z")) <= first);
        CHECK(number_in(onset.at("last_good_eye_z")) >= first / 2);
        CHECK(number_in(onset.at("value_at_first_bad")) > 0);
    }
    CHECK(rows == 2);
}

TEST_CASE("a sweep: --steps, --set and --size change the part they name, and the title says so") {
    const Scratch scratch;
    scratch.write("s.toml", small_sweep);
    const auto sweep = [&](const std::string& options) {
        return run("sweep s.toml -i sphere.unified -f f32 -q " + options, scratch.path());
    };
    REQUIRE(sweep("--steps 3 --set rays=5 --set sphere_rays.views=2 --set 'axis[0].to=8' -o a").code == 0);
    const auto samples = read_csv(scratch / "a/s/samples.csv");
    REQUIRE(samples.size() == 3);
    CHECK(number_in(samples.back().at("distance_radii")) == 8);
    CHECK(samples.front().at("rays") == "10");
    CHECK(has(contents(scratch / "a/s/datapackage.json"),
              "A test (--steps 3, --set rays=5, --set sphere_rays.views=2, --set axis[0].to=8)"));

    scratch.write("scene.toml",
                  make_sweep_file("scene = \"near-benign\"\n" +
                                  make_axis({"radius", "\"sphere[0].radius\"", "0.25", "1", 4, "linear"})));
    const auto scene = [&](const std::string& options) {
        return run("sweep scene.toml -i sphere.unified -f f32 -q " + options, scratch.path());
    };
    REQUIRE(scene("--size 12x8 --steps 2 -o b").code == 0);
    const auto small = read_csv(scratch / "b/scene/samples.csv");
    REQUIRE(small.size() == 2);
    CHECK(small.front().at("rays") == "96");
    REQUIRE(scene("--size 12x8 --steps 2 --set 'sphere[1].radius=0.01' -o c").code == 0);
    CHECK(number_in(read_csv(scratch / "c/scene/samples.csv").front().at("agree_hit")) <
          number_in(small.front().at("agree_hit")));
    must("sweep near --worst -i sphere.press -f f32 -q --set starts=1 --set generations=2 -o d", scratch.path());
    CHECK(read_csv(scratch / "d/near/worst.csv").front().at("evaluations") == "64");
}

TEST_CASE("an interrupted sweep reports where it was and what is kept") {
    const Scratch scratch;
    scratch.write("s.toml", with_steps(4000));
    const auto r = run("sweep s.toml --set views=64 -i sphere.unified -f f32 -j 1 -o out" + end_after(1.5, "TERM"),
                       scratch.path(), "set -m; ");
    CHECK(r.code == 130);
    CHECK(has(r.err, "interrupted in the steps of s: the results of this sweep are lost"));
    CHECK_FALSE(has(r.err, "scenes"));
}

}  // namespace test_sweep_options
