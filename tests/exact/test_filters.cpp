// The promise of the forms that filter: no wrong decision, and 17 correct bits of 24 or 46 of 53 by a span, 18 or 47 by
// steps of their own, held against answers that share nothing with them, in scalars and in packs. LOSTBITS_EXACT_RAYS
// says how many rays of each kind.
#include <algorithm>
#include <cmath>
#include <limits>
#include <sstream>
#include <string>
#include <vector>

#include "catch.hpp"
#include "exact/check.hpp"
#include "exact/draw.hpp"
#include "intersect/form_list.hpp"
#include "intersect/table/table.hpp"
#include "intersect/takes.hpp"
#include "number/pack.hpp"
#include "number/wide/wide_pack.hpp"
#include "shapes/box/forms/filtered.hpp"
#include "shapes/capsule/forms/filtered.hpp"
#include "shapes/cone/forms/filtered.hpp"
#include "shapes/cylinder/forms/filtered.hpp"
#include "shapes/disc/forms/filtered.hpp"
#include "shapes/ellipsoid/forms/filtered.hpp"
#include "shapes/plane/forms/filtered.hpp"
#include "shapes/sphere/forms/filtered.hpp"
#include "shapes/torus/forms/filtered.hpp"
#include "shapes/triangle/forms/filtered.hpp"
#include "shapes/tube/forms/filtered.hpp"

