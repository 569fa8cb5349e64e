#include "measure/repair/repair.hpp"

#include <algorithm>
#include <optional>
#include <set>
#include <utility>

#include "number/error.hpp"

namespace lostbits::measure::repair {

using scene::file::Scene;

namespace {

std::vector<NodeId> without(std::vector<NodeId> set, std::size_t k) {
    set.erase(set.begin() + static_cast<std::ptrdiff_t>(k));
    return set;
}

/// Advances to the next choice of as many indices below n, in lexicographic order; false after the last one.
bool next_choice(std::vector<std::size_t>& chosen, std::size_t n) {
    const std::size_t size = chosen.size();
    for (std::size_t k = size; k-- > 0;) {
        if (chosen[k] == n - size + k) continue;
        ++chosen[k];
        for (std::size_t l = k + 1; l < size; ++l) chosen[l] = chosen[l - 1] + 1;
        return true;
    }
    return false;
}

std::uint64_t binomial(std::uint64_t n, std::uint64_t k) {
    std::uint64_t all = 1;
    for (std::uint64_t i = 0; i < k; ++i) all = all * (n - i) / (i + 1);
    return all;
}

class Search {
public:
    Search(const Tape& tape, const FloatFormat& wider, const RepairRequest& request, Judge& judge)
        : tape_(tape), wider_(wider), request_(request), judge_(judge), all_(tape::rounded_operations(tape)) {}

    /// `with_all` is the worth with all operations wider, which meets the requirement.
    WiderSet smallest(const RowQuality& with_all, std::uint64_t affordable) {
        WiderSet found{.operations = all_, .quality = with_all};
        while (take_one(found)) {}
        for (std::size_t size = 1; size < found.operations.size(); ++size) {
            if (binomial(all_.size(), size) > affordable) break;
            if (auto smaller = some_of(size)) {
                found = std::move(*smaller);
                found.without = quality_without(found.operations);
                break;
            }
            found.none_of = size;
        }
        return found;
    }

private:
    std::vector<RowQuality> quality_of(const std::vector<std::vector<NodeId>>& sets) {
        std::vector<Tape> tapes;
        for (const auto& set : sets) tapes.push_back(tape::widened(tape_, set, wider_));
        return judge_.quality_of(tapes);
    }
    std::vector<RowQuality> quality_without(const std::vector<NodeId>& set) {
        std::vector<std::vector<NodeId>> fewer;
        for (std::size_t k = 0; k < set.size(); ++k) fewer.push_back(without(set, k));
        return quality_of(fewer);
    }

    /// Takes operations out of the set while the requirement is still met. False where none can be taken out;
    /// `set.without` is then the quality without each of them. It takes out the operation whose loss costs least. Where
    /// several could each be taken out, it first tries the better half of them together, then the better quarter, and
    /// so on.
    bool take_one(WiderSet& set) {
        const std::vector<RowQuality> left = quality_without(set.operations);
        std::vector<std::size_t> spare;
        for (std::size_t k = 0; k < left.size(); ++k)
            if (left[k].meets(request_.requirement)) spare.push_back(k);
        if (spare.empty()) {
            set.without = left;
            return false;
        }
        std::ranges::stable_sort(spare, [&](auto a, auto b) { return is_more_accurate(left[a], left[b]); });
        std::vector<std::vector<NodeId>> fewer;
        for (std::size_t n = (spare.size() + 1) / 2; n > 1; n /= 2) {
            std::vector<NodeId> rest;
            for (std::size_t k = 0; k < set.operations.size(); ++k)
                if (std::find(spare.begin(), spare.begin() + static_cast<std::ptrdiff_t>(n), k) ==
                    spare.begin() + static_cast<std::ptrdiff_t>(n))
                    rest.push_back(set.operations[k]);
            fewer.push_back(std::move(rest));
        }
        const std::vector<RowQuality> quality = quality_of(fewer);
        for (std::size_t k = 0; k < fewer.size(); ++k) {
            if (!quality[k].meets(request_.requirement)) continue;
            set = {.operations = fewer[k], .quality = quality[k]};
            return true;
        }
        set = {.operations = without(set.operations, spare.front()), .quality = left[spare.front()]};
        return true;
    }

