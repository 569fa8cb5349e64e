#include "measure/mend/wider_set.hpp"

#include <algorithm>
#include <optional>

namespace lostbits::measure::mend {

namespace {

std::vector<NodeId> without(std::vector<NodeId> set, std::size_t k) {
    set.erase(set.begin() + static_cast<std::ptrdiff_t>(k));
    return set;
}

/// The next choice of as many of n, in lexicographic order.
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
    Search(const Tape& tape, const FloatFormat& wider, const MendRequest& request, Judge& judge)
        : tape_(tape), wider_(wider), request_(request), judge_(judge), all_(tape::rounded_operations(tape)) {}

    /// `with_all`: what is kept with all operations wider, which meets the wish.
    WiderSet smallest(const Worth& with_all, std::uint64_t affordable) {
        WiderSet found{.operations = all_, .worth = with_all};
        while (take_one(found)) {}
        for (std::size_t size = 1; size < found.operations.size(); ++size) {
            if (binomial(all_.size(), size) > affordable) break;
            if (auto smaller = some_of(size)) {
                found = std::move(*smaller);
                found.without = worth_without(found.operations);
                break;
            }
            found.none_of = size;
        }
        return found;
    }

private:
    std::vector<Worth> worth_of(const std::vector<std::vector<NodeId>>& sets) {
        std::vector<Tape> tapes;
        for (const auto& set : sets) tapes.push_back(tape::widened(tape_, set, wider_));
        return judge_.worth_of(tapes);
    }
    std::vector<Worth> worth_without(const std::vector<NodeId>& set) {
        std::vector<std::vector<NodeId>> fewer;
        for (std::size_t k = 0; k < set.size(); ++k) fewer.push_back(without(set, k));
        return worth_of(fewer);
    }

    /// Takes the operation away whose loss costs least, or keeps what becomes of the set without each. Where several
    /// can go, the better half of them is tried at once.
    bool take_one(WiderSet& set) {
        const std::vector<Worth> left = worth_without(set.operations);
        std::vector<std::size_t> spare;
        for (std::size_t k = 0; k < left.size(); ++k)
            if (left[k].meets(request_.wish)) spare.push_back(k);
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
        const std::vector<Worth> worth = worth_of(fewer);
        for (std::size_t k = 0; k < fewer.size(); ++k) {
            if (!worth[k].meets(request_.wish)) continue;
            set = {.operations = fewer[k], .worth = worth[k]};
            return true;
        }
        set = {.operations = without(set.operations, spare.front()), .worth = left[spare.front()]};
        return true;
    }

    /// The most accurate of all sets of a size that meet the wish.
    std::optional<WiderSet> some_of(std::size_t size) {
        std::vector<std::vector<NodeId>> sets;
        std::vector<std::size_t> chosen(size);
        for (std::size_t k = 0; k < size; ++k) chosen[k] = k;
        do {
            std::vector<NodeId>& set = sets.emplace_back();
            for (const std::size_t k : chosen) set.push_back(all_[k]);
        } while (next_choice(chosen, all_.size()));
        const std::vector<Worth> worth = worth_of(sets);
        std::optional<WiderSet> best;
        for (std::size_t k = 0; k < sets.size(); ++k) {
            if (worth[k].meets(request_.wish) && (!best || is_more_accurate(worth[k], best->worth)))
                best = WiderSet{.operations = sets[k], .worth = worth[k], .without = {}, .none_of = size - 1};
        }
        return best;
    }

    const Tape& tape_;
    const FloatFormat& wider_;
    const MendRequest& request_;
    Judge& judge_;
    std::vector<NodeId> all_;
};

}  // namespace

WiderSet smallest_set(const Tape& tape, const FloatFormat& wider, const Worth& with_all, const MendRequest& request,
                      Judge& judge, std::uint64_t affordable) {
    return Search(tape, wider, request, judge).smallest(with_all, affordable);
}

}  // namespace lostbits::measure::mend
