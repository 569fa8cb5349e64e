// How far a ray that a form is given is from the ideal one.
#pragma once

#include "measure/metric/metrics.hpp"

namespace lostbits::measure::metric {

/// Each is infinite, or the bits of the format, where a component is NaN or infinite.
double origin_error(const Sample& s);
double origin_lost_bits(const Sample& s);
double direction_error(const Sample& s);
double direction_lost_bits(const Sample& s);
/// |d/(d·f) − d*/(d*·f)| over the side of a pixel, both at distance 1 in front of the eye; f is where the camera looks.
double pixel_error(const Sample& s);

/// Of every ray, whatever the form makes of it.
inline constexpr Metric metrics_of_rays[] = {
    {.name = "origin_error",
     .unit = "length",
     .layer = "ray.origin",
     .meaning = "|o - o*|: how far the ray that the form is given begins from where the ideal one does, in the scene's "
                "unit of length",
     .needs = needs_true_ray,
     .ramp = Ramp::magnitude,
     .high = 0x1p+10,
     .value = origin_error,
     .over = Over::every},
    {.name = "origin_lost_bits",
     .unit = "bits",
     .layer = "ray.origin_bits",
     .meaning = "clamp(log2(2 e), 0, p), e the largest component of o - o* in ulps of the largest of o*",
     .needs = needs_true_ray,
     .value = origin_lost_bits,
     .over = Over::every},
    {.name = "direction_error",
     .unit = "radian",
     .layer = "ray.direction",
     .meaning = "the angle between the direction that the form is given and the ideal one",
     .needs = needs_true_ray,
     .ramp = Ramp::magnitude,
     .high = 0x1p+1,
     .value = direction_error,
     .over = Over::every},
    {.name = "direction_lost_bits",
     .unit = "bits",
     .layer = "ray.direction_bits",
     .meaning = "clamp(log2(2 e), 0, p), e the largest component of d/|d| - d*/|d*| in ulps of the largest of d*/|d*|",
     .needs = needs_true_ray,
     .value = direction_lost_bits,
     .over = Over::every},
    {.name = "pixel_error",
     .unit = "pixels",
     .layer = "ray.pixel",
     .meaning =
         "of a camera whose rays each format makes: how far from the middle of its pixel the direction meets the "
         "picture; infinite where it points away from it",
     .needs = needs_true_ray,
     .ramp = Ramp::magnitude,
     .low = 0x1p-10,
     .high = 0x1p+6,
     .value = pixel_error,
     .over = Over::every}};

}  // namespace lostbits::measure::metric
