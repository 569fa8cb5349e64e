// Truth of rays that touch a primitive or begin on it or in it, for every convention and instruction set. The problems
// have small integers. They are compared with a primitive that is smaller by 2^-44, and with ranges that leave out the
// origin.
#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include "catch.hpp"
#include "counts.hpp"
#include "exact/ask.hpp"
#include "exact/draw.hpp"
#include "intersect/simd/packed.hpp"
#include "measure/truth/conditioning.hpp"
#include "measure/truth/truth.hpp"

namespace test_conventions {

using namespace lostbits;
using namespace lostbits::exact;
using intersect::AtOrigin, intersect::Convention, intersect::Inside, intersect::Touching;
using measure::truth::find_truth, measure::truth::Truth;

namespace {

constexpr double little = 0x1p-46;

/// Small whole numbers, for which any two different places are farther apart than 2^-44.
std::vector<Problem> whole_problems(const ShapeTest& shape, std::size_t count) {
    Chance chance(7);
    std::vector<Problem> some(500), whole;
    const auto is_small = [](double x) { return x == std::floor(x) && std::fabs(x) < 16; };
    while (whole.size() < count) {
        draw_made(shape, true, {}, chance, some);
        for (Problem& problem : some) {
            problem.tmin = 0, problem.tmax = INFINITY;
            if (std::ranges::all_of(problem.ray, is_small) && std::ranges::all_of(problem.primitive, is_small))
                whole.push_back(problem);
        }
    }
    whole.resize(count);
    return whole;
}

/// The primitive without its surface, or without its rim, to within some 2^-44. False if nothing is left.
bool shrink(std::string_view shape, Problem& problem) {
    std::array<double, max_primitive_numbers>& n = problem.primitive;
    const auto closer = [&n](std::size_t i, std::size_t j, double part = little) {
        for (std::size_t k = 0; k < 3; ++k) {
            const double step = part * (n[j + k] - n[i + k]);
            n[i + k] += step, n[j + k] -= step;
        }
    };
    const double lengths = 4 * little * std::fmax(n[6], n[7]);
    if (shape == "sphere") n[3] -= little;
    else if (shape == "ellipsoid") n[3] -= little, n[4] -= little, n[5] -= little;
    else if (shape == "torus") n[7] -= little;
    else if (shape == "capsule") n[6] -= little;
    else if (shape == "tube") closer(0, 3, 0x1p-32), n[6] -= little;  // roots at a rim move less than the rim
    else if (shape == "cylinder") closer(0, 3), n[6] -= little;
    else if (shape == "cone") closer(0, 3), n[6] -= n[6] > 0 ? lengths : 0, n[7] -= n[7] > 0 ? lengths : 0;
    else if (shape == "disc") n[6] -= little, n[7] += n[7] > 0 ? little : 0;
    else if (shape == "triangle") closer(0, 3), closer(3, 6), closer(6, 0);
    else if (shape == "box")
        for (std::size_t k = 0; k < 3; ++k) {
            if (n[k] == n[3 + k]) return false;
            n[k] += little, n[3 + k] -= little;
        }
    return true;
}

bool meets(const ShapeTest& shape, const Problem& problem) { return meet(shape.exactly, problem).is_hit(); }

/// Point at which the ray enters the open primitive. The ray starts a little earlier, so that an exit at its start
/// counts. A surface without an inside is crossed a little later, since a tube is narrower then.
First<Whole> meets_open(const ShapeTest& shape, Problem p) {
    const Shape kind = *shape_named(shape.name);
    const double later = has_inside(kind) ? 0 : 0x1p-24;
    const double back = p.open_tmin ? -later : inside_returns_zero(kind) ? 0 : 0x1p-24;
    for (std::size_t i = 0; i < 3; ++i) p.ray[i] -= back * p.ray[3 + i];
    p.tmax += back + (p.open_tmax ? 0 : later);
    return shrink(shape.name, p) ? meet(shape.exactly, p) : First<Whole>(std::nullopt);
}

struct GivenProblem {
    Ray<double> ray;
    Primitive<double> primitive;
    Range<double> range;

