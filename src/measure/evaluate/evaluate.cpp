#include "measure/evaluate/evaluate.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <utility>

#include "measure/evaluate/map.hpp"
#include "scene/rays/composed_forms.hpp"

namespace lostbits::measure::evaluate {

using answer::Outcome;
using metric::Metric;
using truth::Band;
using truth::BandNeeds;

SharedBandTruth::SharedBandTruth(Band& band, const std::vector<TestedForm>& tested_forms,
                                 const std::vector<const Metric*>& metrics)
    : band_(band), columns_(band) {
    const unsigned metric_needs = needs_of(metrics);
    if (metric_needs & metric::needs_condition) band.find_condition();

    // A format computes its inputs once, for all of its rows.
    std::map<std::string, BandNeeds> needs_by_format;
    for (const TestedForm& tested_form : tested_forms) {
        BandNeeds& needs =
            needs_by_format.try_emplace(tested_form.format.name, BandNeeds{.without_forms = true}).first->second;
        for (const intersect::table::Intersector* form : {tested_form.form, tested_form.against}) {
            if (form == nullptr) continue;
            needs.unit_rays |= form->info->direction == intersect::Direction::unit;
            needs.without_forms &=
                !form->exists_in(tested_form.format);  // a row of a file's answers exists in no format
        }
        needs.stored_truth = (metric_needs & metric::needs_stored_truth) != 0;
        const truth::Length length = truth::length_of(tested_form.form->info->direction);
        if (metric_needs & metric::needs_reach) needs.add_reach(truth::Perturbation::componentwise, length);
        if (metric_needs & metric::needs_reach_normwise) needs.add_reach(truth::Perturbation::normwise, length);
    }
    for (const auto& [name, needs] : needs_by_format) inputs_.emplace(name, band.inputs(*find_format(name), needs));

    for (const TestedForm& tested_form : tested_forms)
        columns_.compute_lengths(tested_form.convention(), tested_form.form->info->direction);
}

std::vector<const intersect::table::Intersector*> forms_of(const std::vector<TestedForm>& tested_forms) {
    std::vector<const intersect::table::Intersector*> forms;
    for (const TestedForm& tested_form : tested_forms) {
        if (std::ranges::find(forms, tested_form.form) == forms.end()) forms.push_back(tested_form.form);
    }
    return forms;
}

FormSummary::FormSummary(const std::vector<const Metric*>& measured) : metrics(measured.size()) {
    for (const Metric* m : measured) categories.emplace_back(m->categories.size());
}

void FormSummary::add(std::size_t m, const Metric& metric, std::span<const double> values) {
    if (metric.categories.empty()) return metrics[m].add(values);
    for (const double value : values) {
        if (!std::isnan(value)) ++categories[m][static_cast<std::size_t>(value)];
    }
}

void FormSummary::append(FormSummary&& next_rays) {
    ray_count += next_rays.ray_count;
    true_hit_count += next_rays.true_hit_count;
    for (std::size_t o = 0; o < outcomes.size(); ++o) outcomes[o] += next_rays.outcomes[o];
    for (std::size_t m = 0; m < metrics.size(); ++m) metrics[m].add(next_rays.metrics.at(m));
    for (std::size_t m = 0; m < categories.size(); ++m) {
        for (std::size_t c = 0; c < categories[m].size(); ++c) categories[m][c] += next_rays.categories.at(m).at(c);
    }
    if (next_rays.worst.size > worst.size) worst = std::move(next_rays.worst);
    for (std::size_t kind = 0; kind < faults.size(); ++kind) {
        if (!faults[kind]) faults[kind] = std::move(next_rays.faults[kind]);
    }
}

void FormSummary::seal() {
    for (metric::Distribution& d : metrics) d.seal();
}

std::uint64_t FormSummary::wrong_count() const {
    std::uint64_t sum = 0;
    for (const Outcome o : wrong_decisions) sum += count(o);
    return sum;
}

std::optional<Outcome> FormSummary::most_frequent_wrong_decision() const {
    const auto most_frequent = std::ranges::max_element(wrong_decisions, {}, [this](Outcome o) { return count(o); });
    return count(*most_frequent) > 0 ? std::optional(*most_frequent) : std::nullopt;
}

const WorstRay* FormSummary::first_of(Outcome wrong) const {
    return faults[std::ranges::find(wrong_decisions, wrong) - wrong_decisions.begin()].get();
}

const WorstRay* FormSummary::first_fault() const {
    const auto most_frequent = most_frequent_wrong_decision();
    return most_frequent ? first_of(*most_frequent) : nullptr;
}

const WorstRay* FormSummary::worst_ray() const {
    if (const WorstRay* const wrong = first_fault()) return wrong;
    return worst.x < 0 ? nullptr : &worst;
}

unsigned needs_of(const std::vector<const Metric*>& metrics) {
    unsigned needs = metric::needs_nothing;
    for (const Metric* m : metrics) needs |= m->needs;
    return needs;
}

unsigned needs_supported_by(const intersect::table::Intersector& form) {
    return ~((form.ball ? 0U : metric::needs_unrounded) | (form.record ? 0U : metric::needs_tape) |
             (form.bounded ? 0U : metric::needs_bound) |
             (form.deciding_arithmetic ? 0U : metric::needs_deciding_arithmetic) |
             (form.shapes().have_transform() ? 0U : metric::needs_steps) |
             (intersect::bounding_box::has_box(form) ? 0U : metric::needs_levels | metric::needs_end_margin));
}

namespace {

/// Groups of rays with one primitive each, joined into one group whose rays are paired with their primitives.
struct JoinedRays {
    scene::rays::RayGroup rays = {.rays = {}, .primitives = {}, .is_paired = true};
    std::vector<std::size_t> first_rays = {};  ///< index of the first ray of each group

