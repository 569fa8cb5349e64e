#include "output/repair/repair_files.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <sstream>
#include <utility>

#include "measure/attribution/tape_text.hpp"
#include "output/choice/choice_files.hpp"
#include "output/repair/form_code.hpp"
#include "output/repair/tape_code.hpp"
#include "scene/toml/counted.hpp"

namespace lostbits::output::repair {

using measure::attribution::TapeText;

namespace {

TapeText text_of(const RepairSummary& r) {
    return {r.repair.tape, input_names_of(*r.request.row.form), TapeText::Style::plain};
}

/// `22.1 bits, no wrong decision`
std::string in_words(const RowQuality& quality, const measure::choice::Requirement& requirement) {
    const std::string bits = std::isnan(quality.kept_bits)
                                 ? "no bits, because form and truth agree on no hit"
                                 : choice::bits_text_near(quality.kept_bits, requirement) + " bits";
    if (quality.wrong == 0) return bits + ", no wrong decision";
    return fmt::format("{}, {} of {} decided wrongly", bits, quality.wrong,
                       scene::toml::count_with_noun(quality.rays, "ray"));
}

/// Predicate of a sentence: `keep 22.1 bits and decide no ray wrongly`.
std::string as_clause(const RowQuality& quality, const measure::choice::Requirement& requirement) {
    const std::string predicate =
        std::isnan(quality.kept_bits)
            ? "agree with the truth on no hit"
            : fmt::format("keep {} bits", choice::bits_text_near(quality.kept_bits, requirement));
    if (quality.wrong == 0) return predicate + " and decide no ray wrongly";
    return fmt::format("{} and decide {} of {} wrongly", predicate, quality.wrong,
                       scene::toml::count_with_noun(quality.rays, "ray"));
}

std::string margin_text(const GrowthMargin& margin, const RepairSummary& r) {
    const auto growth_name = measure::choice::growth_names[static_cast<std::size_t>(margin.growth)];
    const auto& requirement = r.request.requirement;
    if (margin.holds == 0)
        return fmt::format("{}: fails already as it is, on a smaller picture: {}", growth_name,
                           in_words(margin.broken, requirement));
    return fmt::format("{}: holds up to a factor of {:.4g} ({:.6g} {})", growth_name, margin.holds, margin.value,
                       margin.growth == measure::choice::Growth::view ? "degrees" : "units of length") +
           choice::margin_end_text(margin, r.request.rays,
                                   fmt::format("; first broken at a factor of {:.4g}: {}", margin.beyond,
                                               in_words(margin.broken, requirement)));
}

std::string unchanged_is_enough_text(const RepairSummary& r) {
    return fmt::format("It meets the requirement as it is: no operation has to be wider.\n{}",
                       r.repair.own_held_out.meets(r.request.requirement)
                           ? ""
                           : fmt::format("On {} it does not: {}.\n",
                                         r.request.scene ? "rays that lie between these" : "all rays of the file",
                                         in_words(r.repair.own_held_out, r.request.requirement)));
}

/// Text of the change of a proposal: a patch of the user's file if there is one, otherwise lines of the formula.
std::string change_lines(const RepairSummary& r, std::size_t k) {
    const measure::repair::Patch* const patch = k < r.patches.size() ? &r.patches[k] : nullptr;
    std::string text;
    if (patch == nullptr || patch->diff.empty()) {
        for (const std::string& line : changed_lines(r, proposals_of(r)[k].tape)) text += fmt::format("    {}\n", line);
        if (patch != nullptr && !patch->reason.empty())
            text += fmt::format("  It is not a patch of {}: {}.\n", patch->file, patch->reason);
        return text;
    }
    text = "  As a patch for `patch -p0`; the patched file was compiled and has these operations' bits:\n";
    std::istringstream lines(patch->diff);
    for (std::string line; std::getline(lines, line);) text += fmt::format("    {}\n", line);
    return text;
}

/// Accuracy on the rays that the search did not use; `on_searched` is that on the rays of the search.
std::string held_out_text(const RepairSummary& r, const RowQuality& on_searched, const RowQuality& held_out) {
    const auto& repair = r.repair;
    const std::string where =
        r.request.scene ? fmt::format("{}x{} other pixels, which the search did not use", repair.held_out_scene.width,
                                      repair.held_out_scene.height)
                        : fmt::format("all {} of the file", scene::toml::count_with_noun(r.request.rays->rays, "ray"));
    std::string text =
        fmt::format("  On {}: {}; without the change: {}.\n", where, in_words(held_out, r.request.requirement),
                    in_words(repair.own_held_out, r.request.requirement));
    if (on_searched.meets(r.request.requirement) && !held_out.meets(r.request.requirement))
        text += fmt::format("  There it does not meet the requirement: it was found for the {} only.\n",
                            r.request.scene ? "pixels of this scene" : "rays that the search kept");
    return text;
}

std::string margins_text(const std::vector<GrowthMargin>& margins, const RepairSummary& r) {
    if (margins.empty()) return "";
    const auto ray_count =
        r.request.scene ? measure::choice::with_smaller_picture(*r.request.scene, measure::repair::few_rays).pixels()
                        : r.request.rays->sample.rays.size();
    std::string text =
        fmt::format("  How far it holds on {} of the {} as {}:\n", scene::toml::count_with_noun(ray_count, "ray"),
                    r.request.scene ? "scene" : "file", r.request.scene ? "it is" : "they are");
    for (const GrowthMargin& margin : margins) text += fmt::format("  {}.\n", margin_text(margin, r));
    return text;
}

/// Probes on whose rays the form holds, and those on whose rays it fails.
std::string probes_text(const RepairSummary& r, const std::vector<RowQuality>& probed) {
    const auto& requirement = r.request.requirement;
    if (r.repair.probes.empty())
        return "  Exchanged axes were not tried: the scene has a sphereflake, a mesh from a file, or more than 1024 "
               "primitives.\n";
    std::vector<std::string> holds;
    std::vector<std::pair<std::string, std::vector<std::string>>> fails;  // by quality, the probes with that quality
    for (std::size_t k = 0; k < probed.size(); ++k) {
        const std::string probe_text(r.repair.probes[k]->description), quality = in_words(probed[k], requirement);
        if (probed[k].meets(requirement)) holds.push_back(probe_text);
        else if (!fails.empty() && fails.back().first == quality) fails.back().second.push_back(probe_text);
        else fails.push_back({quality, {probe_text}});
    }
    std::string text;
    const std::string moved = fmt::format("if rays and primitives are moved together ({})",
                                          scene::toml::count_with_noun(r.repair.probed_rays, "ray"));
    if (!holds.empty()) text += fmt::format("  It also holds {}: {}.\n", moved, fmt::join(holds, "; "));
    for (const auto& [quality, probes] : fails)
        text += fmt::format("  It fails {}: {}. Then it keeps {}.\n", moved, fmt::join(probes, "; "), quality);
    return text;
}

std::string symmetric_set_text(const RepairSummary& r) {
    const auto& repair = r.repair;
    if (proposals_of(r).front().is_symmetric(r)) return "";
    if (!repair.symmetric)
        return "  It is not symmetric, and no set that treats x, y and z alike was found in its place.\n";
    const auto& set = *repair.symmetric;
    std::string text = fmt::format(
        "  It is not symmetric: it was found for the axes as they are.\nWith {} of its {} operations in {}, the same "
        "ones for x, y and z, it keeps {}.\n  Statements with wider operations: {}.\n",
        set.operations.size(), repair.operations, name_of_wider(repair.wider),
        in_words(set.quality, r.request.requirement), names_of(r, set.operations));
    text += change_lines(r, r.has_set() ? 1 : 0);
    text += fmt::format("  These are {} of its {} groups of operations that are alike up to an exchange of axes; {}.\n",
                        set.groups, set.all_groups,
                        set.is_smallest ? "no groups with fewer operations are enough (all were tried)"
                                        : "none of these can be spared");
    return text + probes_text(r, set.probed) + held_out_text(r, set.quality, set.held_out) +
           margins_text(r.symmetric_margins, r);
}

std::string wider_set_text(const RepairSummary& r) {
    const auto& repair = r.repair;
    const auto& requirement = r.request.requirement;
    const std::string wider = name_of_wider(repair.wider);
    const std::size_t size = repair.wider_set->operations.size();
    std::string text = fmt::format("With {} of its {} operations in {} it keeps {} ({} with all of them).\n", size,
                                   repair.operations, wider, in_words(repair.wider_set->quality, requirement),
                                   in_words(repair.all_wider_quality, requirement));
    text += fmt::format("  Statements with wider operations: {}.\n", names_of(r, repair.wider_set->operations));
    text += change_lines(r, 0);
    const auto best = std::ranges::min_element(repair.wider_set->quality_without, measure::repair::is_more_accurate);
    text += fmt::format(
        "  No operation can be spared: if any one of the {} is not widened, the requirement fails; the best of these "
        "{} "
        "variants keeps {}.\n",
        size, size, in_words(*best, requirement));
    if (repair.wider_set->largest_failing_size > 0) {
        const std::string sets = repair.wider_set->largest_failing_size == 1
                                     ? "No operation alone"
                                     : fmt::format("No set of {} or fewer", repair.wider_set->largest_failing_size);
        text += fmt::format("  {} is enough (all were tried){}.\n", sets,
                            repair.wider_set->largest_failing_size + 1 == size
                                ? ", so this set is one of the smallest"
                                : "; sets of sizes between were not all tried");
    }
    return text + held_out_text(r, repair.wider_set->quality, repair.set_held_out) + probes_text(r, repair.set_probed) +
           margins_text(r.margins, r) + symmetric_set_text(r);
}

/// Says in a sentence or two what remains wrong if the form's operations do not round.
std::string obstruction_text(const RepairSummary& r) {
    const auto& requirement = r.request.requirement;
    const auto& [exact, with_unit_directions, largest_length_error] = *r.repair.obstruction;
    const auto& form = *r.request.row.form->info;
    if (r.repair.own_quality.hits == 0) return "  In the way: no ray truly hits anything, so no t has bits to keep.\n";
    if (requirement.bits > r.request.row.format.parameters.precision)
        return fmt::format("  In the way: {} has {} bits. Try a wider format.\n", r.request.row.format.name,
                           r.request.row.format.parameters.precision);
    std::string exact_text = "without any rounding, its operations " + as_clause(exact, requirement);
    if (exact.wrong > 0)
        exact_text +=
            fmt::format(" ({} of these are {})", exact.main_fault_count,
                        exact.main_fault == measure::answer::Outcome::false_hit ? "false hits" : "missed hits");
    if (with_unit_directions && !exact.meets(requirement) &&
        measure::repair::is_more_accurate(*with_unit_directions, exact))
        return fmt::format(
            "  In the way: {} assumes directions of length one, but after rounding to {} their lengths differ from one "
            "by up to {:.2g}. "
            "On a sample, {}; with directions of length one to 53 bits, they {}.\n",
            form.name, r.request.row.format.name, largest_length_error, exact_text,
            as_clause(*with_unit_directions, requirement));
    if (!exact.meets(requirement))
        return fmt::format("  In the way: the formula itself, at any precision. On a sample, {}.\n", exact_text);
    return fmt::format("  In the way: more rounding than {} removes. On a sample, {}; a wider format is needed.\n",
                       name_of_wider(r.repair.wider), exact_text);
}

std::string rewritten_text(const RepairSummary& r, std::size_t k) {
    const auto& rewritten = r.repair.rewriting.forms[k];
    const std::string wider_text =
        rewritten.wider_set
            ? fmt::format(", {} of it in {},",
                          scene::toml::count_with_noun(rewritten.wider_set->operations.size(), "operation"),
                          name_of_wider(r.repair.wider))
            : "";
    std::string text =
        fmt::format("Written another way{} it keeps {}; {} instead of {}.\n", wider_text,
                    in_words(rewritten.quality, r.request.requirement),
                    scene::toml::count_with_noun(rewritten.operations, "operation"), r.repair.operations);
    if (!rewritten.quality.meets(r.request.requirement))
        return text + fmt::format("  That does not meet the requirement. Rules: {}.\n", rules_of(rewritten));
    std::set<const measure::identity::Rule*> listed;
    for (const measure::identity::Rule* rule : rewritten.rules) {
        if (!listed.insert(rule).second) continue;
        text += fmt::format("  {}: {}{}{}.\n", rule->name, rule->identity, rule->condition.empty() ? "" : "; where ",
                            rule->condition);
    }
    text += change_lines(r, proposals_of(r).size() - r.repair.rewriting.forms.size() + k);
    text += held_out_text(r, rewritten.quality, rewritten.held_out) + probes_text(r, rewritten.probed);
    return k < r.rewritten_margins.size() ? text + margins_text(r.rewritten_margins[k], r) : text;
}

/// Times of a form: `1.2 ns a ray in packs of 512 bits (0.8 times the form's time), 4.1 ns alone (0.9 times)`.
std::string price_text(const Price& price, const Price& form_price) {
    return fmt::format(
        "{:.3g} ns a ray in packs of {} bits ({:.2f} times the form's time), {:.3g} ns alone ({:.2f} times)",
        price.packed.median * 1e9, price.isa, price.packed.median / form_price.packed.median, price.single.median * 1e9,
        price.single.median / form_price.single.median);
}

std::string prices_text(const RepairSummary& r) {
    if (!r.no_price.empty()) return fmt::format("No price: {}\n", r.no_price);
    if (r.prices.empty()) return "";
    const Price& form_price = r.prices.front();
    std::string text =
        "These forms were compiled, compared bit by bit with their recorded operations on all rays, and timed (*: no "
        "other "
        "is both as accurate and as fast):\n";
    std::string other_lines;
    for (const FormRow& row : rows_of(r)) {
        if (!row.price || !row.is_shown) continue;
        (row.front ? text : other_lines) +=
            fmt::format("  {}{}: {}; {}.\n", row.front ? "* " : "",
                        row.kind == "wider" ? "in " + name_of_wider(r.repair.wider) : row.name,
                        in_words(*row.quality, r.request.requirement), price_text(*row.price, form_price));
    }
    return text + other_lines;
}

}  // namespace

std::string name_of_wider(const FloatFormat& wider) {
    if (wider == measure::tape::two_floats) return "two floats";
    return wider == measure::tape::two_doubles ? "two doubles" : "double";
}

std::string operation_text(const RepairSummary& result, NodeId operation) {
    return text_of(result).definition(operation);
}

std::vector<std::string> changed_lines(const RepairSummary& r, const Tape& changed) {
    const auto& form = *r.request.row.form;
    return changed_lines(statements(r.repair.tape, form), statements(changed, form, &r.repair.tape));
}

RepairSummary result_of(const measure::repair::RepairRequest& request, const measure::repair::RepairResult& repair) {
    RepairSummary r{.request = request, .repair = repair, .catalogue = {}, .catalogue_quality = {}};
    for (const auto& [row, quality] : rank_catalogue(request)) {
        r.catalogue.push_back(row);
        r.catalogue_quality.push_back(quality);
    }
    for (const Proposal& proposal : proposals_of(r)) {
        std::vector<GrowthMargin> margins;
        if (proposal.quality->meets(request.requirement)) margins = margins_of_tape(request, proposal.tape);
        if (proposal.rewritten) r.rewritten_margins.push_back(std::move(margins));
        else if (proposal.symmetric) r.symmetric_margins = std::move(margins);
        else r.margins = std::move(margins);
    }
    measure::repair::Patcher patcher(request, repair.tape);
    if (!patcher.has_file()) return r;
    for (const Proposal& proposal : proposals_of(r))
        r.patches.push_back(proposal.quality->meets(request.requirement) ? patcher.make_patch(proposal.tape)
                                                                         : measure::repair::Patch());
    return r;
}

std::vector<Proposal> proposals_of(const RepairSummary& r) {
    std::vector<Proposal> proposals;
    const auto& repair = r.repair;
    if (r.has_set())
        proposals.push_back({widen_operations(repair, repair.wider_set->operations), &repair.wider_set->quality,
                             &repair.set_held_out, &repair.set_probed, nullptr, &repair.wider_set->operations});
    if (const auto& set = repair.symmetric)
        proposals.push_back({widen_operations(repair, set->operations), &set->quality, &set->held_out, &set->probed,
                             nullptr, &set->operations, true});
    for (const auto& rewritten : repair.rewriting.forms)
        proposals.push_back(
            {rewritten.tape, &rewritten.quality, &rewritten.held_out, &rewritten.probed, &rewritten, nullptr});
    for (std::size_t k = 0; k < proposals.size() && !r.prices.empty(); ++k) proposals[k].price = &r.prices[k + 1];
    return proposals;
}

bool Proposal::is_symmetric(const RepairSummary& result) const {
    const auto& probes = result.repair.probes;
    for (std::size_t k = 0; k < probes.size(); ++k)
        if (probes[k]->is_exact() && !(*probed)[k].meets(result.request.requirement)) return false;
    return true;
}

const Proposal* best_of(const std::vector<Proposal>& proposals, const RepairSummary& result) {
    const auto rank = [&](const Proposal& p) {
        const double operations = p.rewritten ? static_cast<double>(p.rewritten->operations) : HUGE_VAL;
        return std::pair(!p.is_symmetric(result), p.price ? p.price->packed.median : operations);
    };
    const Proposal* best = nullptr;
    for (const Proposal& proposal : proposals)
        if (proposal.quality->meets(result.request.requirement) && (!best || rank(proposal) < rank(*best)))
            best = &proposal;
    return best;
}

std::string rules_of(const measure::repair::Rewritten& rewritten) {
    std::vector<std::string_view> names;
    for (const auto* rule : rewritten.rules) names.push_back(rule->name);
    if (rewritten.wider_set)
        return fmt::format("{}, {} wider", fmt::join(names, ", "), rewritten.wider_set->operations.size());
    return fmt::format("{}", fmt::join(names, ", "));
}

// Names each operation by the statement that it belongs to, in order.
std::string names_of(const RepairSummary& r, const std::vector<NodeId>& operations) {
    const Tape& tape = r.repair.tape;
    std::vector<std::string> names;
    std::set<std::string> seen;
    for (const NodeId i : operations) {
        NodeId owner = i;
        // Finds the next named operation that uses the result, as maps of culprits do.
        for (NodeId k = i; k < tape.size() && tape[owner].label.empty(); ++k) {
            const auto& operands = tape[k].operands;
            if (!is_given(tape[k].op) && std::ranges::find(operands, owner) != operands.end()) owner = k;
        }
        const std::string name = std::string(tape[owner].label.empty() ? "an unnamed operation" : tape[owner].label);
        if (seen.insert(name).second) names.push_back(name);
    }
    return fmt::format("{}", fmt::join(names, ", "));
}

std::string method_text(const RepairSummary& r, const Proposal& proposal) {
    const auto& repair = r.repair;
    if (proposal.rewritten) return "written another way: " + rules_of(*proposal.rewritten);
    return fmt::format("{} of its {} operations in {}{}", proposal.wider->size(), repair.operations,
                       name_of_wider(repair.wider), proposal.symmetric ? ", the same ones for x, y and z" : "");
}

std::string in_words(const RepairSummary& r) {
    const auto& requirement = r.request.requirement;
    const auto& repair = r.repair;
    std::string text = fmt::format("{}: {}\n{} in {} keeps {}.\n", r.request.id(), choice::in_words(requirement),
                                   r.request.row.form->info->name, r.request.row.format.name,
                                   in_words(repair.own_quality, requirement));
    if (!repair.wider_set)
        text += fmt::format("Even with all of its {} operations in {} it does not meet the requirement: {}.\n{}",
                            repair.operations, name_of_wider(repair.wider),
                            in_words(repair.all_wider_quality, requirement), obstruction_text(r));
    else text += repair.wider_set->operations.empty() ? unchanged_is_enough_text(r) : wider_set_text(r);
    if (repair.wider_set && repair.wider_set->operations.empty()) text += probes_text(r, repair.own_probed);
    for (std::size_t k = 0; k < repair.rewriting.forms.size(); ++k) text += rewritten_text(r, k);
    if (!r.catalogue.empty()) {
        const auto meet =
            std::ranges::count_if(r.catalogue_quality, [&](const RowQuality& w) { return w.meets(requirement); });
        text += fmt::format(
            "The most accurate form of the catalogue in {} is {}: {}. Of its {} forms {} meet the requirement.\n",
            r.request.row.format.name, r.catalogue.front().form->info->name,
            in_words(r.catalogue_quality.front(), requirement), r.catalogue.size(), meet);
    }
    text += prices_text(r);
    return text +
           fmt::format("Tried {} on all {}.\n", scene::toml::count_with_noun(repair.tried, "candidate"),
                       scene::toml::count_with_noun(
                           r.request.scene ? r.request.scene->pixels() : r.request.rays->sample.rays.size(), "ray"));
}

}  // namespace lostbits::output::repair