    /// The most accurate of all sets of `size` operations that meet the requirement; nothing where none does.
    std::optional<WiderSet> some_of(std::size_t size) {
        std::vector<std::vector<NodeId>> sets;
        std::vector<std::size_t> chosen(size);
        for (std::size_t k = 0; k < size; ++k) chosen[k] = k;
        do {
            std::vector<NodeId>& set = sets.emplace_back();
            for (const std::size_t k : chosen) set.push_back(all_[k]);
        } while (next_choice(chosen, all_.size()));
        const std::vector<RowQuality> quality = quality_of(sets);
        std::optional<WiderSet> best;
        for (std::size_t k = 0; k < sets.size(); ++k) {
            if (quality[k].meets(request_.requirement) && (!best || is_more_accurate(quality[k], best->quality)))
                best = WiderSet{.operations = sets[k], .quality = quality[k], .without = {}, .none_of = size - 1};
        }
        return best;
    }

    const Tape& tape_;
    const FloatFormat& wider_;
    const RepairRequest& request_;
    Judge& judge_;
    std::vector<NodeId> all_;
};

/// Scene with fewer pixels, an odd number each way, so that hardly any of them lies where an old one did.
Scene in_other_pixels(Scene scene) {
    const auto fewer = [](int n) { return std::max(n * 7 / 8, 1) | 1; };
    scene.width = fewer(scene.width);
    scene.height = fewer(scene.height);
    return scene;
}

/// Widens the fewest operations of a rewritten form that does not meet the requirement by itself. Keeps the result only
/// if it widens fewer operations than the set that was found for the original form, where there is one.
void widen_where_needed(Rewritten& one, const RepairResult& m, const RepairRequest& request, Judge& judge,
                        std::uint64_t affordable) {
    if (one.quality.meets(request.requirement)) return;
    const Tape written = one.tape;
    const RowQuality all =
        judge.quality_of({tape::widened(written, tape::rounded_operations(written), m.wider)}).front();
    if (!all.meets(request.requirement)) return;
    auto set = smallest_set(written, m.wider, all, request, judge, affordable);
    if (m.set && set.operations.size() >= m.set->operations.size()) return;
    one.tape = tape::widened(written, set.operations, m.wider);
    one.quality = set.quality;
    one.set = std::move(set);
}

/// True if a tape meets the requirement on a list of probes.
bool passes(const Tape& tape, const std::vector<Probe*>& probes, const Requirement& requirement) {
    return std::ranges::all_of(
        probes, [&](Probe* probe) { return probe->judge().quality_of({tape}).front().meets(requirement); });
}

std::vector<RowQuality> probed(const Tape& tape, const std::vector<std::unique_ptr<Probe>>& probes) {
    std::vector<RowQuality> all;
    for (const auto& probe : probes) all.push_back(probe->judge().quality_of({tape}).front());
    return all;
}

/// Search for the set of `exchanged_groups` with the fewest operations that meets the requirement on the scene and on
/// probes.
class SymmetricSearch {
public:
    SymmetricSearch(const RepairResult& m, const RepairRequest& request, Judge& judge, std::vector<Probe*> probes)
        : m_(m), request_(request), judge_(judge), probes_(std::move(probes)) {
        const auto first = request.scene ? scene::rays::shared_primitives(*request.scene).front()
                                         : request.rays->sample.primitives.front();
        groups_ = exchanged_groups(m.tape, tape::rounded_operations(m.tape), first);
    }

