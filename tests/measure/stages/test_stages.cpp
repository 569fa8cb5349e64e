// The stages against MPFI: what they say is so, they say nothing outside of their range, and their constants are no
// larger than they must be by much.
#include <cstdio>
#include <cstdlib>
#include <functional>
#include <string>
#include <vector>

#include "catch.hpp"
#include "counts.hpp"
#include "measure/stages/stage_rays.hpp"
#include "measure/truth/box_families.hpp"
#include "measure/truth/ray_families.hpp"

namespace test_stages {

using namespace lostbits;
using namespace lostbits::testing;

namespace {

using Draw = std::function<StageProblem(Seeded&)>;

StageProblem problem_of(const Ray<double>& ray, const Solid<double>& solid, double tmax = HUGE_VAL) {
    StageProblem p{.ray = {}, .shape = solid.shape, .solid = {}, .tmax = tmax};
    for (int i = 0; i < 3; ++i) {
        p.ray[static_cast<std::size_t>(i)] = {ray.origin[i]};
        p.ray[static_cast<std::size_t>(i) + 3] = {ray.direction[i]};
    }
    for (std::size_t k = 0; k < 6; ++k) p.solid[k] = {solid.numbers[k]};
    return p;
}

struct Family {
    std::string name;
    Draw draw;
};

std::vector<Family> sphere_families(const FloatFormat& storage) {
    std::vector<Family> families;
    const auto add = [&](const auto& some) {
        for (const RayFamily& f : some)
            families.push_back({f.name, [&f, &storage](Seeded& rng) {
                                    const RaySample s = f.make(rng, storage);
                                    return problem_of(s.ray, s.sphere);
                                }});
    };
    add(near_families);
    add(power_families);
    add(wide_families);
    return families;
}

std::vector<Family> all_box_families(const FloatFormat& storage) {
    std::vector<Family> families;
    for (const BoxFamily& f : box_families)
        families.push_back({f.name, [&f, &storage](Seeded& rng) {
                                const BoxSample s = f.make(rng, storage);
                                StageProblem p = problem_of(s.ray, s.box, s.tmax);
                                // Some families scale what they have rounded.
                                for (StageNumber& x : p.ray) x.first = stored(x.first, storage);
                                for (StageNumber& x : p.solid) x.first = stored(x.first, storage);
                                return p;
                            }});
    return families;
}

/// The same problems with second words, and a rest that only MPFI sees.
Family between_doubles(const Family& f) {
    return {f.name, [draw = f.draw](Seeded& rng) {
                StageProblem p = draw(rng);
                const auto move = [&rng](StageNumber& x) {
                    if (rng.index(4) == 0 || std::fabs(x.first) < 0x1p-800) return;
                    x.second = x.first * rng.uniform(-0x1p-54, 0x1p-54);
                    x.rest = x.second * rng.uniform(-0x1p-54, 0x1p-54);
                };
                for (StageNumber& x : p.ray) move(x);
                for (StageNumber& x : p.solid) move(x);
                return p;
            }};
}

struct Counts {
    std::size_t rays = 0, settled = 0, hits = 0, wrong = 0;
};

struct Run {
    StageName stage;
    bool distance = false;
    double scale = 1;
    /// Compare the widths with each other, too.
    bool all_widths = false;
};

Counts run_family(const Family& family, const Run& run, std::size_t rays, std::string* first_wrong) {
    const std::vector<intersect::simd::Isa> isas = intersect::simd::available_isas();
    Seeded rng(20261122);
    Counts counts;
    while (counts.rays < rays) {
        std::vector<StageProblem> problems;
        for (std::size_t i = 0; i < 997; ++i) problems.push_back(family.draw(rng));
        const auto found = run_stage(run.stage, run.distance, problems, isas.back(), run.scale);
        if (run.all_widths) {
            for (const auto isa : isas) REQUIRE(run_stage(run.stage, run.distance, problems, isa) == found);
        }
        for (std::size_t i = 0; i < problems.size(); ++i) {
            ++counts.rays;
            counts.settled += found[i].settled;
            counts.hits += found[i].settled && found[i].hit;
            const std::string wrong = contradiction(problems[i], found[i], run.distance);
            if (wrong.empty()) continue;
            ++counts.wrong;
            if (first_wrong && first_wrong->empty()) *first_wrong = wrong + ": " + paste(problems[i]);
        }
    }
    return counts;
}

/// How many rays each stage is tried on: LOSTBITS_RAYS_PER_STAGE, which takes ten million some minutes.
std::size_t rays_per_stage() {
    const char* const asked = std::getenv("LOSTBITS_RAYS_PER_STAGE");
    return asked ? std::strtoull(asked, nullptr, 10) : test::draws<std::size_t>(150'000);
}

/// A stage over all families; `least` of the rays of the family "random" must be settled.
void contains(const std::vector<Family>& families, const Run& run, std::size_t rays, double least) {
    for (const Family& family : families) {
        std::string wrong;
        const Counts c = run_family(family, run, rays / families.size(), &wrong);
        std::printf("%-18s %zu rays, %zu settled, %zu hits\n", family.name.c_str(), c.rays, c.settled, c.hits);
        INFO(family.name << ": " << wrong);
        CHECK(c.wrong == 0);
        if (family.name == families.front().name)
            CHECK(static_cast<double>(c.settled) >= least * static_cast<double>(c.rays));
    }
}

/// Half the errors that the lemma allows for, and half of that: how many halvings until MPFI contradicts.
int halvings_until_wrong(const std::vector<Family>& families, Run run) {
    for (int k = 1; k <= 24; ++k) {
        run.scale = std::ldexp(1.0, -k);
        for (const Family& family : families) {
            std::string wrong;
            if (run_family(family, run, 4000, &wrong).wrong == 0) continue;
            std::printf("%s, halved %d times: %s\n", family.name.c_str(), k, wrong.c_str());
            return k;
        }
    }
    return 99;
}

}  // namespace

TEST_CASE("stages: spheres in binary64 contain what MPFI says") {
    contains(sphere_families(binary32), {.stage = StageName::binary64}, rays_per_stage(), 0.999);
    contains(sphere_families(binary32), {.stage = StageName::binary64, .distance = true}, rays_per_stage() / 10, 0.999);
}

TEST_CASE("stages: spheres in double-double contain what MPFI says") {
    contains(sphere_families(binary32), {.stage = StageName::double_double}, rays_per_stage() / 2, 0.999);
    contains(sphere_families(binary64), {.stage = StageName::double_double}, rays_per_stage() / 2, 0.999);
    contains(sphere_families(binary64), {.stage = StageName::double_double, .distance = true}, rays_per_stage() / 10,
             0.999);
}

TEST_CASE("stages: spheres of two words contain what MPFI says") {
    std::vector<Family> families;
    for (const Family& f : sphere_families(binary64)) families.push_back(between_doubles(f));
    contains(families, {.stage = StageName::of_two_words}, rays_per_stage(), 0.999);
    contains(families, {.stage = StageName::of_two_words, .distance = true}, rays_per_stage() / 10, 0.999);
}

TEST_CASE("stages: boxes contain what MPFI says") {
    contains(all_box_families(binary32), {.stage = StageName::binary64}, rays_per_stage(), 0.99);
    contains(all_box_families(binary64), {.stage = StageName::double_double}, rays_per_stage(), 0.99);
    contains(all_box_families(binary32), {.stage = StageName::binary64, .distance = true}, rays_per_stage() / 10, 0.99);
    contains(all_box_families(binary64), {.stage = StageName::double_double, .distance = true}, rays_per_stage() / 10,
             0.99);
}

TEST_CASE("stages: boxes of two words contain what MPFI says") {
    std::vector<Family> families;
    for (const Family& f : all_box_families(binary64)) families.push_back(between_doubles(f));
    contains(families, {.stage = StageName::of_two_words}, rays_per_stage(), 0.99);
    contains(families, {.stage = StageName::of_two_words, .distance = true}, rays_per_stage() / 10, 0.99);
}

TEST_CASE("stages: every width finds the same bits") {
    const auto same = [](const std::vector<Family>& families, StageName stage) {
        for (const Family& family : families) {
            for (const bool distance : {false, true})
                run_family(family, {.stage = stage, .distance = distance, .all_widths = true}, 2000, nullptr);
        }
    };
    same(sphere_families(binary32), StageName::binary64);
    same(sphere_families(binary64), StageName::double_double);
    same(sphere_families(binary64), StageName::of_two_words);
    same(all_box_families(binary32), StageName::binary64);
    same(all_box_families(binary64), StageName::double_double);
    same(all_box_families(binary64), StageName::of_two_words);
}

TEST_CASE("stages: errors halved too far no longer contain what MPFI says") {
    const auto sphere32 = sphere_families(binary32), sphere64 = sphere_families(binary64);
    const auto box32 = all_box_families(binary32), box64 = all_box_families(binary64);
    const auto told = [](const char* name, int halvings) {
        std::printf("%s: wrong after %d halvings\n", name, halvings);
        return halvings;
    };
    CHECK(told("sphere, binary64", halvings_until_wrong(sphere32, {.stage = StageName::binary64})) <= 12);
    CHECK(told("sphere, double-double", halvings_until_wrong(sphere64, {.stage = StageName::double_double})) <= 12);
    CHECK(told("sphere, two words", halvings_until_wrong(sphere64, {.stage = StageName::of_two_words})) <= 12);
    CHECK(told("box, binary64", halvings_until_wrong(box32, {.stage = StageName::binary64})) <= 12);
    CHECK(told("box, double-double", halvings_until_wrong(box64, {.stage = StageName::double_double})) <= 12);
}

TEST_CASE("stages: nothing is said of what lies outside of their range") {
    constexpr double inf = HUGE_VAL, none = std::numeric_limits<double>::quiet_NaN();
    const Ray<double> ray{{0, 0.125, 4}, {0, 0.0625, -1}};
    const Sphere<double> ball{{0, 0, 0}, 1};
    const Box<double> box{{-1, -1, -1}, {1, 1, 1}};
    const auto says = [](StageName stage, const StageProblem& p) {
        bool any = false;
        for (const auto isa : intersect::simd::available_isas())
            for (const bool distance : {false, true}) any = any || run_stage(stage, distance, {p}, isa)[0].settled;
        return any;
    };
    const auto with = [](StageProblem p, std::size_t k, double x) {
        (k < 6 ? p.ray[k] : p.solid[k - 6]).first = x;
        return p;
    };
    for (const StageName stage : {StageName::binary64, StageName::double_double, StageName::of_two_words}) {
        for (const Solid<double>& solid : {Solid<double>(ball), Solid<double>(box)}) {
            const StageProblem p = problem_of(ray, solid);
            CHECK(says(stage, p));
            for (std::size_t k = 0; k < 6 + solid.used().size(); ++k) {
                for (const double bad : {none, inf, -inf}) CHECK_FALSE(says(stage, with(p, k, bad)));
                if (stage != StageName::binary64) CHECK_FALSE(says(stage, with(p, k, 0x1p+201)));
            }
            StageProblem still = p;
            for (std::size_t k = 3; k < 6; ++k) still.ray[k].first = stage == StageName::binary64 ? 0 : 0x1p-201;
            CHECK_FALSE(says(stage, still));
        }
        CHECK_FALSE(says(stage, with(problem_of(ray, ball), 9, 0)));
        CHECK_FALSE(says(stage, with(problem_of(ray, ball), 9, -1)));
        CHECK_FALSE(says(stage, with(problem_of(ray, box), 6, 1)));  // no thickness
        CHECK_FALSE(says(stage, with(problem_of(ray, box), 6, 2)));  // lo > hi
        for (const double end : {none, -1.0, 0.0}) CHECK_FALSE(says(stage, problem_of(ray, box, end)));
    }
    // o − c is no binary64 number.
    CHECK_FALSE(says(StageName::binary64, with(with(problem_of(ray, ball), 0, 0x1p-60), 6, 0.5)));
    CHECK_FALSE(says(StageName::binary64, with(with(problem_of(ray, ball), 0, 0x1p+40), 6, 0x1p-20)));
}

}  // namespace test_stages
