// The ray on which a form does worst: a wrong decision, or else the largest error.
#pragma once

#include <memory>
#include <vector>

#include "analysis/selection/ray_words.hpp"
#include "scene/sweep/case_file.hpp"
#include "scene/sweep/sweep_file.hpp"

namespace lostbits::analysis::selection {

/// Ray K of a case, as its groups of so many rays have them one after another.
scene::rays::RayGroup ray_of(std::vector<scene::rays::RayGroup> groups, int rays, int k);
/// The place among these of the worst: the ray that cases.csv names.
int worst_of(std::vector<scene::rays::RayGroup> groups, int rays, const measure::evaluate::TestedForm& row,
             intersect::process::StopToken stop);

/// Of all pixels of a scene, of all rays of all steps of a sweep, of all cases of a file: with a note on which it is.
/// InputError where every decision is right and nothing is lost anywhere, as of a scene that no ray hits.
AskedRay worst_of_scene(std::shared_ptr<const scene::file::Scene> scene, const measure::evaluate::TestedForm& row,
                        intersect::process::StopToken stop);
AskedRay worst_along(const scene::sweep::SweepFile& sweep, const measure::evaluate::TestedForm& row,
                     intersect::process::StopToken stop);
AskedRay worst_of_cases(const scene::sweep::CaseFile& file, const measure::evaluate::TestedForm& row,
                        intersect::process::StopToken stop);

}  // namespace lostbits::analysis::selection
