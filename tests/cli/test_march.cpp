// Marches from the outside: explain, the maps of iterations and of reasons for stopping, sweeps of the constants.

#include "catch.hpp"
#include "program.hpp"

namespace test_march {

using namespace lostbits::test;

TEST_CASE("explain prints a march sample by sample") {
    const auto r = must("explain sdf-by-hand.off-axis --pixel 0,0 -i sdf.sphere_trace -f f64");
    CHECK(has(r.out, "1.0293462564704334"));  // |p| of the second sample, where the seed has 1.030
    CHECK(has(r.out, "step by 0.001297"));
    CHECK(has(r.out, "of 53 bits lost"));
    CHECK(has(r.out, "  3 "));           // the fourth sample,
    CHECK_FALSE(has(r.out, "\n   4 "));  // and no fifth
    // It stops short on purpose, and rounding costs less than a bit.
    CHECK(has(r.out, "\nThe march ended at sample 4 of at most 64, where the field is "));
    CHECK(has(r.out, "No operation is to blame: rounding inside the form causes "));
    CHECK(has(r.out, "and the rest comes from where the march ended."));
    CHECK_FALSE(has(r.out, "The culprit is"));
    CHECK_FALSE(has(r.out, "\n* "));
    CHECK_FALSE(has(r.out, "the formula loses"));
    const auto same =
        must("explain sdf-by-hand.off-axis --ray 0,0,3,0x1.978fd4p-4,0,-0x1.fd73cap-1 -i sdf.sphere_trace");
    CHECK(has(same.out, "1.02934623"));
    CHECK(has(run("explain sdf-by-hand.miss --pixel 0,0 -i sdf.sphere_trace").out, "miss: t > 20"));
    CHECK(
        has(run("explain sdf-by-hand.off-axis --ray 4,4,4,-1,-1,-1 -i sdf.sphere_trace --set march.hit_eps=1e-12").out,
            "no step: t + d = t"));
}

TEST_CASE("maps of marches show iterations, why they ended, and model and rounding error on one sheet") {
    const Scratch scratch;
    const std::string out = scratch.path().string();
    must(
        "map sdf-union -i sdf.sphere_trace -i sdf.secant_refined --size 32x24 --metric iterations --metric stop "
        "--metric model_error --metric rounding_error "
        "--pixels csv --pictures all -o '" +
        out + "'");
    for (const char* file : {"contact.png", "contact.stop.png", "contact.model_error.png",
                             "sdf.sphere_trace.f32.stop.png", "sdf.sphere_trace.f64.iterations.png"}) {
        CHECK(fs::exists(scratch / "sdf-union" / file));
    }
    CHECK_FALSE(fs::exists(scratch / "sdf-union/contact.rounding_error.png"));  // on the sheet of model_error
    const auto summary = read_csv(scratch / "sdf-union/summary.csv");
    REQUIRE(summary.size() == 4);
    for (const auto& row : summary) {
        CHECK(std::stoi(row.at("stop_hit")) + std::stoi(row.at("stop_max_dist")) + std::stoi(row.at("stop_max_steps")) +
                  std::stoi(row.at("stop_stagnated")) ==
              32 * 24);
        CHECK(std::stoi(row.at("stop_hit")) == std::stoi(row.at("agree_hit")) + std::stoi(row.at("false_hit")));
        CHECK(std::stod(row.at("iterations_max")) <= 64);
        CHECK(row.count("worst_radius_hex") == 1);
        CHECK(row.count("worst_hi_z_hex") == 1);
    }
    const auto pixels = read_csv(scratch / "sdf-union/sdf.sphere_trace.f32.csv");
    REQUIRE(pixels.size() == 32 * 24);
    for (const auto& p : pixels) {
        CHECK((p.at("stop") == "hit") == (p.at("outcome") == "agree_hit" || p.at("outcome") == "false_hit"));
        CHECK(std::stoi(p.at("iterations")) >= 1);
    }
}

TEST_CASE("explain and map report stagnation where the next step leads nowhere") {
    const Scratch scratch;
    const auto scene = [&](int cap) {
        return "'" +
               scratch.write(
                   "far.toml",
                   scene_text("[march]\nhit_eps = 1e-5\nmax_dist = 20000\nmax_steps = " + std::to_string(cap) +
                                  "\n[[sphere]]\ncentre = [0, 0, 0]\nradius = 0.9999\n",
                              "size = [1, 1]\n", "kind = \"orthographic\"\nwidth = 1\neye = [-8192, 0, 0]\n")) +
               "'";
    };
    const auto table = [&](int cap) { return run("explain " + scene(cap) + " --pixel 0,0 -i sdf.sphere_trace").out; };
    CHECK(has(table(1), "  miss: all 1 samples are used\n"));
    CHECK(has(table(2), "  no step: t + d = t; miss: all 2 samples are used\n"));
    CHECK(has(table(3), "  no step: t + d = t\n"));
    for (const int cap : {1, 2, 3}) {
        const std::string out = (scratch.path() / std::to_string(cap)).string();
        must("map " + scene(cap) + " -i sdf.sphere_trace -i sdf.accumulated -f f32 --metric stop -o '" + out + "'");
        const auto rows = read_csv(scratch.path() / std::to_string(cap) / "far/summary.csv");
        REQUIRE(rows.size() == 2);
        CHECK(rows[0].at("stop_stagnated") == (cap == 1 ? "0" : "1"));
        CHECK(rows[1].at("stop_stagnated") == "0");  // its point moves on
        CHECK(rows[1].at("stop_hit") == (cap == 3 ? "1" : "0"));
    }
}

TEST_CASE("a sweep over the constants of a march gives onsets of stagnation and the parts of the error") {
    const Scratch scratch;
    const std::string sweep = scratch.write("s.toml", march_sweep);
    must("sweep '" + sweep + "' -i 'sdf.*' -f f32 -o one", scratch.path());
    bool found = false;
    for (const auto& row : read_csv(scratch / "one/s/onsets.csv")) {
        if (row.at("form") != "sdf.sphere_trace" || row.at("event") != "stagnated") continue;
        if (row.at("read_from") != "first") continue;
        found = true;
        CHECK(row.at("found") == "1");
        const double bad = std::stod(row.at("first_bad_hit_eps"));  // half an ulp of t in [2, 4) is 2^-23
        CHECK(bad <= 0x1p-23);
        CHECK(bad > 0x1p-24);
    }
    CHECK(found);
    for (const char* file : {"unfinished.f32.png", "iterations.f32.png", "split.sdf.sphere_trace.f32.png"})
        CHECK(fs::exists(scratch / "one/s" / file));
    for (const auto& row : read_csv(scratch / "one/s/samples.csv")) CHECK(row.count("model_error_p50") == 1);
}

}  // namespace test_march
