// How much a problem may change before its answer does: against problems that are changed so much, exactly.
//
//   LOSTBITS_RAYS=13400 build/test_truth "[margin]"      so many rays of each of 76 families and formats, 10^6 in all
#include <cmath>
#include <cstdlib>
#include <sstream>
#include <string>
#include <vector>

#include "catch.hpp"
#include "counts.hpp"
#include "intersect/process/parallel.hpp"
#include "intersect/triangle/triangle_rays.hpp"
#include "measure/seeded.hpp"
#include "measure/stability/stability.hpp"
#include "measure/truth/box_families.hpp"
#include "measure/truth/brute_force.hpp"
#include "measure/truth/hard_rays.hpp"
#include "measure/truth/truth.hpp"
#include "scene/sweep/families.hpp"

namespace test_margin {

using namespace lostbits;
using namespace test::textbook;
using measure::stability::backward_error;
using measure::stability::decision_margin;
using measure::stability::Turned;
using measure::truth::find_truth;
using measure::truth::Perturbed;
using test::Seeded;

namespace {

struct Tally {
    int tight = 0, all = 0;
    void take(bool found) { ++all, tight += found; }
    void add(const Tally& other) { tight += other.tight, all += other.all; }
};

/// What the rays of a family showed. Catch counts on one thread, so it is told afterwards.
struct Found {
    Tally margins, errors;
    int rays = 0;
    std::vector<std::string> contradictions;

    void add(const Found& other) {
        margins.add(other.margins), errors.add(other.errors), rays += other.rays;
        contradictions.insert(contradictions.end(), other.contradictions.begin(), other.contradictions.end());
    }
};

Way random_way(std::uint64_t bits) {
    Way way{};
    for (std::size_t i = 0; i < way.size(); ++i) way[i] = (bits >> i & 1) != 0 ? 1 : -1;
    return way;
}

struct Seen {
    bool holds = true, is_tight = false;
};

/// What is said of every change by a part of each number, against changes at random and those on the ways to where
/// one of the functions is 0; and whether one that is a fifth larger is seen to matter.
template <class N, class Functions, class Same, class Turned>
Seen look(const Problem<N>& problem, double said, std::uint64_t bits, const Functions& functions, const Same& same,
          const Turned& turned) {
    Seen seen;
    const double farther = std::max(1.2 * said, 0x1p-80);
    for (std::size_t k = 0; k < 4; ++k)
        seen.holds &= same(problem.moved(random_way(bits >> k * most_of_problem), said));
    for (const Way& way : problem.ways_to_zero(functions, farther)) {
        seen.holds &= same(problem.moved(way, said));
        seen.is_tight |= turned(problem.moved(way, farther));
    }
    return seen;
}

/// One ray at one solid: what is said of its problem, and what is seen.
class Trial {
public:
    Trial(Found& found, const Ray<double>& ray, const Solid<double>& solid, Seeded& rng)
        : found_(found), ray_(ray), solid_(solid), rng_(rng) {
        ++found.rays;
    }

    /// A margin is never above what is found by looking. Of most a change a fifth larger that turns the decision is
    /// found: not of rays from the surface or at a rim, where two signs decide together, nor where the second order
    /// does, as of one through the middle of a sphere far away.
    void check_margin() {
        const double margin = decision_margin(ray_, solid_, Turned::decision);
        const double root = decision_margin(ray_, solid_);
        if (!(root >= 0 && root <= margin && margin <= 0.5)) contradict("margins", margin, root);
        const std::uint64_t bits = rng_.bits(60);
        Seen seen;
        const bool exact = in_exact_numbers([&]<class N>(const N&) {
            const Problem<N> problem(ray_, solid_);
            const bool hit = is_hit(problem.shape, problem.x);
            const auto signs = [&](const NumbersOf<N>& x) { return deciding(problem.shape, x); };
            const auto same = [&](const NumbersOf<N>& x) {
                return !is_problem(problem.shape, x) || is_hit(problem.shape, x) == hit;
            };
            seen = look(problem, margin, bits, signs, same, [&](const NumbersOf<N>& x) { return !same(x); });
        });
        if (!exact || !seen.holds) contradict(exact ? "margin" : "rounded, margin", margin);
        if (margin < 0x1p-8) found_.margins.take(seen.is_tight);
    }

