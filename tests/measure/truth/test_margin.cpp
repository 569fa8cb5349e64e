// Decision margins, compared with the exact decisions of problems that are changed by as much.
//
//   LOSTBITS_RAYS=13400 build/test_truth "[margin]"      so many rays of each of 76 distributions and formats, 10^6 in
//   all LOSTBITS_LONG=1 build/test_truth "[attack]"          100000 attacked problems of each shape
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
#include "measure/truth/box_distributions.hpp"
#include "measure/truth/brute_force.hpp"
#include "measure/truth/hard_rays.hpp"
#include "measure/truth/margin_problems.hpp"
#include "measure/truth/truth.hpp"
#include "scene/sweep/distributions.hpp"

namespace test_margin {

using namespace lostbits;
using namespace test::textbook;
using measure::stability::backward_error;
using measure::stability::CountedChange;
using measure::stability::find_decision_margin;
using measure::stability::find_margin;
using measure::stability::Margin;
using measure::stability::max_tight_margin;
using measure::truth::find_truth;
using measure::truth::Perturbation;
using test::Seeded;

namespace {

struct Tally {
    int tight = 0, all = 0;
    void take(bool found) { ++all, tight += found; }
    void add(const Tally& other) { tight += other.tight, all += other.all; }
};

/// Findings about the rays of a distribution. Catch counts on one thread, so they are checked afterwards.
struct Findings {
    Tally margins, errors;
    int rays = 0;
    std::vector<std::string> contradictions;

    void add(const Findings& other) {
        margins.add(other.margins), errors.add(other.errors), rays += other.rays;
        contradictions.insert(contradictions.end(), other.contradictions.begin(), other.contradictions.end());
    }
};

Way random_way(std::uint64_t bits) {
    Way way{};
    for (std::size_t i = 0; i < way.size(); ++i) way[i] = (bits >> i & 1) != 0 ? 1 : -1;
    return way;
}

struct SeenWays {
    bool holds = true, is_tight = false;
};

/// Tests the margin `said`: no change by that part of each number changes the result, neither a random one nor one
/// towards a zero of one of the functions. `is_tight` if a change that is a fifth larger does.
template <class N, class Functions, class Same, class Turned>
SeenWays look(const Problem<N>& problem, double said, std::uint64_t bits, const Functions& functions, const Same& same,
              const Turned& turned) {
    SeenWays seen;
    const double farther = std::max(1.2 * said, 0x1p-80);
    for (std::size_t k = 0; k < 4; ++k)
        seen.holds &= same(problem.moved(random_way(bits >> k * most_of_problem), said));
    for (const Way& way : problem.ways_to_zero(functions, farther)) {
        seen.holds &= same(problem.moved(way, said));
        seen.is_tight |= turned(problem.moved(way, farther));
    }
    return seen;
}

/// A ray at a primitive: the numbers computed for its problem, and those observed.
class Trial {
public:
    Trial(Findings& found, const Ray<double>& ray, const Primitive<double>& primitive, Seeded& rng)
        : found_(found), ray_(ray), primitive_(primitive), rng_(rng) {
        ++found.rays;
    }

    /// A margin is never above the smallest change that the search finds. For most problems it finds a change that is a
    /// fifth larger and changes the decision. Exceptions are rays from the surface or at a rim, where two signs decide
    /// together, and problems of second order, such as a ray through the middle of a sphere far away.
    void check_margin() {
        const double margin = find_margin(ray_, primitive_, CountedChange::decision).proved;
        const double root = find_margin(ray_, primitive_).proved;
        // Both are searched to 2^(1/16), or to 2 if they are large.
        const bool in_order = root <= margin * (margin < max_tight_margin ? 1.05 : 2);
        if (!(root >= 0 && in_order && margin <= 0.5)) contradict("margins", margin, root);
        const std::uint64_t bits = rng_.bits(60);
        SeenWays seen;
        const bool exact = in_exact_numbers([&]<class N>(const N&) {
            const Problem<N> problem(ray_, primitive_);
            const bool hit = is_hit(problem.shape, problem.x);
            const auto signs = [&](const NumbersOf<N>& x) { return deciding(problem.shape, x); };
            const auto same = [&](const NumbersOf<N>& x) {
                return !is_problem(problem.shape, x) || is_hit(problem.shape, x) == hit;
            };
            seen = look(problem, margin, bits, signs, same, [&](const NumbersOf<N>& x) { return !same(x); });
        });
        if (!exact || !seen.holds) contradict(exact ? "margin" : "rounded, margin", margin);
        if (margin < max_tight_margin) found_.margins.take(seen.is_tight);
    }

