// Every form of every shape without rounding, compared with answers that share nothing with it. Enclosures of each form
// are compared with its unrounded result.
#include <algorithm>
#include <cmath>
#include <iterator>
#include <optional>
#include <vector>

#include "catch.hpp"
#include "counts.hpp"
#include "exact/check.hpp"
#include "exact/draw.hpp"
#include "intersect/form_shape.hpp"
#include "intersect/table/table.hpp"
#include "measure/truth/truth.hpp"
#include "number/real.hpp"
#include "shapes/torus/forms/forms.hpp"

namespace test_forms {

using namespace lostbits;
using namespace lostbits::exact;

namespace {

using intersect::Direction, intersect::Facing, intersect::Roots, intersect::table::Intersector;

template <class T>
Ray<T> ray_of(const Problem& problem) {
    return {{T(problem.ray[0]), T(problem.ray[1]), T(problem.ray[2])},
            {T(problem.ray[3]), T(problem.ray[4]), T(problem.ray[5])}};
}
Primitive<double> primitive_of(const ShapeTest& shape, const Problem& problem) {
    Primitive<double> primitive(*shape_named(shape.name));
    for (std::size_t k = 0; k < primitive.shape_numbers().size(); ++k) primitive.numbers[k] = problem.primitive[k];
    return primitive;
}

/// True if no decision is near: rays on both sides of it, changed by up to 2^-14 of all lengths, hit or miss the
/// primitive as it does. A component of the direction that is 0 stays 0.
bool is_clear(const ShapeTest& shape, const Problem& problem, Chance& chance) {
    double reach = 0;
    for (std::size_t i = 0; i < 3; ++i) reach = std::fmax(reach, std::fabs(problem.ray[i]));
    for (const double x : problem.primitive) reach = std::fmax(reach, std::fabs(x));
    const auto meets = [&](const std::array<double, 6>& off, double sign) {
        Problem beside = problem;
        for (std::size_t k = 0; k < 6; ++k) beside.ray[k] += sign * off[k];
        return meet(shape.quickly, beside).is_hit();
    };
    in_doubt = false;
    const bool hit = meets({}, 0);
    for (int i = 0; i < 4; ++i) {
        std::array<double, 6> off{};
        for (std::size_t k = 0; k < 6; ++k) off[k] = 0x1p-14 * chance.part() * (k < 3 ? reach : problem.ray[k]);
        if (meets(off, 1) != hit || meets(off, -1) != hit || in_doubt) return false;
    }
    return true;
}

/// Problems of a kind without a near decision, at least half of them hits.
std::vector<Problem> clear_problems(const ShapeTest& shape, bool made, std::size_t count) {
    Chance chance(made ? 2 : 1);
    std::vector<Problem> some(200), clear;
    std::size_t misses = 0;
    while (clear.size() < count) {
        (made ? draw_made : draw_random)(shape, true, {}, chance, some);
        for (Problem& problem : some) {
            problem.tmin = 0, problem.tmax = INFINITY;
            double least = HUGE_VAL, most = 0;
            const std::span<const double> ray(problem.ray), primitive(problem.primitive);
            for (const auto& numbers : {ray, primitive})
                for (const double x : numbers)
                    if (x != 0) least = std::fmin(least, std::fabs(x)), most = std::fmax(most, std::fabs(x));
            // Some forms compare with 10^-6 or 10^-4, whatever the unit.
            if (least <= 0x1p-8 || most >= 0x1p16 || !is_clear(shape, problem, chance)) continue;
            if (!meet(shape.quickly, problem).is_hit() && ++misses > count / 2) continue;
            clear.push_back(problem);
        }
    }
    clear.resize(count);
    return clear;
}

/// Compares t to 2^-100 of itself.
Answer answer_of(bool hit, const Real& t) {
    Answer a{.hit = hit, .as_float = NAN, .as_double = NAN};
    if (!hit) return a;
    a.high = t.convert_to<double>(), a.low = Real(t - a.high).convert_to<double>();
    a.bound = 0x1p-100 * std::fabs(a.high);
    return a;
}

/// Answer of a form without rounding. A number is empty if it is not known to 2^-200.
struct UnroundedForm {
    std::optional<bool> hit;
    std::optional<Real> t, near, far;
};

std::optional<Real> number_of(const Real& x) { return x; }
std::optional<Real> number_of(const Interval& x) {
    if (x.undefined() == Undefined::always) return Real(NAN);
    if (!x.is_bounded()) return std::nullopt;
    Real low, high;
    mpfr_set(low.backend().data(), x.lower(), MPFR_RNDN), mpfr_set(high.backend().data(), x.upper(), MPFR_RNDN);
    return high - low <= ldexp(abs(high) + 1, -200) ? std::optional(high) : std::nullopt;
}

/// Divides t by `divisor`.
template <class T>
UnroundedForm to_unrounded(const Hit<T>& hit, const T& divisor) {
    if (!is_certain(hit.hit) && !is_certain(!hit.hit)) return {};
    return {is_certain(hit.hit), number_of(hit.t / divisor), number_of(hit.near / divisor),
            number_of(hit.far / divisor)};
}

/// `made_unit`: for the normalised direction, in lengths of the stored direction.
template <class T, class Form>
UnroundedForm unrounded_in(const Problem& problem, bool made_unit, const Form& form) {
    Ray<T> ray = ray_of<T>(problem);
    if (!made_unit) return to_unrounded(form(ray), T(1));
    const T size = length(ray.direction);
    for (int k = 0; k < 3; ++k) ray.direction[k] = ray.direction[k] / size;
    return to_unrounded(form(ray), size);
}

/// Computes a form without rounding. Enclosures do not decide solvers of degree four, so forms of tori are computed in
/// numbers of 256 bits, and all others in intervals of 400 bits, which are compiled already.
UnroundedForm unrounded(const Intersector& form, const ShapeTest& shape, const Problem& problem, bool made_unit) {
    UnroundedForm found;
    if (form.shape == Shape::torus) {
        intersect::torus::TorusForms::for_each([&]<class Form>() {
            if (&Form::info != form.info) return;
            found = unrounded_in<Real>(problem, made_unit, [&problem](const Ray<Real>& ray) {
                return intersect::intersect_numbers<Form, Real>(
                    ray, [&problem](std::size_t k) { return Real(problem.primitive[k]); }, Real(HUGE_VAL));
            });
        });
        return found;
    }
    const Interval::Precision precision(400);
    const auto primitive = convert_numbers(primitive_of(shape, problem), [](double x) { return Interval(x); });
    return unrounded_in<Interval>(problem, made_unit,
                                  [&](const Ray<Interval>& ray) { return form.interval(ray, primitive); });
}

struct Tally {
    std::size_t ray_count = 0, hits = 0;
    std::vector<Problem> problems;
    std::vector<Answer> answers;

