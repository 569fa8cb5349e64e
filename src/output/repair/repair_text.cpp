#include "output/repair/repair_files.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <sstream>
#include <utility>

#include "measure/attribution/tape_text.hpp"
#include "output/choose/choice_files.hpp"
#include "output/repair/form_code.hpp"
#include "output/repair/tape_code.hpp"
#include "text/count_with_noun.hpp"

namespace lostbits::output::repair {

using measure::attribution::TapeText;

namespace {

TapeText make_tape_text(const RepairSummary& summary) {
    return {summary.repair.tape, input_names_of(*summary.request.tested_form.form), TapeText::TextStyle::plain};
}

/// `22.1 bits, no wrong decision`
std::string quality_text(const FormQuality& quality, const measure::choose::Requirement& requirement) {
    const std::string bits = std::isnan(quality.kept_bits)
                                 ? "no bits, because form and truth agree on no hit"
                                 : choose::kept_bits_text(quality.kept_bits, requirement) + " bits";
    if (quality.wrong_count == 0) return bits + ", no wrong decision";
    return fmt::format("{}, {} of {} decided wrongly", bits, quality.wrong_count,
                       text::count_with_noun(quality.ray_count, "ray"));
}

/// Predicate of a sentence: `keep 22.1 bits and decide no ray wrongly`.
std::string quality_clause(const FormQuality& quality, const measure::choose::Requirement& requirement) {
    const std::string predicate =
        std::isnan(quality.kept_bits)
            ? "agree with the truth on no hit"
            : fmt::format("keep {} bits", choose::kept_bits_text(quality.kept_bits, requirement));
    if (quality.wrong_count == 0) return predicate + " and decide no ray wrongly";
    return fmt::format("{} and decide {} of {} wrongly", predicate, quality.wrong_count,
                       text::count_with_noun(quality.ray_count, "ray"));
}

std::string margin_text(const GrowthMargin& margin, const RepairSummary& summary) {
    const auto growth_name = measure::choose::growth_names[static_cast<std::size_t>(margin.growth)];
    const auto& requirement = summary.request.requirement;
    if (margin.holding_factor == 0)
        return fmt::format("{}: fails already as it is, on a smaller picture: {}", growth_name,
                           quality_text(margin.end_quality, requirement));
    return fmt::format("{}: holds up to a factor of {:.4g} ({:.6g} {})", growth_name, margin.holding_factor,
                       margin.value, margin.growth == measure::choose::Growth::view ? "degrees" : "units of length") +
           choose::margin_end_text(margin, summary.request.rays,
                                   fmt::format("; first broken at a factor of {:.4g}: {}", margin.end_factor,
                                               quality_text(margin.end_quality, requirement)));
}

std::string unchanged_is_enough_text(const RepairSummary& summary) {
    return fmt::format(
        "It meets the requirement as it is: no operation has to be wider.\n{}",
        summary.repair.own_held_out_quality.meets(summary.request.requirement)
            ? ""
            : fmt::format("On {} it does not: {}.\n",
                          summary.request.scene ? "rays that lie between these" : "all rays of the file",
                          quality_text(summary.repair.own_held_out_quality, summary.request.requirement)));
}

/// Change that proposal `k` makes: a patch of the user's file if there is one, otherwise lines of the formula.
std::string change_listing(const RepairSummary& summary, std::size_t k) {
    const measure::repair::Patch* const patch = k < summary.patches.size() ? &summary.patches[k] : nullptr;
    std::string text;
    if (patch == nullptr || patch->diff.empty()) {
        for (const std::string& line : changed_lines(summary, list_proposals(summary)[k].tape))
            text += fmt::format("    {}\n", line);
        if (patch != nullptr && !patch->reason.empty())
            text += fmt::format("  It is not a patch of {}: {}.\n", patch->file, patch->reason);
        return text;
    }
    text = "  As a patch for `patch -p0`; the patched file was compiled and has these operations' bits:\n";
    std::istringstream lines(patch->diff);
    for (std::string line; std::getline(lines, line);) text += fmt::format("    {}\n", line);
    return text;
}

/// Accuracy on the rays that the search did not use. `on_searched` is the accuracy on the rays of the search.
std::string held_out_text(const RepairSummary& summary, const FormQuality& on_searched,
                          const FormQuality& held_out_quality) {
    const auto& repair = summary.repair;
    const std::string rays_text =
        summary.request.scene
            ? fmt::format("{}x{} other pixels, which the search did not use", repair.held_out_scene.width,
                          repair.held_out_scene.height)
            : fmt::format("all {} of the file", text::count_with_noun(summary.request.rays->ray_count, "ray"));
    std::string text = fmt::format("  On {}: {}; without the change: {}.\n", rays_text,
                                   quality_text(held_out_quality, summary.request.requirement),
                                   quality_text(repair.own_held_out_quality, summary.request.requirement));
    if (on_searched.meets(summary.request.requirement) && !held_out_quality.meets(summary.request.requirement))
        text += fmt::format("  There it does not meet the requirement: it was found for the {} only.\n",
                            summary.request.scene ? "pixels of this scene" : "rays that the search kept");
    return text;
}

std::string margins_text(const std::vector<GrowthMargin>& margins, const RepairSummary& summary) {
    if (margins.empty()) return "";
    const auto ray_count = summary.request.scene ? measure::choose::with_smaller_picture(
                                                       *summary.request.scene, measure::repair::few_rays_count)
                                                       .pixel_count()
                                                 : summary.request.rays->sample.rays.size();
    std::string text =
        fmt::format("  How far it holds on {} of the {} as {}:\n", text::count_with_noun(ray_count, "ray"),
                    summary.request.scene ? "scene" : "file", summary.request.scene ? "it is" : "they are");
    for (const GrowthMargin& margin : margins) text += fmt::format("  {}.\n", margin_text(margin, summary));
    return text;
}

/// Lists the probes on whose rays the form meets the requirement, and those on whose rays it fails.
std::string probes_text(const RepairSummary& summary, const std::vector<FormQuality>& probe_qualities) {
    const auto& requirement = summary.request.requirement;
    if (summary.repair.probes.empty())
        return "  Exchanged axes were not tried: the scene has a sphereflake, a mesh from a file, or more than 1024 "
               "primitives.\n";

    // Neighbouring probes that fail alike share a sentence.
    std::vector<std::string> met_probes;
    std::vector<std::pair<std::string, std::vector<std::string>>> failed_probes;  // each quality, and its probes
    for (std::size_t k = 0; k < probe_qualities.size(); ++k) {
        const std::string probe_text(summary.repair.probes[k]->description);
        const std::string quality = quality_text(probe_qualities[k], requirement);
        if (probe_qualities[k].meets(requirement)) met_probes.push_back(probe_text);
        else if (!failed_probes.empty() && failed_probes.back().first == quality)
            failed_probes.back().second.push_back(probe_text);
        else failed_probes.push_back({quality, {probe_text}});
    }

    std::string text;
    const std::string condition = fmt::format("if rays and primitives are moved together ({})",
                                              text::count_with_noun(summary.repair.probed_ray_count, "ray"));
    if (!met_probes.empty()) text += fmt::format("  It also holds {}: {}.\n", condition, fmt::join(met_probes, "; "));
    for (const auto& [quality, probes] : failed_probes)
        text += fmt::format("  It fails {}: {}. Then it keeps {}.\n", condition, fmt::join(probes, "; "), quality);
    return text;
}

std::string symmetric_set_text(const RepairSummary& summary) {
    const auto& repair = summary.repair;
    if (list_proposals(summary).front().meets_on_exact_probes(summary)) return "";
    if (!repair.symmetric)
        return "  It is not symmetric, and no set that treats x, y and z alike was found in its place.\n";

    // The symmetric set and its changes.
    const auto& symmetric_set = *repair.symmetric;
    std::string text = fmt::format(
        "  It is not symmetric: it was found for the axes as they are.\nWith {} of its {} operations in {}, the same "
        "ones for x, y and z, it keeps {}.\n  Statements with wider operations: {}.\n",
        symmetric_set.operations.size(), repair.rounding_operation_count, wider_format_name(repair.wider),
        quality_text(symmetric_set.quality, summary.request.requirement),
        statement_names(summary, symmetric_set.operations));
    text += change_listing(summary, summary.has_wider_set() ? 1 : 0);

    // How small it is, and how well it does elsewhere.
    text += fmt::format("  These are {} of its {} groups of operations that are alike up to an exchange of axes; {}.\n",
                        symmetric_set.group_count, symmetric_set.total_group_count,
                        symmetric_set.is_smallest ? "no groups with fewer operations are enough (all were tried)"
                                                  : "none of these can be spared");
    return text + probes_text(summary, symmetric_set.probe_qualities) +
           held_out_text(summary, symmetric_set.quality, symmetric_set.held_out_quality) +
           margins_text(summary.symmetric_margins, summary);
}

/// How small the wider set is: no operation of it can be left out, and which smaller sets were tried.
std::string wider_set_size_text(const measure::repair::WiderSet& set, const measure::choose::Requirement& requirement) {
    const std::size_t size = set.operations.size();
    const auto best = std::ranges::min_element(set.quality_without, measure::repair::is_more_accurate);
    std::string text = fmt::format(
        "  No operation can be spared: if any one of the {} is not widened, the requirement fails; the best of these "
        "{} variants keeps {}.\n",
        size, size, quality_text(*best, requirement));
    if (set.largest_failing_size == 0) return text;

    const std::string smaller_sets = set.largest_failing_size == 1
                                         ? "No operation alone"
                                         : fmt::format("No set of {} or fewer", set.largest_failing_size);
    return text + fmt::format("  {} is enough (all were tried){}.\n", smaller_sets,
                              set.largest_failing_size + 1 == size ? ", so this set is one of the smallest"
                                                                   : "; sets of sizes between were not all tried");
}

std::string wider_set_text(const RepairSummary& summary) {
    const auto& repair = summary.repair;
    const auto& requirement = summary.request.requirement;

    // The set, its changes and its size.
    std::string text = fmt::format(
        "With {} of its {} operations in {} it keeps {} ({} with all of them).\n", repair.wider_set->operations.size(),
        repair.rounding_operation_count, wider_format_name(repair.wider),
        quality_text(repair.wider_set->quality, requirement), quality_text(repair.all_wider_quality, requirement));
    text += fmt::format("  Statements with wider operations: {}.\n",
                        statement_names(summary, repair.wider_set->operations));
    text += change_listing(summary, 0);
    text += wider_set_size_text(*repair.wider_set, requirement);

    // How well it does on other rays, and in larger scenes.
    return text + held_out_text(summary, repair.wider_set->quality, repair.set_held_out_quality) +
           probes_text(summary, repair.set_probe_qualities) + margins_text(summary.margins, summary) +
           symmetric_set_text(summary);
}

/// Sentence or two on the errors that remain if the operations of the form do not round.
std::string obstruction_text(const RepairSummary& summary) {
    const auto& requirement = summary.request.requirement;
    const auto& [exact, with_unit_directions, largest_length_error] = *summary.repair.obstruction;
    const auto& form = *summary.request.tested_form.form->info;

    // Requirements that no precision can meet.
    if (summary.repair.own_quality.true_hit_count == 0)
        return "  In the way: no ray truly hits anything, so no t has bits to keep.\n";
    if (requirement.bits > summary.request.tested_form.format.parameters.precision)
        return fmt::format("  In the way: {} has {} bits. Try a wider format.\n",
                           summary.request.tested_form.format.name,
                           summary.request.tested_form.format.parameters.precision);

    // Results of the operations without any rounding.
    std::string exact_text = "without any rounding, its operations " + quality_clause(exact, requirement);
    if (exact.wrong_count > 0)
        exact_text +=
            fmt::format(" ({} of these are {})", exact.main_fault_count,
                        exact.main_fault == measure::answer::Outcome::false_hit ? "false hits" : "missed hits");

    // The cause: rounded directions, the formula, or more rounding than the wider format removes.
    if (with_unit_directions && !exact.meets(requirement) &&
        measure::repair::is_more_accurate(*with_unit_directions, exact))
        return fmt::format(
            "  In the way: {} assumes directions of length one, but after rounding to {} their lengths differ from one "
            "by up to {:.2g}. On a sample, {}; with directions of length one to 53 bits, they {}.\n",
            form.name, summary.request.tested_form.format.name, largest_length_error, exact_text,
            quality_clause(*with_unit_directions, requirement));
    if (!exact.meets(requirement))
        return fmt::format("  In the way: the formula itself, at any precision. On a sample, {}.\n", exact_text);
    return fmt::format("  In the way: more rounding than {} removes. On a sample, {}; a wider format is needed.\n",
                       wider_format_name(summary.repair.wider), exact_text);
}

std::string rewritten_text(const RepairSummary& summary, std::size_t k) {
    const auto& rewritten = summary.repair.rewriting.forms[k];
    const std::string wider_text =
        rewritten.wider_set ? fmt::format(", {} of it in {},",
                                          text::count_with_noun(rewritten.wider_set->operations.size(), "operation"),
                                          wider_format_name(summary.repair.wider))
                            : "";
    std::string text = fmt::format("Written another way{} it keeps {}; {} instead of {}.\n", wider_text,
                                   quality_text(rewritten.quality, summary.request.requirement),
                                   text::count_with_noun(rewritten.rounding_operation_count, "operation"),
                                   summary.repair.rounding_operation_count);
    if (!rewritten.quality.meets(summary.request.requirement))
        return text + fmt::format("  That does not meet the requirement. Rules: {}.\n", rule_names(rewritten));

    // Each rule once, although it may have been applied several times.
    std::set<const measure::identity::Rule*> listed_rules;
    for (const measure::identity::Rule* rule : rewritten.rules) {
        if (!listed_rules.insert(rule).second) continue;
        text += fmt::format("  {}: {}{}{}.\n", rule->name, rule->identity, rule->condition.empty() ? "" : "; where ",
                            rule->condition);
    }

    // Its changes, and its quality on other rays.
    text += change_listing(summary, list_proposals(summary).size() - summary.repair.rewriting.forms.size() + k);
    text += held_out_text(summary, rewritten.quality, rewritten.held_out_quality) +
            probes_text(summary, rewritten.probe_qualities);
    return k < summary.rewritten_margins.size() ? text + margins_text(summary.rewritten_margins[k], summary) : text;
}

/// Sentence on the most accurate form of the catalogue; empty if the catalogue has none for these primitives.
std::string catalogue_text(const RepairSummary& summary) {
    if (summary.catalogue.empty()) return "";
    const auto& requirement = summary.request.requirement;
    const auto meeting_count = std::ranges::count_if(
        summary.catalogue_quality, [&](const FormQuality& quality) { return quality.meets(requirement); });
    return fmt::format(
        "The most accurate form of the catalogue in {} is {}: {}. Of its {} forms {} meet the requirement.\n",
        summary.request.tested_form.format.name, summary.catalogue.front().form->info->name,
        quality_text(summary.catalogue_quality.front(), requirement), summary.catalogue.size(), meeting_count);
}

/// Times of a form: `1.2 ns a ray in packs of 512 bits (0.8 times the form's time), 4.1 ns alone (0.9 times)`.
std::string price_text(const Price& price, const Price& form_price) {
    return fmt::format(
        "{:.3g} ns a ray in packs of {} bits ({:.2f} times the form's time), {:.3g} ns alone ({:.2f} times)",
        price.packed.median * 1e9, price.isa, price.packed.median / form_price.packed.median, price.single.median * 1e9,
        price.single.median / form_price.single.median);
}

std::string prices_text(const RepairSummary& summary) {
    if (!summary.no_price_reason.empty()) return fmt::format("No price: {}\n", summary.no_price_reason);
    if (summary.prices.empty()) return "";

    // Forms on the front come first.
    const Price& form_price = summary.prices.front();
    std::string text =
        "These forms were compiled, compared bit by bit with their recorded operations on all rays, and timed (*: no "
        "other is both as accurate and as fast):\n";
    std::string other_lines;
    for (const FormRow& row : make_form_rows(summary)) {
        if (!row.price || !row.is_shown) continue;
        (row.is_on_pareto_front ? text : other_lines) +=
            fmt::format("  {}{}: {}; {}.\n", row.is_on_pareto_front ? "* " : "",
                        row.kind == "wider" ? "in " + wider_format_name(summary.repair.wider) : row.name,
                        quality_text(*row.quality, summary.request.requirement), price_text(*row.price, form_price));
    }
    return text + other_lines;
}

}  // namespace

std::string wider_format_name(const FloatFormat& wider) {
    if (wider == measure::tape::two_floats) return "two floats";
    return wider == measure::tape::two_doubles ? "two doubles" : "double";
}

std::string operation_text(const RepairSummary& summary, NodeId operation) {
    return make_tape_text(summary).definition(operation);
}

std::vector<std::string> changed_lines(const RepairSummary& summary, const Tape& changed) {
    const auto& form = *summary.request.tested_form.form;
    return changed_lines(statements(summary.repair.tape, form), statements(changed, form, &summary.repair.tape));
}

RepairSummary summarise_repair(const measure::repair::RepairRequest& request,
                               const measure::repair::RepairResult& repair) {
    RepairSummary summary{.request = request, .repair = repair, .catalogue = {}, .catalogue_quality = {}};
    for (const auto& [row, quality] : rank_catalogue(request)) {
        summary.catalogue.push_back(row);
        summary.catalogue_quality.push_back(quality);
    }

    for (const Proposal& proposal : list_proposals(summary)) {
        std::vector<GrowthMargin> margins;
        if (proposal.quality->meets(request.requirement)) margins = find_margins_of_tape(request, proposal.tape);
        if (proposal.rewritten) summary.rewritten_margins.push_back(std::move(margins));
        else if (proposal.is_symmetric_set) summary.symmetric_margins = std::move(margins);
        else summary.margins = std::move(margins);
    }

    // Patches are made only for a function of a user's file.
    measure::repair::Patcher patcher(request, repair.tape);
    if (!patcher.can_write()) return summary;
    for (const Proposal& proposal : list_proposals(summary))
        summary.patches.push_back(proposal.quality->meets(request.requirement) ? patcher.make_patch(proposal.tape)
                                                                               : measure::repair::Patch());
    return summary;
}

std::vector<Proposal> list_proposals(const RepairSummary& summary) {
    std::vector<Proposal> proposals;
    const auto& repair = summary.repair;
    if (summary.has_wider_set())
        proposals.push_back({.tape = widen_operations(repair, repair.wider_set->operations),
                             .quality = &repair.wider_set->quality,
                             .held_out_quality = &repair.set_held_out_quality,
                             .probe_qualities = &repair.set_probe_qualities,
                             .wider_operations = &repair.wider_set->operations});
    if (const auto& set = repair.symmetric)
        proposals.push_back({.tape = widen_operations(repair, set->operations),
                             .quality = &set->quality,
                             .held_out_quality = &set->held_out_quality,
                             .probe_qualities = &set->probe_qualities,
                             .wider_operations = &set->operations,
                             .is_symmetric_set = true});
    for (const auto& rewritten : repair.rewriting.forms)
        proposals.push_back({.tape = rewritten.tape,
                             .quality = &rewritten.quality,
                             .held_out_quality = &rewritten.held_out_quality,
                             .probe_qualities = &rewritten.probe_qualities,
                             .rewritten = &rewritten});

    // The first price is that of the form itself.
    for (std::size_t k = 0; k < proposals.size() && !summary.prices.empty(); ++k)
        proposals[k].price = &summary.prices[k + 1];
    return proposals;
}

bool Proposal::meets_on_exact_probes(const RepairSummary& summary) const {
    const auto& probes = summary.repair.probes;
    for (std::size_t k = 0; k < probes.size(); ++k)
        if (probes[k]->is_exact() && !(*probe_qualities)[k].meets(summary.request.requirement)) return false;
    return true;
}

const Proposal* best_proposal(const std::vector<Proposal>& proposals, const RepairSummary& summary) {
    const auto rank = [&](const Proposal& proposal) {
        const double operations =
            proposal.rewritten ? static_cast<double>(proposal.rewritten->rounding_operation_count) : HUGE_VAL;
        return std::pair(!proposal.meets_on_exact_probes(summary),
                         proposal.price ? proposal.price->packed.median : operations);
    };
    const Proposal* best = nullptr;
    for (const Proposal& proposal : proposals)
        if (proposal.quality->meets(summary.request.requirement) && (!best || rank(proposal) < rank(*best)))
            best = &proposal;
    return best;
}

std::string rule_names(const measure::repair::RewrittenForm& rewritten) {
    std::vector<std::string_view> names;
    for (const auto* rule : rewritten.rules) names.push_back(rule->name);
    if (rewritten.wider_set)
        return fmt::format("{}, {} wider", fmt::join(names, ", "), rewritten.wider_set->operations.size());
    return fmt::format("{}", fmt::join(names, ", "));
}

// Names each operation by the statement that it belongs to, in order.
std::string statement_names(const RepairSummary& summary, const std::vector<NodeId>& operations) {
    const Tape& tape = summary.repair.tape;
    std::vector<std::string> names;
    std::set<std::string> listed_names;
    for (const NodeId i : operations) {
        NodeId owner = i;
        // Follow the result to the first named operation that uses it, as maps of culprits do.
        for (NodeId k = i; k < tape.size() && tape[owner].label.empty(); ++k) {
            const auto& operands = tape[k].operands;
            if (!is_given(tape[k].op) && std::ranges::find(operands, owner) != operands.end()) owner = k;
        }
        const std::string name = std::string(tape[owner].label.empty() ? "an unnamed operation" : tape[owner].label);
        if (listed_names.insert(name).second) names.push_back(name);
    }
    return fmt::format("{}", fmt::join(names, ", "));
}

std::string method_text(const RepairSummary& summary, const Proposal& proposal) {
    const auto& repair = summary.repair;
    if (proposal.rewritten) return "written another way: " + rule_names(*proposal.rewritten);
    return fmt::format("{} of its {} operations in {}{}", proposal.wider_operations->size(),
                       repair.rounding_operation_count, wider_format_name(repair.wider),
                       proposal.is_symmetric_set ? ", the same ones for x, y and z" : "");
}

std::string repair_text(const RepairSummary& summary) {
    const auto& requirement = summary.request.requirement;
    const auto& repair = summary.repair;
    std::string text =
        fmt::format("{}: {}\n{} in {} keeps {}.\n", summary.request.id(), choose::requirement_text(requirement),
                    summary.request.tested_form.form->info->name, summary.request.tested_form.format.name,
                    quality_text(repair.own_quality, requirement));

    // Wider operations: what they achieve, or what is in the way.
    if (!repair.wider_set)
        text += fmt::format("Even with all of its {} operations in {} it does not meet the requirement: {}.\n{}",
                            repair.rounding_operation_count, wider_format_name(repair.wider),
                            quality_text(repair.all_wider_quality, requirement), obstruction_text(summary));
    else text += repair.wider_set->operations.empty() ? unchanged_is_enough_text(summary) : wider_set_text(summary);
    if (repair.wider_set && repair.wider_set->operations.empty())
        text += probes_text(summary, repair.own_probe_qualities);

    // Other forms, and times.
    for (std::size_t k = 0; k < repair.rewriting.forms.size(); ++k) text += rewritten_text(summary, k);
    text += catalogue_text(summary);
    text += prices_text(summary);
    return text + fmt::format("Tried {} on all {}.\n", text::count_with_noun(repair.tried_count, "candidate"),
                              text::count_with_noun(summary.request.scene ? summary.request.scene->pixel_count()
                                                                          : summary.request.rays->sample.rays.size(),
                                                    "ray"));
}

}  // namespace lostbits::output::repair