namespace test_filters {

using namespace lostbits;
using namespace lostbits::exact;

namespace {

using ByOwnSteps = intersect::FormList<intersect::sphere::Filtered, intersect::box::FilteredSlabs,
                                       intersect::triangle::FilteredTriangle>;
using BySpan = intersect::FormList<  //
    intersect::ellipsoid::FilteredEllipsoid, intersect::cylinder::FilteredCylinder, intersect::capsule::FilteredCapsule,
    intersect::tube::FilteredTube, intersect::cone::FilteredCone, intersect::disc::FilteredDisc,
    intersect::plane::FilteredPlane, intersect::torus::FilteredTorus>;

constexpr std::size_t batch = 2000;

std::size_t rays_of_each() { return rays_or(10'000); }

/// Number k of a problem: those of its ray, then those of its solid, and where the ray ends.
constexpr std::size_t end_of_ray = 6 + most_solid;
double number_of(const Problem& p, std::size_t k) {
    return k == end_of_ray ? p.tmax : k < 6 ? p.ray[k] : p.solid[k - 6];
}

template <class Form>
const Shaped& shaped() {
    const std::string_view name = row_of(intersect::shape_of<Form>).name;
    return *std::ranges::find(shapes, name, &Shaped::name);
}

template <class Visit>
void for_each_filter(const Visit& visit) {
    ByOwnSteps::for_each(visit), BySpan::for_each(visit);
}

template <class Form>
constexpr bool has_own_steps = intersect::shape_of<Form> <= Shape::triangle;

template <class Form, class T, class Number, class... Watch>
Hit<T> ask(const Number& number, Watch&... watch) {
    const Ray<T> ray{{number(0), number(1), number(2)}, {number(3), number(4), number(5)}};
    return Solids::of_shape<intersect::shape_of<Form>>([&]<template <class> class S>() {
        return intersect::intersect_solid<Form>(ray, solid_from<S, T>([&](std::size_t k) { return number(6 + k); }),
                                                number(end_of_ray), watch...);
    });
}

/// t to 32u or 64u of itself and the least number of the format; of a t of 0 what rounds to it. What is not a number is
/// wrong.
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
template <class F>
constexpr FloatFormat format_of = sizeof(F) == 4 ? binary32 : binary64;

struct Tally {
    std::size_t asked = 0, hits = 0, wrong = 0, endless = 0, differ = 0;
    std::array<std::size_t, 4> ways{};
    std::string first;
};

/// How many answers of a pack are not those of its rays, to the bit.
template <class Form, class F>
std::size_t differing(const Problem* problems, const Hit<F>* alone) {
    using P = Pack<F, Registers<16>>;
    const Hit<P> packed = ask<Form, P>([&](std::size_t k) {
        F lanes[P::lanes];
        for (std::size_t lane = 0; lane < P::lanes; ++lane) lanes[lane] = static_cast<F>(number_of(problems[lane], k));
        return P::load(lanes);
    });
    F t[P::lanes], near[P::lanes], far[P::lanes];
    bool hit[P::lanes];
    packed.t.store(t), packed.near.store(near), packed.far.store(far), packed.hit.store(hit);
    std::size_t differ = 0;
    for (std::size_t lane = 0; lane < P::lanes; ++lane) {
        const auto same = [](F a, F b) { return a == b ? std::signbit(a) == std::signbit(b) : a != a && b != b; };
        const Hit<F>& one = alone[lane];
        differ +=
            hit[lane] != one.hit || !same(t[lane], one.t) || !same(near[lane], one.near) || !same(far[lane], one.far);
    }
    return differ;
}

/// Of rays that `draw(problems)` fills a batch with.
template <class Form, class F, class Draw>
Tally ask_all(std::size_t rays, const Draw& draw) {
    Tally tally;
    std::vector<Problem> problems(batch);
    while (tally.asked < rays) {
        draw(problems);
        std::vector<Hit<F>> found;
        std::vector<Problem> checked;
        std::vector<Answer> answers;
        for (Problem& p : problems) {
            p.tmin = 0;
            if (!told_end(intersect::shape_of<Form>)) p.tmax = INFINITY;
            intersect::WayWatch watch;
            found.push_back(ask<Form, F>([&p](std::size_t k) { return static_cast<F>(number_of(p, k)); }, watch));
            ++tally.ways[static_cast<std::size_t>(watch.widest)];
            tally.hits += found.back().hit;
            if (found.back().hit && std::isinf(found.back().t)) ++tally.endless;
            else
                checked.push_back(p), answers.push_back(answer_of(found.back().hit, static_cast<double>(found.back().t),
                                                                  format_of<F>, has_own_steps<Form>));
        }
        const Findings f = check(shaped<Form>(), checked, answers, HUGE_VAL, 200);
        if (tally.wrong == 0 && f.differ > 0)
            tally.first =
                std::string(words_of(f.fault)) + "\n" + paste(shaped<Form>(), checked[f.first], answers[f.first]);
        tally.wrong += f.differ, tally.asked += batch;
        constexpr std::size_t lanes = 16 / sizeof(F);
        for (std::size_t i = 0; i < batch; i += lanes) tally.differ += differing<Form, F>(&problems[i], &found[i]);
    }
    return tally;
}

template <class Form, class F>
std::string words_of(const Tally& tally) {
    std::ostringstream counts;
    counts << Form::info.name << " in " << 8 * sizeof(F) << " bits: " << tally.asked << " rays, " << tally.hits
           << " hits, of which " << tally.endless << " at infinity; in its own arithmetic " << tally.ways[0]
           << ", wider " << tally.ways[1] << ", two words " << tally.ways[2] << ", exact " << tally.ways[3];
    return counts.str();
}

/// Of each shape, how many of a thousand rays hit at least, are settled by its own arithmetic, by two words, and
/// exactly in double: of random rays, and of those where something is exactly equal. A tenth less than was measured.
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
    for_each_filter([made]<class Form>() {
        // What checks a torus takes as long as of thirty other solids, and t of every twentieth is too large.
        constexpr bool dear = std::same_as<Form, intersect::torus::FilteredTorus>;
        Chance chance(made ? 2 : 1);
        const Tally tally = ask_all<Form, F>(rays_of_each() / (dear ? 5 : 1), [&](std::vector<Problem>& problems) {
            (made ? draw_made : draw_random)(shaped<Form>(), sizeof(F) == 4, {}, chance, problems);
        });
        const std::string counts = words_of<Form, F>(tally);
        INFO(counts << "; " << tally.first);
        CHECK(tally.wrong == 0);
        CHECK(tally.differ == 0);
        CHECK(tally.endless < tally.hits / (dear ? 12 : 20));
        CHECK((tally.ways[1] > 0) == (sizeof(F) == 4));
        const auto* const row = std::ranges::find(least, shaped<Form>().name, &Shares::shape);
        REQUIRE(row != least.end());
        const auto share = [&tally](std::size_t n) { return 1000 * n / tally.asked; };
        CHECK(share(tally.hits) >= (made ? row->hits : row->random_hits));
        CHECK(share(tally.ways[0]) >= (made ? row->own : row->random_own));
        CHECK((!made || share(tally.ways[2]) >= row->two_words));
        CHECK((!made || sizeof(F) == 4 || share(tally.ways[3]) >= row->exact));
        if (are_rays_asked()) WARN(counts);
    });
}

/// Tori of small whole numbers, and rays at what is left of them in one point: along the top, in the plane along either
/// equator, along the axis beside the rim of the hole or through the middle, through both sides at once. `horn`: with
/// a hole of one point. One number in six may be moved by an ulp.
template <class F>
Problem beside_torus(Chance& chance, bool horn) {
    const auto whole = [&](int n) { return static_cast<double>(1 + chance.below(n)); };
    const auto side = [&] { return chance.below(2) == 0 ? 1.0 : -1.0; };
    const double minor = 5 * whole(6), major = horn ? minor : minor + 5 * whole(6), away = whole(60);
    const double edge = chance.below(2) == 0 ? major + minor : major - minor;
    std::array<double, 3> o{-4 * away, 3 * away, side() * minor}, d{4, -3, 0};
    switch (chance.below(5)) {
        case 0: break;
        case 1: o = {edge / 5 * 3 - 4 * away, edge / 5 * 4 + 3 * away, 0}; break;
        case 2: o = {edge / 5 * 3, edge / 5 * 4, away}, d = {0, 0, -whole(4)}; break;
        case 3: o = {0, 0, away}, d = {chance.below(2) * whole(3), 0, -whole(3)}; break;
        default: o = {-4 * away, 3 * away, side() * minor * away / major}, d = {4 * major, -3 * major, -minor}; break;
    }
    const double scale = std::ldexp(1.0, chance.below(81) - 40), heads = chance.below(6) == 0 ? side() : 1;
    std::array<double, 3> centre{};
    if (chance.below(2) == 0) centre = {whole(99) - 50, whole(99) - 50, whole(99) - 50};
    Problem p{};
    for (std::size_t i = 0; i < 3; ++i)
        p.ray[i] = scale * (o[i] + centre[i]), p.ray[3 + i] = heads * d[i], p.solid[i] = scale * centre[i];
    p.solid[5] = side() * whole(3), p.solid[6] = scale * major, p.solid[7] = scale * minor;
    if (const std::size_t k = static_cast<std::size_t>(chance.below(72)); k < 12) {
        double& x = k < 6 ? p.ray[k] : p.solid[k - 6];
        if (x != 0) x = std::nextafter(static_cast<F>(x), chance.below(2) == 0 ? F(0) : std::numeric_limits<F>::max());
    }
    for (double& x : p.ray) x = static_cast<F>(x);
    return p;
}

/// Numbers of all sizes, of which a solid is one.
template <class F>
Problem torus_of_any_size(Chance& chance) {
    const int most = sizeof(F) == 4 ? 126 : 300;
    const auto number = [&] {
        return static_cast<double>(static_cast<F>(std::ldexp(chance.part(), chance.below(2 * most) - most)));
    };
    Problem p{};
    for (double& x : p.ray) x = number();
    for (std::size_t k = 0; k < 6; ++k) p.solid[k] = chance.below(3) == 0 ? 0 : number();
    p.solid[5] = number();
    const double one = std::fabs(number()), other = std::fabs(number());
    p.solid[6] = std::fmax(one, other), p.solid[7] = std::fmin(one, other);
    return p;
}

}  // namespace

TEMPLATE_TEST_CASE("exact: filters decide right and keep their bits", "[exact][filtered]", float, double) {
    hold<TestType>(false);
}

TEMPLATE_TEST_CASE("exact: so do they where something is exactly equal", "[exact][filtered]", float, double) {
    hold<TestType>(true);
}

TEMPLATE_TEST_CASE("exact: the filter of tori decides right at what one point is left of", "[exact][filtered]", float,
                   double) {
    using Form = intersect::torus::FilteredTorus;
    for (const char* const kind : {"touched", "without a hole", "of any size"}) {
        const bool any_size = kind == std::string_view("of any size");
        Chance chance(4);
        const Tally tally = ask_all<Form, TestType>(rays_of_each() / 5, [&](std::vector<Problem>& problems) {
            for (Problem& p : problems)
                p = any_size ? torus_of_any_size<TestType>(chance)
                             : beside_torus<TestType>(chance, kind == std::string_view("without a hole"));
        });
        const std::string counts = words_of<Form, TestType>(tally);
        INFO(kind << ": " << counts << "; " << tally.first);
        CHECK(tally.wrong == 0);
        CHECK(tally.differ == 0);
        CHECK(tally.hits > tally.asked / 50);
        CHECK(tally.ways[3] > (any_size ? 0 : tally.asked / 10));
        if (are_rays_asked()) WARN(kind << ": " << counts);
    }
}

/// The same formula without a filter: this test sees what a filter is for.
TEST_CASE("exact: the formula of a filter is wrong without it", "[exact][filtered]") {
    BySpan::for_each([]<class Form>() {
        Chance chance(3);
        std::vector<Problem> problems(batch);
        std::vector<Answer> answers;
        draw_made(shaped<Form>(), true, {}, chance, problems);
        for (Problem& p : problems) {
            p.tmin = 0, p.tmax = INFINITY;
            const auto number = [&p](std::size_t k) { return static_cast<float>(number_of(p, k)); };
            const Ray<float> ray{{number(0), number(1), number(2)}, {number(3), number(4), number(5)}};
            const auto met = Solids::of_shape<intersect::shape_of<Form>>([&]<template <class> class S>() {
                const auto solid = solid_from<S, float>([&](std::size_t k) { return number(6 + k); });
                return intersect::filter::first_met(solid.span(ray));
            });
            answers.push_back(answer_of(met.hit, static_cast<double>(met.t), binary32, false));
        }
        INFO(Form::info.name);
        CHECK(check(shaped<Form>(), problems, answers, HUGE_VAL, 200).differ > 0);
    });
}

/// Formats that no number of the processor has, of whole numbers that they hold.
TEST_CASE("exact: filters decide right and keep their bits in formats of 16 bits and half", "[exact][filtered]") {
    for (const char* const name : {"p16", "fp16"})
        for_each_filter([name]<class Form>() {
            const Format format = *find_format(name);
            const auto& rows = intersect::table::catalogue();
            const auto& row = *std::ranges::find_if(rows, [](const auto& r) { return r.info == &Form::info; });
            Chance chance(5);
            std::vector<Problem> some(batch), asked;
            std::vector<Answer> answers;
            draw_made(shaped<Form>(), true, {}, chance, some);
            std::size_t hits = 0;
            for (Problem& p : some) {
                p.tmin = 0, p.tmax = INFINITY;
                const auto is_held = [&](double x) {
                    return std::fabs(x) < 64 && rounding::to_format(x, 0, format.parameters) == x;
                };
                if (!std::ranges::all_of(p.ray, is_held) || !std::ranges::all_of(p.solid, is_held)) continue;
                const auto column = [&p](std::size_t k) { return std::span<const double>(&p.ray[k], 1); };
                Solid<double> solid(intersect::shape_of<Form>);
                std::copy_n(p.solid.begin(), solid.used().size(), solid.numbers.begin());
                double t, near, far;
                std::uint8_t hit;
                row.rounded(format.parameters, {column(0), column(1), column(2), column(3), column(4), column(5)},
                            solid, {{&t, 1}, {&near, 1}, {&far, 1}, {&hit, 1}});
                hits += hit;
                if (hit != 0 && std::isinf(t)) continue;
                asked.push_back(p), answers.push_back(answer_of(hit != 0, t, format.parameters, has_own_steps<Form>));
            }
            const Findings f = check(shaped<Form>(), asked, answers, HUGE_VAL, 20);
            INFO(Form::info.name << " in " << name << ": " << asked.size() << " rays, " << hits << " hits; "
                                 << words_of(f.fault) << "\n"
                                 << paste(shaped<Form>(), asked[f.first], answers[f.first]));
            CHECK(f.differ == 0);
            CHECK(hits > asked.size() / 20);
            CHECK(asked.size() > batch / 4);
        });
}

}  // namespace test_filters
