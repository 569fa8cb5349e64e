// Finds the ray for `lostbits explain`: a ray of a scene, of a file of cases, or of primitives given as options. Also
// finds the worst ray of a form: a wrong decision or, if it makes no wrong decision, the largest error.
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

/// The options of the command line that name a ray and its primitives.
struct RayOptions {
    std::string subject;  ///< a scene, a sweep or a file of cases; empty if `primitives` has the primitives
    std::string pixel, size, variant;  ///< of a scene; `size` also applies to the scene of a sweep
    std::string steps;                 ///< of a sweep
    bool worst = false;                ///< the worst of all pixels of a scene, or of all rays of a sweep
    std::string named_case;            ///< NAME or NAME:K, in a file of cases
    std::string ray, format;           ///< six numbers, and the format to which they are rounded first
    PrimitiveOptions primitives;
    std::string tmin, tmax, open_ends, convention;
    std::vector<std::string> set;
    intersect::process::StopToken stop = {};
};

/// A ray with its primitives.
struct SelectedRay {
    std::shared_ptr<const scene::file::Scene> scene;  ///< null if the ray belongs to no scene; the ray may refer to it
    measure::answer::OneRay ray;
    /// The form to run: that of the tested form or, for transformed primitives, the same with the usual transform
    /// method.
    const intersect::table::Intersector* form = nullptr;
    std::string note = {};                          ///< names the ray, if the options do not
    std::optional<std::pair<int, int>> pixel = {};  ///< pixel of the scene, if the ray is that of one
};

/// Finds the ray that the options name, with the numbers that the tested form gets: a case has other numbers in
/// each format. Throws InputError if they name no ray, and for primitives that the form does not take.
SelectedRay find_ray(const RayOptions& options, const measure::evaluate::TestedForm& tested_form,
                     const std::filesystem::path& data);

/// The file of a sweep if the subject is one: its path, or its name, unless a scene has that name.
std::optional<std::filesystem::path> find_sweep_file(const std::string& subject, const std::filesystem::path& data);

/// Ray `k` of a case. Each of its groups has `rays_per_group` rays; `k` counts the rays of all groups.
scene::rays::RayGroup pick_ray(std::vector<scene::rays::RayGroup> groups, int rays_per_group, int k);
/// The index of the worst of these rays, which is the ray that cases.csv names.
int find_worst_ray_index(std::vector<scene::rays::RayGroup> groups, int rays_per_group,
                         const measure::evaluate::TestedForm& tested_form, intersect::process::StopToken stop);

/// The worst ray of all pixels of a scene, of all steps of a sweep, or of all cases of a file, with a note that names
/// it. Throws InputError if every decision is right and no hit has an error of t, as in a scene that no ray hits.
SelectedRay find_worst_in_scene(std::shared_ptr<const scene::file::Scene> scene,
                                const measure::evaluate::TestedForm& tested_form, intersect::process::StopToken stop);
SelectedRay find_worst_in_sweep(const scene::sweep::SweepFile& sweep, const measure::evaluate::TestedForm& tested_form,
                                intersect::process::StopToken stop);
SelectedRay find_worst_in_cases(const scene::sweep::CaseFile& file, const measure::evaluate::TestedForm& tested_form,
                                intersect::process::StopToken stop);

}  // namespace lostbits::analysis::selection
