// Bounds how far a small error in every input can move the true answer, at a tangent too.
#pragma once

#include <cstddef>
#include <cstdint>

#include "measure/truth/lost_bits.hpp"
#include "measure/truth/truth.hpp"
#include "number/format.hpp"
#include "number/real.hpp"
#include "shapes/primitive.hpp"

namespace lostbits::measure::truth {

/// Errors of the inputs of a problem. `componentwise`: each number has half an ulp of the format (0: half of the least
/// subnormal number), and zeros stay 0. `normwise`: each vector (origin, direction, each point of the primitive) and
/// each length v has an error of length u|v|, u = 2^-p, in any direction: a component 0 moves as far as a component 1
/// of the same vector.
enum class Perturbation : std::uint8_t { componentwise, normwise };

/// Index in a matrix of its k-th perturbed number: the linear part comes first, row by row, then the translation.
inline constexpr std::size_t index_in_matrix(std::size_t k) { return k < 9 ? k / 3 * 4 + k % 3 : (k - 9) * 4 + 3; }

/// Faces of a box that can move the answer. For a ray that begins inside at tmin, the answer is max(tmin, largest
/// entry). If this is tmin, no face through which the ray leaves moves it.
enum class AnswerFaces : std::uint8_t { every_face, entered_faces };

/// Bound of |t' − t|, or of the change of the distance, for every problem within these errors whose answer is the same
/// root: both the near root or both the far one, on the same face. The bound is never too small; reach.cpp has the
/// inequalities. `answer` is the t or the distance of the root, or of the start of the range. The unit of the bound is
/// the power of two of `answer` (`exponent_of_unit`). If the errors may move the line past the rim, or the origin
/// across the surface, a problem within the errors may also miss or meet another root first. The inputs do not decide
/// then, and the bound does not cover such answers.
double reach(const Ray<double>& ray, const Primitive<double>& primitive, const CertifiedNumber& answer, Length length,
             const FloatFormat& format, Perturbation perturbation = Perturbation::componentwise,
             AnswerFaces answer_faces = AnswerFaces::every_face);
double reach(const Ray<Real>& ray, const Primitive<Real>& primitive, const CertifiedNumber& answer, Length length,
             const FloatFormat& format, Perturbation perturbation = Perturbation::componentwise,
             AnswerFaces answer_faces = AnswerFaces::every_face);

}  // namespace lostbits::measure::truth
