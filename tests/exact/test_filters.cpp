// Promise of the forms that filter: no wrong decision, and 17 correct bits of 24 or 46 of 53 by a span, 18 or 47 by
// steps of their own. They are compared with answers that share nothing with them, in scalars and in packs.
// LOSTBITS_EXACT_RAYS sets the number of rays of each kind.
#include <algorithm>
#include <cmath>
#include <sstream>
#include <string>
#include <vector>

#include "catch.hpp"
#include "exact/check.hpp"
#include "exact/draw.hpp"
#include "exact/hard_tori.hpp"
#include "intersect/filter/first_span_hit.hpp"
#include "intersect/filter/first_span_hit_quartic.hpp"
#include "intersect/simd/packed.hpp"
#include "intersect/table/table.hpp"

namespace test_filters {

using namespace lostbits;
using namespace lostbits::exact;

namespace {

using intersect::DecidingArithmetic, intersect::simd::Isa, intersect::table::Intersector, intersect::table::Kernel;

constexpr std::size_t batch = 2000;
std::size_t rays_of_each() { return ray_count_or(4'000); }

constexpr bool has_own_steps(Shape shape) { return shape <= Shape::triangle; }

template <class Visit>
void for_each_filter(const Visit& visit) {
    std::size_t filters = 0;
    for (const Intersector& form : intersect::table::catalogue())
        if (form.deciding_arithmetic)
            visit(form, *std::ranges::find(shapes, name_of(form.shape), &ShapeTest::name)), ++filters;
    CHECK(filters == shapes.size());
}

template <class F>
Primitive<F> primitive_of(const Intersector& form, const Problem& problem) {
    Primitive<F> primitive(form.shape);
    for (std::size_t k = 0; k < primitive.shape_numbers().size(); ++k)
        primitive.numbers[k] = static_cast<F>(problem.primitive[k]);
    return primitive;
}

/// The rays of problems: all at one primitive, or each at its own.
template <class F, class Run>
std::vector<Hit<F>> ask(const Run& run, std::span<const Problem> problems, std::span<const Primitive<F>> primitives) {
    std::array<std::vector<F>, 7> columns;
    for (const Problem& problem : problems) {
        for (std::size_t k = 0; k < 6; ++k) columns[k].push_back(static_cast<F>(problem.ray[k]));
        columns[6].push_back(static_cast<F>(problem.tmax));
    }
    std::vector<F> t(problems.size()), near = t, far = t;
    std::vector<std::uint8_t> hit(problems.size());
    const auto& [ox, oy, oz, dx, dy, dz, tmax] = columns;
    run(intersect::table::RayBatch<F>{ox, oy, oz, dx, dy, dz, tmax}, intersect::Target<F>(primitives),
        intersect::table::HitBatch<F>{t, near, far, hit});
    std::vector<Hit<F>> found;
    for (std::size_t i = 0; i < hit.size(); ++i) found.push_back({hit[i] != 0, t[i], near[i], far[i]});
    return found;
}

/// Compares t to 32u or 64u of itself plus the least number of the format; a t of 0 must round to 0. NaN is wrong.
Answer answer_of(bool hit, double t, const FloatFormat& format, bool own_steps) {
    Answer a{.hit = hit, .as_float = NAN, .as_double = NAN};
    if (!hit) return a;
    const int lowest = format.emin - format.precision + 1;
    if (!std::isfinite(t)) t = -1;
    a.high = t, a.bound = std::ldexp(t, (own_steps ? 5 : 6) - format.precision) + std::ldexp(1.0, lowest);
    if (t < 0) a.bound = 0;
    if (t == 0) a.high = a.bound = 1, a.exponent = lowest - 1;
    return a;
}
/// Answers and the expected answers: all except hits at infinity.
struct CheckedForm {
    std::vector<Problem> problems;
    std::vector<Answer> answers;
    std::size_t hits = 0, endless = 0;

    template <class F>
    CheckedForm(const Intersector& form, const FloatFormat& format, std::span<const Problem> all,
                const std::vector<Hit<F>>& found) {
        for (std::size_t i = 0; i < found.size(); ++i) {
            const double t = static_cast<double>(found[i].t);
            hits += found[i].hit;
            if (found[i].hit && std::isinf(t)) ++endless;
            else
                problems.push_back(all[i]),
                    answers.push_back(answer_of(found[i].hit, t, format, has_own_steps(form.shape)));
        }
    }
    [[nodiscard]] std::string words_of_first(const ShapeTest& shape, const Findings& f) const {
        return std::string(words_of(f.fault)) + "\n" + paste(shape, problems[f.first_wrong], answers[f.first_wrong]);
    }
};

/// Alone (`Isa::scalar`) or in packs.
template <class F>
Kernel<F> kernel_of(const Intersector& form, Isa isa) {
    const intersect::simd::PackedFormKernels row = intersect::simd::packed_kernels(form, isa);
    if constexpr (sizeof(F) == 4) return row.f32;
    else return row.f64;
}

struct Tally {
    std::size_t ray_count = 0, hits = 0, wrong = 0, endless = 0, differ = 0, first_batch = 0;
    std::array<std::size_t, 4> ways{};  ///< of the first batch, which is asked again for it
    std::string first;

    [[nodiscard]] bool go_some(DecidingArithmetic way, std::size_t of_a_thousand) const {
        return 1000 * ways[static_cast<std::size_t>(way)] >= of_a_thousand * first_batch;
    }
};

template <class F>
void add_ways(const Intersector& form, std::span<const Problem> problems, Tally& tally) {
    const Format format = *find_format(sizeof(F) == 4 ? "f32" : "f64");
    for (const Problem& problem : problems) {
        const Ray<double> ray{{problem.ray[0], problem.ray[1], problem.ray[2]},
                              {problem.ray[3], problem.ray[4], problem.ray[5]}};
        ++tally.ways[static_cast<std::size_t>(
            form.deciding_arithmetic(format, ray, primitive_of<double>(form, problem), problem.tmax))];
    }
    tally.first_batch = problems.size();
}

/// Counts answers of a pack that differ in any bit from those of each ray alone. The pack contains a ray, others on its
/// line, and the same rays reversed: most of them are proved by fewer steps than the first ray needs.
template <class F>
std::size_t differing(const Intersector& form, const Problem& problem) {
    std::vector<Problem> problems(16 / sizeof(F), problem);
    for (std::size_t lane = 1; lane < problems.size(); ++lane)
        for (std::size_t i = 0; i < 3; ++i) {
            if (lane > 1) problems[lane].ray[i] -= problems[lane].ray[3 + i];
            if (lane % 2 == 1) problems[lane].ray[3 + i] *= -1;
        }
    const Primitive<F> primitive = primitive_of<F>(form, problem);
    const std::vector<Hit<F>> alone = ask<F>(kernel_of<F>(form, Isa::scalar), problems, {&primitive, 1}),
                              together = ask<F>(kernel_of<F>(form, Isa::w128), problems, {&primitive, 1});
    const auto same = [](F a, F b) { return a == b ? std::signbit(a) == std::signbit(b) : a != a && b != b; };
    std::size_t differ = 0;
    for (std::size_t i = 0; i < alone.size(); ++i) {
        const Hit<F>&a = alone[i], &b = together[i];
        differ += a.hit != b.hit || !same(a.t, b.t) || !same(a.near, b.near) || !same(a.far, b.far);
    }
    return differ;
}

/// Checks the rays that `draw(problems)` fills a batch with.
template <class F, class Draw>
Tally ask_all(const Intersector& form, const ShapeTest& shape, std::size_t rays, const Draw& draw) {
    Tally tally;
    std::vector<Problem> problems(std::min(batch, rays));
    while (tally.ray_count < rays) {
        draw(problems);
        std::vector<Primitive<F>> primitives;
        for (Problem& problem : problems) {
            problem.tmin = 0;
            if (!takes_tmax(form.shape)) problem.tmax = INFINITY;
            primitives.push_back(primitive_of<F>(form, problem));
        }
        if (tally.ray_count == 0) add_ways<F>(form, problems, tally);
        const CheckedForm all(form, sizeof(F) == 4 ? binary32 : binary64, problems,
                              ask<F>(kernel_of<F>(form, Isa::scalar), problems, primitives));
        const Findings f = check(shape, all.problems, all.answers, HUGE_VAL, 200);
        if (tally.wrong == 0 && f.wrong_count > 0) tally.first = all.words_of_first(shape, f);
        tally.hits += all.hits, tally.endless += all.endless;
        tally.wrong += f.wrong_count, tally.ray_count += problems.size();
        for (std::size_t i = 0; i < problems.size(); i += 16) tally.differ += differing<F>(form, problems[i]);
    }
    return tally;
}

template <class F>
std::string words_of(const Intersector& form, const Tally& tally) {
    std::ostringstream counts;
    counts << form.info->name << " in " << 8 * sizeof(F) << " bits: " << tally.ray_count << " rays, " << tally.hits
           << " hits, of which " << tally.endless << " at infinity; of the first " << tally.first_batch
           << " in its own arithmetic " << tally.ways[0] << ", wider " << tally.ways[1] << ", two words "
           << tally.ways[2] << ", exact " << tally.ways[3];
    return counts.str();
}

/// Least counts in a thousand rays, for each shape: hits, and rays that are settled by the form's own arithmetic, by
/// two words, and exactly in double. They are for random rays, and for rays where something is exactly equal; each is a
/// tenth less than was measured.
struct Shares {
    std::string_view shape;
    std::size_t random_hits, random_own, hits, own, two_words, exact;
};
constexpr std::array<Shares, 11> least{{{"sphere", 610, 830, 290, 400, 3, 440},
                                        {"box", 720, 910, 490, 500, 0, 410},
                                        {"triangle", 310, 490, 440, 165, 8, 690},
                                        {"ellipsoid", 610, 910, 280, 440, 85, 360},
                                        {"cylinder", 670, 590, 330, 360, 185, 360},
                                        {"capsule", 700, 610, 410, 290, 235, 380},
                                        {"tube", 660, 630, 270, 375, 175, 350},
                                        {"cone", 650, 540, 300, 360, 180, 355},
                                        {"disc", 175, 910, 98, 490, 105, 290},
                                        {"plane", 990, 880, 510, 420, 235, 250},
                                        {"torus", 450, 780, 330, 345, 50, 410}}};

template <class F>
void hold(bool made) {
    for_each_filter([made](const Intersector& form, const ShapeTest& shape) {
        // A torus takes as long to check as thirty other primitives, and t of every twentieth is too large.
        const bool slow = form.shape == Shape::torus;
        Chance chance(made ? 2 : 1);
        const auto draw = [&](std::vector<Problem>& problems) {
            (made ? draw_made : draw_random)(shape, sizeof(F) == 4, {}, chance, problems);
        };
        const Tally tally = ask_all<F>(form, shape, rays_of_each() / (slow ? 5 : 1), draw);
        const std::string counts = words_of<F>(form, tally);
        INFO(counts << "; " << tally.first);
        CHECK(tally.wrong == 0);
        CHECK(tally.differ == 0);
        CHECK(tally.endless < tally.hits / (slow ? 12 : 20));
        CHECK((tally.ways[1] > 0) == (sizeof(F) == 4));
        const auto* const row = std::ranges::find(least, shape.name, &Shares::shape);
        REQUIRE(row != least.end());
        CHECK(1000 * tally.hits >= (made ? row->hits : row->random_hits) * tally.ray_count);
        CHECK(tally.go_some(DecidingArithmetic::own, made ? row->own : row->random_own));
        CHECK((!made || tally.go_some(DecidingArithmetic::two_words, row->two_words)));
        CHECK((!made || sizeof(F) == 4 || tally.go_some(DecidingArithmetic::exact, row->exact)));
        if (is_ray_count_given()) WARN(counts);
    });
}

}  // namespace

TEMPLATE_TEST_CASE("exact: filters decide right and keep their bits", "[exact][filtered]", float, double) {
    hold<TestType>(false);
}

TEMPLATE_TEST_CASE("exact: filters decide right where two values are exactly equal", "[exact][filtered]", float,
                   double) {
    hold<TestType>(true);
}

TEMPLATE_TEST_CASE("exact: the filter of tori decides right at tangent points, for tori without a hole and at any size",
                   "[exact][filtered]", float, double) {
    const Intersector& form = *std::ranges::find(intersect::table::catalogue(), "torus.filtered",
                                                 [](const Intersector& row) { return row.info->name; });
    for (const char* const kind : {"touched", "without a hole", "of any size"}) {
        const bool any_size = kind == std::string_view("of any size");
        Chance chance(4);
        const auto draw = [&](std::vector<Problem>& problems) {
            for (Problem& problem : problems)
                problem = any_size ? torus_of_any_size<TestType>(chance)
                                   : beside_torus<TestType>(chance, kind == std::string_view("without a hole"));
        };
        const Tally tally = ask_all<TestType>(form, shapes.back(), rays_of_each() / 5, draw);
        const std::string counts = words_of<TestType>(form, tally);
        INFO(kind << ": " << counts << "; " << tally.first);
        CHECK(tally.wrong == 0);
        CHECK(tally.differ == 0);
        CHECK(tally.hits > tally.ray_count / 50);
        CHECK(tally.ways[3] > (any_size ? 0 : tally.first_batch / 10));
        if (is_ray_count_given()) WARN(kind << ": " << counts);
    }
}

/// The same formula without a filter: the test shows why a filter is needed.
TEST_CASE("exact: a filter's formula alone gives wrong answers", "[exact][filtered]") {
    for_each_filter([](const Intersector& form, const ShapeTest& shape) {
        if (has_own_steps(form.shape)) return;
        Chance chance(3);
        std::vector<Problem> problems(batch);
        std::vector<Answer> answers;
        draw_made(shape, true, {}, chance, problems);
        for (Problem& problem : problems) {
            problem.tmin = 0, problem.tmax = INFINITY;
            const auto number = [&problem](std::size_t k) { return static_cast<float>(problem.ray[k]); };
            const Ray<float> ray{{number(0), number(1), number(2)}, {number(3), number(4), number(5)}};
            visit(primitive_of<float>(form, problem), [&](const auto& primitive) {
                if constexpr (requires { intersect::filter::first_span_hit(primitive.span(ray)); }) {
                    const auto met = intersect::filter::first_span_hit(primitive.span(ray));
                    answers.push_back(answer_of(met.hit, static_cast<double>(met.t), binary32, false));
                }
            });
        }
        INFO(form.info->name);
        CHECK(check(shape, problems, answers, HUGE_VAL, 200).wrong_count > 0);
    });
}

/// Formats that no register holds, with whole numbers that they represent.
TEST_CASE("exact: filters decide right and keep their bits in p16 and fp16", "[exact][filtered]") {
    for (const char* const name : {"p16", "fp16"})
        for_each_filter([name](const Intersector& form, const ShapeTest& shape) {
            const FloatFormat format = find_format(name)->parameters;
            const auto is_held = [&](double x) { return std::fabs(x) < 64 && rounding::to_format(x, 0, format) == x; };
            Chance chance(5);
            std::vector<Problem> some(batch), held_problems;
            std::vector<Primitive<double>> primitives;
            draw_made(shape, true, {}, chance, some);
            for (Problem& problem : some) {
                problem.tmin = 0, problem.tmax = INFINITY;
                if (!std::ranges::all_of(problem.ray, is_held) || !std::ranges::all_of(problem.primitive, is_held))
                    continue;
                held_problems.push_back(problem), primitives.push_back(primitive_of<double>(form, problem));
            }
            const auto in_format = [&](const auto&... batch_of) { form.rounded(format, batch_of...); };
            const CheckedForm all(form, format, held_problems, ask<double>(in_format, held_problems, primitives));
            const Findings f = check(shape, all.problems, all.answers, HUGE_VAL, 20);
            INFO(form.info->name << " in " << name << ": " << all.problems.size() << " rays, " << all.hits << " hits; "
                                 << all.words_of_first(shape, f));
            CHECK(f.wrong_count == 0);
            CHECK(all.hits > all.problems.size() / 20);
            CHECK(all.problems.size() > batch / 4);
        });
}

}  // namespace test_filters