    /// The same of the backward error of a t that is off by 2^-3 to 2^-45.
    void check_backward() {
        Textbook book;
        const Numbers wide = numbers_of(ray_, solid_);
        const bool is_far = solid_.shape == Shape::sphere && Quadratic(wide).c < 0;
        book.which = is_far ? 1 : -1, book.crossed = {wide[3] != 0, wide[4] != 0, wide[5] != 0};
        const auto root = book.t(solid_.shape, wide);
        if (!root || *root <= ldexp(Wide(1), -900) || *root >= ldexp(Wide(1), 900)) return;
        const double off = rng_.sign() * std::ldexp(1.0, -static_cast<int>(rng_.integer(3, 45)));
        const double t = static_cast<double>(*root) * (1 + off);
        const double error = backward_error(ray_, solid_, t);
        const std::uint64_t bits = rng_.bits(60);
        Seen seen;
        const bool exact = in_exact_numbers([&]<class N>(const N&) {
            const Problem<N> problem(ray_, solid_);
            const Shape shape = problem.shape;
            const N there(t);
            const Side before = side_of(shape, problem.x, there, is_far);
            const auto functions = [&](const NumbersOf<N>& x) { return residuals(shape, x, there); };
            const auto same = [&](const NumbersOf<N>& x) {
                const Side after = side_of(shape, x, there, is_far);
                return after == Side::none || after == before;
            };
            // At the rim a triangle may be missed where its plane comes to t.
            const bool above = functions(problem.x)[0] > 0;
            seen = look(problem, error, bits, functions, same, [&](const NumbersOf<N>& x) {
                return !same(x) || (shape == Shape::triangle && (functions(x)[0] > 0) != above);
            });
        });
        if (!exact || !seen.holds) contradict(exact ? "backward error" : "rounded, backward error", error, t);
        if (error < 0x1p-8) found_.errors.take(seen.is_tight);
    }

private:
    void contradict(const char* what, double said, double other = 0) {
        std::ostringstream out;
        out << std::hexfloat << what << ' ' << said << ' ' << other << " of the ray";
        for (const Vec<double>& v : {ray_.origin, ray_.direction}) out << ' ' << v.x << ' ' << v.y << ' ' << v.z;
        out << " at the " << row_of(solid_.shape).name;
        for (const double number : solid_.used()) out << ' ' << number;
        found_.contradictions.push_back(out.str());
    }