    /// Tries all sets if there are at most `affordable`. Otherwise starts from all groups and removes one after the
    /// other, as long as the rest passes. Nothing if no set passes.
    std::optional<SymmetricSet> found(std::uint64_t affordable) {
        const bool all = groups_.size() < 20 && (std::uint64_t{1} << groups_.size()) <= affordable;
        auto set = all ? best_of_all() : reduced();
        if (set) set->is_smallest = all;
        return set;
    }

private:
    using Groups = std::vector<std::size_t>;  ///< indices of groups

    [[nodiscard]] std::vector<NodeId> operations(const Groups& chosen) const {
        std::vector<NodeId> all;
        for (const std::size_t k : chosen) all.insert(all.end(), groups_[k].begin(), groups_[k].end());
        std::ranges::sort(all);
        return all;
    }
    /// The first of these sets that meets the requirement everywhere.
    std::optional<SymmetricSet> first_that_passes(const std::vector<Groups>& sets) {
        std::vector<Tape> tapes;
        for (const Groups& set : sets) tapes.push_back(with_wider(m_, operations(set)));
        const auto quality = judge_.quality_of(tapes);
        for (std::size_t k = 0; k < sets.size(); ++k) {
            if (!quality[k].meets(request_.requirement) || !passes(tapes[k], probes_, request_.requirement)) continue;
            left_ = sets[k];
            return SymmetricSet{.operations = operations(sets[k]),
                                .quality = quality[k],
                                .groups = sets[k].size(),
                                .all_groups = groups_.size()};
        }
        return std::nullopt;
    }
    std::optional<SymmetricSet> best_of_all() {
        std::vector<Groups> sets;
        for (std::uint64_t bits = 1; bits < std::uint64_t{1} << groups_.size(); ++bits) {
            Groups& set = sets.emplace_back();
            for (std::size_t k = 0; k < groups_.size(); ++k)
                if ((bits >> k & 1U) != 0) set.push_back(k);
        }
        std::ranges::stable_sort(sets, {}, [&](const Groups& set) { return operations(set).size(); });
        return first_that_passes(sets);
    }
    std::optional<SymmetricSet> reduced() {
        Groups set(groups_.size());
        for (std::size_t k = 0; k < set.size(); ++k) set[k] = k;
        auto found = first_that_passes({set});
        while (found && left_.size() > 1) {
            std::vector<Groups> fewer;
            for (std::size_t k = 0; k < left_.size(); ++k) {
                fewer.push_back(left_);
                fewer.back().erase(fewer.back().begin() + static_cast<std::ptrdiff_t>(k));
            }
            std::ranges::stable_sort(fewer, {}, [&](const Groups& one) { return operations(one).size(); });
            auto next = first_that_passes(fewer);
            if (!next) break;
            found = std::move(next);
        }
        return found;
    }

