// How much the inputs may change before the answer does, and how little they must for a wrong one to be right.
#pragma once

#include "measure/truth/reach.hpp"
#include "measure/truth/truth.hpp"

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

}  // namespace lostbits::measure::stability
