// The stages against MPFI: what they say is so, they say it of nearly all rays, and nothing of what is not proper.
#include <cstdio>
#include <cstdlib>
#include <functional>
#include <string>
#include <vector>

#include "catch.hpp"
#include "counts.hpp"
#include "measure/stages/stage_rays.hpp"
#include "measure/truth/hard_rays.hpp"
#include "measure/truth/ranges.hpp"

namespace test_stages {

using namespace lostbits;
using namespace lostbits::testing;

namespace {

using Draw = std::function<StageProblem(Seeded&)>;

StageProblem problem_of(const Ray<double>& ray, const Solid<double>& solid, double tmax = HUGE_VAL) {
    StageProblem p{.ray = {}, .shape = solid.shape, .solid = {}, .range = {.tmax = tmax}};
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

/// The hard rays of spheres or boxes, the first family random.
std::vector<Family> families_of(Shape shape, const FloatFormat& storage) {
    std::vector<Family> families;
    for (const HardFamily& f : hard_families(shape, {storage}, Wide::yes))
        families.push_back({f.name, [draw = f.draw](Seeded& rng) {
                                const HardRay hard = draw(rng);
                                return problem_of(hard.ray, hard.solid, hard.range.tmax);
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

/// The same problems in ranges about what they meet.
Family in_ranges(const Family& f, OpenEnds open, const FloatFormat& storage) {
    return {f.name + ", open " + std::string(name_of(open)), [draw = f.draw, open, storage](Seeded& rng) {
                StageProblem p = draw(rng);
                const auto at = [&p](std::size_t k) { return p.ray[k].first; };
                Solid<double> solid(p.shape);
                for (std::size_t k = 0; k < solid.used().size(); ++k) solid.numbers[k] = p.solid[k].first;
                p.range = range_about_solid(rng, {{at(0), at(1), at(2)}, {at(3), at(4), at(5)}}, solid, storage);
                p.range.open = open;
                return p;
            }};
}

struct Counts {
    std::size_t rays = 0, settled = 0, hits = 0, wrong = 0;
};

struct Run {
    StageName stage;
    bool distance = false;
    /// Compare the widths with each other, too.
    bool all_widths = false;
};

std::vector<StageProblem> drawn(const Family& family, std::size_t count, Seeded& rng) {
    std::vector<StageProblem> problems;
    for (std::size_t i = 0; i < count; ++i) problems.push_back(family.draw(rng));
    return problems;
}

/// What a stage finds, in the widest registers; where it is asked of all, it must be the same in each.
std::vector<StageFinding> found_of(const std::vector<StageProblem>& problems, const Run& run) {
    const std::vector<intersect::simd::Isa> isas = intersect::simd::available_isas();
    auto found = run_stage(run.stage, run.distance, problems, isas.back());
    if (run.all_widths) {
        for (const auto isa : isas) REQUIRE(run_stage(run.stage, run.distance, problems, isa) == found);
    }
    return found;
}

Counts run_family(const Family& family, const Run& run, std::size_t rays, std::string* first_wrong) {
    Seeded rng(20261122);
    Counts counts;
    while (counts.rays < rays) {
        const auto problems = drawn(family, test::draws<std::size_t>(997), rng);  // no whole registers
        const auto found = found_of(problems, run);
        for (std::size_t i = 0; i < problems.size(); ++i) {
            ++counts.rays;
            counts.settled += found[i].settled;
            counts.hits += found[i].settled && found[i].hit;
            const std::string wrong = contradiction(problems[i], found[i], run.distance);
            if (wrong.empty()) continue;
            ++counts.wrong;
            if (first_wrong->empty()) *first_wrong = wrong + ": " + paste(problems[i]);
        }
    }
    return counts;
}

/// How many random rays each stage is tried on, and a tenth as many that are constructed: together over 10^5 and 10^4
/// a shape. LOSTBITS_RAYS_PER_STAGE is another number; ten million take some minutes.
std::size_t rays_per_stage() {
    const char* const asked = std::getenv("LOSTBITS_RAYS_PER_STAGE");
    return asked ? std::strtoull(asked, nullptr, 10) : test::draws<std::size_t>(400'000);
}

/// A stage over all families, of which the first is random; `least` of its rays must be settled.
void contains(const std::vector<Family>& families, const Run& run, std::size_t rays, double least) {
    for (const Family& family : families) {
        std::string wrong;
        const bool random = &family == &families.front();
        const Counts c = run_family(family, run, random ? rays : rays / 10 / (families.size() - 1), &wrong);
        std::printf("%-18s %zu rays, %zu settled, %zu hits\n", family.name.c_str(), c.rays, c.settled, c.hits);
        INFO(family.name << ": " << wrong);
        CHECK(c.wrong == 0);
        if (random) CHECK(static_cast<double>(c.settled) >= least * static_cast<double>(c.rays));
    }
}

/// A stage, and the numbers that it is asked about.
struct Asked {
    StageName stage;
    FloatFormat storage;
};
constexpr Asked all_asked[] = {
    {StageName::binary64, binary32}, {StageName::double_double, binary64}, {StageName::of_two_words, binary64}};

std::vector<Family> families_for(Shape shape, const Asked& asked) {
    std::vector<Family> families = families_of(shape, asked.storage);
    if (asked.stage != StageName::of_two_words) return families;
    for (Family& f : families) f = between_doubles(f);
    return families;
}

void contain(Shape shape, const Asked& asked, double least) {
    const std::vector<Family> families = families_for(shape, asked);
    contains(families, {.stage = asked.stage}, rays_per_stage(), least);
    contains(families, {.stage = asked.stage, .distance = true}, rays_per_stage() / 10, least);
}

}  // namespace

TEST_CASE("stages: spheres contain what MPFI says") {
    for (const Asked& asked : all_asked) contain(Shape::sphere, asked, 0.999);
    contain(Shape::sphere, {StageName::double_double, binary32}, 0.999);
}

TEST_CASE("stages: boxes contain what MPFI says") {
    for (const Asked& asked : all_asked) contain(Shape::box, asked, 0.99);
}

TEST_CASE("stages: rays with ranges contain what MPFI says, at every width") {
    for (const Shape shape : {Shape::sphere, Shape::box}) {
        for (const auto& [stage, storage] : all_asked) {
            for (const auto& [name, open] : open_ends_names) {
                std::vector<Family> ranged;
                for (const Family& f : families_for(shape, {stage, storage}))
                    ranged.push_back(in_ranges(f, open, storage));
                contains(ranged, {.stage = stage, .all_widths = true}, rays_per_stage() / 40, 0.4);
                contains(ranged, {.stage = stage, .distance = true}, rays_per_stage() / 80, 0.4);
            }
        }
    }
}

TEST_CASE("stages: every width finds the same bits") {
    for (const Shape shape : {Shape::sphere, Shape::box}) {
        for (const auto& [stage, storage] : all_asked) {
            for (const Family& family : families_of(shape, storage)) {
                Seeded rng(20261122);
                const auto problems = drawn(family, 2011, rng);
                for (const bool distance : {false, true})
                    static_cast<void>(found_of(problems, {.stage = stage, .distance = distance, .all_widths = true}));
            }
        }
    }
}

TEST_CASE("stages: nothing is said of what is no ray and no solid") {
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
            }
            StageProblem still = p;
            for (std::size_t k = 3; k < 6; ++k) still.ray[k].first = 0;
            CHECK_FALSE(says(stage, still));
        }
        CHECK_FALSE(says(stage, with(problem_of(ray, ball), 9, 0)));
        CHECK_FALSE(says(stage, with(problem_of(ray, ball), 9, -1)));
        CHECK_FALSE(says(stage, with(problem_of(ray, box), 8, 1)));  // no thickness
        CHECK_FALSE(says(stage, with(problem_of(ray, box), 6, 2)));  // lo > hi
        for (const Solid<double>& solid : {Solid<double>(ball), Solid<double>(box)}) {
            StageProblem p = problem_of(ray, solid);
            for (const double bad : {none, -1.0, inf}) {
                p.range = {.tmin = bad};
                CHECK_FALSE(says(stage, p));
            }
            for (const double end : {none, -1.0, 0.0}) CHECK_FALSE(says(stage, problem_of(ray, solid, end)));
        }
    }
}

}  // namespace test_stages
