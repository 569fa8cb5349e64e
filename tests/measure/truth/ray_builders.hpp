// Pieces that the distributions share: integer frames in which tangency and contact are exact, scaling, permuting.
#pragma once

#include "measure/truth/ray_distributions.hpp"

namespace lostbits::test {

using Integers = std::array<std::int64_t, 3>;

/// Three orthogonal integer vectors of the same integer length: the columns of a quaternion's rotation matrix,
/// w² + x² + y² + z² times as long.
struct Frame {
    Integers u, v, w;
    std::int64_t length;
};
Frame draw_frame(Seeded& rng, std::int64_t largest);

/// Whole p and q with p² + q² = hypotenuse².
struct PythagoreanTriple {
    std::int64_t p, q, hypotenuse;
};
PythagoreanTriple draw_triple(Seeded& rng, std::int64_t largest_scale);

/// a·u + b·v + c·w, exactly (the distributions keep within 2^53).
Vec<double> combine(std::int64_t a, const Integers& u, std::int64_t b, const Integers& v, std::int64_t c,
                    const Integers& w);

/// Multiplies all lengths by 2^lengths and the direction by 2^direction.
RaySample rescale(RaySample s, int lengths, int direction);
/// Permutes the axes and flips their signs.
RaySample shuffle_axes(Seeded& rng, const RaySample& sample);
RaySample stored(const RaySample& sample, const FloatFormat& storage);

/// Any unit vector (to rounding), and one perpendicular to `d`.
Vec<double> draw_unit_vector(Seeded& rng);
Vec<double> draw_normal_to(Seeded& rng, const Vec<double>& d);

/// A scene of small integers, the ray aimed near the sphere more often than not.
RaySample draw_integer_scene(Seeded& rng);
/// Integer tangents and contacts that fit binary32 or binary64.
RaySample draw_integer_tangent(Seeded& rng, const FloatFormat& storage);
RaySample draw_integer_contact(Seeded& rng, const FloatFormat& storage);

}  // namespace lostbits::test
