#include "measure/attribution/culprits.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>

#include "intersect/bounding_box/behind.hpp"
#include "measure/attribution/operation_error.hpp"
#include "measure/attribution/range_on_tape.hpp"
#include "measure/attribution/tape_text.hpp"
#include "measure/truth/missing.hpp"
#include "scene/file/march_table.hpp"
#include "scene/rays/composed_forms.hpp"

namespace lostbits::measure::attribution {

using intersect::Target;
using intersect::table::Intersector;
using truth::missing;

namespace {

/// Hash of what determines the names of a form's operations: their kinds and operands. FNV-1a over 64 bits.
std::uint64_t structure_hash(const Tape& tape) {
    std::uint64_t h = 14695981039346656037u;
    const auto mix = [&h](std::uint64_t x) { h = (h ^ x) * 1099511628211u; };
    for (const TapeNode& node : tape.nodes) {
        mix(static_cast<std::uint64_t>(node.op));
        for (const NodeId operand : node.operands) mix(static_cast<std::uint32_t>(operand));
    }
    return h;
}

/// For each operation its label, or the label that it leads to first.
std::vector<std::string_view> leading_labels(const Tape& tape) {
    std::vector<std::string_view> labels(tape.nodes.size());
    for (NodeId i = tape.size() - 1; i >= 0; --i) {
        const TapeNode& n = tape[i];
        if (!n.label.empty()) labels[i] = n.label;
        // Users come later on the tape. The earliest of them is visited last, so its label stays.
        for (const NodeId operand : tape.operands_of(i)) {
            if (tape[operand].label.empty() && !is_decision(n.op)) labels[operand] = labels[i];
        }
    }
    return labels;
}

std::optional<Target<double>> target_of(const Intersector& form, const Setting& setting) {
    if (!form.is_template()) return std::nullopt;
    if (!is_primitive(form.shape))
        return setting.march ? std::optional(Target<double>(setting.primitives, *setting.march)) : std::nullopt;
    const auto match = std::ranges::find(setting.primitives, form.shape, &Primitive<double>::shape);
    return match == setting.primitives.end() ? std::nullopt : std::optional(Target<double>(*match));
}

/// Records the camera ray of the first pixel in binary32, if formats make the rays of the setting.
std::optional<scene::rays::RecordedRay> record_first_pixel_ray(const Intersector& form, const Setting& setting) {
    const auto* const generator = scene::rays::generator_of(form);
    if (setting.scene == nullptr || !(generator || setting.scene->camera.ray_generator)) return std::nullopt;
    const scene::rays::GeneratedRays rays(generator ? with_ray_generator(*setting.scene, *generator) : *setting.scene);
    return rays.record_ray(*find_format("f32"), {0, 0});
}

/// Records all operations of a form, after those that make its rays. Returns the names of the inputs.
std::vector<std::string> record_all(const Intersector& form, const Target<double>& target, const Setting& setting,
                                    Tape& tape) {
    form.record_all(target, tape);
    auto recorded_ray = record_first_pixel_ray(form, setting);
    const bool begins_with_ray = recorded_ray && form.info->direction != intersect::Direction::unit;
    if (begins_with_ray) recorded_ray->prepend_to(tape);
    std::vector<std::string> names = names_of_inputs(form, target, begins_with_ray ? &*recorded_ray : nullptr);
    if (setting.rays_have_ranges) append_range_checks(tape, names, form, *find_format("f32"), {.tmin = 1, .tmax = 2});
    return names;
}

/// Joins `names` of all forms of a set, each name once.
template <class Names>
auto join_over_parts(const Intersector& set, const Setting& setting, const Names& names) {
    decltype(names(set, setting)) joined;
    for (const Intersector* const part : set.parts) {
        for (const auto& name : names(*part, setting))
            if (std::ranges::find(joined, name) == joined.end()) joined.push_back(name);
    }
    return joined;
}

}  // namespace

OwnedSetting::OwnedSetting(const scene::file::Scene& scene)
    : primitives_(scene::rays::make_shared_primitives(scene)),
      scene_(std::shared_ptr<void>(), &scene),
      rays_have_ranges_(!scene.range.is_whole()) {
    if (scene.march) march_ = scene::file::round_march(*scene.march, binary32);
}

std::vector<std::string> operation_names(const Intersector& form, const Setting& setting) {
    if (form.is_set()) return join_over_parts(form, setting, operation_names);
    std::vector<std::string> operations;
    const auto target = target_of(form, setting);
    if (!target) return operations;
    Tape tape;
    const TapeText text(tape, record_all(form, *target, setting, tape), TapeText::TextStyle::generic);
    for (NodeId i = 0; i < tape.size(); ++i) {
        if (!can_err(tape[i].op)) continue;
        std::string category = text.category(i);
        if (std::ranges::find(operations, category) == operations.end()) operations.push_back(std::move(category));
    }
    return operations;
}

std::vector<std::string_view> labels_of(const Intersector& form, const Setting& setting) {
    if (form.is_set()) return join_over_parts(form, setting, labels_of);
    std::vector<std::string_view> labels;
    const auto target = target_of(form, setting);
    if (!target) return labels;
    Tape tape;
    record_all(form, *target, setting, tape);
    for (const TapeNode& node : tape.nodes) {
        if (!node.label.empty() && std::ranges::find(labels, node.label) == labels.end()) labels.push_back(node.label);
    }
    return labels;
}

std::vector<std::string> names_of_inputs(const Intersector& form, const Target<double>& target,
                                         const scene::rays::RecordedRay* recorded_ray) {
    std::vector<std::string> names = intersect::bounding_box::find_names_on_tape(form, target);
    if (recorded_ray == nullptr) return names;
    names.erase(names.begin(), names.begin() + 6);
    names.insert(names.begin(), recorded_ray->names.begin(), recorded_ray->names.end());
    return names;
}

std::uint64_t count_rays_with_culprit(std::span<const std::uint64_t> counts) {
    return std::accumulate(counts.begin() + 1, counts.end(), std::uint64_t{0});
}

double culprit_fraction(std::span<const std::uint64_t> counts, std::span<const std::size_t> categories) {
    const std::uint64_t total = count_rays_with_culprit(counts);
    std::uint64_t sum = 0;
    for (const std::size_t category : categories) sum += counts[category];
    return truth::fraction(sum, total);
}

double contribution_of(const Tape& tape, const Attribution& attribution, std::string_view label) {
    const auto labels = leading_labels(tape);
    double sum = 0;
    bool has_label = false;
    for (std::size_t i = 0; i < labels.size(); ++i) {
        if (labels[i] != label) continue;
        has_label = true;
        if (attribution.errors[i].is_live) sum += attribution.errors[i].contribution;
    }
    return has_label ? sum : missing;
}

int worst_cancellation(const Attribution& attribution) {
    int worst = 0;
    for (const OperationError& error : attribution.errors) {
        if (error.is_live && error.operands_have_error) worst = std::max(worst, error.cancelled_bits);
    }
    return worst;
}

double cancellation_of(const Tape& tape, const Attribution& attribution, std::string_view label) {
    double worst = missing;
    for (NodeId i = 0; i < tape.size(); ++i) {
        if (tape[i].label != label) continue;
        const OperationError& e = attribution[i];
        worst = std::fmax(worst, e.is_live && e.operands_have_error ? e.cancelled_bits : 0);
    }
    return worst;
}

const std::vector<std::int32_t>& Attributor::categories_of_nodes(
    const std::function<std::vector<std::string>()>& names) {
    const auto [entry, is_new] = categories_by_structure_.try_emplace(structure_hash(tape_));
    if (!is_new) return entry->second;
    const TapeText text(tape_, names(), TapeText::TextStyle::generic);
    for (NodeId i = 0; i < tape_.size(); ++i) {
        const auto category = std::ranges::find(categories_, text.category(i));
        entry->second.push_back(
            category == categories_.end() ? -1 : static_cast<std::int32_t>(category - categories_.begin()));
    }
    return entry->second;
}

RayAttribution Attributor::attribute_ray(const Ray<double>& ray, const Target<double>& target,
                                         const Range<double>& range,
                                         const std::optional<scene::rays::RecordedRay>& recorded_ray) {
    form_.record(format_, ray, target, range.tmax, tape_);

    const bool begins_with_ray = recorded_ray && recorded_ray->try_prepend_to(tape_);
    const auto names_without_range = [&] {
        return names_of_inputs(form_, target, begins_with_ray ? &*recorded_ray : nullptr);
    };

    std::vector<std::string> names;  // computed only where needed
    if (!range.is_whole()) {
        names = names_without_range();
        append_range_checks(tape_, names, form_.form_for(target.primitives.front().shape), format_, range);
    }

    attribution_ = attribute(tape_);
    RayAttribution result{.culprit = missing, .tape = &tape_, .attribution = &attribution_, .ulp = missing};
    const NodeId subject = attribution_.subject;
    if (subject == no_node) return result;
    result.ulp = ulp_at(attribution_[subject].exact, format_.parameters);

    if (with_counterfactuals_ && attribution_.culprit != no_node && subject == tape_.outputs.t)
        result.culprit_alone = run_counterfactuals(tape_, attribution_.culprit);

    // Finds the category of the culprit. A plain miss has none; category 0 means that there is no culprit.
    if (categories_.empty() || is_plain_miss(tape_, attribution_)) return result;
    if (attribution_.culprit == no_node) {
        result.culprit = 0;
        return result;
    }
    const auto all_names = [&] { return names.empty() ? names_without_range() : names; };
    const std::int32_t category = categories_of_nodes(all_names)[attribution_.culprit];
    if (category >= 0) result.culprit = category;
    return result;
}

}  // namespace lostbits::measure::attribution
