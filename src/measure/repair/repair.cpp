#include "measure/repair/repair.hpp"

#include <algorithm>
#include <optional>
#include <set>
#include <span>
#include <utility>

#include "number/error.hpp"

namespace lostbits::measure::repair {

using scene::file::Scene;

namespace {

std::vector<NodeId> remove_at(std::vector<NodeId> set, std::size_t k) {
    set.erase(set.begin() + static_cast<std::ptrdiff_t>(k));
    return set;
}

/// Advances to the next choice of the same number of indices below `count`, in lexicographic order. Returns false after
/// the last choice.
bool next_choice(std::vector<std::size_t>& chosen, std::size_t count) {
    const std::size_t size = chosen.size();
    for (std::size_t k = size; k-- > 0;) {
        if (chosen[k] == count - size + k) continue;
        ++chosen[k];
        for (std::size_t l = k + 1; l < size; ++l) chosen[l] = chosen[l - 1] + 1;
        return true;
    }
    return false;
}

std::uint64_t binomial(std::uint64_t n, std::uint64_t k) {
    std::uint64_t product = 1;
    for (std::uint64_t i = 0; i < k; ++i) product = product * (n - i) / (i + 1);
    return product;
}

/// Search for the smallest set of operations to do wider.
class WiderSearch {
public:
    WiderSearch(const Tape& tape, const FloatFormat& wider, const RepairRequest& request, QualityMeasurer& measurer)
        : tape_(tape),
          wider_(wider),
          request_(request),
          measurer_(measurer),
          operations_(tape::find_widenable_operations(tape)) {}

    /// `all_wider_quality` is the quality with all operations wider, which meets the requirement.
    WiderSet smallest(const FormQuality& all_wider_quality, std::uint64_t max_sets_per_size) {
        WiderSet result{.operations = operations_, .quality = all_wider_quality};
        while (remove_operations(result)) {}
        for (std::size_t size = 1; size < result.operations.size(); ++size) {
            if (binomial(operations_.size(), size) > max_sets_per_size) break;
            if (auto smaller = find_best_of_size(size)) {
                result = std::move(*smaller);
                result.quality_without = measure_without_each(result.operations);
                break;
            }
            result.largest_failing_size = size;
        }
        return result;
    }

private:
    std::vector<FormQuality> measure_sets(const std::vector<std::vector<NodeId>>& sets) {
        std::vector<Tape> tapes;
        for (const auto& set : sets) tapes.push_back(tape::widen_operations(tape_, set, wider_));
        return measurer_.measure_quality(tapes);
    }
    std::vector<FormQuality> measure_without_each(const std::vector<NodeId>& set) {
        std::vector<std::vector<NodeId>> smaller_sets;
        for (std::size_t k = 0; k < set.size(); ++k) smaller_sets.push_back(remove_at(set, k));
        return measure_sets(smaller_sets);
    }

    /// Removes operations from the set such that the requirement is still met. Returns false if none can be removed;
    /// `set.quality_without` is then the quality without each of the operations. If only one operation can be removed,
    /// removes it. If each of several can be removed, first tries to remove the better half of them together, then the
    /// better quarter, and so on. In the end, removes the operation whose removal costs least.
    bool remove_operations(WiderSet& set) {
        const std::vector<FormQuality> quality_without_each = measure_without_each(set.operations);
        const std::vector<std::size_t> removable = sort_removable(quality_without_each);
        if (removable.empty()) {
            set.quality_without = quality_without_each;
            return false;
        }

        // Tries to remove several at once.
        const std::vector<std::vector<NodeId>> smaller_sets = remove_several(set.operations, removable);
        const std::vector<FormQuality> quality = measure_sets(smaller_sets);
        for (std::size_t k = 0; k < smaller_sets.size(); ++k) {
            if (!quality[k].meets(request_.requirement)) continue;
            set = {.operations = smaller_sets[k], .quality = quality[k]};
            return true;
        }

        set = {.operations = remove_at(set.operations, removable.front()),
               .quality = quality_without_each[removable.front()]};
        return true;
    }

