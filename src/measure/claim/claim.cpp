#include "measure/claim/claim.hpp"

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
#include "measure/claim/claim_columns.hpp"
#include "measure/claim/claim_subjects.hpp"
#include "measure/speed/timing.hpp"
#include "measure/tape/contraction.hpp"
#include "scene/rays/composed_forms.hpp"
#include "scene/toml/counted.hpp"
#include "scene/toml/did_you_mean.hpp"

namespace lostbits::measure::claim {

using evaluate::TestedForm;
using scene::claim::Claim;

namespace {

/// Names the requirement of a claim that this machine does not meet; empty if it meets all.
std::string missing_for(const Claim& claim) {
    const auto rows = intersect::table::intersectors();
    const auto named = [&claim](const intersect::table::Intersector& row) { return row.info->name == claim.form; };
    if (claim.profile == Claim::Profile::libraries && std::ranges::none_of(rows, named))
        return "no loaded library has " + claim.form + "; add --plugin, --pipe, --shader or --function";
    for (const std::string& need : claim.requirements) {
        // For a shader: the driver named in its source description.
        if (need.starts_with("driver-")) {
            const auto row = std::ranges::find_if(rows, named);
            if (row == rows.end() || row->info->source.find(need.substr(7)) == std::string_view::npos)
                return claim.form + " does not run on " + need.substr(7);
            continue;
        }
        if (need == "processors-2") {
            if (speed::allowed_processors().size() < 2) return "this program may use only one processor";
            continue;
        }
        const auto isa = need.starts_with("isa-") ? intersect::simd::isa_named(need.substr(4)) : std::nullopt;
        if (!isa)
            scene::toml::fail(claim.where, "unknown requirement \"" + need +
                                               "\"; write isa-128, isa-256, isa-512, processors-2 or driver-WORDS");
        const auto there = intersect::simd::available_isas();
        if (std::ranges::find(there, *isa) == there.end()) return "this machine has no " + need;
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

ClaimResult judge(const Claim& claim, double measured, const evaluate::FormSummary* summary) {
    ClaimResult result;
    result.measured = measured;
    if (summary) {
        result.witness = summary->worst;
        // A wrong decision is shown by its first ray, not by the ray with the largest error of t.
        for (std::size_t k = 0; k < evaluate::wrong_decisions.size(); ++k) {
            const auto name = answer::outcome_names[static_cast<std::size_t>(evaluate::wrong_decisions[k])];
            if (claim.metric.starts_with(name) && summary->faults[k]) result.witness = *summary->faults[k];
        }
        if (claim.metric == "wrong_fraction" && summary->fault() != nullptr) result.witness = *summary->fault();
    }
    if (summary && summary->count(answer::Outcome::unresolved) > 0) {
        result.trouble = scene::toml::counted(summary->count(answer::Outcome::unresolved), "ray has no proved truth",
                                              "rays have no proved truth");
    } else if (std::isnan(measured)) {
        result.trouble = "no ray to measure it on";
    } else {
        result.state = measured >= claim.low && measured <= claim.high ? ClaimResult::State::agrees
                                                                       : ClaimResult::State::disagrees;
    }
    return result;
}

namespace {

/// Finds the row of a table by its name in the name of a form.
template <class Row>
std::vector<const Row*> part_named(const Claim& claim, std::span<const Row> table, const std::string& name,
                                   const std::string& what) {
    std::vector<std::string> names;
    for (const Row& row : table) names.emplace_back(row.info->name);
    const auto found = std::ranges::find(names, name);
    if (found == names.end())
        scene::toml::fail(claim.where, "unknown " + what + " \"" + name + "\" in form \"" + claim.form + "\"; " +
                                           scene::toml::did_you_mean(name, names));
    return {&table[static_cast<std::size_t>(found - names.begin())]};
}

const intersect::table::Intersector& form_named(const Claim& claim, const std::string& form) {
    const auto rows = intersect::table::intersectors();
    const auto found = std::ranges::find_if(
        rows, [&form](const intersect::table::Intersector& row) { return row.info->name == form; });
    if (found != rows.end()) return *found;
    const std::vector<std::string> names = scene::rays::forms_in_name(form);
    if (const auto made = scene::rays::split_composed_name(form); made && names.size() == 1) {
        return *rows_of(*made, {.forms = [&](const std::string& name) { return std::vector{&form_named(claim, name)}; },
                                .transform_methods =
                                    [&](const std::string& name) {
                                        return part_named(claim, intersect::transform::transform_methods(), name,
                                                          "transform method");
                                    },
                                .ray_generators =
                                    [&](const std::string& name) {
                                        return part_named(claim, scene::camera::ray_generators(), name,
                                                          "ray generator");
                                    },
                                .box_methods =
                                    [&](const std::string& name) {
                                        return part_named(claim, intersect::bounding_box::box_methods(), name,
                                                          "bounding-box method");
                                    },
                                .contracted = tape::contracted_row})
                    .front();
    }
    if (names.size() == 1) {
        std::vector<std::string> known;
        for (const intersect::table::Intersector& row : rows) known.emplace_back(row.info->name);
        scene::toml::fail(claim.where,
                          "unknown form \"" + form +
                              "\" (load a form of your own with --plugin, --pipe, --shader or --function); " +
                              scene::toml::did_you_mean(form, known));
    }
    std::vector<const intersect::table::Intersector*> parts;
    for (const std::string& name : names) parts.push_back(&scene::rays::require_no_generator(form_named(claim, name)));
    if (const std::string why = intersect::table::refusal_of_set(parts); !why.empty())
        scene::toml::fail(claim.where, "form \"" + form + "\": " + why);
    return intersect::table::set_of(parts);
}

}  // namespace

TestedForm claim_row(const Claim& claim) {
    const intersect::table::Intersector& form = form_named(claim, claim.form);
    const Format format = claim_format(claim);
    if (!form.exists_in(format))
        scene::toml::fail(claim.where, claim.form + " does not exist in " + claim.format +
                                           "; `lostbits list forms` shows its formats");
    return {&form, format, claim.convention};
}

void require_proof(ClaimResult& result, std::uint64_t unproved, const char* one, const char* several) {
    if (unproved == 0) return;
    result.state = ClaimResult::State::broken;
    result.trouble = scene::toml::counted(unproved, one, several);
}

void add_draw(ClaimResult& result, const ClaimResult& draw) {
    result.further.push_back(draw.state == ClaimResult::State::broken ? truth::missing : draw.measured);
    if (result.state != ClaimResult::State::agrees || draw.state == ClaimResult::State::agrees) return;
    result.state = draw.state;
    result.trouble = draw.trouble;
    result.witness = draw.witness;
}

metric::Spread interval_of(const Claim& claim, const ClaimResult& result) {
    metric::Spread s = result.spread();
    const bool onset = !claim.onset.empty(), fraction = claim.metric.ends_with("fraction");
    if ((onset || fraction) && s.low > 0) {
        const double aside = std::max(std::sqrt(s.high / s.low), onset ? 1 + 0x1p-9 : 1);
        s.low /= aside;
        s.high *= aside;
    } else {
        const double aside = (s.high - s.low) / 2;
        s.low = s.low < 0 ? s.low - aside : std::max(0.0, s.low - aside);
        s.high += aside;
    }
    if (fraction) s.high = std::min(s.high, 1.0);
    return s;
}

namespace {

/// Slow work that a claim about rays needs beyond the default metrics; empty if it needs none. Claims that need the
/// same work are measured together, and the other forms of their scene or sweep are spared it: one such metric of a row
/// may take a hundred times as long as all default ones.
std::string slow_work(const Claim& claim) {
    if (claim.on<scene::claim::SceneSubject>() == nullptr && claim.on<scene::claim::SweepSubject>() == nullptr)
        return "";
    const metric::Metric* slow = nullptr;  // in worst_step_origin_fraction, both worst and worst_step may be metrics:
                                           // the longer name counts
    for (const metric::Metric& m : metric::metrics()) {
        const bool longer = slow == nullptr || m.name.size() > slow->name.size();
        if (!m.by_default && longer && claim.metric.starts_with(std::string(m.name) + "_")) slow = &m;
    }
    const bool runs_again = slow != nullptr && (slow->needs & metric::needs_counterfactuals) != 0;
    if (asks_for_attribution(claim) && !runs_again) return "the tape of every ray";
    return slow == nullptr ? "" : std::string(slow->name);
}

}  // namespace

std::vector<ClaimResult> measure_claims(const std::vector<Claim>& claims, const ClaimRequest& request) {
    std::vector<ClaimResult> results(claims.size());
    std::map<std::tuple<std::size_t, std::string, std::string>, std::vector<std::size_t>> together;
    for (std::size_t i = 0; i < claims.size(); ++i) {
        const Claim& c = claims[i];
        results[i].trouble = missing_for(c);
        if (results[i].trouble.empty()) together[{c.subject.index(), c.subject_name(), slow_work(c)}].push_back(i);
        else results[i].state = ClaimResult::State::skipped;
    }
    for (const auto& [subject, places] : together) {
        const auto begin = std::chrono::steady_clock::now();
        std::visit(
            [&]<class Kind>(const Kind&) {
                SubjectClaims<Kind> some;
                for (const std::size_t i : places) some.push_back({claims[i], *claims[i].on<Kind>(), results[i]});
                measure(some, request);
            },
            claims[places.front()].subject);
        const std::chrono::duration<double> took = std::chrono::steady_clock::now() - begin;
        for (const std::size_t i : places) results[i].seconds = took.count() / static_cast<double>(places.size());
    }
    for (std::size_t i = 0; i < claims.size(); ++i) {
        if (claims[i].draws > 0 && results[i].state != ClaimResult::State::skipped && !results[i].is_drawn())
            scene::toml::fail(claims[i].where,
                              "`draws` belongs to claims about random rays, and this claim draws none; leave it out");
    }
    return results;
}

}  // namespace lostbits::measure::claim
