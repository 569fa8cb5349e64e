// A wrong contract costs more than any rounding. It is reported, and a right contract never is.
#include <algorithm>
#include <cmath>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "catch.hpp"
#include "cli/program.hpp"
#include "external/libraries.hpp"
#include "measure/contract/suspect.hpp"
#include "scene/file/scene.hpp"

namespace test_suspect {

using namespace lostbits::test;
using namespace lostbits;

namespace {

const std::string odd = plugin("odd_plugin");

/// Rays of many lengths from everywhere at a sphere of radius 3, answered by `answer(true near, true far, ray)`.
template <class Answer>
std::vector<measure::contract::AnswerSample> judged(const Answer& answer) {
    std::vector<measure::contract::AnswerSample> all;
    for (int i = 0; i < 500; ++i) {
        const double length = 0.5 + 0.01 * i, from = 4 + 0.03 * i, side = 0.005 * i, half = std::sqrt(9 - side * side);
        measure::contract::AnswerSample j{.ray = {{side, 0, -from}, {0, 0, length}},
                                          .primitive = Primitive<double>(Sphere<double>{{0, 0, 0}, 3}),
                                          .truly_hits = true,
                                          .true_t = (from - half) / length,
                                          .other_t = from - half,
                                          .hit = true};
        j.t = answer(j.true_t, (from + half) / length, length);
        all.push_back(j);
    }
    return all;
}

}  // namespace

TEST_CASE("suspicion: each wrong contract is recognised from its answers", "[external]") {
    using measure::contract::suspicion_text;
    CHECK(suspicion_text(judged([](double t, double, double) { return t; })).empty());
    CHECK(suspicion_text(judged([](double t, double, double) { return t * (1 + 0x1p-9); })).empty());
    CHECK(has(suspicion_text(judged([](double t, double, double l) { return t * l; })),
              "as if directions had unit length"));
    CHECK(has(suspicion_text(judged([](double, double far, double) { return far; })), "the far root"));
    auto by_distance = judged([](double t, double, double) { return t; });  // although a distance was promised
    for (auto& j : by_distance) {
        j.is_unit = true;
        std::swap(j.true_t, j.other_t);
    }
    CHECK(has(suspicion_text(by_distance), "the ray's parameter, not a distance"));
    CHECK(has(suspicion_text(judged([](double t, double, double) { return -t; })), "wrong sign"));
    // No known mistake explains it, so only the number is reported.
    const std::string unknown = suspicion_text(judged([](double, double, double) { return 17.0; }));
    CHECK(has(unknown, " have a t that is off by more than 0.4%"));
    CHECK(has(unknown, "no known mistake explains nine in ten"));
    const std::string none = suspicion_text(judged([](double, double, double) { return HUGE_VAL; }));
    CHECK(has(none, "500 have a t that is not a finite number"));
}

TEST_CASE("suspicion: t in other units is recognised and the factor reported", "[external]") {
    using measure::contract::suspicion_text;
    const auto off_by = [](double factor) {
        return suspicion_text(judged([factor](double t, double, double) { return factor * t; }));
    };
    CHECK(has(off_by(1000), "t is in other units: it is 1000 times what is right: millimetres for metres?"));
    CHECK(has(off_by(0.001), "0.001 times what is right: metres for millimetres?"));
    CHECK(has(off_by(0.0254), "metres for inches?"));
    CHECK(has(off_by(7.5), "t is in other units: it is 7.5 times what is right"));
    // Wrong decisions beside it, as arithmetic causes them, hide neither a factor nor a sign.
    const auto with_wrong_decisions = [](double factor) {
        auto all = judged([factor](double t, double, double) { return factor * t; });
        for (std::size_t i = 0; i < all.size(); i += 6) (i % 4 == 0 ? all[i].hit : all[i].truly_hits) = false;
        return suspicion_text(all);
    };
    CHECK(has(with_wrong_decisions(1000), "all 416 rays that hit and should hit are wrong; t is in other units"));
    CHECK(has(with_wrong_decisions(-1), "all 416 rays that hit and should hit are wrong; t has the wrong sign"));
    CHECK(with_wrong_decisions(1).empty());
    // A factor that differs from ray to ray is not a factor, and neither is one answer to rays that are all alike.
    int n = 0;
    CHECK_FALSE(has(suspicion_text(judged([&n](double t, double, double) { return t * (2 + n++ % 7); })), "units"));
    std::vector<measure::contract::AnswerSample> alike;
    for (int i = 0; i < 100; ++i) alike.push_back(judged([](double t, double, double) { return 3 * t; }).front());
    CHECK_FALSE(has(suspicion_text(alike), "units"));
    // From far away all t are nearly alike: a deliberate factor is recognised there too.
    const auto from_afar = [](double factor) {
        std::vector<measure::contract::AnswerSample> all;
        for (int i = 0; i < 100; ++i) {
            all.push_back(judged([](double t, double, double) { return t; }).front());
            all.back().true_t *= 1 + 0x1p-17 * i;
            all.back().t = factor * all.back().true_t;
        }
        return suspicion_text(all);
    };
    CHECK(has(from_afar(1000), "1000 times what is right"));
    CHECK(has(from_afar(1 / 0.0254), "inches for metres?"));
    CHECK(has(from_afar(1024), "1.02e+03 times what is right"));
    CHECK_FALSE(has(from_afar(3), "units"));
}

TEST_CASE("suspicion: answers that fit the ray itself do not suggest another ray", "[external]") {
    // They end where they enter, which is a miss if a touch is a miss. y = z, so that exchanging the two gives the same
    // rays.
    std::vector<measure::contract::AnswerSample> all;
    for (int i = 0; i < 20; ++i) {
        const double y = 0.02 * i;
        all.push_back({.ray = {{-5, y, y}, {1, 0, 0}},
                       .primitive = Primitive<double>(Sphere<double>{{0, 0, 0}, 1}),
                       .hit = true,
                       .t = 5 - std::sqrt(1 - 2 * y * y)});
    }
    CHECK(
        has(measure::contract::suspicion_text(all), "all 20 rays that hit or should hit are wrong; 20 hit what they"));
}

TEST_CASE("suspicion: changes to the rays or to the primitive are recognised from the answers", "[external]") {
    using measure::contract::AnswerSample;
    using R = Ray<double>;
    using S = Sphere<double>;
    const auto nearest = [](const R& ray, const S& s) {
        const Vec<double> f = ray.origin - s.centre;
        const double a = dot(ray.direction, ray.direction), b = dot(f, ray.direction);
        const double left = b * b - a * (dot(f, f) - s.radius * s.radius), root = std::sqrt(std::max(0.0, left));
        const double near = (-b - root) / a, far = (-b + root) / a;
        return left < 0 || far < 0 ? std::nan("") : near >= 0 ? near : far;
    };
    // Rays from around (1, -2, 0) at a sphere around (4, 6, -20), some of which miss. They are answered as they are,
    // and reported as `change` leaves them.
    const auto describe_suspicion = [&nearest](const auto& change, bool inverted = false) {
        std::vector<AnswerSample> all;
        for (int i = 0; i < 400; ++i) {
            const double u = (i % 20 - 9.5) / 4, v = (i / 20 - 9.5) / 4;
            R ray{{1 + u / 8, -2, v / 8}, {3 + u, 8 + v, -20}};
            S sphere{{4, 6, -20}, 2};
            const double t = nearest(ray, sphere);
            const bool hit = std::isnan(t) == inverted;
            change(ray, sphere);
            const double truth = nearest(ray, sphere);
            all.push_back({.ray = ray,
                           .primitive = Primitive<double>(sphere),
                           .truly_hits = !std::isnan(truth),
                           .true_t = truth,
                           .other_t = truth,
                           .hit = hit,
                           .t = std::isnan(t) ? 0 : t});
        }
        return measure::contract::suspicion_text(all, measure::contract::AnswerSource::file);
    };
    CHECK(describe_suspicion([](R&, S&) {}).empty());
    CHECK(has(describe_suspicion([](R& ray, S&) { ray.direction = -ray.direction; }),
              "the direction seems to be reversed: the answers are those for -d; write -dx, -dy, -dz"));
    CHECK(has(describe_suspicion([](R& ray, S&) { ray.direction = ray.origin + ray.direction; }),
              "the point where the ray ends"));
    CHECK(has(describe_suspicion([](R& ray, S&) {
                  for (Vec<double>* v : {&ray.origin, &ray.direction}) std::swap(v->y, v->z);
              }),
              "y and z of the rays seem to be exchanged"));
    CHECK(has(describe_suspicion([](R& ray, S&) { std::swap(ray.origin, ray.direction); }),
              "the origin and the direction"));
    for (const auto& [factor, says] : {std::pair(1000.0, "1000 times as large (millimetres for metres?); write both"),
                                       std::pair(0.01, "0.01 times as large (metres for centimetres?)")})
        CHECK(has(describe_suspicion([f = factor](R&, S& sphere) {
                      sphere = {sphere.centre * f, sphere.radius * f};
                  }),
                  says));
    CHECK(has(describe_suspicion([](R&, S&) {}, true),
              "hit seems to be inverted, 1 where the ray misses; write 1 for a hit"));
    // A sphere elsewhere: hits and misses are both wrong, but most rays miss both spheres.
    const std::string elsewhere = describe_suspicion([](R&, S& sphere) { sphere.centre.x += 9; });
    CHECK(has(elsewhere, "no known mistake"));
}

TEST_CASE("suspicion: errors from inside are told apart", "[external]") {
    using measure::contract::AnswerSource;
    using measure::contract::suspicion_text;
    // Rays from inside a sphere of radius 3, nearer to its back; `right` is the true t, `answer` the one given.
    const auto describe_suspicion = [](const auto& right, const auto& answer,
                                       AnswerSource source = AnswerSource::intersector) {
        std::vector<measure::contract::AnswerSample> all;
        for (int i = 0; i < 200; ++i) {
            const double z = -2.5 + 0.01 * i, near = -3 - z, far = 3 - z;
            measure::contract::AnswerSample j{.ray = {{0, 0, z}, {0, 0, 1}},
                                              .primitive = Primitive<double>(Sphere<double>{{0, 0, 0}, 3}),
                                              .truly_hits = true,
                                              .true_t = right(near, far),
                                              .other_t = right(near, far),
                                              .hit = true};
            j.t = answer(near, far);
            all.push_back(j);
        }
        return suspicion_text(all, source);
    };
    const auto near = [](double t, double) { return t; };
    const auto far = [](double, double t) { return t; };
    const auto none = [](double, double) { return 0.0; };
    const auto size = [](double t, double) { return std::fabs(t); };
    CHECK(describe_suspicion(far, far).empty());
    CHECK(describe_suspicion(none, none).empty());
    CHECK(has(describe_suspicion(far, none),
              "it answers 0 from inside, where another t is right; say so (inside_zero, inside=zero)"));
    CHECK(has(describe_suspicion(far, none, AnswerSource::file), "; say --inside zero"));
    CHECK(has(describe_suspicion(none, far), "it answers with the exit, where 0 is right; say so (inside_exit"));
    CHECK(has(describe_suspicion(none, far, AnswerSource::file), "; say --inside exit"));
    CHECK(has(describe_suspicion(far, size), "the near root without its sign"));
    CHECK_FALSE(has(describe_suspicion(far, near), "without its sign"));
    CHECK(has(describe_suspicion(far, near), "the near root, behind the ray; say so (near_root, roots=near)"));
    CHECK(has(describe_suspicion(far, near, AnswerSource::file), "; say --inside near"));
}

TEST_CASE("suspicion: swapped origin and direction are recognised by hits, not by misses", "[external]") {
    const auto describe_suspicion = [](bool ever_hits) {
        std::vector<measure::contract::AnswerSample> all;
        for (int i = 0; i < 300; ++i) {
            // The ray from (x, 0, -5) along z is exchanged for one from (0, 0, 1) along d = (x, 0, -5), whose t has
            // d² t² - 10 t + 1 - r² = 0.
            const double x = -0.45 + 0.003 * i, half = std::sqrt(0.25 - x * x), d2 = x * x + 25;
            measure::contract::AnswerSample j{.ray = {{x, 0, -5}, {0, 0, 1}},
                                              .primitive = Primitive<double>(Sphere<double>{{0, 0, 0}, 0.5}),
                                              .truly_hits = true,
                                              .true_t = 5 - half,
                                              .other_t = 5 - half,
                                              .hit = ever_hits};
            j.t = ever_hits ? (5 - std::sqrt(25 - 0.75 * d2)) / d2 : std::nan("");
            all.push_back(j);
        }
        return measure::contract::suspicion_text(all);
    };
    CHECK(has(describe_suspicion(true), "the origin and the direction seem to be exchanged"));
    CHECK_FALSE(has(describe_suspicion(false), "exchanged"));
    CHECK(
        has(describe_suspicion(false), "all 300 rays that hit or should hit are wrong; 300 miss what they should hit"));
    const measure::contract::AnswerSample one{.ray = {{0, 0, -5}, {0, 0, 1}},
                                              .primitive = Primitive<double>(Sphere<double>{{0, 0, 0}, 1}),
                                              .truly_hits = true,
                                              .true_t = 4,
                                              .other_t = 4};
    CHECK(has(measure::contract::suspicion_text({one}),
              "wrong on the only ray that hits or should hit: it misses what it should hit"));
}

TEST_CASE("suspicion: a radius is blamed only if it explains everything, not for a march that stops early",
          "[external]") {
    const double nan = std::nan("");
    // Rays from 1 to 2.7 beside the middle of a sphere of radius 3; those beyond 1.5 miss one of half the radius.
    const auto describe_suspicion = [&](const auto& t_of) {
        std::vector<measure::contract::AnswerSample> all;
        for (int i = 0; i < 500; ++i) {
            const double side = 1 + 0.0035 * i, t = 10 - std::sqrt(9 - side * side);
            measure::contract::AnswerSample j{.ray = {{side, 0, -10}, {0, 0, 1}},
                                              .primitive = Primitive<double>(Sphere<double>{{0, 0, 0}, 3}),
                                              .truly_hits = true,
                                              .true_t = t,
                                              .other_t = t,
                                              .hit = side < 1.5};
            j.t = t_of(t, side);
            all.push_back(j);
        }
        return measure::contract::suspicion_text(all);
    };
    const auto of_half = [](double, double side) { return 10 - std::sqrt(std::max(0.0, 1.5 * 1.5 - side * side)); };
    CHECK(has(describe_suspicion(of_half), "expect a diameter instead of the radius"));
    CHECK(has(describe_suspicion([&](double, double) { return nan; }),
              "expect a diameter instead of the radius"));  // for a form that returns no t
    // Too few steps: right in the middle, a miss near the rim.
    const std::string early = describe_suspicion([](double t, double) { return t; });
    CHECK(has(early, "miss what they should hit"));
    CHECK_FALSE(has(early, "radius"));
}

TEST_CASE("suspicion: no form of the catalogue is suspected, from outside or from inside", "[external]") {
    const Scratch folder;
    for (const std::string name : {"near-benign", "camera-inside", "rtg-fig-7-3-100-oblique", "box-one"}) {
        const auto loaded =
            scene::file::load_scene(std::string(LOSTBITS_DATA_DIR) + "/scenes/" + name + ".toml").front();
        for (const auto& form : intersect::table::intersectors()) {
            const bool near_only = form.info->roots == intersect::Roots::near_only;
            if (!loaded.accepts(form.shape) || (near_only && name == "camera-inside")) continue;
            INFO(name << ' ' << form.info->name);
            const Format format = *find_format(form.native64 ? "f64" : "f32");
            CHECK(measure::contract::suspicion_text(loaded, {&form, format}).empty());
        }
    }
}

TEST_CASE("suspicion: map and sweep report suspicions on stderr, for wrong forms only", "[external]") {
    const Scratch folder;
    const auto map = [&](const std::string& form, const std::string& scene) {
        return run("map " + scene + " --size 48x32 -f f32 -o out -i " + form + odd, folder.path()).err;
    };
    CHECK(has(map("odd.squared", "camera-inside"),
              "odd.squared f32: on all 1536 rays of camera-inside: all 1536 rays that "));
    folder.write("large.toml", scene_text("[[sphere]]\ncentre = [0, 0, 0]\nradius = 4\n", "",
                                          "kind = \"pinhole\"\nfov_deg = 50\neye = [0, 0, 12]\n"));
    CHECK(has(map("odd.squared", "large.toml"), "seems to expect the square of the radius"));
    // For a radius of 1000 the form sees a sphere of radius √1000, which all rays miss. That says nothing about a
    // radius.
    CHECK(has(map("odd.squared", "rtg-fig-7-4.r1e3"), "miss what they should hit; no known mistake"));
    CHECK(has(map("odd.far_first", "near-benign"), "far root"));
    CHECK(has(map("odd.forgetful", "near-benign"),
              "odd.forgetful f32: on all 1536 rays of near-benign: all 1536 rays that "));  // a number for each call
    for (const std::string form : {"odd.right", "odd.first", "odd.predicate", "odd.unit"}) {
        INFO(form);
        CHECK(map(form, "camera-inside").empty());
        CHECK(map(form, "near-benign").empty());
    }
    const Outcome sweep = run("sweep sphere-distance -i odd.far_first -f f32 -o out" + odd, folder.path());
    CHECK(has(sweep.err,
              "odd.far_first f32: on all 1024 rays of sphere-distance at distance_radii = 1.25, the first "
              "step: all 1024 rays that "));
    // A small picture stands for a large one, and the line says so.
    const Outcome large = run("map near-benign --size 256x128 -f f32 -o out -i odd.far_first" + odd, folder.path());
    CHECK(has(large.err, "on a sample of near-benign, a picture of 64x32 with 2048 rays: all "));
    CHECK(has(sweep.err, "far root"));
    const Outcome quiet = run("map near-benign -q --size 48x32 -f f32 -o out -i odd.far_first" + odd, folder.path());
    CHECK(quiet.err.empty());
}

TEST_CASE("suspicion: an infinite condition excuses neither an exit where 0 is right nor a t far from a tangent",
          "[external]") {
    const Scratch folder;
    const std::string cases = folder.write("cases.toml", R"(schema = "lostbits-sweep/1"
title = "t = 0, and a tangent"
source = "-"
[[case]]
name = "from the surface"
spheres = [{ centre = [0, 0, 0], radius = 3 }]
rays = [{ origin = [0, 0, -3], direction = [0, 0, 1] }]
[[case]]
name = "touching"
spheres = [{ centre = [0, 0, 0], radius = 3 }]
rays = [{ origin = [3, 0, -8], direction = [0, 0, 1] }]
)");
    must("sweep " + cases + " -i odd.far_first -i odd.nothing_ahead -i sphere.unified -f f32 -o out" + odd,
         folder.path());
    std::map<std::string, std::string> verdict;
    for (auto& row : read_csv(folder.path() / "out/cases/cases.csv"))
        verdict[row["form"] + " " + row["case"]] = row["verdict"];
    CHECK(verdict["odd.far_first from the surface"] == "wrong_value");  // 6 for 0
    CHECK(verdict["odd.nothing_ahead touching"] == "wrong_value");      // 0 for 8
    CHECK(verdict["odd.far_first touching"] == "right");                // both roots are 8
    CHECK(verdict["sphere.unified from the surface"] == "right");
}

TEST_CASE("suspicion: commands that need operations report the rows that they leave out", "[external]") {
    const Scratch folder;
    const std::string map = "map near-benign --size 48x32 -f f32 -o out --metric culprit -i odd.right";
    const Outcome both = must(map + " -i sphere.unified" + odd, folder.path());
    CHECK(has(both.err, "--metric culprit: cannot be measured for odd.right"));
    const Outcome alone = run(map + odd, folder.path());
    CHECK(alone.code == 2);
    CHECK(has(alone.err, "docs/your-own-form.md"));
}

}  // namespace test_suspect
