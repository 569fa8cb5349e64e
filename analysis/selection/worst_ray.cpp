#include "analysis/selection/ray_options.hpp"

#include <fmt/format.h>

#include <utility>

#include "measure/answer/wrong_decision_phrase.hpp"
#include "measure/evaluate/map.hpp"
#include "measure/sweep/sweep.hpp"
#include "number/error.hpp"
#include "output/file/number_text.hpp"

namespace lostbits::analysis::selection {

using intersect::process::StopToken;
using measure::answer::OneRay;
using measure::answer::Outcome;
using measure::evaluate::FormSummary;
using measure::evaluate::TestedForm;
using measure::evaluate::WorstRay;
using scene::rays::RayGroup;

namespace {

std::vector<const measure::metric::Metric*> lost_bits() { return {measure::metric::find_metric("lost_bits")}; }

/// The worst ray of several summaries, by the same rule as of one. If there are wrong decisions, it is the first ray
/// with the most frequent kind of them in all summaries; else the ray with the largest error.
struct OverallWorst {
    std::size_t summary_index = 0;
    const WorstRay* ray = nullptr;  ///< null if every ray is a correct miss
    std::uint64_t rays = 0;
    std::string reason = "the largest error";
    bool has_hit = false;  ///< at least one decision is a correct hit

