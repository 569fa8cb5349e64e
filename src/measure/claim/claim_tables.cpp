// Measures claims about tables: how often the result of a sum or a difference does not depend on one of its operands,
// and what passing on the nearest hit as the end of a ray changes.
#include <cmath>
#include <random>
#include <string_view>
#include <vector>

#include "measure/claim/claim_subjects.hpp"
#include "number/error.hpp"
#include "number/rounded.hpp"
#include "shapes/box/distribution/distribution.hpp"

namespace lostbits::measure::claim {

using scene::claim::Claim;
using scene::claim::TableSubject;
using truth::FormatInputs;

namespace {

/// A row of the table "arithmetic": a share of seeded samples, mostly of those whose result does not depend on an
/// operand.
struct ArithmeticRow {
    std::string_view name;
    int samples;  ///< number of significands drawn; 0: the row is about fixed numbers
    double (*fraction)(const FloatFormat&, double at, std::uint64_t seed);
};

constexpr int tried = 4096;

/// Share of significands in [1, 2) on which the test is true; `unit` gives further numbers in [0, 1).
template <class Test>
double share(const FloatFormat& f, std::uint64_t seed, const Test& test) {
    std::mt19937_64 engine(seed);
    const auto unit = [&engine] { return static_cast<double>(engine() >> 11) * 0x1p-53; };
    int yes = 0;
    for (int i = 0; i < tried; ++i) {
        const double significand =
            std::fmin(rounding::to_format(1 + unit(), 0, f), 2 - std::ldexp(1.0, 1 - f.precision));
        yes += test(significand, unit);
    }
    return static_cast<double>(yes) / tried;
}

/// a ± a/ratio = a, with the quotient rounded.
template <int sign>
double sum(const FloatFormat& f, double ratio, std::uint64_t seed) {
    return share(f, seed,
                 [&](double a, const auto&) { return rounding::add(a, sign * rounding::div(a, ratio, f), f) == a; });
}

/// The same for a = 1.
template <int sign>
double power_of_two(const FloatFormat& f, double ratio, std::uint64_t) {
    return rounding::add(1, sign * rounding::div(1, ratio, f), f) == 1 ? 1 : 0;
}

/// f·f − r² = f·f for |f| = distance·r, r over a binade and f in a random direction.
double far_radius(const FloatFormat& f, double distance, std::uint64_t seed) {
    return share(f, seed, [&](double r, const auto& unit) {
        double v[3], size = 0;
        do {
            size = 0;
            for (double& x : v) {
                x = 2 * unit() - 1;
                size += x * x;
            }
        } while (size > 1 || size < 0.01);
        double ff = 0;
        for (int i = 0; i < 3; ++i) {
            const double x = rounding::to_format(v[i] / std::sqrt(size) * distance * r, 0, f);
            const double square = rounding::mul(x, x, f);
            ff = i == 0 ? square : rounding::add(ff, square, f);
        }
        return rounding::add(ff, -rounding::mul(r, r, f), f) == ff;
    });
}

/// r² − l² is the same if r² is replaced by the next number; l = share·r.
double radius_over_l(const FloatFormat& f, double part, std::uint64_t seed) {
    return share(f, seed, [&](double r, const auto&) {
        const double r2 = rounding::mul(r, r, f), l = rounding::to_format(part * r, 0, f), l2 = rounding::mul(l, l, f);
        return rounding::add(r2, -l2, f) == rounding::add(rounding::next_up(r2, f), -l2, f);
    });
}

/// 0·∞ is NaN, for either sign of both.
double zero_times_infinity(const FloatFormat& f, double, std::uint64_t) {
    int yes = 0;
    for (const double zero : {0.0, -0.0}) {
        for (const double infinity : {HUGE_VAL, -HUGE_VAL}) yes += std::isnan(rounding::mul(zero, infinity, f));
    }
    return yes / 4.0;
}

/// Sign of ab − cd for |ab − cd| ≤ |ab|/2; 0 may be returned where the two differ by less than 2^-105 |ab|.
int sign_of_difference(double a, double b, double c, double d) {
    const double p = a * b, q = c * d, left = (p - q) + (std::fma(a, b, -p) - std::fma(c, d, -q));
    return left > 0 ? 1 : left < 0 ? -1 : 0;
}

/// ab − cd has the opposite sign: each product rounded, or the first one fused into the difference. d is one of the
/// numbers next to ab/c, up to `apart` steps away.
template <bool fused>
double wrong_sign(const FloatFormat& f, double apart, std::uint64_t seed) {
    return share(f, seed, [&](double a, const auto& unit) {
        const double b = rounding::to_format(1 + unit(), 0, f), c = rounding::to_format(1 + unit(), 0, f);
        const double ulp = std::ldexp(1.0, 1 - f.precision);
        const double d = rounding::to_format(a * b / c + std::round((2 * unit() - 1) * apart) * ulp, 0, f);
        const double cd = rounding::mul(c, d, f);
        const double computed = fused ? rounding::fma(a, b, -cd, f) : rounding::add(rounding::mul(a, b, f), -cd, f);
        return computed * sign_of_difference(a, b, c, d) < 0;
    });
}

constexpr ArithmeticRow measured_rows[] = {
    {"sum", tried, sum<1>},
    {"sum_power_of_two", 0, power_of_two<1>},
    {"difference", tried, sum<-1>},
    {"difference_power_of_two", 0, power_of_two<-1>},
    {"ff_minus_r2", tried, far_radius},
    {"zero_times_infinity", 0, zero_times_infinity},
    {"r2_minus_l2", tried, radius_over_l},
    {"difference_of_products", tried, wrong_sign<false>},
    {"fused_difference_of_products", tried, wrong_sign<true>},
};

/// The nearest t over the primitives, infinite for a miss.
std::vector<double> nearest(const evaluate::TestedForm& row, const FormatInputs& in, bool pass_on) {
    const std::size_t n = in.rays.size();
    std::vector<double> best(n, HUGE_VAL);
    for (const Primitive<double>& primitive : in.primitives.listed()) {
        FormatInputs one{.format = in.format, .rays = in.rays, .primitives = std::vector{primitive}, .stop = in.stop};
        if (pass_on) one.rays.tmax = best;
        const answer::Answers answers = answer::evaluate(*row.form, one);
        for (std::size_t i = 0; i < n; ++i) {
            if (answers.hit[i] != 0 && answers.t[i] < best[i]) best[i] = answers.t[i];
        }
    }
    return best;
}

}  // namespace

double differs_with_closest(const evaluate::TestedForm& row, double distance, std::uint64_t seed,
                            truth::TruthLimit limit) {
    if (!takes_tmax(row.form->shape))
        throw InputError(std::string(row.form->info->name) + " does not take the end of a ray; name a form that does");
    scene::box::BoxDistribution distribution;
    distribution.adjoining = true;
    distribution.distance = distance;
    distribution.seed = seed;
    std::size_t rays = 0, different = 0;
    for (scene::rays::RayGroup& group : distribution.draw()) {
        const truth::Band band(std::move(group), limit);
        const FormatInputs in = band.inputs(row.format, {});
        const auto apart = nearest(row, in, false), passed = nearest(row, in, true);
        rays += apart.size();
        for (std::size_t i = 0; i < apart.size(); ++i) different += apart[i] != passed[i];
    }
    return static_cast<double>(different) / static_cast<double>(rays);
}

namespace {

ClaimResult judge_arithmetic(const Claim& claim, const TableSubject& on, std::uint64_t seed) {
    const ArithmeticRow& row = measured_rows[place_of_word(claim, "row", on.row, measured_rows, &ArithmeticRow::name)];
    auto result = judge(claim, row.fraction(claim_format(claim).parameters, on.at, seed), nullptr);
    result.samples = static_cast<std::uint64_t>(row.samples);
    return result;
}

ClaimResult judge_closest(const Claim& claim, const TableSubject& on, std::uint64_t seed, truth::TruthLimit limit) {
    Claim form = claim;
    form.form = on.row;
    const double differs =
        find_for_claim(claim, [&] { return differs_with_closest(claim_row(form), on.at, seed, limit); });
    auto result = judge(claim, differs, nullptr);
    result.samples = scene::box::BoxDistribution{}.views;
    return result;
}

}  // namespace

void measure(const SubjectClaims<TableSubject>& claims, const ClaimRequest& run) {
    measure_draws(claims, run, [&run](const SubjectClaims<TableSubject>& some, int draw) {
        const auto seed = 1 + static_cast<std::uint64_t>(draw);
        for (const auto& [claim, on, result] : some) {
            if (on.name != "arithmetic" && on.name != "closest_as_tmax") {
                scene::toml::fail(claim.where,
                                  "unknown table \"" + on.name +
                                      "\"; write \"arithmetic\" or \"closest_as_tmax\", whose rows are box forms");
            }
            if (claim.metric != "fraction")
                scene::toml::fail(claim.where,
                                  "unknown metric \"" + claim.metric + "\"; the only metric of a table is fraction");
            result = on.name == "arithmetic" ? judge_arithmetic(claim, on, seed)
                                             : judge_closest(claim, on, seed, {.stop = run.stop});
        }
    });
}

}  // namespace lostbits::measure::claim
