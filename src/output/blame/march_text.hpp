// A march as a table that a person reads.
#pragma once

#include <string>

#include "measure/answer/one_ray.hpp"

namespace lostbits::output::blame {

/// What became of a sample: `hit`, `step by d`, `miss: t > max_dist`, `no step: t + d = t`, `steps are up`.
std::string action_of(const intersect::table::MarchLog& log, std::size_t step,
                      const intersect::MarchConstants<double>& constants);

/// Iteration, t, position, |p|, d and action of every sample, and what the answer is worth.
std::string march_table(const intersect::table::Intersector& form, const Format& format,
                        const measure::answer::OneRay& ray);

}  // namespace lostbits::output::blame