    Found& found_;
    const Ray<double>& ray_;
    Solid<double> solid_;
    Seeded& rng_;
};

void try_ray(Found& found, const Ray<double>& ray, const Solid<double>& solid, Seeded& rng) {
    Trial trial(found, ray, solid, rng);
    trial.check_margin();
    trial.check_backward();
}

const int rays_per_family = [] {
    const char* const asked = std::getenv("LOSTBITS_RAYS");
    return asked ? std::atoi(asked) : test::draws(400);
}();

/// The hard rays of a shape, on all threads.
void check_families(Shape shape, std::initializer_list<FloatFormat> formats) {
    const auto families = test::hard_families(shape, formats);
    std::vector<Found> parts(families.size());
    intersect::process::in_parallel(std::size_t{0}, families.size(), [&](std::size_t i) {
        Seeded rng(0x3a61);
        for (int k = 0; k < rays_per_family; ++k) {
            const auto [ray, solid, range] = families[i].draw(rng);
            if (measure::truth::is_proper(ray) && measure::truth::is_proper(solid)) try_ray(parts[i], ray, solid, rng);
        }
    });
    Found found;
    for (const Found& part : parts) found.add(part);
    for (const std::string& contradiction : found.contradictions) FAIL_CHECK(contradiction);
    if (rays_per_family > test::draws(400))
        WARN(found.rays << " rays, " << found.contradictions.size() << " contradictions");
    CHECK(found.margins.all >= 150);
    CHECK(found.errors.all >= 150);
    CHECK(found.margins.tight * 100 >= found.margins.all * 65);
    CHECK(found.errors.tight * 100 >= found.errors.all * 65);
}

}  // namespace

TEST_CASE("no change within the margin turns a decision, none within the backward error makes t right - spheres",
          "[margin]") {
    check_families(Shape::sphere, {binary32, binary64});
}

TEST_CASE("no change within the margin turns a decision, none within the backward error makes t right - boxes",
          "[margin]") {
    check_families(Shape::box, {binary32, binary64});
}

TEST_CASE("no change within the margin turns a decision, none within the backward error makes t right - triangles",
          "[margin]") {
    check_families(Shape::triangle, {binary32});
}

TEST_CASE("no change within the margin turns a decision, of every shape", "[margin]") {
    for (const auto& family : scene::sweep::families()) {
        INFO(family.table);
        Seeded rng(0x3a61);
        int told = 0, asked = 0;
        for (const auto& set : family.sets()) {
            for (const auto& group : set.groups()) {
                if (asked >= 4 * rays_per_family) break;
                const Ray<double> ray = group.rays[0];
                const Solid<double> solid = group.solids.front();
                const auto truth = find_truth(ray, solid);
                ++asked;
                for (const Perturbed perturbed : {Perturbed::componentwise, Perturbed::normwise}) {
                    const double margin = decision_margin(ray, solid, Turned::decision, perturbed);
                    told += margin > 0;
                    const double by = margin * (1 - 0x1p-20) - 0x1p-52;
                    if (by <= 0) continue;
                    for (int k = 0; k < 4; ++k) {
                        Ray<double> r = ray;
                        Solid<double> s = solid;
                        for (int i = 0; i < 3; ++i)
                            r.origin[i] *= 1 + by * rng.sign(), r.direction[i] *= 1 + by * rng.sign();
                        for (double& number : s.used()) number *= 1 + by * rng.sign();
                        if (measure::truth::is_proper(s)) CHECK(find_truth(r, s).is_hit() == truth.is_hit());
                    }
                }
            }
        }
        CHECK(asked > 0);
        CHECK(told >= asked);
    }
}

TEST_CASE("margins and backward errors by hand", "[margin]") {
    const Ray<double> ray{{0, 0, 0}, {0, 0, 1}};
    // d = 1 at distance 4 from a unit sphere whose centre is off the line by 1 - 2^-10: r and the centre move.
    const Sphere<double> grazed{{1 - 0x1p-10, 0, 4}, 1};
    const double margin = decision_margin(ray, grazed);
    CHECK(margin > 0.95 * 0x1p-11);
    CHECK(margin < 1.01 * 0x1p-11);
    // t = 3 of the sphere in front, and 3.003: (4 - 1)(1 + e) against a direction that is longer by e.
    const Sphere<double> front{{0, 0, 4}, 1};
    CHECK(backward_error(ray, front, 3) == 0);
    const double error = backward_error(ray, front, 3.003);
    // 4 (1 + e) - (1 - e) = 3.003 (1 - e): e = 0.003/8.003
    CHECK(error < 0.003 / 8.003);
    CHECK(error > 0.95 * 0.003 / 8.003);
    CHECK(std::isnan(backward_error(ray, front, 0)));
    // Where componentwise the ray along an axis keeps its zeros, normwise it turns.
    const Box<double> box{{1, -1, 3}, {2, 1, 5}};
    CHECK(decision_margin({{0, 0, 0}, {0, 0, 1}}, box) == 0.5);
    CHECK(decision_margin({{0, 0, 0}, {0, 0, 1}}, box, Turned::root, Perturbed::normwise) < 0.25);
    // A t so small or so large that it has no place beside the other numbers.
    CHECK(backward_error({{0, 0, 0}, {0, 0, 0x1p-1000}}, front, 0x1p-1074) >= 0);
    CHECK(backward_error({{0, 0, 0}, {0, 0, 0x1p+1000}}, front, 0x1p-1070) >= 0);
    // Nothing is proved where the ray touches.
    CHECK(decision_margin({{1, 0, 0}, {0, 0, 1}}, Sphere<double>{{0, 0, 4}, 1}) == 0);
}

}  // namespace test_margin
