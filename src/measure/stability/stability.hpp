// Distance of an answer from the answer of a nearby problem, the root that an answer belongs to, its derivatives, and
// predictions of its error that do not need the exact answer.
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "measure/attribution/attribution.hpp"
#include "measure/truth/reach.hpp"
#include "measure/truth/truth.hpp"
#include "number/tape.hpp"
#include "scene/rays/primitive_list.hpp"

namespace lostbits::measure::stability {

using truth::Perturbation;

/// Changes that count: only of hit or miss, or also of the root that is hit.
enum class CountedChange : std::uint8_t { decision, root };

/// Margins from here on are proved, but the least change may be several times as large.
inline constexpr double max_tight_margin = 0x1p-10;

/// Amounts added to the numbers of origin, direction, primitive and matrix, in this order.
using Amounts = std::array<double, 6 + max_primitive_number_count>;

/// Bounds of the least relative change that changes the answer.
struct Margin {
    double proved;                ///< no smaller change changes the answer
    double reached;               ///< a change of this size changes the answer; infinite if none was found
    Amounts reached_change = {};  ///< the amounts of the change of that size

    [[nodiscard]] bool is_tight() const { return reached <= 2 * proved || proved >= max_tight_margin || is_zero(); }
    /// True if changes of 2^-89 change the answer.
    [[nodiscard]] bool is_zero() const { return proved == 0 && reached < 0x1p-80; }
};

/// Relative change within which the answer is the same, for every problem: each number x of ray and primitive changes
/// by at most ε|x| (`componentwise`), or each vector and length v by ε|v| (`normwise`). `proved` is at most 1/2.
Margin find_margin(const Ray<double>& ray, const Primitive<double>& primitive,
                   CountedChange counted = CountedChange::root, Perturbation perturbation = Perturbation::componentwise,
                   intersect::Convention convention = {}, Range<double> range = {});

/// The proved margin; NaN if it is below 2^-10 and no change of at most twice its size is found that changes the
/// answer.
double find_decision_margin(const Ray<double>& ray, const Primitive<double>& primitive,
                            CountedChange counted = CountedChange::root,
                            Perturbation perturbation = Perturbation::componentwise,
                            intersect::Convention convention = {}, Range<double> range = {});

/// Decides whether a change of at most ε changes the answer: true with an example, false with a proof, otherwise
/// nothing.
std::optional<bool> changes_within(double epsilon, const Ray<double>& ray, const Primitive<double>& primitive,
                                   CountedChange counted = CountedChange::root,
                                   Perturbation perturbation = Perturbation::componentwise,
                                   intersect::Convention convention = {}, Range<double> range = {});

/// Index of the primitive with the least margin, for a ray that misses all of them.
std::size_t find_nearest_decision(const Ray<double>& ray, const scene::rays::PrimitiveList<double>& primitives,
                                  intersect::Convention convention = {}, Range<double> range = {});

/// Lower bound of the backward error of t: for a ray that hits, no problem within a relative change of ε has the answer
/// t. At most 1/2; 0 if t is right or if nothing can be proved. NaN for a t that is not above 0.
double backward_error(const Ray<double>& ray, const Primitive<double>& primitive, double t,
                      Perturbation perturbation = Perturbation::componentwise, intersect::Convention convention = {},
                      Range<double> range = {});

using attribution::Attribution;

/// Three runs of a tape in which each result that rounds is rounded up or down at random, and every decision follows
/// the values of its run: CESTAC (La Porte and Vignes, 1974), as in CADNA. The random bits depend only on the inputs.
struct RandomRuns {
    std::array<double, 3> t{};
    std::array<bool, 3> hit{};

    explicit RandomRuns(Tape tape);

    [[nodiscard]] bool agree() const { return hit[0] == hit[1] && hit[1] == hit[2]; }
    /// Answer of CESTAC: the mean of the three runs.
    [[nodiscard]] double mean() const { return (t[0] + t[1] + t[2]) / 3; }
    /// Correct bits of the mean: log2(√3 |mean| / (4.303 σ)), from 0 to p, if all runs hit; 4.303 is Student's factor
    /// of three samples and 95 %. The result is p if all runs have the same t, and NaN if a run misses.
    [[nodiscard]] double correct_bits(int precision) const;
};

/// √Σ (adjointᵢ · ulp(vᵢ)/2)² over the operations that round. If the error is a sum of independent errors of mean 0, it
/// exceeds λ times this bound with probability 2 exp(−λ²/2) at most (Hoeffding; Higham and Mary, A new approach to
/// probabilistic rounding error analysis, 2019). The subject of the attribution must be a number.
double compute_statistical_bound(const Tape& tape, const Attribution& attribution);

/// ∂t/∂x of each input x of a tape, in the order of the inputs, by forward differentiation: the chain rule for each
/// operation, with the tape's values. Each operation of the derivative is rounded to the format of the tape's operation
/// (as `Dual` of that format does). NaN if t is computed by a call, whose rule is not on the tape.
std::vector<double> compute_forward_derivatives(const Tape& tape);

/// True if t belongs to another crossing of the ray's line, ahead or behind, with the surface that the ray truly hits
/// at `truth`: t is nearer to that crossing than a quarter of its distance from the true one. Checks the three
/// crossings after the true one, and the three nearest behind the origin.
bool is_wrong_root(const Ray<double>& ray, const Primitive<double>& primitive, const truth::CertifiedNumber& truth,
                   double t);

}  // namespace lostbits::measure::stability
