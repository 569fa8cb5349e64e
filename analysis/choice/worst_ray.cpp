#include "analysis/choice/worst_ray.hpp"

#include <fmt/format.h>

#include <utility>

#include "measure/sweep/sweep.hpp"
#include "number/error.hpp"
#include "output/file/number_text.hpp"

namespace lostbits::analysis::choice {

using intersect::process::StopToken;
using measure::answer::OneRay;
using measure::map::MapRow;
using measure::map::MapSummary;
using measure::map::WorstRay;
using scene::rays::RayGroup;

namespace {

std::vector<const measure::metric::Metric*> lost_bits() { return {measure::metric::find_metric("lost_bits")}; }

/// A wrong decision is worse than any error; of two the first found.
bool is_worse(const MapSummary& a, const MapSummary& b) {
    const WorstRay *const x = a.worst_ray(), *const y = b.worst_ray();
    if (x == nullptr || y == nullptr) return x != nullptr;
    const bool wrong = a.fault() != nullptr, other = b.fault() != nullptr;
    return wrong != other ? wrong : !wrong && x->size > y->size;
}

/// What makes the ray the worst.
std::string why(const MapSummary& s) {
    const auto wrong = s.wrong();
    if (!wrong) return "the largest error";
    std::string name(measure::answer::outcome_names[static_cast<std::size_t>(*wrong)]);
    for (char& c : name) c = c == '_' ? ' ' : c;
    return fmt::format("a {}, the first of {}", name, s.count(*wrong));
}

[[noreturn]] void refuse(const MapRow& row, const std::string& where) {
    throw InputError(
        fmt::format("--worst: {} in {} has no worst ray in {}: it decides all rays rightly, and none of them hits "
                    "anything; name a ray, as with --pixel X,Y",
                    row.form->info->name, row.format.name, where));
}

}  // namespace

RayGroup ray_of(std::vector<RayGroup> groups, int rays, int k) {
    RayGroup& from = groups[static_cast<std::size_t>(k / rays)];
    const auto place = static_cast<std::size_t>(k % rays);
    RayGroup one = scene::rays::group_of(from.rays[place]);
    one.solids = std::move(from.solids);
    if (!from.rays.tmax.empty()) one.rays.tmax.push_back(from.rays.tmax[place]);
    return one;
}

int worst_of(std::vector<RayGroup> groups, int rays, const MapRow& row, StopToken stop) {
    const auto summaries = measure::map::measure_groups(std::move(groups), {row}, lost_bits(), {.stop = stop});
    const WorstRay* const worst = summaries.front().worst_ray();
    return worst ? worst->group * rays + static_cast<int>(worst->x) : 0;
}

AskedRay worst_of_scene(std::shared_ptr<const scene::file::Scene> scene, const MapRow& row, StopToken stop) {
    const measure::map::MapRequest request{
        .scene = scene.get(), .rows = {row}, .metrics = lost_bits(), .limit = {.stop = stop}};
    const auto summaries = measure::map::run_map(request, {nullptr});
    const WorstRay* const worst = summaries.front().worst_ray();
    if (worst == nullptr) refuse(row, "scene " + scene->id);
    const auto x = static_cast<int>(worst->x);
    AskedRay found{scene, OneRay(*scene, x, worst->y, {.stop = stop}),
                   fmt::format("Pixel {},{}, the worst of {} for this form: {}.\n", x, worst->y, scene->pixels(),
                               why(summaries.front()))};
    found.ray.judge_by(row.judged);
    return found;
}

AskedRay worst_along(const scene::sweep::SweepFile& sweep, const MapRow& row, StopToken stop) {
    const measure::sweep::SweepRequest request{
        .sweep = &sweep, .rows = {row}, .metrics = lost_bits(), .limit = {.stop = stop}};
    const auto steps = measure::sweep::run_sweep(request);
    const measure::sweep::SweepStep* worst = &steps.front();
    for (const auto& step : steps) {
        if (is_worse(step.rows.front(), worst->rows.front())) worst = &step;
    }
    const MapSummary& summary = worst->rows.front();
    const WorstRay* const ray = summary.worst_ray();
    if (ray == nullptr) refuse(row, "sweep " + sweep.id);
    if (!ray->given)
        throw InputError(
            fmt::format("--worst: the worst ray of sweep {} has too many solids to be taken along; explain "
                        "a pixel of its scene with --set",
                        sweep.id));
    std::string place;
    for (std::size_t a = 0; a < sweep.axes.size(); ++a)
        place += fmt::format("{}{} {}", a > 0 ? ", " : "", sweep.axes[a].name, output::file::decimal(worst->values[a]));
    AskedRay found{
        nullptr, OneRay(RayGroup(*ray->given)),
        fmt::format("Ray {} of the step {}, the worst of all steps for this form: {}.\n", ray->x, place, why(summary))};
    found.ray.judge_by(row.judged);
    return found;
}

AskedRay worst_of_cases(const scene::sweep::CaseFile& file, const MapRow& row, StopToken stop) {
    MapSummary least(lost_bits());
    std::size_t which = 0;
    for (std::size_t i = 0; i < file.size(); ++i) {
        auto summaries =
            measure::map::measure_groups(file.rays(i, row.format.shape), {row}, lost_bits(), {.stop = stop});
        if (!is_worse(summaries.front(), least)) continue;
        least = std::move(summaries.front());
        which = i;
    }
    const WorstRay* const worst = least.worst_ray();
    if (worst == nullptr) refuse(row, "the file of cases " + file.id);
    const int rays = file.rays_of(which), k = worst->group * rays + static_cast<int>(worst->x);
    AskedRay found{nullptr, OneRay(ray_of(file.rays(which, row.format.shape), rays, k)),
                   fmt::format("Case \"{}\", ray {} (counted from 0), the worst of all cases for this form: {}.\n",
                               file.name(which), k, why(least))};
    found.ray.judge_by(row.judged);
    return found;
}

}  // namespace lostbits::analysis::choice