    /// Converts the position of a ray in the joined group to its position in its own group.
    void to_group_position(WorstRay& worst, const std::vector<scene::rays::RayGroup>& groups) const {
        if (worst.x < 0) return;
        const auto i = static_cast<std::size_t>(worst.x);
        const std::size_t g =
            static_cast<std::size_t>(std::ranges::upper_bound(first_rays, i) - first_rays.begin()) - 1;
        const auto width = static_cast<std::size_t>(groups[g].rays.width);
        worst.group = static_cast<int>(g);
        worst.x = static_cast<std::int64_t>((i - first_rays[g]) % width);
        worst.y = groups[g].rays.y0 + static_cast<int>((i - first_rays[g]) / width);
        worst.primitive_index = std::min<std::int64_t>(worst.primitive_index, 0);
    }
};

/// Joins the groups; empty if there is only one, if one of them has several primitives, or if they differ in shape or
/// in the kind of range. Joining pays: the fixed cost of a band is a hundred times the cost of a ray, and ray
/// distributions have a group for each ray.
std::optional<JoinedRays> join(const std::vector<scene::rays::RayGroup>& groups) {
    const auto can_be_joined = [&](const scene::rays::RayGroup& group) {
        return group.primitives.size() == 1 && !group.is_paired && group.rays.size() > 0 && group.rays.width > 0 &&
               group.primitives[0].shape == groups[0].primitives[0].shape &&
               group.rays.tmin.empty() == groups[0].rays.tmin.empty() &&
               group.rays.tmax.empty() == groups[0].rays.tmax.empty() &&
               group.rays.open_ends.tmin == groups[0].rays.open_ends.tmin &&
               group.rays.open_ends.tmax == groups[0].rays.open_ends.tmax;
    };
    if (groups.size() < 2 || groups[0].primitives.empty() || !std::ranges::all_of(groups, can_be_joined))
        return std::nullopt;

    JoinedRays joined;
    scene::rays::RayBlock& rays = joined.rays.rays;
    for (const scene::rays::RayGroup& group : groups) {
        joined.first_rays.push_back(rays.size());
        for (std::size_t i = 0; i < group.rays.size(); ++i) {
            rays.push(group.rays[i]);
            rays.push_range(group.rays, i);
        }
        joined.rays.primitives.insert(joined.rays.primitives.end(), group.rays.size(), group.primitives[0]);
    }
    rays.mark_as_list();
    return joined;
}

/// Measures rows on one band, into the summaries with the same indices.
void measure_band(Band& band, int group, const std::vector<TestedForm>& tested_forms,
                  const std::vector<const Metric*>& metrics, const std::vector<FormSummary*>& summaries) {
    const SharedBandTruth shared(band, tested_forms, metrics);
    for (std::size_t r = 0; r < tested_forms.size(); ++r)
        measure_form({tested_forms[r], metrics, {}, group}, shared.inputs_of(tested_forms[r]), *summaries[r]);
}

/// Measures rows on the rays of one group, into the summaries with the same indices.
void measure_group(scene::rays::RayGroup rays, int group, const std::vector<TestedForm>& tested_forms,
                   const std::vector<const Metric*>& metrics, truth::ProofLimit limit,
                   const std::vector<FormSummary*>& summaries) {
    for (const FormsOfGenerator& forms : group_by_generator(tested_forms)) {
        std::vector<TestedForm> generator_rows;
        std::vector<FormSummary*> row_summaries;
        for (const std::size_t r : forms.form_indices) {
            generator_rows.push_back(tested_forms[r]);
            row_summaries.push_back(summaries[r]);
        }

        // The rays as they are given.
        if (forms.generator == nullptr && !(rays.scene && rays.scene->camera.ray_generator)) {
            std::optional<culling::Culler> culler;
            if (rays.mesh) culler.emplace(scene::rays::primitive_list_of(rays), rays.rays);
            Band band(rays, limit, culler ? &*culler : nullptr);
            measure_band(band, group, generator_rows, metrics, row_summaries);
            continue;
        }

        // The rays that a generator makes for the picture of their scene.
        if (!rays.scene)
            throw InputError(std::string(generator_rows.front().form->info->name) +
                             ": it makes camera rays, and the rays of this sweep do not come from a camera with a "
                             "projection; name a sweep over a scene that has [camera.projection]");
        const scene::file::Scene generated_scene =
            forms.generator ? with_ray_generator(*rays.scene, *forms.generator) : *rays.scene;
        Band band(generated_scene, 0, generated_scene.height, limit);
        measure_band(band, group, generator_rows, metrics, row_summaries);
    }
}

}  // namespace

std::vector<FormSummary> measure_groups(std::vector<scene::rays::RayGroup> groups,
                                        const std::vector<TestedForm>& tested_forms,
                                        const std::vector<const Metric*>& metrics, truth::ProofLimit limit) {
    std::vector<FormSummary> summaries;
    for (std::size_t r = 0; r < tested_forms.size(); ++r) summaries.emplace_back(metrics);

    // Forms that march are not joined: a distance field contains all primitives of a group, for every ray.
    std::optional<JoinedRays> joined = join(groups);
    std::vector<TestedForm> joined_rows, separate_rows;
    std::vector<FormSummary*> joined_summaries, separate_summaries;
    for (std::size_t r = 0; r < tested_forms.size(); ++r) {
        const bool is_joined = joined && is_primitive(tested_forms[r].form->shape);
        (is_joined ? joined_rows : separate_rows).push_back(tested_forms[r]);
        (is_joined ? joined_summaries : separate_summaries).push_back(&summaries[r]);
    }

    // Measures the joined rays, and restores the positions of the rays that are kept.
    if (!joined_rows.empty()) {
        measure_group(std::move(joined->rays), 0, joined_rows, metrics, limit, joined_summaries);
        for (FormSummary* const s : joined_summaries) {
            joined->to_group_position(s->worst, groups);
            for (const auto& fault : s->faults)
                if (fault) joined->to_group_position(*fault, groups);
        }
    }

    for (std::size_t g = 0; !separate_rows.empty() && g < groups.size(); ++g)
        measure_group(std::move(groups[g]), static_cast<int>(g), separate_rows, metrics, limit, separate_summaries);
    for (FormSummary& summary : summaries) {
        summary.view_count = groups.size();
        summary.seal();
    }
    return summaries;
}

}  // namespace lostbits::measure::evaluate