    GivenProblem(const ShapeTest& shape, const Problem& problem)
        : ray{{problem.ray[0], problem.ray[1], problem.ray[2]}, {problem.ray[3], problem.ray[4], problem.ray[5]}},
          primitive(*shape_named(shape.name)),
          range{problem.tmin, problem.tmax, {problem.open_tmin, problem.open_tmax}} {
        for (std::size_t k = 0; k < primitive.shape_numbers().size(); ++k) primitive.numbers[k] = problem.primitive[k];
    }
    [[nodiscard]] Truth truth(const Convention& convention = {}) const {
        return find_truth(ray, primitive, {}, convention, range);
    }
};

struct Tally {
    std::size_t touching = 0, behind = 0, from_it = 0, inside = 0;
};

double number_of(const Truth& truth) { return std::ldexp(truth.t.hi, static_cast<int>(truth.t.exponent)); }

/// True if t is the first t there, to within the size by which the open primitive is smaller.
bool is_about(const First<Whole>& first, double t) {
    return first.side(Whole(t - 0x1p-16)) > 0 && first.side(Whole(t + 0x1p-16)) < 0;
}

/// Compares rays that only touch the primitive and do not begin inside a torus, whose hole grows. A tube may still be
/// hit behind its rim, and a torus behind a tangent.
void hold_touching(const ShapeTest& shape, const Problem& problem, const GivenProblem& given, const Truth& closed,
                   Tally& tally) {
    const First<Whole> through = meets_open(shape, problem);
    const bool at_once = closed.is_hit() && through.is_hit() && through.side(Whole(number_of(closed) + 0x1p-16)) < 0;
    const Truth open = given.truth(Touching::miss);
    REQUIRE(open.is_hit() == (closed.is_hit() && through.is_hit()));
    REQUIRE(closed.touches == (closed.is_hit() && !at_once));
    if (!open.is_hit() || at_once) return;
    REQUIRE(is_about(through, number_of(open)));
    ++tally.behind;
}

void hold(const ShapeTest& shape, const Problem& problem, Tally& tally) {
    const GivenProblem given(shape, problem);
    const Truth closed = given.truth();
    INFO(paste(shape, problem, {.hit = closed.is_hit()}));
    REQUIRE(closed.is_hit() == meets(shape, problem));
    const double depth = visit(given.primitive, [&](const auto& s) { return s.relative_distance(given.ray.origin); });
    if (shape.name != "torus" || depth > 0x1p-30) hold_touching(shape, problem, given, closed, tally);
    if (!closed.is_hit()) return;
    tally.touching += closed.touches, tally.from_it += closed.on_surface;
    if (inside_returns_zero(given.primitive.shape)) return;
    Problem at = problem, after = problem;
    at.tmax = 0, after.open_tmin = true;
    REQUIRE(closed.on_surface == meets(shape, at));
    has_no_first = false;
    if (const bool ahead = meets(shape, after); !has_no_first) REQUIRE(given.truth(AtOrigin::miss).is_hit() == ahead);
    if (is_flat(given.primitive.shape) || !(depth < -0x1p-30)) return;
    ++tally.inside;
    Convention none;
    none.inside = Inside::miss;
    REQUIRE_FALSE(given.truth(none).is_hit());
}

/// Entry and exit of a ray from outside, if doubles represent both and the ray crosses the surface there.
struct CrossedSurface {
    double entry, exit;
};
std::optional<CrossedSurface> crossed(const ShapeTest& shape, Problem p) {
    Convention enter, leave;
    enter.inside = Inside::miss, leave.inside = Inside::exit;
    const Truth first = GivenProblem(shape, p).truth(enter);
    if (!first.is_hit() || first.touches || first.on_surface || first.t.is_zero()) return std::nullopt;
    const double entry = number_of(first);
    if (meet(shape.exactly, p).side(Whole(entry)) != 0) return std::nullopt;
    p.tmin = entry, p.open_tmin = true;
    const Truth last = GivenProblem(shape, p).truth(leave);
    const double exit = last.is_hit() && !last.touches ? number_of(last) : 2 * entry;
    if (!last.is_hit()) return CrossedSurface{entry, exit};
    // The range [exit, …) contains the exit only at its beginning, and behind that nothing is hit. Otherwise no double
    // is the exit of the line.
    p.tmin = exit, p.open_tmin = false, has_no_first = false;
    if (!meets(shape, p) || meet(shape.exactly, p).side(Whole(exit)) != 0) return std::nullopt;
    p.open_tmin = inside_returns_zero(*shape_named(shape.name));
    if (p.open_tmin && (meets(shape, p) || has_no_first)) return std::nullopt;
    return CrossedSurface{entry, exit};
}

/// Problems whose ranges end and begin where the line enters and leaves, with open ends and without, each with whether
/// the closed and the open primitive are hit.
struct RangeAtEnds {
    std::array<std::vector<Problem>, 4> problems;  ///< by which ends are open
    std::array<std::vector<std::uint8_t>, 4> closed, open;
    std::size_t of_closed = 0, of_open = 0;