    /// Indices of the operations that can be removed alone, the one whose removal costs least first.
    [[nodiscard]] std::vector<std::size_t> sort_removable(const std::vector<FormQuality>& quality_without_each) const {
        std::vector<std::size_t> removable;
        for (std::size_t k = 0; k < quality_without_each.size(); ++k)
            if (quality_without_each[k].meets(request_.requirement)) removable.push_back(k);
        std::ranges::stable_sort(removable, [&](auto a, auto b) {
            return is_more_accurate(quality_without_each[a], quality_without_each[b]);
        });
        return removable;
    }
    /// The set without the first half of `removable`, without the first quarter, and so on, as long as at least two
    /// operations are removed.
    static std::vector<std::vector<NodeId>> remove_several(const std::vector<NodeId>& set,
                                                           const std::vector<std::size_t>& removable) {
        std::vector<std::vector<NodeId>> smaller_sets;
        for (std::size_t n = (removable.size() + 1) / 2; n > 1; n /= 2) {
            const std::span removed = std::span(removable).first(n);
            std::vector<NodeId> remaining;
            for (std::size_t k = 0; k < set.size(); ++k)
                if (std::ranges::find(removed, k) == removed.end()) remaining.push_back(set[k]);
            smaller_sets.push_back(std::move(remaining));
        }
        return smaller_sets;
    }

    /// Finds the most accurate of all sets of `size` operations that meet the requirement; empty if none does.
    std::optional<WiderSet> find_best_of_size(std::size_t size) {
        std::vector<std::vector<NodeId>> sets;
        std::vector<std::size_t> indices(size);
        for (std::size_t k = 0; k < size; ++k) indices[k] = k;
        do {
            std::vector<NodeId>& set = sets.emplace_back();
            for (const std::size_t k : indices) set.push_back(operations_[k]);
        } while (next_choice(indices, operations_.size()));

        const std::vector<FormQuality> quality = measure_sets(sets);
        std::optional<WiderSet> best;
        for (std::size_t k = 0; k < sets.size(); ++k) {
            if (quality[k].meets(request_.requirement) && (!best || is_more_accurate(quality[k], best->quality)))
                best = WiderSet{.operations = sets[k],
                                .quality = quality[k],
                                .quality_without = {},
                                .largest_failing_size = size - 1};
        }
        return best;
    }

    const Tape& tape_;
    const FloatFormat& wider_;
    const RepairRequest& request_;
    QualityMeasurer& measurer_;
    std::vector<NodeId> operations_;
};

/// Scene with fewer pixels, an odd number each way, so that hardly any new pixel lies where an old pixel did.
Scene change_pixels(Scene scene) {
    const auto reduce = [](int n) { return std::max(n * 7 / 8, 1) | 1; };
    scene.width = reduce(scene.width);
    scene.height = reduce(scene.height);
    return scene;
}

/// Widens the fewest operations of a rewritten form that does not meet the requirement by itself. Keeps the result only
/// if it widens fewer operations than the set that was found for the original form, if there is one.
void widen_where_needed(RewrittenForm& rewritten, const RepairResult& result, const RepairRequest& request,
                        QualityMeasurer& measurer, std::uint64_t max_sets_per_size) {
    if (rewritten.quality.meets(request.requirement)) return;
    const Tape unwidened = rewritten.tape;
    const FormQuality all_wider_quality = measurer
                                              .measure_quality({tape::widen_operations(
                                                  unwidened, tape::find_widenable_operations(unwidened), result.wider)})
                                              .front();
    if (!all_wider_quality.meets(request.requirement)) return;
    auto set = find_smallest_set(unwidened, result.wider, all_wider_quality, request, measurer, max_sets_per_size);
    if (result.wider_set && set.operations.size() >= result.wider_set->operations.size()) return;
    rewritten.tape = tape::widen_operations(unwidened, set.operations, result.wider);
    rewritten.quality = set.quality;
    rewritten.wider_set = std::move(set);
}

/// True if a tape meets the requirement on a list of probes.
bool passes_probes(const Tape& tape, const std::vector<Probe*>& probes, const Requirement& requirement) {
    return std::ranges::all_of(
        probes, [&](Probe* probe) { return probe->measurer().measure_quality({tape}).front().meets(requirement); });
}

std::vector<FormQuality> measure_on_probes(const Tape& tape, const std::vector<std::unique_ptr<Probe>>& probes) {
    std::vector<FormQuality> qualities;
    for (const auto& probe : probes) qualities.push_back(probe->measurer().measure_quality({tape}).front());
    return qualities;
}

/// Searches for the set of `find_exchanged_groups` with the fewest operations that meets the requirement on the scene
/// and on probes.
class SymmetricSearch {
public:
    SymmetricSearch(const RepairResult& result, const RepairRequest& request, QualityMeasurer& measurer,
                    std::vector<Probe*> probes)
        : result_(result), request_(request), measurer_(measurer), probes_(std::move(probes)) {
        const auto example = request.scene ? scene::rays::make_shared_primitives(*request.scene).front()
                                           : request.rays->sample.primitives.front();
        groups_ = find_exchanged_groups(result.tape, tape::find_widenable_operations(result.tape), example);
    }