    explicit OverallWorst(const std::vector<FormSummary>& summaries) {
        FormSummary all;
        for (const FormSummary& summary : summaries) {
            rays += summary.ray_count;
            for (std::size_t o = 0; o < all.outcomes.size(); ++o) all.outcomes[o] += summary.outcomes[o];
        }
        has_hit = all.count(Outcome::agree_hit) > 0;
        const auto wrong = all.most_frequent_wrong_decision();
        if (wrong)
            reason =
                fmt::format("{}, the first of {}", measure::answer::wrong_decision_phrase(*wrong), all.count(*wrong));

        for (std::size_t i = 0; i < summaries.size(); ++i) {
            const WorstRay* const candidate = wrong                      ? summaries[i].first_of(*wrong)
                                              : summaries[i].worst.x < 0 ? nullptr
                                                                         : &summaries[i].worst;
            if (candidate == nullptr || (ray != nullptr && (wrong || candidate->size <= ray->size))) continue;
            ray = candidate;
            summary_index = i;
        }
    }
};

[[noreturn]] void fail_without_worst(const TestedForm& tested_form, const std::string& where,
                                     const OverallWorst& worst) {
    throw InputError(fmt::format(
        "--worst: {} in {} has no worst ray in {}: it decides every ray correctly, and {}; name a ray, as with --pixel "
        "X,Y",
        tested_form.form->info->name, tested_form.format.name, where,
        worst.has_hit ? "it returns no t that could have an error" : "none of the rays hits anything"));
}

/// The index of a ray among all rays of a step, which are in groups.
std::size_t index_among(const std::vector<RayGroup>& groups, const WorstRay& ray) {
    auto index = static_cast<std::size_t>(ray.x);
    for (int g = 0; g < ray.group; ++g) index += groups[g].rays.size();
    return index;
}

}  // namespace

RayGroup pick_ray(std::vector<RayGroup> groups, int rays_per_group, int ray_index) {
    RayGroup& group = groups[ray_index / rays_per_group];
    const auto index = static_cast<std::size_t>(ray_index % rays_per_group);
    RayGroup single_ray = scene::rays::make_group(group.rays[index]);
    single_ray.primitives = std::move(group.primitives);
    single_ray.rays.push_range(group.rays, index);
    return single_ray;
}

int find_worst_ray_index(std::vector<RayGroup> groups, int rays_per_group, const TestedForm& tested_form,
                         StopToken stop) {
    const auto summaries =
        measure::evaluate::measure_groups(std::move(groups), {tested_form}, lost_bits(), {.stop = stop});
    const WorstRay* const worst = summaries.front().worst_ray();
    return worst ? worst->group * rays_per_group + static_cast<int>(worst->x) : 0;
}

SelectedRay find_worst_in_scene(std::shared_ptr<const scene::file::Scene> scene, const TestedForm& tested_form,
                                StopToken stop) {
    const measure::evaluate::MapStudy request{
        .scene = scene.get(), .tested_forms = {tested_form}, .metrics = lost_bits(), .limit = {.stop = stop}};
    const auto summaries = measure::evaluate::run_map(request);
    const OverallWorst worst(summaries);
    if (worst.ray == nullptr) fail_without_worst(tested_form, "scene " + scene->id, worst);
    const auto x = static_cast<int>(worst.ray->x);
    SelectedRay found{
        scene, OneRay(*scene, x, worst.ray->y, {.stop = stop}), tested_form.form,
        fmt::format("Pixel {},{}, the worst of {} for this form: {}.\n", x, worst.ray->y, worst.rays, worst.reason),
        std::pair{x, worst.ray->y}};
    found.ray.set_touching(tested_form.touching);
    return found;
}

SelectedRay find_worst_in_sweep(const scene::sweep::SweepFile& sweep, const TestedForm& tested_form, StopToken stop) {
    const measure::sweep::SweepRequest request{
        .sweep = sweep, .tested_forms = {tested_form}, .metrics = lost_bits(), .limit = {.stop = stop}};

    // The summary of each step, and its position on the axes.
    std::vector<FormSummary> summaries;
    std::vector<std::vector<double>> values;
    for (auto& step : measure::sweep::run_sweep(request)) {
        summaries.push_back(std::move(step.summaries.front()));
        values.push_back(std::move(step.values));
    }

    const OverallWorst worst(summaries);
    const WorstRay* const ray = worst.ray;
    if (ray == nullptr) fail_without_worst(tested_form, "sweep " + sweep.id, worst);
    if (!ray->given)
        throw InputError(
            fmt::format("--worst: the worst ray of sweep {} cannot be explained by itself, since it has too many "
                        "primitives, or each format computes a ray of its own; explain a pixel of its scene with --set",
                        sweep.id));

    // The note names the ray by its step and its index there.
    std::string step;
    for (std::size_t a = 0; a < sweep.axes.size(); ++a)
        step += fmt::format("{}{} {}", a > 0 ? ", " : "", sweep.axes[a].name,
                            output::file::decimal(values[worst.summary_index][a]));
    SelectedRay found{
        nullptr, OneRay(RayGroup(*ray->given)), tested_form.form,
        fmt::format("Ray {} (counted from 0) of the {} of the step {}, the worst of {} in {} steps for this "
                    "form: {}.\n",
                    index_among(sweep.rays(values[worst.summary_index]), *ray),
                    summaries[worst.summary_index].ray_count, step, worst.rays, summaries.size(), worst.reason)};
    found.ray.set_touching(tested_form.touching);
    return found;
}

SelectedRay find_worst_in_cases(const scene::sweep::CaseFile& file, const TestedForm& tested_form, StopToken stop) {
    std::vector<FormSummary> summaries;
    for (std::size_t i = 0; i < file.size(); ++i)
        summaries.push_back(std::move(measure::evaluate::measure_groups(file.rays(i, tested_form.format.parameters),
                                                                        {tested_form}, lost_bits(), {.stop = stop})
                                          .front()));
    const OverallWorst worst(summaries);
    if (worst.ray == nullptr) fail_without_worst(tested_form, "the file of cases " + file.id, worst);
    const int rays_per_group = file.ray_count(worst.summary_index),
              ray_index = worst.ray->group * rays_per_group + static_cast<int>(worst.ray->x);
    SelectedRay found{
        nullptr,
        OneRay(pick_ray(file.rays(worst.summary_index, tested_form.format.parameters), rays_per_group, ray_index)),
        tested_form.form,
        fmt::format("Case \"{}\", ray {} (counted from 0), the worst of {} in {} cases for this form: {}.\n",
                    file.name(worst.summary_index), ray_index, worst.rays, summaries.size(), worst.reason)};
    found.ray.set_touching(tested_form.touching);
    return found;
}

}  // namespace lostbits::analysis::selection
