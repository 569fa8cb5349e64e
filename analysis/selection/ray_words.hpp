// Which ray `lostbits explain` is asked about: of a scene, of a file of cases, or with solids of its own; and the ray
// on which a form does worst: a wrong decision, or else the largest error.
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "analysis/selection/ray_numbers.hpp"
#include "intersect/process/stop_token.hpp"
#include "measure/answer/one_ray.hpp"
#include "measure/evaluate/evaluate.hpp"
#include "scene/sweep/case_file.hpp"
#include "scene/sweep/sweep_file.hpp"

namespace lostbits::analysis::selection {

/// The words of the command line that name a ray and what it is aimed at.
struct RayWords {
    std::string subject;               ///< a scene or a file of cases; empty where the ray has its own solids
    std::string pixel, size, variant;  ///< of a scene; a size also of the scene of a sweep
    std::string steps;                 ///< of a sweep
    bool worst = false;                ///< of all pixels of a scene, or of all rays of a sweep
    std::string named_case;            ///< NAME or NAME:K, of a file of cases
    std::string ray, as;               ///< six numbers, and the format they are rounded to first
    SolidWords solids;
    std::string tmin, tmax, open_ends, convention;
    std::vector<std::string> set;
    intersect::process::StopToken stop = {};
};

/// A ray with what it is aimed at.
struct AskedRay {
    std::shared_ptr<const scene::file::Scene> scene;  ///< null where the ray is of no scene; the ray may refer to it
    measure::answer::OneRay ray;
    /// The one that is asked: that of the row, or it through the usual space where solids stand under matrices.
    const intersect::table::Intersector* form = nullptr;
    std::string note = {};                          ///< a line on which ray it is, where the words leave that open
    std::optional<std::pair<int, int>> pixel = {};  ///< of the scene, where the ray is that of one
};

/// The ray that the words name, as the row's form is asked about it: a case has other numbers in each format.
/// InputError for words that name none, and for solids that the form is not made for.
AskedRay find_ray(const RayWords& words, const measure::evaluate::TestedForm& row, const std::filesystem::path& data);

/// The file of a sweep where the subject is one: its path, or its name and not that of a scene.
std::optional<std::filesystem::path> sweep_named(const std::string& subject, const std::filesystem::path& data);

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