    void add(const ShapeTest& shape, Problem p, const CrossedSurface& at) {
        const double middle = (at.entry + at.exit) / 2;
        const Range<double> ranges[] = {{0, at.entry},     {at.entry, at.entry}, {at.entry, at.exit}, {0, at.exit},
                                        {middle, at.exit}, {at.exit, HUGE_VAL},  {at.exit, at.exit}};
        for (std::size_t k = 0; k < std::size(ranges); ++k) {
            if (shape.name == "torus" && k > 3) continue;  // the hole of a smaller one is larger
            p.tmin = ranges[k].tmin, p.tmax = ranges[k].tmax;
            for (std::size_t ends = 0; ends < 4; ++ends) {
                p.open_tmin = ends % 2 == 1, p.open_tmax = ends >= 2;
                has_no_first = false;
                const bool met = meets(shape, p);
                if (!GivenProblem(shape, p).range.holds_any() || has_no_first) continue;
                problems[ends].push_back(p);
                closed[ends].push_back(met);
                open[ends].push_back(closed[ends].back() && meets_open(shape, p).is_hit());
            }
        }
    }
    void hold(const ShapeTest& shape) {
        std::vector<std::uint8_t> hits;
        for (std::size_t ends = 0; ends < 4; ++ends)
            for (const bool with_rim : {true, false}) {
                const std::vector<std::uint8_t>& right = with_rim ? closed[ends] : open[ends];
                for (const auto isa : intersect::simd::available_isas()) {
                    intersect::simd::set_isa(isa);
                    decide(shape.name, TruthRoute::doubles, with_rim, problems[ends], hits);
                    CHECK(std::ranges::equal(hits, right));
                }
                for (std::size_t i = 0; i < right.size(); ++i) hold(shape, problems[ends][i], with_rim, right[i] != 0);
            }
    }

private:
    /// Tests each ray alone, from each side, and with the properties about an inside, which do not matter for a ray
    /// that comes from outside.
    void hold(const ShapeTest& shape, const Problem& problem, bool with_rim, bool right) {
        const GivenProblem given(shape, problem);
        Convention convention(with_rim ? Touching::hit : Touching::miss);
        INFO(paste(shape, problem, {.hit = right}) << (with_rim ? "" : ", open"));
        REQUIRE(given.truth(convention).is_hit() == right);
        (with_rim ? of_closed : of_open) += right;
        if (is_flat(given.primitive.shape)) {
            int sides = 0;
            for (const auto facing : {intersect::Facing::front, intersect::Facing::back})
                convention.facing = facing, sides += given.truth(convention).is_hit();
            REQUIRE(sides == right);
        }
        if (problem.tmin > 0 || !has_inside(given.primitive.shape) || shape.name == "torus") return;
        for (const Inside inside : {Inside::zero, Inside::miss}) {
            convention.inside = inside;
            REQUIRE(given.truth(convention).is_hit() == right);
        }
    }
};

}  // namespace

TEST_CASE("exact: a ray that ends where it enters a primitive touches it", "[exact]") {
    const auto before = intersect::simd::current_isa();
    for (const ShapeTest& shape : shapes) {
        RangeAtEnds all;
        // A torus is slow, and few rays with whole numbers meet a triangle at a whole number.
        const std::size_t count = shape.name == "torus" ? 5000 : shape.name == "triangle" ? 100000 : 50000;
        for (const Problem& problem : whole_problems(shape, test::draws(count)))
            if (const auto at = crossed(shape, problem)) all.add(shape, problem, *at);
        all.hold(shape);
        INFO(shape.name << ": closed " << all.of_closed << ", open " << all.of_open);
        CHECK(all.of_closed > 30);
        CHECK(all.of_open > 30);
        CHECK((all.of_closed > all.of_open || !has_inside(*shape_named(shape.name))));
    }
    intersect::simd::set_isa(before);
}

TEST_CASE("exact: rays that touch a primitive or begin on or in it are recognised and follow the convention",
          "[exact]") {
    for (const ShapeTest& shape : shapes) {
        Tally tally;
        const std::size_t count = test::draws(std::size_t{shape.name == "torus" ? 10000U : 30000U});
        for (const Problem& problem : whole_problems(shape, count)) hold(shape, problem, tally);
        const Shape kind = *shape_named(shape.name);
        INFO(shape.name << ": touched " << tally.touching << ", met behind that " << tally.behind << ", from it "
                        << tally.from_it << ", from inside " << tally.inside);
        CHECK((tally.touching > 20) == (shape.name != "plane"));
        CHECK((shape.name != "tube" || tally.behind > 5));
        CHECK((tally.from_it > 10) == !inside_returns_zero(kind));
        CHECK((tally.inside > 20) == !(inside_returns_zero(kind) || is_flat(kind) || shape.name == "tube"));
    }
}

TEST_CASE("exact: a ray through an excluded rim of a tube hits the far wall", "[exact]") {
    const Ray<double> given{{3, 2, 3}, {-1, -1, -1}};
    const Primitive<double> tube(Tube<double>{{2, -1, 2}, {-2, -1, 2}, 2});
    CHECK(number_of(find_truth(given, tube)) == 1);
    CHECK(number_of(find_truth(given, tube, {}, Touching::miss)) == 3);
    CHECK_FALSE(find_truth(given, tube, {}, Touching::miss, {0, 2}).is_hit());

    // x = −3 + 2 t is −1 on the rim and 1 on the far wall: t = (3 ± r)/2, and κ = (3/2 + t + r/2)/t.
    const Ray<double> ray{{-3, 0, 3}, {2, 0, -1}};
    const Primitive<double> along_z(Tube<double>{{0, 0, 0}, {0, 0, 2}, 1});
    CHECK(number_of(find_truth(ray, along_z, {}, Touching::miss)) == 2);
    CHECK(measure::truth::condition(ray, along_z) == Approx(3));
    CHECK(measure::truth::condition(ray, along_z, Touching::miss) == Approx(2));
}

TEST_CASE("exact: t in formats of few bits is the nearest number, or the even one of two", "[exact]") {
    for (const ShapeTest& shape : shapes) {
        std::size_t ray_count = 0, ties = 0;
        Chance chance(11);
        for (Problem p : whole_problems(shape, test::draws(std::size_t{6000}))) {
            // From so far away that t has a few bits more than the formats have.
            const int back = chance.below(5000);
            for (std::size_t i = 0; i < 3; ++i) p.ray[i] -= back * p.ray[3 + i];
            const GivenProblem given(shape, p);
            const Truth truth = given.truth();
            if (!truth.is_hit()) continue;
            const First<Whole> right = meet(shape.exactly, p);
            for (const char* const name : {"bf16", "fp16"}) {
                const FloatFormat format = find_format(name)->parameters;
                const double t = round_truth(truth, given.ray, given.primitive, format);
                if (t == 0 || std::isinf(t)) continue;
                const int exponent = std::max(std::ilogb(t), format.emin);
                const double step = std::ldexp(1.0, exponent - format.precision + 1);
                const bool is_power = t == std::ldexp(1.0, exponent) && exponent > format.emin;
                INFO(name << " " << paste(shape, p, {.hit = true, .high = t}));
                const int above = right.side(Whole(t - step / (is_power ? 4 : 2))),
                          below = right.side(Whole(t + step / 2));
                REQUIRE((above >= 0 && below <= 0));
                const bool is_tie = above == 0 || below == 0;
                REQUIRE((!is_tie || std::fmod(t / step, 2) == 0));
                ++ray_count, ties += is_tie;
            }
        }
        INFO(shape.name << ": asked " << ray_count << ", ties " << ties);
        CHECK(ray_count > 100);
        CHECK(ties > 0);
    }
}

TEST_CASE("exact: packs decide as single rays with every instruction set", "[exact]") {
    const auto before = intersect::simd::current_isa();
    for (const ShapeTest& shape : shapes) {
        Chance chance(8);
        std::vector<Problem> problems(test::draws(std::size_t{5000}));
        std::vector<std::uint8_t> hits;
        for (const bool made : {false, true}) {
            (made ? draw_made : draw_random)(shape, true, {}, chance, problems);
            for (Problem& problem : problems) problem.tmin = 0, problem.tmax = INFINITY;
            for (const bool with_rim : {true, false}) {
                std::vector<std::uint8_t> alone;
                for (const Problem& problem : problems)
                    alone.push_back(
                        GivenProblem(shape, problem).truth(with_rim ? Touching::hit : Touching::miss).is_hit());
                for (const auto isa : intersect::simd::available_isas()) {
                    intersect::simd::set_isa(isa);
                    decide(shape.name, TruthRoute::floats_for_ulps, with_rim, problems, hits);
                    INFO(shape.name << ", " << intersect::simd::name_of(isa) << (made ? ", made" : ", random"));
                    CHECK(std::ranges::equal(hits, alone));
                }
            }
        }
    }
    intersect::simd::set_isa(before);
}

}  // namespace test_conventions
