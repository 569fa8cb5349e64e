// How far a small error in every input can move the true answer, at a tangent too.
#pragma once

#include <cstddef>
#include <cstdint>

#include "measure/truth/lost_bits.hpp"
#include "measure/truth/truth.hpp"
#include "number/format.hpp"
#include "number/real.hpp"
#include "shapes/solid.hpp"

namespace lostbits::measure::truth {

/// Which errors the inputs of a problem have. `componentwise`: each number half an ulp of the format (0: half of the
/// least subnormal number), which leaves zeros what they are. `normwise`: each vector (origin, direction, each point of
/// the solid) and each length v an error of length u|v|, u = 2^-p, in any direction: a 0 beside a 1 moves as far.
enum class Perturbed : std::uint8_t { componentwise, normwise };

/// Where the k-th perturbed number of a matrix stands in it: the linear part first, row by row, then what is added.
inline constexpr std::size_t place_in_matrix(std::size_t k) { return k < 9 ? k / 3 * 4 + k % 3 : (k - 9) * 4 + 3; }

/// Which faces of a box the answer can come from. A ray that begins inside at tmin answers max(tmin, largest entry):
/// where that is tmin, no face that the ray leaves moves it.
enum class MovedBy : std::uint8_t { every_face, entered_faces };

/// A bound of |t' − t|, or of how far the distance moves, for every problem within those errors whose answer is the
/// same root: the near root or the far one, the same face. It is never too small; reach.cpp has the inequalities.
/// `answer` is the t or the distance of the root, or of where the range begins; the bound is in units of its power of
/// two
/// (`exponent_of_unit`). A problem within the errors may also miss, or meet another root first, where its line may pass
/// the rim, or its origin the surface: then the inputs do not decide, and what those answer is no part of the bound.
double reach(const Ray<double>& ray, const Solid<double>& solid, const Certified& answer, Length length,
             const FloatFormat& format, Perturbed perturbed = Perturbed::componentwise,
             MovedBy moved_by = MovedBy::every_face);
double reach(const Ray<Real>& ray, const Solid<Real>& solid, const Certified& answer, Length length,
             const FloatFormat& format, Perturbed perturbed = Perturbed::componentwise,
             MovedBy moved_by = MovedBy::every_face);

}  // namespace lostbits::measure::truth
