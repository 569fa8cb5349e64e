// Forward error, backward error and condition, each computed in its own way: no t is further off than the condition of
// its problem times the backward error of t.
#include <cmath>
#include <utility>

#include "catch.hpp"
#include "counts.hpp"
#include "measure/seeded.hpp"
#include "measure/stability/stability.hpp"
#include "measure/truth/conditioning.hpp"
#include "measure/truth/reach_of_t.hpp"
#include "measure/truth/truth.hpp"
#include "scene/sweep/distributions.hpp"

namespace test_forward {

using namespace lostbits;
using measure::stability::backward_error;
using measure::stability::CountedChange;
using measure::truth::as_certified;
using measure::truth::CertifiedNumber;
using measure::truth::Perturbation;
using test::reach_of_t;
using test::Seeded;

namespace {

/// |t - t*|, to 2^-50 of itself.
double forward_error(double t, const CertifiedNumber& truth) {
    return std::fabs(measure::truth::scaled_difference(as_certified(t), truth, 0));
}

/// Largest allowed (forward error)/(condition x backward error): `backward_error` stops looking within 2^(1/16) = 1.044
/// of the largest change that it can prove, and the second order that it leaves out is at most 1/64 (below). The
/// largest value seen, in 200 rays of each distribution, is 1.031.
const double max_allowed = std::exp2(1.0 / 16) * (1 + 0x1p-6);

struct Tally {
    int trials = 0, above = 0;
    double most = 0;

    void take(double forward, double condition, double backward) {
        const double ratio = forward / (condition * backward);
        ++trials, above += !(ratio <= max_allowed), most = std::max(most, ratio);
    }
    /// Checks that the bound holds, and that it would fail if one of the three numbers were half or twice as large.
    void check(int at_least) const {
        CHECK(above == 0);
        CHECK(most <= max_allowed);
        CHECK(most > max_allowed / 2);
        CHECK(trials >= at_least);
    }
};

/// A ray that hits and does not start on the surface.
struct Problem {
    const Ray<double>& ray;
    Primitive<double> primitive;
    CertifiedNumber truth;

    [[nodiscard]] double t() const { return std::ldexp(truth.hi, static_cast<int>(truth.exponent)); }
    /// The e from which on the same root or face is met by far: with m the least change that turns it, 2^-e <= m²/64.
    /// S the size of all numbers and r that of the primitive, a sign that decides moves by S r 2^-e or more to first
    /// order where the line is not at a rim, and by (S 2^-e)² to second; a change of r/S turns it, so m <= r/S, and the
    /// second is to the first as 2^-e S/r <= m/64 at most, or, of the middle of a sphere, where r² stands for S r, as
    /// 2^-e (S/r)² <= 1/64.
    [[nodiscard]] int certain_within(Perturbation perturbation) const {
        const double margin =
            measure::stability::find_decision_margin(ray, primitive, CountedChange::root, perturbation);
        return margin > 0 ? static_cast<int>(std::ceil(6 - 2 * std::log2(margin))) : 1000;
    }
};

/// No problem within ε has its root further than reach(ε) from t*. So a t just beyond is right for none of them, and
/// its backward error e is at least ε. With the condition of finite changes κ(ε) = reach(ε)/ε,
///     |t - t*| = κ(ε) ε (1 + 2^-10) <= κ(ε) e (1 + 2^-10) <= κ(ε) · 2^(1/16) (1 + 2^-6) · backward_error(t).
/// `anywhere`: also where two roots meet, or faces; there t goes as the root of ε, or as the steeper face.
void check_finite(Tally& tally, const Problem& problem, bool anywhere, Seeded& rng) {
    const int least = anywhere ? 20 : std::max(20, problem.certain_within(Perturbation::normwise));
    const int p = least + rng.index(8);
    const double t = problem.t(), far = reach_of_t(problem.ray, problem.primitive, problem.truth, {p, -1022, 1023},
                                                   Perturbation::normwise);
    if (p > 60 || !(far < t / 8 && far > t * 0x1p-42)) return;
    const double there = t + rng.sign() * far * (1 + 0x1p-10);
    tally.take(forward_error(there, problem.truth), std::ldexp(far, p),
               backward_error(problem.ray, problem.primitive, there, Perturbation::normwise));
}

/// With κ = Σ |xᵢ ∂t/∂xᵢ|/|t| a change of e moves t by κ e |t| and terms of second order, as above: t is off by 2^-40
/// of itself, and so e about 2^-40/κ.
void check_first_order(Tally& tally, const Problem& problem, Seeded& rng) {
    const double kappa = measure::truth::condition(problem.ray, problem.primitive), t = problem.t();
    if (!std::isfinite(kappa)) return;
    if (std::log2(kappa) + 40 < problem.certain_within(Perturbation::componentwise)) return;
    const double there = t * (1 + rng.sign() * 0x1p-40);
    tally.take(forward_error(there, problem.truth), kappa * t, backward_error(problem.ray, problem.primitive, there));
}

struct BothBounds {
    Tally finite, first_order;
    void check(int at_least) const { finite.check(at_least), first_order.check(at_least); }
};

void try_ray(BothBounds& both, const Ray<double>& ray, const Primitive<double>& primitive, bool anywhere, Seeded& rng) {
    if (!measure::truth::is_valid(ray) || !measure::truth::is_valid(primitive)) return;
    const auto truth = measure::truth::find_truth(ray, primitive);
    if (!truth.is_hit() || truth.t.is_zero() || std::abs(truth.t.exponent) > 900) return;
    const Problem problem{ray, primitive, truth.t};
    check_finite(both.finite, problem, anywhere, rng);
    check_first_order(both.first_order, problem, rng);
}

const int rays_per_distribution = test::draws(2000);

}  // namespace

TEST_CASE("the forward error is at most condition number times backward error for every shape", "[margin][forward]") {
    for (const auto& distribution : scene::sweep::distributions())
        for (const auto& set : distribution.ray_sets()) {
            INFO(distribution.table << ", " << set.name);
            const bool at_edges = set.name == "edge-grazing";
            BothBounds both;
            Seeded rng(0xf0a3);
            int tried = 0;
            for (const auto& group : set.groups())
                for (std::size_t i = 0; i < group.rays.size() && tried < rays_per_distribution; ++i, ++tried)
                    try_ray(both, group.rays[i], group.primitives[group.is_paired ? i : 0], at_edges, rng);
            both.finite.check(rays_per_distribution / 4);
            // At an edge there is no derivative.
            if (!at_edges) both.first_order.check(rays_per_distribution / 4);
        }
}

}  // namespace test_forward
