// A contract that is wrong costs more than any rounding: it is said, and never of one that is right.
#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "catch.hpp"
#include "cli/program.hpp"
#include "measure/contract/suspect.hpp"
#include "scene/file/scene.hpp"

namespace test_suspect {

using namespace lostbits::test;
using namespace lostbits;

namespace {

const std::string odd = std::string(" --plugin ") + LOSTBITS_LIBRARIES + "/odd_plugin.so";

/// Rays of many lengths from everywhere at a sphere of radius 3, answered by `answer(true near, true far, ray)`.
template <class Answer>
std::vector<measure::contract::Judged> judged(const Answer& answer) {
    std::vector<measure::contract::Judged> all;
    for (int i = 0; i < 500; ++i) {
        const double length = 0.5 + 0.01 * i, from = 4 + 0.03 * i, side = 0.005 * i, half = std::sqrt(9 - side * side);
        measure::contract::Judged j{.ray = {{side, 0, -from}, {0, 0, length}},
                                    .solid = Solid<double>(Sphere<double>{{0, 0, 0}, 3}),
                                    .truly_hits = true,
                                    .true_t = (from - half) / length,
                                    .other_measure = from - half,
                                    .hit = true};
        j.t = answer(j.true_t, (from + half) / length, length);
        all.push_back(j);
    }
    return all;
}

}  // namespace

TEST_CASE("suspicion: each wrong contract is known by its answers", "[doors]") {
    using measure::contract::suspicion;
    CHECK(suspicion(judged([](double t, double, double) { return t; })).empty());
    CHECK(suspicion(judged([](double t, double, double) { return t * (1 + 0x1p-9); })).empty());
    CHECK(has(suspicion(judged([](double t, double, double l) { return t * l; })), "directions of unit length"));
    CHECK(has(suspicion(judged([](double, double far, double) { return far; })), "the far root"));
    auto by_distance = judged([](double t, double, double) { return t; });  // where a distance was promised
    for (auto& j : by_distance) {
        j.unit = true;
        std::swap(j.true_t, j.other_measure);
    }
    CHECK(has(suspicion(by_distance), "the ray's parameter, not a distance"));
    CHECK(has(suspicion(judged([](double t, double, double) { return -t; })), "wrong sign"));
    CHECK(suspicion(judged([](double, double, double) { return 17.0; })).empty());  // nothing known explains it
}

TEST_CASE("suspicion: a radius is blamed for what it explains everywhere, not for a march that ends early", "[doors]") {
    const double nan = std::nan("");
    // Rays from 1 to 2.7 beside the middle of a sphere of radius 3; those beyond 1.5 miss one of half the radius.
    const auto asked = [&](const auto& t_of) {
        std::vector<measure::contract::Judged> all;
        for (int i = 0; i < 500; ++i) {
            const double side = 1 + 0.0035 * i, t = 10 - std::sqrt(9 - side * side);
            measure::contract::Judged j{.ray = {{side, 0, -10}, {0, 0, 1}},
                                        .solid = Solid<double>(Sphere<double>{{0, 0, 0}, 3}),
                                        .truly_hits = true,
                                        .true_t = t,
                                        .other_measure = t,
                                        .hit = side < 1.5};
            j.t = t_of(t, side);
            all.push_back(j);
        }
        return measure::contract::suspicion(all);
    };
    const auto of_half = [](double, double side) { return 10 - std::sqrt(std::max(0.0, 1.5 * 1.5 - side * side)); };
    CHECK(has(asked(of_half), "taken for a diameter"));
    CHECK(has(asked([&](double, double) { return nan; }), "taken for a diameter"));  // of a form that tells no t
    CHECK(
        asked([](double t, double) { return t; }).empty());  // too few steps: right in the middle, a miss near the rim
}

TEST_CASE("suspicion: of every form of the catalogue nothing, from outside and from inside", "[doors]") {
    const Scratch folder;
    for (const std::string name : {"near-benign", "camera-inside", "rtg-fig-7-3-100-oblique", "box-one"}) {
        const auto loaded =
            scene::file::load_scene(std::string(LOSTBITS_DATA_DIR) + "/scenes/" + name + ".toml").front();
        for (const auto& form : intersect::table::intersectors()) {
            const bool near_only = form.info->roots == intersect::Roots::near_only;
            if (!loaded.meets(form.shape) || (near_only && name == "camera-inside")) continue;
            INFO(name << ' ' << form.info->name);
            const Format format = *find_format(form.native64 ? "f64" : "f32");
            CHECK(measure::contract::suspicion(loaded, {&form, format}).empty());
        }
    }
}

TEST_CASE("suspicion: a map and a sweep say it on stderr, for what is wrong alone", "[doors]") {
    const Scratch folder;
    const auto map = [&](const std::string& form, const std::string& scene) {
        return run("map " + scene + " --size 48x32 -f f32 -o out -i " + form + odd, folder.path()).err;
    };
    CHECK(has(map("odd.squared", "camera-inside"), "odd.squared f32: wrong on "));
    CHECK(has(map("odd.squared", "rtg-fig-7-4.r1e3"), "taken for its square"));
    CHECK(has(map("odd.far_first", "near-benign"), "far root"));
    for (const std::string form : {"odd.right", "odd.first", "odd.predicate", "odd.unit"}) {
        INFO(form);
        CHECK(map(form, "camera-inside").empty());
        CHECK(map(form, "near-benign").empty());
    }
    const Outcome sweep = run("sweep sphere-distance -i odd.far_first -f f32 -o out" + odd, folder.path());
    CHECK(has(sweep.err, "far root"));
    const Outcome quiet = run("map near-benign -q --size 48x32 -f f32 -o out -i odd.far_first" + odd, folder.path());
    CHECK(quiet.err.empty());
}

TEST_CASE("suspicion: what asks for operations says which rows it leaves out", "[doors]") {
    const Scratch folder;
    const std::string map = "map near-benign --size 48x32 -f f32 -o out --metric culprit -i odd.right";
    const Outcome both = run(map + " -i sphere.unified" + odd, folder.path());
    CHECK(both.code == 0);
    CHECK(has(both.err, "--metric culprit: leaves out odd.right"));
    const Outcome alone = run(map + odd, folder.path());
    CHECK(alone.code == 2);
    CHECK(has(alone.err, "docs/your-own-form.md"));
}

}  // namespace test_suspect
