// A march as a table that a person reads.
#pragma once

#include <string>

#include "output/blame/verdict_text.hpp"

namespace lostbits::output::blame {

/// What became of a sample: `hit`, `step by d`, `no step: t + d = t`, `miss: t > max_dist`, `miss: all n samples are
/// used` (behind `no step: t + d = t; ` where the march stands still: `Stop::stagnated`).
std::string action_of(const intersect::table::MarchLog& log, std::size_t step,
                      const intersect::MarchConstants<double>& constants);

/// The constants of a march; iteration, t, position, |p|, d and action of every sample.
std::string march_samples(const MarchEnd& march, const Format& format);

/// The same with the form and the ray above, and what the answer is worth below: to be read by itself.
std::string march_table(const intersect::table::Intersector& form, const Format& format,
                        const measure::answer::OneRay& ray);

}  // namespace lostbits::output::blame