    void add(const Problem& problem, const Answer& a) { problems.push_back(problem), answers.push_back(a); }
};

/// True if this problem is among those for which a form promises an answer without rounding.
bool is_requested(const intersect::Info& form, const ShapeTest& shape, const Problem& problem, bool made) {
    // This form treats a root d1 with |d1| < 1e-4 as 0: test_tori has the consequences.
    if (form.name == "torus.quilez") return false;
    // If two real roots are equal, the last remainder is 0. Rounded in any precision, it has a sign, which decides.
    for (const char* const chain : {"sturm", "bracketed", "bracketed_double", "filtered"})
        if (made && shape.name == "torus" && form.name.substr(6) == chain) return false;
    // Constructed rays pass corners as closely as the form pads.
    if (made && form.name == "box.max_mult") return false;
    // In box forms the order of operands decides what 0·∞ becomes: test_box_known has the consequences.
    if (shape.name == "box" && problem.ray[3] * problem.ray[4] * problem.ray[5] == 0) return false;
    const Primitive<double> primitive = primitive_of(shape, problem);
    const Ray<double> ray = ray_of<double>(problem);
    if (form.facing != Facing::both)
        return measure::truth::find_truth(ray, primitive, {}, form.convention()).is_hit() ==
               measure::truth::find_truth(ray, primitive).is_hit();
    return form.roots != Roots::near_only ||
           visit(primitive, [&](const auto& s) { return s.relative_distance(ray.origin) >= 0; });
}

/// Adds the first t at which the form meets the ray. A form with both roots is also asked for the last one: it is the
/// first of the ray that comes back.
void ask(const Intersector& form, const ShapeTest& shape, const Problem& problem, Tally& tally) {
    const UnroundedForm h = unrounded(form, shape, problem, form.info->direction == Direction::unit);
    if (!h.hit || (*h.hit && !h.t)) return;
    ++tally.ray_count, tally.hits += *h.hit;
    tally.add(problem, answer_of(*h.hit, h.t.value_or(Real(0))));
    if (!*h.hit || form.info->roots != Roots::both || !h.far || form.info->name == "box.max_mult")
        return;  // which pads it
    const double from = std::exp2(2 + std::fmax(10, std::ilogb(h.far->convert_to<double>())));
    Problem back = problem;
    for (std::size_t i = 0; i < 3; ++i) {
        back.ray[i] += from * problem.ray[i + 3], back.ray[i + 3] = -problem.ray[i + 3];
        if (back.ray[i] - from * problem.ray[i + 3] != problem.ray[i]) return;
    }
    tally.add(back, answer_of(true, from - *h.far));
}

/// True if an enclosure agrees with the number in 256 bits, of which a form may lose half.
template <class E>
bool contains(const E& x, const Real& v) {
    const mpfr_srcptr p = v.backend().data();
    if (mpfr_nan_p(p) != 0) return x.undefined() != Undefined::never;
    if (mpfr_inf_p(p) != 0) return !x.is_bounded();
    const Real slack = ldexp(abs(v) + 1, -128);
    if (x.undefined() == Undefined::always) return false;
    if constexpr (std::same_as<E, Ball>) {
        return abs(v - Real(x.hi()) - Real(x.lo())) <= Real(x.radius()) + slack;
    } else {
        return mpfr_cmp(x.lower(), Real(v + slack).backend().data()) <= 0 &&
               mpfr_cmp(x.upper(), Real(v - slack).backend().data()) >= 0;
    }
}

struct Enclosures {
    bool by_other_steps;  ///< than without rounding: t of a miss is another
    std::size_t wrong = 0, contradictory = 0, bounded = 0;
    std::array<std::size_t, 2> ray_count{}, decided{};  ///< misses and hits
    std::size_t doubles = 0;                            ///< that intervals of 53 bits were held against