    /// Tries all sets if there are at most `max_sets_per_size`. Otherwise starts from all groups and removes one after
    /// the other, as long as the rest passes. Returns nothing if no set passes.
    std::optional<SymmetricSet> search(std::uint64_t max_sets_per_size) {
        const bool tries_all = groups_.size() < 20 && (std::uint64_t{1} << groups_.size()) <= max_sets_per_size;
        auto set = tries_all ? find_best_of_all() : reduce_groups();
        if (set) set->is_smallest = tries_all;
        return set;
    }

private:
    using Groups = std::vector<std::size_t>;  ///< indices of groups

    [[nodiscard]] std::vector<NodeId> operations_in(const Groups& chosen) const {
        std::vector<NodeId> nodes;
        for (const std::size_t k : chosen) nodes.insert(nodes.end(), groups_[k].begin(), groups_[k].end());
        std::ranges::sort(nodes);
        return nodes;
    }
    /// Finds the first of these sets that meets the requirement on the scene and on the probes.
    std::optional<SymmetricSet> find_first_passing(const std::vector<Groups>& sets) {
        std::vector<Tape> tapes;
        for (const Groups& set : sets) tapes.push_back(widen_operations(result_, operations_in(set)));
        const auto quality = measurer_.measure_quality(tapes);
        for (std::size_t k = 0; k < sets.size(); ++k) {
            if (!quality[k].meets(request_.requirement) || !passes_probes(tapes[k], probes_, request_.requirement))
                continue;
            last_passed_ = sets[k];
            return SymmetricSet{.operations = operations_in(sets[k]),
                                .quality = quality[k],
                                .group_count = sets[k].size(),
                                .total_group_count = groups_.size()};
        }
        return std::nullopt;
    }
    std::optional<SymmetricSet> find_best_of_all() {
        std::vector<Groups> sets;
        for (std::uint64_t mask = 1; mask < std::uint64_t{1} << groups_.size(); ++mask) {
            Groups& set = sets.emplace_back();
            for (std::size_t k = 0; k < groups_.size(); ++k)
                if ((mask >> k & 1U) != 0) set.push_back(k);
        }
        std::ranges::stable_sort(sets, {}, [&](const Groups& set) { return operations_in(set).size(); });
        return find_first_passing(sets);
    }
    std::optional<SymmetricSet> reduce_groups() {
        Groups set(groups_.size());
        for (std::size_t k = 0; k < set.size(); ++k) set[k] = k;
        auto found = find_first_passing({set});
        while (found && last_passed_.size() > 1) {
            std::vector<Groups> smaller_sets;
            for (std::size_t k = 0; k < last_passed_.size(); ++k) {
                smaller_sets.push_back(last_passed_);
                smaller_sets.back().erase(smaller_sets.back().begin() + static_cast<std::ptrdiff_t>(k));
            }
            std::ranges::stable_sort(smaller_sets, {},
                                     [&](const Groups& groups) { return operations_in(groups).size(); });
            auto next = find_first_passing(smaller_sets);
            if (!next) break;
            found = std::move(next);
        }
        return found;
    }

