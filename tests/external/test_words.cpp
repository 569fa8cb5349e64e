// Contracts of forms: every command accepts a contract that fits the code and detects one that does not.
#include <string>

#include "catch.hpp"
#include "cli/program.hpp"
#include "external/libraries.hpp"
#include "measure/truth/band.hpp"
#include "measure/truth/conditioning.hpp"

namespace test_words {

using namespace lostbits::test;
using namespace lostbits;
using intersect::AtOrigin;
using intersect::Convention;
using intersect::Inside;
using measure::truth::find_truth;

namespace {

const std::string worded = std::string(LOSTBITS_LIBRARIES) + "/worded.so";

Convention from_inside(Inside inside, AtOrigin at_origin = AtOrigin::hit) {
    Convention convention(at_origin);
    convention.inside = inside;
    return convention;
}

/// The true t, to 2^-20 of itself; −1 for a miss.
double true_t(const Ray<double>& ray, const Primitive<double>& primitive, Convention convention,
              double tmax = HUGE_VAL) {
    const auto truth = find_truth(ray, primitive, {}, convention, {.tmax = tmax});
    REQUIRE(truth.decision != measure::truth::Truth::Decision::unresolved);
    return truth.is_hit() ? std::ldexp(truth.t.hi, static_cast<int>(truth.t.exponent)) : -1;
}

}  // namespace

TEST_CASE("words: plugin check names the missing property and accepts a form with the right ones", "[external]") {
    const Scratch folder;
    const Outcome o = run("plugin check " + worded, folder.path());
    CHECK(o.code == 3);  // the last form ends it
    const auto finding = [&o](const std::string& form) { return find_output_of(o, form); };
    for (const std::string form :
         {"clipped",     "clipped_ahead", "zero",          "misses",        "exit_at_origin",
          "near",        "signed_near",   "near_line",     "insists",       "box_exit",
          "box_clipped", "box_near",      "endless",       "segment",       "centre",
          "at_origin",   "thickness",     "points",        "in_range",      "box_in_range",
          "blocks",      "triangle",      "open_triangle", "segment_point", "segment_thickness"}) {
        INFO(finding("word." + form));
        CHECK(has(finding("word." + form), ": keeps its contract"));
    }
    for (const auto& [form, says] : std::initializer_list<std::array<std::string, 2>>{
             {"unsigned_near", "the near root without its sign"},
             {"touch", "is answered with t = 0; 5 is right"},
             {"tmin", "a surface 3.051758e-05 ahead is answered with t = 4.00003"},
             {"clipped", "near is clipped to 0; say LB_CLIPPED and LB_EXIT"},
             {"clipped_ahead", "goes out misses; say LB_MISS (origin_misses, at_origin=miss)"},
             {"zero", "say LB_INSIDE_ZERO (inside_zero, inside=zero)"},
             {"misses", "say LB_INSIDE_MISS (inside_misses, inside=miss)"},
             {"exit_at_origin", "say LB_EXIT (origin_exits, at_origin=exit)"},
             {"box_exit", "say LB_INSIDE_EXIT (inside_exit, inside=exit)"},
             {"near", "say LB_FIRST (first_root, roots=first)"},
             {"behind", "or say LB_NEAR (near_root, roots=near): t < 0 is then a miss"},
             {"endless", "say LB_NO_END (ignores_end, flags=no_end)"},
             {"open_triangle", "a ray through an edge misses; say LB_MISS (touching_misses, touching=miss)"},
             {"at_triangle", "a surface at the origin is passed over; say LB_MISS (origin_misses, at_origin=miss)"},
             {"open_at_start", "both ends of a range belong to it, start <= t <= end"},
             {"forgets_the_start", "a range that begins behind the primitive, at t = 8, hits; it should miss"},
             {"thickness", "the thickness; hand over near + thickness"}}) {
        INFO(finding("bad." + form));
        CHECK(has(finding("bad." + form), ": fails "));
        CHECK(has(finding("bad." + form), says));
    }
    CHECK(has(o.err, "form \"bad.insists\", in the probe \"nan-origin\": gave up: it called abort()"));
}

TEST_CASE("words: a crash in a child process is reported with its probe", "[external]") {
    const Scratch folder;
    const Outcome odd = run("plugin check --isolate " + worded, folder.path());
    CHECK(odd.code == 1);
    CHECK(has(odd.out, "nan-origin"));
    CHECK(has(odd.out, "an origin of NaN: refused: "));
    const std::string crashes = std::string(LOSTBITS_LIBRARIES) + "/odd_plugin.so";
    const Outcome first = run("plugin check --isolate " + crashes, folder.path());
    CHECK(first.code == 3);
    CHECK(has(first.err, "form \"odd.crash\""));
    CHECK(has(first.err, "(in the probe \"answers\")"));
}

TEST_CASE("words: a map from inside compares each form with its own contract", "[external]") {
    const Scratch folder;
    must("map camera-inside --size 48x32 -i 'word.*' -i 'bad.*' -f f32 -o out --plugin " + worded, folder.path());
    const auto summary = folder.path() / "out/camera-inside/summary.csv";
    for (const std::string form :
         {"clipped", "clipped_ahead", "zero", "misses", "exit_at_origin", "near", "signed_near", "near_line", "insists",
          "segment", "at_origin", "thickness", "points", "segment_point", "segment_thickness"}) {
        auto row = row_of(summary, "word." + form);
        INFO(form << ' ' << row["lost_bits_max"]);
        CHECK(row["false_hit"] == "0");
        CHECK(row["false_miss"] == "0");
        const bool hits = form != "misses" && form.find("near") == std::string::npos;
        CHECK((std::stoi(row["agree_hit"]) > 0) == hits);
        if (hits) CHECK(std::stod(row["lost_bits_max"]) < 6);
    }
    CHECK(std::stod(row_of(summary, "bad.clipped")["lost_bits_max"]) == 24);
    CHECK(std::stod(row_of(summary, "bad.zero")["lost_bits_max"]) == 24);
    CHECK(row_of(summary, "bad.misses")["false_miss"] != "0");
    CHECK(row_of(summary, "bad.near")["false_hit"] != "0");
}

TEST_CASE("words: sweep, explain and judge use the same contract", "[external]") {
    const Scratch folder;
    const std::string with = " --plugin " + worded;
    must("explain camera-inside --pixel 10,10 -i sphere.unified -f f32 --beside word.zero --json" + with,
         folder.path());
    const std::string rays =
        folder.write("rays.csv",
                     "ox,oy,oz,dx,dy,dz,cx,cy,cz,r,t,hit\n0,0,1,0,0,1,0,0,0,2,0,1\n0,0,-1,0,0,1,0,0,0,2,0,1\n"
                     "0,0,-5,0,0,1,0,0,0,2,3,1\n");
    const auto judged = [&](const std::string& words, const std::string& out) {
        must("judge " + rays + " -o " + out + words, folder.path());
        return read_csv(folder.path() / out / "rays/summary.csv").front();
    };
    CHECK(judged(" --inside zero", "zero")["lost_bits_max"] == "0");
    CHECK(judged("", "exit")["lost_bits_max"] != "0");
    CHECK(judged(" --inside miss", "miss")["false_hit"] == "2");
}

TEST_CASE("words: the truth is right from inside and from the surface of spheres and boxes", "[external]") {
    const Primitive<double> sphere(Sphere<double>{{0, 0, 0}, 2}), box(Box<double>{{-2, -2, -2}, {2, 2, 2}});
    const auto from = [](double z, double d) { return Ray<double>{{0, 0, z}, {0, 0, d}}; };
    for (const Primitive<double>& primitive : {sphere, box}) {
        for (const AtOrigin at : {AtOrigin::hit, AtOrigin::miss, AtOrigin::exit}) {
            CHECK(true_t(from(1, 1), primitive, from_inside(Inside::exit, at)) == 1);
            CHECK(true_t(from(-1, 1), primitive, from_inside(Inside::exit, at)) == 3);
            CHECK(true_t(from(-1, 1), primitive, from_inside(Inside::miss, at)) == -1);
            CHECK(true_t(from(-5, 2), primitive, from_inside(Inside::miss, at)) == 1.5);
            CHECK(true_t(from(-5, 1), primitive, from_inside(Inside::exit, at)) == 3);
            CHECK(true_t(from(5, 1), primitive, from_inside(Inside::exit, at)) == -1);
        }
        CHECK(true_t(from(-1, 1), primitive, from_inside(Inside::zero)) == 0);
        // Rays on the surface that go in or out.
        CHECK(true_t(from(-2, 1), primitive, from_inside(Inside::exit, AtOrigin::hit)) == 0);
        CHECK(true_t(from(-2, 1), primitive, from_inside(Inside::exit, AtOrigin::miss)) == 4);
        CHECK(true_t(from(-2, 1), primitive, from_inside(Inside::exit, AtOrigin::exit)) == 4);
        CHECK(true_t(from(-2, -1), primitive, from_inside(Inside::exit, AtOrigin::hit)) == 0);
        CHECK(true_t(from(-2, -1), primitive, from_inside(Inside::exit, AtOrigin::miss)) == -1);
        CHECK(true_t(from(-2, -1), primitive, from_inside(Inside::exit, AtOrigin::exit)) == 0);
        CHECK(true_t(from(-2, 1), primitive, from_inside(Inside::miss, AtOrigin::hit)) == 0);
        CHECK(true_t(from(-2, 1), primitive, from_inside(Inside::miss, AtOrigin::miss)) == -1);
        CHECK(true_t(from(-2, -1), primitive, from_inside(Inside::miss, AtOrigin::hit)) == -1);
        // κ of the exit: |z| + |t| + r over t, and no more if the answer is exact.
        CHECK(measure::truth::condition(from(1, 1), primitive, from_inside(Inside::exit)) == Approx(4).epsilon(1e-5));
        CHECK(std::isinf(measure::truth::condition(from(1, 1), primitive, from_inside(Inside::zero))));
    }
    // Ends of rays: an exit beyond the end does not count, and some rays have no ends.
    Convention endless = from_inside(Inside::usual);
    endless.endless = true;
    CHECK(true_t(from(-1, 1), box, from_inside(Inside::exit), 2) == -1);
    CHECK(true_t(from(-1, 1), box, from_inside(Inside::exit), 3) == 3);
    CHECK(true_t(from(-5, 1), box, {}, 2) == -1);
    CHECK(true_t(from(-5, 1), box, endless, 2) == 3);
    // The exit of a box, 1/3 of the way, correctly rounded.
    const Ray<double> third = from(1, 3);
    const auto exit = find_truth(third, box, {}, from_inside(Inside::exit));
    CHECK(measure::truth::round_truth(exit, third, box, binary64, {}, from_inside(Inside::exit)) == 1.0 / 3);
    CHECK(measure::truth::round_truth(exit, third, box, binary32, {}, from_inside(Inside::exit)) ==
          static_cast<double>(1.0F / 3));
}

TEST_CASE("words: batches and single rays have the same truth", "[external]") {
    scene::rays::RayGroup group;
    for (int i = 0; i < 300; ++i) {
        const double x = 0.0625 * (i % 17 - 8), z = 0.0625 * (i - 150), d = i % 3 - 1;
        group.rays.push({{x, x / 2, z}, {0.25 * (i % 5), 0.125, d}});
        group.rays.tmax.push_back(i % 2 == 0 ? HUGE_VAL : 2);
    }
    group.primitives = {Primitive<double>(Box<double>{{-1, -1, -1}, {1, 1, 1}}),
                        Primitive<double>(Box<double>{{2, -1, -1}, {3, 1, 1}})};
    const auto rays = group.rays;
    const auto primitives = group.primitives;
    const measure::truth::Band band(std::move(group));
    int different = 0;
    for (const Inside inside : {Inside::usual, Inside::exit, Inside::zero, Inside::miss}) {
        for (const bool endless : {false, true}) {
            Convention convention = from_inside(inside);
            convention.endless = endless;
            for (std::size_t i = 0; i < rays.size(); ++i) {
                const auto one =
                    find_truth(rays[i], std::span<const Primitive<double>>(primitives), {}, convention, rays.range(i));
                const auto known = band.truth(i, convention);
                INFO(i << ' ' << static_cast<int>(inside));
                REQUIRE(one.decision == known.decision);
                REQUIRE(one.primitive == known.primitive);
                REQUIRE(compare(one.t, known.t) == 0);
                const auto usual = band.truth(i, {});
                different += usual.decision != known.decision || compare(usual.t, known.t) != 0;
            }
        }
    }
    CHECK(different > 100);
}

TEST_CASE("words: contradictory properties are refused, and older libraries keep their meaning", "[external]") {
    check_refused_headers({{"roots=first\\nflags=line", "line needs roots = both or near"},
                           {"roots=near\\nflags=clipped", "clipped describes an interval"},
                           {"flags=clipped", "set at_origin = exit or miss"},
                           {"inside=near", "inside = near needs roots = near"},
                           {"roots=near\\ninside=exit", "inside = exit contradicts roots = near"},
                           {"shape=box\\nat_origin=miss", "set inside = exit or miss"},
                           {"inside=out", "it must be one of usual, exit, zero, near, miss"}});
    for (const std::string words : {"flags=clipped\\nat_origin=exit", "roots=none\\nflags=no_end\\nshape=box",
                                    "shape=box\\ninside=exit\\nat_origin=miss", "roots=near\\nflags=line"})
        CHECK(list_by_pipe(words).code == 0);
}

TEST_CASE("words: a form that takes the range of a ray is tested on it, in this process, through a pipe and on boxes") {
    const Scratch folder;
    const auto scene = [&](const std::string& name, const std::string& open, const std::string& primitive) {
        folder.write(name + ".toml",
                     scene_text("[rays]\ntmin = 4.5\ntmax = 5.5\nopen_ends = \"" + open + "\"\n" + primitive,
                                "inputs = \"shared\"\n"));
    };
    const std::string sphere = "[[sphere]]\ncentre = [0, 0, 0]\nradius = 1\n";
    scene("closed", "none", sphere);
    scene("open", "both", sphere);
    scene("boxes", "none", "[[box]]\nlo = [-1, -1, -1]\nhi = [1, 1, 1]\n");
    for (const std::string how : {"", " --isolate"}) {
        for (const std::string name : {"closed", "open", "boxes"}) {
            must("map " + name +
                     ".toml --size 48x32 -i 'word.*in_range' -i 'word.blocks' -i "
                     "'bad.forgets_the_start' -f f32 -o out --plugin " +
                     worded + how,
                 folder.path());
            const auto summary = folder.path() / "out" / name / "summary.csv";
            if (name == "boxes") {
                auto row = row_of(summary, "word.box_in_range");
                CHECK(row["false_hit"] == "0");
                CHECK(row["false_miss"] == "0");
                CHECK(std::stoi(row["agree_hit"]) > 20);
                CHECK(std::stoi(row["agree_miss"]) > 20);
                continue;
            }
            for (const std::string form : {"word.in_range", "word.blocks"}) {
                auto row = row_of(summary, form);
                INFO(name << ' ' << form);
                CHECK(row["false_hit"] == "0");
                CHECK(row["false_miss"] == "0");
                CHECK(std::stoi(row["agree_hit"]) > 20);
                CHECK(std::stoi(row["agree_miss"]) > 20);
            }
            auto bad = row_of(summary, "bad.forgets_the_start");
            CHECK(bad["false_hit"] != "0");  // its roots before the range are not removed for it
        }
    }
}

}  // namespace test_words