    const RepairResult& m_;
    const RepairRequest& request_;
    Judge& judge_;
    std::vector<Probe*> probes_;
    std::vector<std::vector<NodeId>> groups_;
    Groups left_;  ///< the last set that passed
};

/// Measures what was found on the probes. Where the set fails exact ones that it could pass, since the form passes them
/// with every operation wider, looks for a symmetric set.
void probe(RepairResult& m, const RepairRequest& request, Judge& judge, std::uint64_t affordable) {
    const auto meets = [&](const RowQuality& quality) { return quality.meets(request.requirement); };
    const auto& found = m.rewriting.found;
    if (!m.set && std::ranges::none_of(found, meets, &Rewritten::quality)) return;
    const auto probes = probes_of(request);
    const std::vector<NodeId> all = tape::rounded_operations(m.tape);
    for (const auto& one : probes) m.probes.push_back(&one->isometry());
    if (!probes.empty()) m.probed_rays = probes.front()->judge().rays();
    m.own_probed = probed(m.tape, probes);
    m.set_probed = probed(with_wider(m, m.set ? m.set->operations : all), probes);
    for (Rewritten& one : m.rewriting.found) one.probed = probed(one.tape, probes);
    if (!m.set || m.set->operations.empty()) return;
    bool fails = false;
    for (std::size_t k = 0; k < probes.size(); ++k)
        fails |= probes[k]->isometry().is_exact() && !meets(m.set_probed[k]);
    if (!fails) return;
    const auto with_all = probed(with_wider(m, all), probes);
    std::vector<Probe*> passable;
    fails = false;
    for (std::size_t k = 0; k < probes.size(); ++k) {
        if (!meets(with_all[k])) continue;
        passable.push_back(probes[k].get());
        fails |= probes[k]->isometry().is_exact() && !meets(m.set_probed[k]);
    }
    if (!fails) return;
    m.symmetric = SymmetricSearch(m, request, judge, passable).found(affordable);
    if (m.symmetric) m.symmetric->probed = probed(with_wider(m, m.symmetric->operations), probes);
}

}  // namespace

WiderSet smallest_set(const Tape& tape, const FloatFormat& wider, const RowQuality& with_all,
                      const RepairRequest& request, Judge& judge, std::uint64_t affordable) {
    return Search(tape, wider, request, judge).smallest(with_all, affordable);
}

bool are_inverses(const RepairRequest& request) {
    if (!request.row.form->is_placed) return false;
    std::set<int> kinds;
    const auto add = [&kinds](const auto& primitives) {
        for (const auto& primitive : primitives)
            kinds.insert(!primitive.placed ? 2 : primitive.placed->is_inverse ? 1 : 0);
    };
    if (request.scene) add(request.scene->primitives());
    else add(request.rays->sample.primitives);
    if (kinds.size() == 1) return *kinds.begin() == 1;
    throw InputError(request.id() +
                     ": some primitives have no matrix, or only some matrices are stored as inverses; the operations "
                     "differ for each kind; mend the form for primitives of one kind");
}

Tape recorded(const RepairRequest& request) {
    return tape::tape_of(*request.row.form, request.row.format, are_inverses(request));
}

Tape with_wider(const RepairResult& repair, const std::vector<NodeId>& operations) {
    return tape::widened(repair.tape, operations, repair.wider);
}

RepairResult repair_form(const RepairRequest& request, std::uint64_t affordable) {
    RepairResult m{.tape = recorded(request),
                   .wider = tape::wider_than(request.row.format.parameters, request.two_words)};
    const std::vector<NodeId> all = tape::rounded_operations(m.tape);
    m.operations = all.size();
    Judge judge(request);
    m.own = own_quality(request, m.tape, judge);
    m.all = judge.quality_of({with_wider(m, all)}).front();
    if (m.own.meets(request.requirement)) m.set = WiderSet{.operations = {}, .quality = m.own};
    else if (m.all.meets(request.requirement)) m.set = smallest_set(m.tape, m.wider, m.all, request, judge, affordable);
    if (!m.own.meets(request.requirement)) m.rewriting = rewrite(request, m.tape, m.own, judge);
    for (Rewritten& one : m.rewriting.found) widen_where_needed(one, m, request, judge, affordable);
    probe(m, request, judge, affordable);
    if (!m.set) m.obstruction = RaySample(request, few_rays).without_rounding(m.tape);
    m.tried = judge.tried();
    std::vector<Tape> asked{m.tape, with_wider(m, m.set ? m.set->operations : all)};
    for (const Rewritten& r : m.rewriting.found) asked.push_back(r.tape);
    if (m.symmetric) asked.push_back(with_wider(m, m.symmetric->operations));
    if (request.scene) m.held_out_scene = in_other_pixels(*request.scene);
    const auto there = request.scene ? Judge(request, m.held_out_scene).quality_of(asked) : request.on_all(asked);
    m.own_held_out = there[0];
    m.set_held_out = there[1];
    for (std::size_t k = 0; k < m.rewriting.found.size(); ++k) m.rewriting.found[k].held_out = there[k + 2];
    if (m.symmetric) m.symmetric->held_out = there.back();
    return m;
}

}  // namespace lostbits::measure::repair
