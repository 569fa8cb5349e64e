// Where a form says that the ray meets the solid, how far that is off the surface, and of which vertices it is made.
#pragma once

#include "measure/metric/metrics.hpp"

namespace lostbits::measure::metric {

/// P = o + t·d as the format computes it: a product and a sum, each rounded.
Vec<double> hit_point(const Sample& s);

/// (|P − G| − r)/r; of a box the largest of lo − P and P − hi over the axes, in longest sides.
double residual(const Sample& s);

/// The angle between the normal of the solid at the hit point and at the true one, of a solid under no matrix.
double normal_error(const Sample& s);

/// `in.operator()<F>()` in the machine's own format; missing in every other.
template <class In>
double in_format(const Sample& s, const In& in) {
    switch (s.format->engine) {
        case Format::Engine::native32: return in.template operator()<float>();
        case Format::Engine::native64: return in.template operator()<double>();
        case Format::Engine::rounded: break;
    }
    return truth::missing;
}

template <class F>
Vec<F> stored(const Vec<double>& v) {
    return {static_cast<F>(v.x), static_cast<F>(v.y), static_cast<F>(v.z)};
}

/// The largest |x − x*| of the weights x of a, b and c that the form computes, in u = 2^-p: a weight of a point within
/// is at most 1, whatever the size of the triangle. x* is of the ray and the triangle as the form received them.
/// Infinite where one is no number; missing of a form that names none, or whose operations cannot be asked.
double barycentric_error(const Sample& s);
/// |x + y + z − 1|, in u, of a form that computes all three.
double barycentric_sum(const Sample& s);

inline constexpr Metric metrics_of_weights[] = {
    {.name = "barycentric_error",
     .unit = "u",
     .layer = "weights.error",
     .meaning = "of a triangle: the largest error of the barycentric coordinates (u, v) that the form computes, "
                "|u - u*| over 2^-p",
     .needs = needs_attribution,
     .ramp = Ramp::magnitude,
     .low = 0x1p-2,
     .value = barycentric_error},
    {.name = "barycentric_sum",
     .unit = "u",
     .layer = "weights.sum",
     .meaning = "of a triangle: |u + v + w - 1| over 2^-p, of a form that computes all three barycentric coordinates",
     .needs = needs_attribution,
     .ramp = Ramp::magnitude,
     .low = 0x1p-2,
     .high = 0x1p+4,
     .value = barycentric_sum}};

}  // namespace lostbits::measure::metric
