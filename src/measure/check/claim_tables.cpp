// Measures claims about tables. "arithmetic": how often a sum or difference does not depend on one of its operands.
// "closest_as_tmax": what changes if the nearest hit so far is passed on as the end of the ray.
#include <cmath>
#include <random>
#include <string_view>
#include <vector>

#include "measure/check/claim_subjects.hpp"
#include "number/error.hpp"
#include "number/rounded.hpp"
#include "shapes/box/distribution/distribution.hpp"

namespace lostbits::measure::check {

using scene::check::Claim;
using scene::check::TableSubject;
using truth::FormatInputs;

namespace {

/// A row of the table "arithmetic": a fraction of seeded samples, mostly the fraction whose result does not depend on
/// an operand.
struct ArithmeticRow {
    std::string_view name;
    int sample_count;  ///< number of significands that are drawn; 0: the row is about fixed numbers
    double (*fraction)(const FloatFormat&, double argument, std::uint64_t seed);
};

constexpr int sample_count = 4096;

/// Measures the fraction of significands in [1, 2) on which the test is true; `random_unit` gives further numbers in
/// [0, 1).
template <class Test>
double measure_fraction(const FloatFormat& format, std::uint64_t seed, const Test& test) {
    std::mt19937_64 engine(seed);
    const auto random_unit = [&engine] { return static_cast<double>(engine() >> 11) * 0x1p-53; };
    int true_count = 0;
    for (int i = 0; i < sample_count; ++i) {
        const double significand =
            std::fmin(rounding::to_format(1 + random_unit(), 0, format), 2 - std::ldexp(1.0, 1 - format.precision));
        true_count += test(significand, random_unit);
    }
    return static_cast<double>(true_count) / sample_count;
}

/// Tests a ± a/ratio = a, with the quotient rounded.
template <int sign>
double sum(const FloatFormat& format, double ratio, std::uint64_t seed) {
    return measure_fraction(format, seed, [&](double a, const auto&) {
        return rounding::add(a, sign * rounding::div(a, ratio, format), format) == a;
    });
}

/// Tests a ± a/ratio = a for a = 1.
template <int sign>
double power_of_two(const FloatFormat& format, double ratio, std::uint64_t) {
    return rounding::add(1, sign * rounding::div(1, ratio, format), format) == 1 ? 1 : 0;
}

/// Tests f·f − r² = f·f for |f| = distance·r, with r over a binade and f in a random direction.
double far_radius(const FloatFormat& format, double distance, std::uint64_t seed) {
    return measure_fraction(format, seed, [&](double r, const auto& random_unit) {
        double direction[3], squares = 0;
        do {
            squares = 0;
            for (double& x : direction) {
                x = 2 * random_unit() - 1;
                squares += x * x;
            }
        } while (squares > 1 || squares < 0.01);
        double f_squared = 0;
        for (int i = 0; i < 3; ++i) {
            const double x = rounding::to_format(direction[i] / std::sqrt(squares) * distance * r, 0, format);
            const double square = rounding::mul(x, x, format);
            f_squared = i == 0 ? square : rounding::add(f_squared, square, format);
        }
        return rounding::add(f_squared, -rounding::mul(r, r, format), format) == f_squared;
    });
}

/// Tests that r² − l² is the same if r² is replaced by the next number; l = ratio·r.
double radius_over_l(const FloatFormat& format, double ratio, std::uint64_t seed) {
    return measure_fraction(format, seed, [&](double r, const auto&) {
        const double r2 = rounding::mul(r, r, format), l = rounding::to_format(ratio * r, 0, format),
                     l2 = rounding::mul(l, l, format);
        return rounding::add(r2, -l2, format) == rounding::add(rounding::next_up(r2, format), -l2, format);
    });
}

/// Tests that 0·∞ is NaN, for either sign of both operands.
double zero_times_infinity(const FloatFormat& format, double, std::uint64_t) {
    int nan_count = 0;
    for (const double zero : {0.0, -0.0}) {
        for (const double infinity : {HUGE_VAL, -HUGE_VAL})
            nan_count += std::isnan(rounding::mul(zero, infinity, format));
    }
    return nan_count / 4.0;
}

/// Sign of ab − cd for |ab − cd| ≤ |ab|/2; may return 0 if ab and cd differ by less than 2^-105 |ab|.
int sign_of_difference(double a, double b, double c, double d) {
    const double p = a * b, q = c * d, difference = (p - q) + (std::fma(a, b, -p) - std::fma(c, d, -q));
    return difference > 0 ? 1 : difference < 0 ? -1 : 0;
}

/// Tests that the computed ab − cd has the wrong sign. Each product is rounded, or the first product is fused into the
/// difference. d is one of the numbers next to ab/c, up to `max_steps` ulps away.
template <bool fused>
double wrong_sign(const FloatFormat& format, double max_steps, std::uint64_t seed) {
    return measure_fraction(format, seed, [&](double a, const auto& random_unit) {
        const double b = rounding::to_format(1 + random_unit(), 0, format),
                     c = rounding::to_format(1 + random_unit(), 0, format);
        const double ulp = std::ldexp(1.0, 1 - format.precision);
        const double d =
            rounding::to_format(a * b / c + std::round((2 * random_unit() - 1) * max_steps) * ulp, 0, format);
        const double cd = rounding::mul(c, d, format);
        const double computed =
            fused ? rounding::fma(a, b, -cd, format) : rounding::add(rounding::mul(a, b, format), -cd, format);
        return computed * sign_of_difference(a, b, c, d) < 0;
    });
}

constexpr ArithmeticRow measured_rows[] = {
    {"sum", sample_count, sum<1>},
    {"sum_power_of_two", 0, power_of_two<1>},
    {"difference", sample_count, sum<-1>},
    {"difference_power_of_two", 0, power_of_two<-1>},
    {"ff_minus_r2", sample_count, far_radius},
    {"zero_times_infinity", 0, zero_times_infinity},
    {"r2_minus_l2", sample_count, radius_over_l},
    {"difference_of_products", sample_count, wrong_sign<false>},
    {"fused_difference_of_products", sample_count, wrong_sign<true>},
};

/// Finds the nearest t of each ray over the primitives; infinite for a miss. If `passes_on`, the nearest t so far ends
/// the ray.
std::vector<double> find_nearest(const evaluate::TestedForm& tested_form, const FormatInputs& in, bool passes_on) {
    const std::size_t ray_count = in.rays.size();
    std::vector<double> best(ray_count, HUGE_VAL);
    for (const Primitive<double>& primitive : in.primitives.listed_primitives()) {
        FormatInputs single_inputs{
            .format = in.format, .rays = in.rays, .primitives = std::vector{primitive}, .stop = in.stop};
        if (passes_on) single_inputs.rays.tmax = best;
        const answer::Answers answers = answer::evaluate(*tested_form.form, single_inputs);
        for (std::size_t i = 0; i < ray_count; ++i) {
            if (answers.hit[i] != 0 && answers.t[i] < best[i]) best[i] = answers.t[i];
        }
    }
    return best;
}

}  // namespace

double measure_closest_t_difference(const evaluate::TestedForm& tested_form, double distance, std::uint64_t seed,
                                    truth::ProofLimit limit) {
    if (!takes_tmax(tested_form.form->shape))
        throw InputError(std::string(tested_form.form->info->name) +
                         " does not take the end of a ray; name a form that does");
    scene::box::BoxDistribution distribution;
    distribution.adjoining = true;
    distribution.distance = distance;
    distribution.seed = seed;
    std::size_t ray_count = 0, different = 0;
    for (scene::rays::RayGroup& group : distribution.draw()) {
        const truth::Band band(std::move(group), limit);
        const FormatInputs in = band.inputs(tested_form.format, {});
        const auto separate = find_nearest(tested_form, in, false), passed_on = find_nearest(tested_form, in, true);
        ray_count += separate.size();
        for (std::size_t i = 0; i < separate.size(); ++i) different += separate[i] != passed_on[i];
    }
    return static_cast<double>(different) / static_cast<double>(ray_count);
}

namespace {

ClaimResult judge_arithmetic(const Claim& claim, const TableSubject& subject, std::uint64_t seed) {
    const ArithmeticRow& row =
        measured_rows[index_of_name(claim, "row", subject.row, measured_rows, &ArithmeticRow::name)];
    auto result =
        judge_measured_value(claim, row.fraction(claim_format(claim).parameters, subject.argument, seed), nullptr);
    result.sample_count = static_cast<std::uint64_t>(row.sample_count);
    return result;
}

ClaimResult judge_closest(const Claim& claim, const TableSubject& subject, std::uint64_t seed,
                          truth::ProofLimit limit) {
    Claim form_claim = claim;
    form_claim.form = subject.row;
    const double measured = find_for_claim(
        claim, [&] { return measure_closest_t_difference(tested_form_of(form_claim), subject.argument, seed, limit); });
    auto result = judge_measured_value(claim, measured, nullptr);
    result.sample_count = scene::box::BoxDistribution{}.view_count;
    return result;
}

}  // namespace

void measure(const SubjectClaims<TableSubject>& claims, const ClaimRequest& run) {
    measure_draws(claims, run, [&run](const SubjectClaims<TableSubject>& draw_claims, int draw) {
        const auto seed = 1 + static_cast<std::uint64_t>(draw);
        for (const auto& [claim, subject, result] : draw_claims) {
            if (subject.name != "arithmetic" && subject.name != "closest_as_tmax") {
                scene::toml::fail(claim.where,
                                  "unknown table \"" + subject.name +
                                      "\"; write \"arithmetic\" or \"closest_as_tmax\", whose rows are box forms");
            }
            if (claim.metric != "fraction")
                scene::toml::fail(claim.where,
                                  "unknown metric \"" + claim.metric + "\"; the only metric of a table is fraction");
            result = subject.name == "arithmetic" ? judge_arithmetic(claim, subject, seed)
                                                  : judge_closest(claim, subject, seed, {.stop = run.stop});
        }
    });
}

}  // namespace lostbits::measure::check