    template <class E>
    void hold(const Hit<E>& got, const UnroundedForm& want, std::optional<bool>& verdict) {
        const auto misses = [](const E& x, const std::optional<Real>& v) { return v && !contains(x, *v); };
        if (want.hit && (*want.hit || !by_other_steps))
            wrong += misses(got.t, want.t) || misses(got.near, want.near) || misses(got.far, want.far);
        wrong += want.hit && (*want.hit ? got.hit.is_no() : got.hit.is_yes());
        bounded += got.t.is_bounded();
        if (got.hit.is_unknown()) return;
        contradictory += verdict && *verdict != got.hit.is_yes();
        verdict = got.hit.is_yes();
    }
    /// Rounding to nearest lies between rounding down and up, so an interval of 53 bits holds the double of every step.
    /// Exceptions are forms that bound or pad by the unit roundoff, which intervals do not have, and filters, which
    /// compute other steps. The filter of boxes computes none of these.
    void hold_double(const Intersector& row, const Problem& problem, const Primitive<double>& primitive,
                     const Hit<Interval>& got) {
        const std::string_view form = row.info->name.substr(row.info->name.find('.') + 1);
        for (const char* const pads : {"pbrt_interval", "pbrt_padded", "embree_robust", "embree_padded", "bvh_robust"})
            if (form == pads) return;
        if (!row.native64 || (row.deciding_arithmetic && row.shape != Shape::box)) return;
        Hit<double> want{};
        std::uint8_t hit;
        const auto column = [&problem](std::size_t k) { return std::span<const double>(&problem.ray[k], 1); };
        row.native64({column(0), column(1), column(2), column(3), column(4), column(5)}, primitive,
                     {{&want.t, 1}, {&want.near, 1}, {&want.far, 1}, {&hit, 1}});
        const auto misses = [](const Interval& x, double v) { return !contains(x, Real(v)); };
        ++doubles;
        wrong += (got.hit.is_yes() && hit == 0) || (got.hit.is_no() && hit != 0) || misses(got.t, want.t) ||
                 misses(got.near, want.near) || misses(got.far, want.far);
    }
    void ask(const Intersector& row, const ShapeTest& shape, Problem p) {
        if (row.info->direction == Direction::unit) {
            const double size = length(ray_of<double>(p).direction);
            for (std::size_t i = 3; i < 6; ++i) p.ray[i] /= size;
        }
        const UnroundedForm want = unrounded(row, shape, p, false);
        const auto target = [primitive = primitive_of(shape, p)]<class E>(const E&) {
            return convert_numbers(primitive, [](double x) { return E(x); });
        };
        std::optional<bool> verdict;
        hold(row.ball(ray_of<Ball>(p), target(Ball())), want, verdict);
        for (const long bits : {12, 24, 53, 113, 250}) {
            const Interval::Precision exact(53);
            const Ray<Interval> ray = ray_of<Interval>(p);
            const Primitive<Interval> primitive = target(Interval());
            const Interval::Precision precision(bits);
            const Hit<Interval> got = row.interval(ray, primitive);
            hold(got, want, verdict);
            if (bits == 53) hold_double(row, p, primitive_of(shape, p), got);
        }
        const bool hit = want.hit ? *want.hit : meet(shape.quickly, p).is_hit();
        ++ray_count[hit], decided[hit] += verdict.has_value();
    }
};

/// Least share of the hits and misses of a form that some enclosure decides, in percent, if it is not the usual 96.
/// `exclusive` makes tmin = tmax for most rays that miss, frames divide by lengths that may be 0, and no enclosure up
/// to 250 bits decides anything about solvers of degree four in closed form.
struct Decided {
    std::string_view name;
    std::size_t hits, misses;
};
constexpr Decided decided_of[] = {
    {"box.exclusive", 96, 25},       {"cylinder.framed", 90, 74},    {"tube.framed", 92, 75},
    {"tube.celeritas", 92, 75},      {"tube.pbrt_interval", 92, 75}, {"tube.mitsuba", 92, 75},
    {"tube.detray", 92, 75},         {"tube.framed_moment", 92, 75}, {"cone.framed", 85, 78},
    {"disc.framed", 80, 90},         {"torus.graphics_gems", 0, 0},  {"torus.quilez", 0, 0},
    {"torus.pov_ray", 0, 0},         {"torus.brl_cad", 0, 0},        {"torus.double_inside", 0, 0},
    {"torus.closest_approach", 0, 0}};

Decided min_decided(std::string_view form) {
    const Decided* const row = std::ranges::find(decided_of, form, &Decided::name);
    return row == std::end(decided_of) ? Decided{form, 96, 96} : *row;
}

}  // namespace

TEST_CASE("exact: every form is right when nothing is rounded", "[exact][forms]") {
    for (const ShapeTest& shape : shapes) {
        const std::size_t count = test::draws(std::size_t{shape.name == "torus" ? 1000U : 10000U});
        const std::vector<Problem> random = clear_problems(shape, false, count),
                                   made = clear_problems(shape, true, count);
        for (const Intersector& form : intersect::table::intersectors(*shape_named(shape.name))) {
            Tally tally;
            for (const std::vector<Problem>* const all : {&random, &made})
                for (const Problem& problem : *all)
                    if (is_requested(*form.info, shape, problem, all == &made)) ask(form, shape, problem, tally);
            if (tally.ray_count == 0) continue;
            const Findings f = check(shape, tally.problems, tally.answers, 1, 50);
            INFO(form.info->name << ": asked " << tally.ray_count << ", hits " << tally.hits << "; differ "
                                 << f.wrong_count << " " << words_of(f.fault) << "\n"
                                 << paste(shape, tally.problems[f.first_wrong], tally.answers[f.first_wrong]));
            CHECK(f.wrong_count == 0);
            // The two lists have 2 count problems. Half of them are hits; for forms that see one side of a triangle,
            // half of these.
            CHECK(tally.ray_count > count * 3 / 4);
            CHECK(10 * tally.hits > tally.ray_count * (form.info->facing == Facing::both ? 4U : 2U));
            CHECK(tally.hits < tally.ray_count);
        }
    }
}

TEST_CASE("exact: enclosures of every form contain its unrounded result", "[exact][forms]") {
    for (const ShapeTest& shape : shapes) {
        const std::size_t count = test::draws(std::size_t{shape.name == "torus" ? 500U : 1000U});
        std::vector<Problem> problems = clear_problems(shape, false, count);
        // A ray along a plane divides by 0, and solvers of degree four divide by numbers that may be 0 within their
        // bounds.
        if (shape.name != "torus") std::ranges::copy(clear_problems(shape, true, count), std::back_inserter(problems));
        std::erase_if(problems,
                      [](const Problem& problem) { return problem.ray[3] * problem.ray[4] * problem.ray[5] == 0; });
        for (const Intersector& form : intersect::table::intersectors(*shape_named(shape.name))) {
            Enclosures e{.by_other_steps = form.info->name == "torus.filtered"};
            for (const Problem& problem : problems) e.ask(form, shape, problem);
            INFO(form.info->name << ": decided " << e.decided[1] << " of " << e.ray_count[1] << " hits and "
                                 << e.decided[0] << " of " << e.ray_count[0] << " misses, bounded " << e.bounded
                                 << ", doubles " << e.doubles);
            CHECK(e.wrong == 0);
            CHECK(e.contradictory == 0);
            const Decided least = min_decided(form.info->name);
            CHECK(100 * e.decided[1] >= least.hits * e.ray_count[1]);
            CHECK(100 * e.decided[0] >= least.misses * e.ray_count[0]);
            CHECK((e.ray_count[0] > 0 && e.ray_count[1] > 0));
        }
    }
}

}  // namespace test_forms
