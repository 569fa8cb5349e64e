// Truth: the exact answer of the geometric problem for the exact stored inputs, with a proof.
#pragma once

#include <array>
#include <span>
#include <string_view>

#include "geometry/range.hpp"
#include "intersect/info.hpp"
#include "intersect/process/stop_token.hpp"
#include "measure/truth/certified.hpp"
#include "number/real.hpp"
#include "shapes/primitive.hpp"

namespace lostbits::measure::truth {

/// First intersection of a ray with primitives that lies in its range, which is t ≥ 0 by default. The primitives are
/// closed (a touch counts, and so does a ray origin on the surface) unless another convention is given.
struct Truth {
    enum class Decision : std::uint8_t { miss, hit, unresolved };

    Decision decision = Decision::miss;
    /// Index of the primitive that is hit first; −1 for a miss. If the order of several hits is not decided, it is the
    /// lowest of their indices.
    int primitive = -1;
    /// Bits of precision that the proof took; 106 for the double-double stage.
    int proof_bits = 0;
    /// The ray only touches some primitive, so the two conventions on touching may differ on this ray.
    bool touches = false;
    /// The ray begins on the surface of some primitive, so conventions on t = 0 may differ on this ray.
    bool on_surface = false;
    /// The ray parameter, in lengths of the direction as stored. Its binade is proved, and so is that of the distance:
    /// the bound never straddles a power of two.
    CertifiedNumber t;
    /// Same length as a distance, t·|d|: the answer that is expected of a form for unit directions.
    CertifiedNumber distance;

    [[nodiscard]] bool is_hit() const { return decision == Decision::hit; }
};

/// Names in files, in the order of `Truth::Decision`.
inline constexpr std::array<std::string_view, 3> decision_names{"miss", "hit", "unresolved"};

/// Limit of the precision of a proof, and a token that stops the search for it.
///
/// Enclosures start at double-double (`Ball`). A problem that this leaves open is tried in MPFI at 192 bits (at 384 for
/// `Real`), and at twice the bits each time, as long as these are at most `max_bits`. So with 32768 the last precision
/// tried is 24576. A problem that is open even then is `unresolved`. The worst case of the tests needed 6144 bits.
///
/// Every decision rests on the sign of a dyadic polynomial in the inputs. An interval of enough bits encloses its value
/// with zero width, so it decides. By the degree of the polynomial, doubles need:
///
/// - Degree four, or eight (ellipsoids, cylinders): fewer than 24576 bits.
/// - Degree twelve (cones): at most 12·(1024 + 1074) + 24 = 25200 bits. This is more than 24576, so a cone with numbers
///   from both ends of the range of doubles may stay unresolved.
/// - Degree 34 or more (tori): more than 24576 bits, if the exponents of the numbers are some 700 apart.
///
/// Code that finds many truths, or that asks forms about the same rays, checks `stop` on the way.
struct ProofLimit {
    int max_bits = 32768;  ///< largest precision that may be tried
    intersect::process::StopToken stop = {};
};

/// Finds the truth of a ray. Only t in `range` counts, and the ray begins at its tmin: a convention about the origin of
/// a ray applies to that point (see `convention_in`). A range that holds no t meets nothing.
///
/// `ray` and `primitives` may be in any exact storage: double (which holds every format up to binary64) or Real (own
/// inputs). A ray with a number that is not finite, or with a direction of zero, meets nothing. Nothing meets a
/// primitive with such a number, a sphere without a positive radius, a box with lo > hi, or a primitive with a
/// singular matrix.
Truth find_truth(const Ray<double>& ray, std::span<const Primitive<double>> primitives, ProofLimit limit = {},
                 intersect::Convention convention = {}, const Range<double>& range = {});
Truth find_truth(const Ray<Real>& ray, std::span<const Primitive<Real>> primitives, ProofLimit limit = {},
                 intersect::Convention convention = {}, const Range<double>& range = {});

/// Merges `truth`, which is about primitive `i` alone, into `best`, the truth about the primitives before it.
void merge_truth(const Truth& truth, int i, Truth& best);

/// True if every number of the ray is finite and its direction is not zero. No other ray meets anything.
bool is_valid(const Ray<double>& ray);
bool is_valid(const Ray<Real>& ray);
/// True if a ray can meet the primitive: every number is finite and within the limits of its shape, and the matrix is
/// not singular.
bool is_valid(const Primitive<double>& primitive);
bool is_valid(const Primitive<Real>& primitive);

inline Truth find_truth(const Ray<double>& ray, const Primitive<double>& primitive, ProofLimit limit = {},
                        intersect::Convention convention = {}, const Range<double>& range = {}) {
    return find_truth(ray, std::span(&primitive, 1), limit, convention, range);
}
inline Truth find_truth(const Ray<Real>& ray, const Primitive<Real>& primitive, ProofLimit limit = {},
                        intersect::Convention convention = {}, const Range<double>& range = {}) {
    return find_truth(ray, std::span(&primitive, 1), limit, convention, range);
}

/// Kinds of lengths: the parameter t*, in lengths of the direction as stored, or the distance t*·|d|.
enum class Length { parameter, distance };
inline Length length_of(intersect::Direction direction) {
    return direction == intersect::Direction::unit ? Length::distance : Length::parameter;
}

/// t* (or the distance) correctly rounded to a format, ties decided exactly: if the certified bound straddles a
/// rounding boundary, the sign of a polynomial at the boundary decides the side. The truth must be a hit, found by the
/// same convention and in the same range.
double round_truth(const Truth& truth, const Ray<double>& ray, const Primitive<double>& primitive,
                   const FloatFormat& format, Length length = Length::parameter,
                   const intersect::Convention& convention = {}, const Range<double>& range = {});
double round_truth(const Truth& truth, const Ray<Real>& ray, const Primitive<Real>& primitive,
                   const FloatFormat& format, Length length = Length::parameter,
                   const intersect::Convention& convention = {}, const Range<double>& range = {});

}  // namespace lostbits::measure::truth
