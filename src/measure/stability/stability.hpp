// How far an answer is from that of a problem nearby, which root it is, what its derivatives are, and what is foretold
// of its error without the exact one.
#pragma once

#include <array>
#include <vector>

#include "measure/blame/attribution.hpp"
#include "measure/truth/reach.hpp"
#include "measure/truth/truth.hpp"
#include "number/tape.hpp"

namespace lostbits::measure::stability {

using truth::Perturbed;

/// Which change counts: of hit or miss alone, or of the root that is met, too.
enum class Turned : std::uint8_t { decision, root };

/// A relative change within which the answer is the same, for every problem: each number x of ray and solid
/// `componentwise` by ε|x|, or each vector and length v `normwise` by ε|v|. It is a proved lower bound of the least
/// change that turns the answer, 4 % below it where one sign decides to first order. From the surface, at a rim, and
/// where the second order decides it may be several times too small, or 0; it is at most 1/2.
double decision_margin(const Ray<double>& ray, const Solid<double>& solid, Turned turned = Turned::root,
                       Perturbed perturbed = Perturbed::componentwise, intersect::Convention convention = {},
                       Range<double> range = {});

/// The backward error of t, from below: no problem within a relative change of ε has the answer t, for a ray that
/// hits. 0 where t is right, or nothing can be said; at most 1/2. NaN for a t that is not above 0.
double backward_error(const Ray<double>& ray, const Solid<double>& solid, double t,
                      Perturbed perturbed = Perturbed::componentwise, intersect::Convention convention = {},
                      Range<double> range = {});

using blame::Attribution;

/// Three runs of a tape in which each result that rounds is rounded up or down by the toss of a coin, and every
/// decision is taken by the values that arise: CESTAC (La Porte and Vignes, 1974), as CADNA has it. The coins follow
/// from the inputs alone.
struct RandomRuns {
    std::array<double, 3> t{};
    std::array<bool, 3> hit{};

    explicit RandomRuns(Tape tape);

    [[nodiscard]] bool agree() const { return hit[0] == hit[1] && hit[1] == hit[2]; }
    /// What CESTAC takes for the answer.
    [[nodiscard]] double mean() const { return (t[0] + t[1] + t[2]) / 3; }
    /// Those of the mean: log2(√3 |mean| / (4.303 σ)), from 0 to p, where all runs hit; 4.303 is Student's factor of
    /// three samples and 95 %. p where they have one t, NaN where a run misses.
    [[nodiscard]] double correct_bits(int precision) const;
};

/// √Σ (adjointᵢ · ulp(vᵢ)/2)² over the operations that round: with λ of these an error that is a sum of independent
/// ones of mean 0 is exceeded with probability 2 exp(−λ²/2) at most (Hoeffding; Higham and Mary, A new approach to
/// probabilistic rounding error analysis, 2019). Of a subject that is a number.
double statistical_bound(const Tape& tape, const Attribution& attribution);

/// ∂t/∂x of each input x of a tape, in their order, by forward differentiation: the chain rule for each operation, with
/// the tape's values, each of its own operations rounded to the format of that operation (as `Dual` of that format has
/// it). NaN where t is computed by a call, whose rule is not on the tape.
std::vector<double> forward_derivatives(const Tape& tape);

/// Whether t is another place where the ray's line, ahead or behind, crosses the surface that it truly meets at
/// `truth`: whether it is nearer to that than a quarter of what lies between the two. The three crossings behind the
/// true one are looked at, and the three nearest behind the origin.
bool is_wrong_root(const Ray<double>& ray, const Solid<double>& solid, const truth::Certified& truth, double t);

}  // namespace lostbits::measure::stability
