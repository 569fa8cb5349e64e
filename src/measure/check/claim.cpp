#include "measure/check/claim.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <map>
#include <tuple>
#include <variant>

#include "intersect/bounding_box/behind.hpp"
#include "intersect/simd/packed.hpp"
#include "intersect/table/sets.hpp"
#include "intersect/transform/transformed_form.hpp"
#include "measure/check/claim_columns.hpp"
#include "measure/check/claim_subjects.hpp"
#include "measure/tape/contraction.hpp"
#include "measure/trade/timing.hpp"
#include "scene/rays/composed_forms.hpp"
#include "text/count_with_noun.hpp"
#include "text/did_you_mean.hpp"

namespace lostbits::measure::check {

using evaluate::TestedForm;
using scene::check::Claim;

namespace {

/// Names a requirement of a claim that this machine does not meet; empty if it meets all of them.
std::string find_unmet_requirement(const Claim& claim) {
    const auto rows = intersect::table::intersectors();
    const auto has_name = [&claim](const intersect::table::Intersector& known) {
        return known.info->name == claim.form;
    };
    if (claim.profile == Claim::Profile::libraries && std::ranges::none_of(rows, has_name))
        return "no loaded library has " + claim.form + "; add --plugin, --pipe, --shader or --function";

    for (const std::string& requirement : claim.requirements) {
        // The source text of a shader names its driver.
        if (requirement.starts_with("driver-")) {
            const auto row = std::ranges::find_if(rows, has_name);
            if (row == rows.end() || row->info->source.find(requirement.substr(7)) == std::string_view::npos)
                return claim.form + " does not run on " + requirement.substr(7);
            continue;
        }

        if (requirement == "processors-2") {
            if (trade::allowed_processors().size() < 2) return "this program may use only one processor";
            continue;
        }

        const auto isa =
            requirement.starts_with("isa-") ? intersect::simd::find_isa(requirement.substr(4)) : std::nullopt;
        if (!isa)
            scene::toml::fail(claim.where, "unknown requirement \"" + requirement +
                                               "\"; write isa-128, isa-256, isa-512, processors-2 or driver-WORDS");
        const auto available = intersect::simd::available_isas();
        if (std::ranges::find(available, *isa) == available.end()) return "this machine has no " + requirement;
    }
    return "";
}

}  // namespace

Format claim_format(const Claim& claim) {
    const auto format = find_format(claim.format);
    if (!format)
        scene::toml::fail(claim.where,
                          "unknown format \"" + claim.format + "\"; write f32, f64, fp16, bf16, tf32 or pN");
    return *format;
}

ClaimResult judge_measured_value(const Claim& claim, double measured, const evaluate::FormSummary* summary) {
    ClaimResult result;
    result.measured = measured;
    if (summary) {
        result.witness = summary->worst;
        // The witness of a wrong decision is its first ray, not the ray with the largest error of t.
        for (std::size_t k = 0; k < evaluate::wrong_decisions.size(); ++k) {
            const auto name = answer::outcome_names[static_cast<std::size_t>(evaluate::wrong_decisions[k])];
            if (claim.metric.starts_with(name) && summary->faults[k]) result.witness = *summary->faults[k];
        }
        if (claim.metric == "wrong_fraction" && summary->first_fault() != nullptr)
            result.witness = *summary->first_fault();
    }

    if (summary && summary->count(answer::Outcome::unresolved) > 0) {
        result.reason = text::count_with_noun(summary->count(answer::Outcome::unresolved), "ray has no proved truth",
                                              "rays have no proved truth");
    } else if (std::isnan(measured)) {
        result.reason = "no ray to measure it on";
    } else {
        result.state = measured >= claim.low && measured <= claim.high ? ClaimResult::State::agrees
                                                                       : ClaimResult::State::disagrees;
    }
    return result;
}

namespace {

/// Finds a part of a composed form, such as its transform method, by its name in the table of such parts.
template <class Row>
std::vector<const Row*> find_part(const Claim& claim, std::span<const Row> table, const std::string& name,
                                  const std::string& kind) {
    std::vector<std::string> names;
    for (const Row& row : table) names.emplace_back(row.info->name);
    const auto found = std::ranges::find(names, name);
    if (found == names.end())
        scene::toml::fail(claim.where, "unknown " + kind + " \"" + name + "\" in form \"" + claim.form + "\"; " +
                                           text::did_you_mean(name, names));
    return {&table[found - names.begin()]};
}

/// Finds a form of the catalogue; null if it has no form with this name.
const intersect::table::Intersector* find_catalogue_form(const std::string& form) {
    const auto rows = intersect::table::intersectors();
    const auto found = std::ranges::find_if(
        rows, [&form](const intersect::table::Intersector& known) { return known.info->name == form; });
    return found == rows.end() ? nullptr : &*found;
}

const intersect::table::Intersector& find_form(const Claim& claim, const std::string& form);

/// Makes a form from the parts that its name consists of.
const intersect::table::Intersector& compose_form(const Claim& claim, const scene::rays::ComposedName& composed) {
    return *rows_of(composed, {.forms = [&](const std::string& name) { return std::vector{&find_form(claim, name)}; },
                               .transform_methods =
                                   [&](const std::string& name) {
                                       return find_part(claim, intersect::transform::transform_methods(), name,
                                                        "transform method");
                                   },
                               .ray_generators =
                                   [&](const std::string& name) {
                                       return find_part(claim, scene::camera::ray_generators(), name, "ray generator");
                                   },
                               .box_methods =
                                   [&](const std::string& name) {
                                       return find_part(claim, intersect::bounding_box::box_methods(), name,
                                                        "bounding-box method");
                                   },
                               .contracted = tape::contract_form})
                .front();
}

[[noreturn]] void fail_unknown_form(const Claim& claim, const std::string& form) {
    std::vector<std::string> known_names;
    for (const intersect::table::Intersector& known : intersect::table::intersectors())
        known_names.emplace_back(known.info->name);
    scene::toml::fail(claim.where, "unknown form \"" + form +
                                       "\" (load a form of your own with --plugin, --pipe, --shader or --function); " +
                                       text::did_you_mean(form, known_names));
}

/// Finds a form by its name: a form of the catalogue, a composed form, or a set of forms joined by `+`.
const intersect::table::Intersector& find_form(const Claim& claim, const std::string& form) {
    if (const auto* const catalogue_form = find_catalogue_form(form)) return *catalogue_form;
    const std::vector<std::string> names = scene::rays::forms_in_name(form);
    if (names.size() == 1) {
        if (const auto composed = scene::rays::split_composed_name(form)) return compose_form(claim, *composed);
        fail_unknown_form(claim, form);
    }

    std::vector<const intersect::table::Intersector*> parts;
    for (const std::string& name : names) parts.push_back(&scene::rays::require_no_generator(find_form(claim, name)));
    if (const std::string refusal = intersect::table::refusal_of_set(parts); !refusal.empty())
        scene::toml::fail(claim.where, "form \"" + form + "\": " + refusal);
    return intersect::table::find_or_add_set(parts);
}

}  // namespace

TestedForm tested_form_of(const Claim& claim) {
    const intersect::table::Intersector& form = find_form(claim, claim.form);
    const Format format = claim_format(claim);
    if (!form.exists_in(format))
        scene::toml::fail(claim.where, claim.form + " does not exist in " + claim.format +
                                           "; `lostbits list forms` shows its formats");
    return {&form, format, claim.convention};
}

void mark_if_unproved(ClaimResult& result, std::uint64_t unproved_count, const char* singular_text,
                      const char* plural_text) {
    if (unproved_count == 0) return;
    result.state = ClaimResult::State::unmeasurable;
    result.reason = text::count_with_noun(unproved_count, singular_text, plural_text);
}

void add_draw(ClaimResult& result, const ClaimResult& draw) {
    result.further_measured.push_back(draw.state == ClaimResult::State::unmeasurable ? truth::missing : draw.measured);
    if (result.state != ClaimResult::State::agrees || draw.state == ClaimResult::State::agrees) return;
    result.state = draw.state;
    result.reason = draw.reason;
    result.witness = draw.witness;
}

metric::Spread expected_interval(const Claim& claim, const ClaimResult& result) {
    metric::Spread interval = result.spread();
    const bool is_onset = !claim.onset.empty(), is_fraction = claim.metric.ends_with("fraction");
    if ((is_onset || is_fraction) && interval.low > 0) {
        const double factor = std::max(std::sqrt(interval.high / interval.low), is_onset ? 1 + 0x1p-9 : 1);
        interval.low /= factor;
        interval.high *= factor;
    } else {
        const double margin = (interval.high - interval.low) / 2;
        interval.low = interval.low < 0 ? interval.low - margin : std::max(0.0, interval.low - margin);
        interval.high += margin;
    }
    if (is_fraction) interval.high = std::min(interval.high, 1.0);
    return interval;
}

namespace {

/// Slow work that a claim about rays needs beyond the default metrics; empty if it needs none. Claims that need the
/// same work are measured together, without the other forms of their scene or sweep: one such metric of a row may take
/// a hundred times as long as all default metrics.
std::string slow_work(const Claim& claim) {
    if (claim.subject_if<scene::check::SceneSubject>() == nullptr &&
        claim.subject_if<scene::check::SweepSubject>() == nullptr)
        return "";
    // Both worst and worst_step may be metrics in worst_step_origin_fraction: the longer name counts.
    const metric::Metric* slow = nullptr;
    for (const metric::Metric& m : metric::metrics()) {
        const bool is_longer = slow == nullptr || m.name.size() > slow->name.size();
        if (!m.is_default && is_longer && claim.metric.starts_with(std::string(m.name) + "_")) slow = &m;
    }
    const bool reruns_form = slow != nullptr && (slow->needs & metric::needs_counterfactuals) != 0;
    if (asks_for_attribution(claim) && !reruns_form) return "the tape of every ray";
    return slow == nullptr ? "" : std::string(slow->name);
}

/// Measures the claims with these indices, all about one subject, and sets their results.
void measure_group(const std::vector<Claim>& claims, const std::vector<std::size_t>& indices,
                   const ClaimRequest& request, std::vector<ClaimResult>& results) {
    std::visit(
        [&]<class Kind>(const Kind&) {
            SubjectClaims<Kind> subject_claims;
            for (const std::size_t i : indices)
                subject_claims.push_back({claims[i], *claims[i].subject_if<Kind>(), results[i]});
            measure(subject_claims, request);
        },
        claims[indices.front()].subject);
}

}  // namespace

std::vector<ClaimResult> measure_claims(const std::vector<Claim>& claims, const ClaimRequest& request) {
    std::vector<ClaimResult> results(claims.size());

    // Groups the claims that can be measured together.
    std::map<std::tuple<std::size_t, std::string, std::string>, std::vector<std::size_t>> groups;
    for (std::size_t i = 0; i < claims.size(); ++i) {
        const Claim& claim = claims[i];
        results[i].reason = find_unmet_requirement(claim);
        if (results[i].reason.empty())
            groups[{claim.subject.index(), claim.subject_name(), slow_work(claim)}].push_back(i);
        else results[i].state = ClaimResult::State::skipped;
    }

    // The claims of a group share its time.
    for (const auto& [subject, indices] : groups) {
        const auto begin = std::chrono::steady_clock::now();
        measure_group(claims, indices, request, results);
        const std::chrono::duration<double> elapsed = std::chrono::steady_clock::now() - begin;
        for (const std::size_t i : indices) results[i].seconds = elapsed.count() / static_cast<double>(indices.size());
    }

    for (std::size_t i = 0; i < claims.size(); ++i) {
        if (claims[i].draws > 0 && results[i].state != ClaimResult::State::skipped && !results[i].is_random())
            scene::toml::fail(claims[i].where,
                              "`draws` belongs to claims about random rays, and this claim draws none; leave it out");
    }
    return results;
}

}  // namespace lostbits::measure::check
