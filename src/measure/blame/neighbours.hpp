// The rays right beside one: what a form does on it alone may be luck.
#pragma once

#include <vector>

#include "measure/answer/one_ray.hpp"

namespace lostbits::measure::blame {

inline constexpr int neighbours = 64;

/// So many rays against these solids, each number moved by an ulp of the format down, up or not at all, by a rule that
/// draws nothing. A 0 stays one, and so does what is not finite: an ulp of 0 is no small change of a direction.
std::vector<answer::OneRay> neighbours_of(const answer::OneRay& ray, const answer::OneRay::Inputs& in,
                                          const FloatFormat& format, const std::vector<Solid<double>>& solids);

}  // namespace lostbits::measure::blame
