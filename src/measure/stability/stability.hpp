// Distance of an answer from that of a problem nearby, the root that it is, its derivatives, and predictions of its
// error that do not need the exact answer.
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

using truth::Perturbed;

/// Changes that count: of hit or miss alone, or also of the root that is met.
enum class CountedChange : std::uint8_t { decision, root };

/// Margins from here on are proved, but the least change may be several times as large.
inline constexpr double most_tight = 0x1p-10;

/// Added to each number of origin, direction, primitive and matrix, in this order.
using Amounts = std::array<double, 6 + most_stored>;

/// Bounds of the least relative change that turns an answer.
struct Margin {
    double proved;            ///< no smaller change turns it
    double reached;           ///< a change of this size turns it; infinite where none was found
    Amounts changes_by = {};  ///< that change

    [[nodiscard]] bool is_tight() const { return reached <= 2 * proved || proved >= most_tight || is_zero(); }
    /// True if changes of 2^-89 turn it.
    [[nodiscard]] bool is_zero() const { return proved == 0 && reached < 0x1p-80; }
};

/// Relative change within which the answer is the same, for every problem: each number x of ray and primitive changes
/// by at most ε|x| (`componentwise`), or each vector and length v by ε|v| (`normwise`). `proved` is at most 1/2.
Margin margin_of(const Ray<double>& ray, const Primitive<double>& primitive, CountedChange turned = CountedChange::root,
                 Perturbed perturbed = Perturbed::componentwise, intersect::Convention convention = {},
                 Range<double> range = {});

/// The proved margin; NaN where it is below 2^-10 and no change of twice its size is found that turns the answer.
double decision_margin(const Ray<double>& ray, const Primitive<double>& primitive,
                       CountedChange turned = CountedChange::root, Perturbed perturbed = Perturbed::componentwise,
                       intersect::Convention convention = {}, Range<double> range = {});

/// Decides whether a change of at most ε turns the answer: true with an example, false with a proof, otherwise nothing.
std::optional<bool> is_turned_within(double epsilon, const Ray<double>& ray, const Primitive<double>& primitive,
                                     CountedChange turned = CountedChange::root,
                                     Perturbed perturbed = Perturbed::componentwise,
                                     intersect::Convention convention = {}, Range<double> range = {});

/// Index of the primitive with the least margin, for a ray that misses all of them: its decision is the nearest.
std::size_t nearest_decision(const Ray<double>& ray, const scene::rays::PrimitiveList<double>& primitives,
                             intersect::Convention convention = {}, Range<double> range = {});

/// Lower bound of the backward error of t: for a ray that hits, no problem within a relative change of ε has the answer
/// t. 0 where t is right, or where nothing can be proved; at most 1/2. NaN for a t that is not above 0.
double backward_error(const Ray<double>& ray, const Primitive<double>& primitive, double t,
                      Perturbed perturbed = Perturbed::componentwise, intersect::Convention convention = {},
                      Range<double> range = {});

using attribution::Attribution;

/// Three runs of a tape in which each result that rounds is rounded up or down at random, and every decision follows
/// the values of its run: CESTAC (La Porte and Vignes, 1974), as in CADNA. The random bits follow from the inputs
/// alone.
struct RandomRuns {
    std::array<double, 3> t{};
    std::array<bool, 3> hit{};

    explicit RandomRuns(Tape tape);

    [[nodiscard]] bool agree() const { return hit[0] == hit[1] && hit[1] == hit[2]; }
    /// Answer by CESTAC.
    [[nodiscard]] double mean() const { return (t[0] + t[1] + t[2]) / 3; }
    /// Correct bits of the mean: log2(√3 |mean| / (4.303 σ)), from 0 to p, where all runs hit; 4.303 is Student's
    /// factor of three samples and 95 %. p where all runs have the same t, NaN where a run misses.
    [[nodiscard]] double correct_bits(int precision) const;
};

/// √Σ (adjointᵢ · ulp(vᵢ)/2)² over the operations that round. If the error is a sum of independent errors of mean 0, it
/// exceeds λ times this bound with probability 2 exp(−λ²/2) at most (Hoeffding; Higham and Mary, A new approach to
/// probabilistic rounding error analysis, 2019). The subject of the attribution must be a number.
double statistical_bound(const Tape& tape, const Attribution& attribution);

/// ∂t/∂x of each input x of a tape, in their order, by forward differentiation: the chain rule for each operation, with
/// the tape's values. Each operation of the derivative is rounded to the format of the tape's operation (as `Dual` of
/// that format does). NaN where t is computed by a call, whose rule is not on the tape.
std::vector<double> forward_derivatives(const Tape& tape);

/// True where t is another place where the ray's line, ahead or behind, crosses the surface that it truly meets at
/// `truth`: t is nearer to that place than a quarter of the distance between the two. Checks the three crossings behind
/// the true one, and the three nearest behind the origin.
bool is_wrong_root(const Ray<double>& ray, const Primitive<double>& primitive, const truth::Certified& truth, double t);

}  // namespace lostbits::measure::stability