    const RepairResult& result_;
    const RepairRequest& request_;
    QualityMeasurer& measurer_;
    std::vector<Probe*> probes_;
    std::vector<std::vector<NodeId>> groups_;
    Groups last_passed_;  ///< the last set that passed
};

using Probes = std::vector<std::unique_ptr<Probe>>;

/// Operations that the repaired form does wider: those of its set, or without a set all of them.
std::vector<NodeId> operations_to_widen(const RepairResult& result) {
    return result.wider_set ? result.wider_set->operations : tape::find_widenable_operations(result.tape);
}

/// Searches for a symmetric set if the set fails on an exact probe on which the form passes with every operation wider.
void find_symmetric_set(RepairResult& result, const RepairRequest& request, QualityMeasurer& measurer,
                        const Probes& probes, std::uint64_t max_sets_per_size) {
    const auto meets = [&](const FormQuality& quality) { return quality.meets(request.requirement); };
    const auto set_fails_exact_probe = [&](std::size_t k) {
        return probes[k]->isometry().is_exact() && !meets(result.set_probe_qualities[k]);
    };

    // Avoids the probes with every operation wider if the set fails nowhere.
    bool fails_exact_probe = false;
    for (std::size_t k = 0; k < probes.size(); ++k) fails_exact_probe |= set_fails_exact_probe(k);
    if (!fails_exact_probe) return;

    // Drops the probes that no set can pass.
    const auto all_wider_qualities =
        measure_on_probes(widen_operations(result, tape::find_widenable_operations(result.tape)), probes);
    std::vector<Probe*> passable;
    fails_exact_probe = false;
    for (std::size_t k = 0; k < probes.size(); ++k) {
        if (!meets(all_wider_qualities[k])) continue;
        passable.push_back(probes[k].get());
        fails_exact_probe |= set_fails_exact_probe(k);
    }
    if (!fails_exact_probe) return;

    result.symmetric = SymmetricSearch(result, request, measurer, passable).search(max_sets_per_size);
    if (result.symmetric)
        result.symmetric->probe_qualities =
            measure_on_probes(widen_operations(result, result.symmetric->operations), probes);
}

/// Measures on the probes the repairs that were found, and finds a symmetric set if the probes call for one.
void measure_probes(RepairResult& result, const RepairRequest& request, QualityMeasurer& measurer,
                    std::uint64_t max_sets_per_size) {
    const auto meets = [&](const FormQuality& quality) { return quality.meets(request.requirement); };
    const auto& rewritten_forms = result.rewriting.forms;
    if (!result.wider_set && std::ranges::none_of(rewritten_forms, meets, &RewrittenForm::quality)) return;

    const Probes probes = make_probes(request);
    for (const auto& probe : probes) result.probes.push_back(&probe->isometry());
    if (!probes.empty()) result.probed_ray_count = probes.front()->measurer().rays();

    result.own_probe_qualities = measure_on_probes(result.tape, probes);
    result.set_probe_qualities = measure_on_probes(widen_operations(result, operations_to_widen(result)), probes);
    for (RewrittenForm& rewritten : result.rewriting.forms)
        rewritten.probe_qualities = measure_on_probes(rewritten.tape, probes);

    if (!result.wider_set || result.wider_set->operations.empty()) return;
    find_symmetric_set(result, request, measurer, probes, max_sets_per_size);
}

/// Measures the form and its repairs on rays that were not searched on: the scene in other pixels, or all rays of the
/// files.
void measure_held_out(RepairResult& result, const RepairRequest& request) {
    std::vector<Tape> tapes{result.tape, widen_operations(result, operations_to_widen(result))};
    for (const RewrittenForm& r : result.rewriting.forms) tapes.push_back(r.tape);
    if (result.symmetric) tapes.push_back(widen_operations(result, result.symmetric->operations));

    if (request.scene) result.held_out_scene = change_pixels(*request.scene);
    const auto held_out_qualities = request.scene
                                        ? QualityMeasurer(request, result.held_out_scene).measure_quality(tapes)
                                        : request.quality_on_all_rays(tapes);

    result.own_held_out_quality = held_out_qualities[0];
    result.set_held_out_quality = held_out_qualities[1];
    for (std::size_t k = 0; k < result.rewriting.forms.size(); ++k)
        result.rewriting.forms[k].held_out_quality = held_out_qualities[k + 2];
    if (result.symmetric) result.symmetric->held_out_quality = held_out_qualities.back();
}

}  // namespace

WiderSet find_smallest_set(const Tape& tape, const FloatFormat& wider, const FormQuality& all_wider_quality,
                           const RepairRequest& request, QualityMeasurer& measurer, std::uint64_t max_sets_per_size) {
    return WiderSearch(tape, wider, request, measurer).smallest(all_wider_quality, max_sets_per_size);
}

bool are_matrices_inverse(const RepairRequest& request) {
    if (!request.tested_form.form->has_transform_method) return false;
    std::set<int> kinds;
    const auto add = [&kinds](const auto& primitives) {
        for (const auto& primitive : primitives)
            kinds.insert(!primitive.transform ? 2 : primitive.transform->is_inverse ? 1 : 0);
    };
    if (request.scene) add(request.scene->primitives());
    else add(request.rays->sample.primitives);
    if (kinds.size() == 1) return *kinds.begin() == 1;
    throw InputError(request.id() +
                     ": some primitives have no matrix, or only some matrices are stored as inverses; the operations "
                     "differ for each kind; mend the form for primitives of one kind");
}

Tape record_tape(const RepairRequest& request) {
    return tape::record_tape(*request.tested_form.form, request.tested_form.format, are_matrices_inverse(request));
}

Tape widen_operations(const RepairResult& repair, const std::vector<NodeId>& operations) {
    return tape::widen_operations(repair.tape, operations, repair.wider);
}

RepairResult repair_form(const RepairRequest& request, std::uint64_t max_sets_per_size) {
    RepairResult result{.tape = record_tape(request),
                        .wider = tape::wider_format(request.tested_form.format.parameters, request.two_words)};
    const std::vector<NodeId> all_operations = tape::find_widenable_operations(result.tape);
    result.rounding_operation_count = all_operations.size();

    QualityMeasurer measurer(request);
    result.own_quality = measure_own_quality(request, result.tape, measurer);
    result.all_wider_quality = measurer.measure_quality({widen_operations(result, all_operations)}).front();

    // The fewest operations to do wider: none if the form meets the requirement as it is.
    if (result.own_quality.meets(request.requirement))
        result.wider_set = WiderSet{.operations = {}, .quality = result.own_quality};
    else if (result.all_wider_quality.meets(request.requirement))
        result.wider_set = find_smallest_set(result.tape, result.wider, result.all_wider_quality, request, measurer,
                                             max_sets_per_size);

    // Other ways of writing the form, wider where they still need it.
    if (!result.own_quality.meets(request.requirement))
        result.rewriting = rewrite(request, result.tape, result.own_quality, measurer);
    for (RewrittenForm& rewritten : result.rewriting.forms)
        widen_where_needed(rewritten, result, request, measurer, max_sets_per_size);

    measure_probes(result, request, measurer, max_sets_per_size);
    if (!result.wider_set)
        result.obstruction = RaySample(request, few_rays_count).compare_without_rounding(result.tape);
    result.tried_count = measurer.tried_count();
    measure_held_out(result, request);
    return result;
}

}  // namespace lostbits::measure::repair