    /// The same for the backward error of a t that is off by 2^-3 to 2^-45.
    void check_backward() {
        Textbook book;
        const Numbers wide = numbers_of(ray_, primitive_);
        const bool is_far = primitive_.shape == Shape::sphere && Quadratic(wide).c < 0;
        book.which = is_far ? 1 : -1, book.crossed = {wide[3] != 0, wide[4] != 0, wide[5] != 0};
        const auto root = book.t(primitive_.shape, wide);
        if (!root || *root <= ldexp(Wide(1), -900) || *root >= ldexp(Wide(1), 900)) return;
        const double off = rng_.sign() * std::ldexp(1.0, -static_cast<int>(rng_.integer(3, 45)));
        const double t = static_cast<double>(*root) * (1 + off);
        const double error = backward_error(ray_, primitive_, t);
        const std::uint64_t bits = rng_.bits(60);
        SeenWays seen;
        const bool exact = in_exact_numbers([&]<class N>(const N&) {
            const Problem<N> problem(ray_, primitive_);
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
        out << " at the " << row_of(primitive_.shape).name;
        for (const double number : primitive_.shape_numbers()) out << ' ' << number;
        found_.contradictions.push_back(out.str());
    }

    Findings& found_;
    const Ray<double>& ray_;
    Primitive<double> primitive_;
    Seeded& rng_;
};

void try_ray(Findings& found, const Ray<double>& ray, const Primitive<double>& primitive, Seeded& rng) {
    Trial trial(found, ray, primitive, rng);
    trial.check_margin();
    trial.check_backward();
}

const int rays_per_distribution = [] {
    const char* const text = std::getenv("LOSTBITS_RAYS");
    return text ? std::atoi(text) : test::draws(400);
}();

/// The hard rays of a shape, on all threads.
void check_distributions(Shape shape, std::initializer_list<FloatFormat> formats) {
    const auto distributions = test::hard_distributions(shape, formats);
    std::vector<Findings> parts(distributions.size());
    intersect::process::in_parallel(std::size_t{0}, distributions.size(), [&](std::size_t i) {
        Seeded rng(0x3a61);
        for (int k = 0; k < rays_per_distribution; ++k) {
            const auto [ray, primitive, range] = distributions[i].draw(rng);
            if (measure::truth::is_valid(ray) && measure::truth::is_valid(primitive))
                try_ray(parts[i], ray, primitive, rng);
        }
    });
    Findings found;
    for (const Findings& part : parts) found.add(part);
    for (const std::string& contradiction : found.contradictions) FAIL_CHECK(contradiction);
    if (rays_per_distribution > test::draws(400))
        WARN(found.rays << " rays, " << found.contradictions.size() << " contradictions");
    CHECK(found.margins.all >= 150);
    CHECK(found.errors.all >= 150);
    CHECK(found.margins.tight * 100 >= found.margins.all * 65);
    CHECK(found.errors.tight * 100 >= found.errors.all * 65);
}

}  // namespace

TEST_CASE("no change within the margin changes a decision, nor one within the backward error corrects t - spheres",
          "[margin]") {
    check_distributions(Shape::sphere, {binary32, binary64});
}

TEST_CASE("no change within the margin changes a decision, nor one within the backward error corrects t - boxes",
          "[margin]") {
    check_distributions(Shape::box, {binary32, binary64});
}

TEST_CASE("no change within the margin changes a decision, nor one within the backward error corrects t - triangles",
          "[margin]") {
    check_distributions(Shape::triangle, {binary32});
}

TEST_CASE("no change within the margin changes a decision for any shape", "[margin]") {
    for (const auto& distribution : scene::sweep::distributions()) {
        INFO(distribution.table);
        Seeded rng(0x3a61);
        int positive_margin_count = 0, ray_count = 0;
        for (const auto& set : distribution.ray_sets()) {
            for (const auto& group : set.groups()) {
                if (ray_count >= 4 * rays_per_distribution) break;
                const Ray<double> ray = group.rays[0];
                const Primitive<double> primitive = group.primitives.front();
                const auto truth = find_truth(ray, primitive);
                ++ray_count;
                for (const Perturbation perturbation : {Perturbation::componentwise, Perturbation::normwise}) {
                    const double margin = find_margin(ray, primitive, CountedChange::decision, perturbation).proved;
                    positive_margin_count += margin > 0;
                    const double by = margin * (1 - 0x1p-20) - 0x1p-52;
                    if (by <= 0) continue;
                    for (int k = 0; k < 4; ++k) {
                        Ray<double> r = ray;
                        Primitive<double> s = primitive;
                        for (int i = 0; i < 3; ++i)
                            r.origin[i] *= 1 + by * rng.sign(), r.direction[i] *= 1 + by * rng.sign();
                        for (double& number : s.shape_numbers()) number *= 1 + by * rng.sign();
                        if (measure::truth::is_valid(s)) CHECK(find_truth(r, s).is_hit() == truth.is_hit());
                    }
                }
            }
        }
        CHECK(ray_count > 0);
        CHECK(positive_margin_count >= ray_count);
    }
}

namespace {

/// Findings of an attack on the margins of a shape.
struct AttackedMargin {
    int problems = 0, missing = 0, small = 0;
    std::vector<std::string> contradictions;
};

/// The change of a margin is at most twice the margin, and changes the decision, exactly.
bool is_witness(const test::MarginProblem& problem, const Margin& margin, Perturbation perturbation) {
    Ray<Real> ray = lift_ray<Real>(problem.ray);
    Primitive<Real> primitive = lift_primitive<Real>(problem.primitive);
    for (int i = 0; i < 3; ++i) {
        ray.origin[i] += margin.reached_change[i];
        ray.direction[i] += margin.reached_change[static_cast<std::size_t>(i) + 3];
    }
    for (std::size_t i = 0; i < primitive.shape_numbers().size(); ++i)
        primitive.shape_numbers()[i] += margin.reached_change[i + 6];
    const std::vector<double> x = problem.numbers();
    const double most = 2 * std::max(margin.proved, 0x1p-90);
    bool is_small = true;
    const auto vector = [&](std::size_t first, std::size_t count) {
        double size = 0, change = 0;
        for (std::size_t i = first; i < first + count; ++i) {
            size += x[i] * x[i], change += margin.reached_change[i] * margin.reached_change[i];
            if (perturbation == Perturbation::componentwise)
                is_small &= std::fabs(margin.reached_change[i]) <= most * std::fabs(x[i]);
        }
        if (perturbation == Perturbation::normwise) is_small &= std::sqrt(change) <= most * std::sqrt(size);
    };
    vector(0, 3), vector(3, 3);
    for_each_key(problem.primitive.shape, [&](const Key& key, std::size_t at) { vector(6 + at, key.count()); });
    const auto truth = find_truth(ray, std::span<const Primitive<Real>>(&primitive, 1));
    return is_small && truth.decision != measure::truth::Truth::Decision::unresolved &&
           truth.is_hit() != *problem.hits();
}

std::string in_hex(const test::MarginProblem& problem) {
    std::ostringstream out;
    out << row_of(problem.primitive.shape).name << std::hexfloat;
    for (const double x : problem.numbers()) out << ' ' << x;
    return out.str();
}

void attack(AttackedMargin& seen, const test::MarginProblem& problem, Seeded& rng) {
    const auto contradict = [&](const char* what, double by) {
        std::ostringstream out;
        out << what << ' ' << by << " of " << in_hex(problem);
        seen.contradictions.push_back(out.str());
    };
    ++seen.problems;
    for (const Perturbation perturbation : {Perturbation::componentwise, Perturbation::normwise}) {
        const Margin margin = find_margin(problem.ray, problem.primitive, CountedChange::decision, perturbation);
        const double decision_margin =
            find_decision_margin(problem.ray, problem.primitive, CountedChange::decision, perturbation);
        const bool missing = std::isnan(decision_margin);
        if (!(missing || decision_margin == margin.proved) || !(margin.proved >= 0 && margin.proved <= 0.5))
            contradict("no margin", margin.proved);
        if (!missing && margin.proved < max_tight_margin && !is_witness(problem, margin, perturbation))
            contradict("no change is found for the margin", margin.proved);
        if (perturbation == Perturbation::normwise) continue;
        seen.missing += missing, seen.small += margin.proved < max_tight_margin;
        // No change of each number by a fraction of itself is smaller, whether or not the margin is reported.
        const double found = test::Attack(problem, rng).least(0.5, 3);
        if (found < margin.proved * (1 - 0x1p-30)) contradict("a smaller change turns the decision", found);
    }
}

}  // namespace

TEST_CASE("margins are the least changes to a factor of two for every shape", "[margin][attack]") {
    const int each = test::draws(100000, 40);
    for (const auto& row : shape_rows) {
        if (!is_primitive(row.shape)) continue;
        INFO(row.name);
        std::vector<AttackedMargin> parts(static_cast<std::size_t>(test::MarginProblems::kinds) * 8);
        intersect::process::in_parallel(std::size_t{0}, parts.size(), [&](std::size_t i) {
            Seeded rng(0x5eed + i);
            test::MarginProblems problems(row.shape, rng);
            for (int k = 0; k < each / static_cast<int>(parts.size()); ++k)
                if (const auto problem = problems.draw(static_cast<int>(i % test::MarginProblems::kinds)))
                    attack(parts[i], *problem, rng);
        });
        AttackedMargin all;
        for (const AttackedMargin& part : parts) {
            all.problems += part.problems, all.missing += part.missing, all.small += part.small;
            for (const std::string& contradiction : part.contradictions) FAIL_CHECK(contradiction);
        }
        INFO(all.problems << " problems, " << all.small << " small margins, " << all.missing << " missing");
        if (test::is_long())
            WARN(all.problems << " problems, " << all.small << " small, " << all.missing << " missing");
        CHECK(all.problems >= each / 2);
        CHECK(all.small * 16 >= all.problems);
        CHECK(all.missing * 25 <= all.problems);
    }
}

TEST_CASE("margins of rays across an axis and of tori at a silhouette do not collapse to zero", "[margin]") {
    // v·d is 0: its sign decides nothing. The ray passes 1/4 inside the side: 1/4 divided by the numbers that move it.
    const Ray<double> across{{-4, 1, 0.75}, {1, 0, 0}};
    for (const Primitive<double>& primitive : {Primitive<double>(Cylinder<double>{{0, 0, 0}, {0, 2, 0}, 1}),
                                               Primitive<double>(Tube<double>{{0, 0, 0}, {0, 2, 0}, 1}),
                                               Primitive<double>(Capsule<double>{{0, 0, 0}, {0, 2, 0}, 1})}) {
        INFO(row_of(primitive.shape).name);
        const Margin margin = find_margin(across, primitive, CountedChange::decision);
        CHECK(margin.proved > 0.04);
    }
    const Primitive<double> torus = Torus<double>{{0, 0, 0}, {0, 0, 1}, 2, 0.5};
    for (const double inside : {0x1p-12, 0x1p-20}) {
        // z and the minor radius meet: (1/2 - inside)(1 + e) = 1/2 (1 - e).
        const double margin = find_decision_margin({{0, -4, 0.5 - inside}, {0, 1, 0}}, torus, CountedChange::decision);
        CHECK(margin < 1.001 * inside);
        CHECK(margin > 0.5 * inside);
    }
}

TEST_CASE("a margin that is not known to a factor of two is left out", "[margin]") {
    const Margin proved_alone{0x1p-20, HUGE_VAL}, twice{0x1p-20, 0x1p-19}, large{0x1p-9, HUGE_VAL};
    CHECK(!proved_alone.is_tight());
    CHECK(twice.is_tight());
    CHECK(large.is_tight());
}

TEST_CASE("whether a change within u changes a decision is found or proved", "[margin]") {
    using measure::stability::changes_within;
    const Ray<double> ray{{0, 0, 0}, {0, 0, 1}};
    const Sphere<double> grazed{{1 - 0x1p-20, 0, 4}, 1};  // margin 2^-21
    CHECK(changes_within(0x1p-24, ray, grazed, CountedChange::decision) == false);
    CHECK(changes_within(0x1p-20, ray, grazed, CountedChange::decision) == true);
}

TEST_CASE("the margin of a ray that misses several primitives is the nearest one's", "[margin]") {
    const Ray<double> ray{{0, 0, 0}, {0, 0, 1}};
    std::vector<Primitive<double>> primitives;
    for (int i = 0; i < 20; ++i) primitives.push_back(Sphere<double>{{4.0 + i, 0, 4}, 1});
    primitives.push_back(Torus<double>{{0, 8, 3}, {1, 0, 0}, 2, 0.5});
    primitives[13] = Sphere<double>{{1 + 0x1p-12, 0, 4}, 1};
    CHECK(measure::stability::find_nearest_decision(ray, scene::rays::PrimitiveList<double>(primitives)) == 13);
    Seeded rng(0x3a61);
    for (int k = 0; k < test::draws(2000); ++k) {
        for (Primitive<double>& primitive : primitives)
            if (primitive.is<Sphere>()) primitive = Sphere<double>{rng.vec(-4, 4), rng.uniform(0.1, 1)};
        double least = HUGE_VAL;
        bool misses = true;
        for (const Primitive<double>& primitive : primitives) {
            misses &= !find_truth(ray, primitive).is_hit();
            least = std::min(least, find_margin(ray, primitive).proved);
        }
        if (!misses) continue;
        const std::size_t nearest =
            measure::stability::find_nearest_decision(ray, scene::rays::PrimitiveList<double>(primitives));
        CHECK(find_margin(ray, primitives[nearest]).proved <= least * (least < max_tight_margin ? 1.1 : 2));
    }
}

TEST_CASE("margins and backward errors agree with those worked out by hand", "[margin]") {
    const Ray<double> ray{{0, 0, 0}, {0, 0, 1}};
    // d = 1 at distance 4 from a unit sphere whose centre is off the line by 1 - 2^-10: r and the centre move.
    const Sphere<double> grazed{{1 - 0x1p-10, 0, 4}, 1};
    const double margin = find_decision_margin(ray, grazed);
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
    // Componentwise, the ray along an axis keeps its zeros; normwise, it turns.
    const Box<double> box{{1, -1, 3}, {2, 1, 5}};
    CHECK(find_decision_margin({{0, 0, 0}, {0, 0, 1}}, box) == 0.5);
    CHECK(find_decision_margin({{0, 0, 0}, {0, 0, 1}}, box, CountedChange::root, Perturbation::normwise) < 0.25);
    // A t so small or so large that it is negligible beside the other numbers.
    CHECK(backward_error({{0, 0, 0}, {0, 0, 0x1p-1000}}, front, 0x1p-1074) >= 0);
    CHECK(backward_error({{0, 0, 0}, {0, 0, 0x1p+1000}}, front, 0x1p-1070) >= 0);
    // Nothing is proved where the ray touches.
    CHECK(find_decision_margin({{1, 0, 0}, {0, 0, 1}}, Sphere<double>{{0, 0, 4}, 1}) == 0);
}

}  // namespace test_margin
