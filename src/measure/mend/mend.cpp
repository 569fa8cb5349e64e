#include "measure/mend/mend.hpp"

#include <algorithm>
#include <bit>
#include <cmath>

#include "number/error.hpp"

namespace lostbits::measure::mend {

using map::MapRow;
using scene::file::Scene;
using tape::TapeForm;

namespace {

/// Rows of one map: more would only take memory.
constexpr std::size_t at_once = 48;

/// The bits of all answers of a row, in order.
class Bits final : public map::MapSink {
public:
    void band(const map::BandResult& result) override {
        const answer::Answers& a = *result.answers;
        for (std::size_t i = 0; i < a.hit.size(); ++i) {
            add(a.hit[i]);
            if (a.hit[i] != 0) add(std::isnan(a.t[i]) ? 1 : std::bit_cast<std::uint64_t>(a.t[i]));
        }
    }
    friend bool operator==(const Bits& a, const Bits& b) { return a.hash_ == b.hash_; }

private:
    /// FNV-1a, a word at a time.
    void add(std::uint64_t x) { hash_ = (hash_ ^ x) * 0x100000001b3U; }
    std::uint64_t hash_ = 0xcbf29ce484222325U;
};

choice::ChoiceRequest asked(const MendRequest& request, const Scene& scene, std::vector<MapRow> rows) {
    choice::ChoiceRequest choice{.scene = &scene, .rows = std::move(rows), .wish = request.wish};
    choice.limit = request.limit;
    return choice;
}

MapRow row_like(const MapRow& row, const TapeForm& form) {
    return {.form = &form.row(), .format = row.format, .judged = row.judged};
}

/// The scene in fewer pixels, an odd number each way, so that hardly a pixel lies where one did.
Scene in_other_pixels(Scene scene) {
    const auto fewer = [](int n) { return std::max(n * 7 / 8, 1) | 1; };
    scene.width = fewer(scene.width);
    scene.height = fewer(scene.height);
    return scene;
}

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
    Search(const Mended& mended, const MendRequest& request, Judge& judge, std::vector<NodeId> all)
        : mended_(mended), request_(request), judge_(judge), all_(std::move(all)) {}

    WiderSet smallest(std::uint64_t affordable) {
        WiderSet found{.operations = all_, .worth = mended_.all};
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
        for (const auto& set : sets) tapes.push_back(with_wider(mended_, set));
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

    const Mended& mended_;
    const MendRequest& request_;
    Judge& judge_;
    std::vector<NodeId> all_;
};

/// The worth of the form itself. InputError where its tape answers otherwise.
Worth own_worth(const MendRequest& request, const Tape& tape) {
    const TapeForm form(*request.row.form, request.row.format, tape, "tape", "");
    Bits own, recorded;
    auto both = asked(request, *request.scene, {request.row, row_like(request.row, form)});
    both.sinks = {&own, &recorded};
    const auto worth = choice::worth_of(both);
    if (own == recorded) return worth.front();
    throw InputError(std::string(request.row.form->info->name) +
                     ": its operations are not the same for every ray, since it decides by itself how far to go; name "
                     "a form that does the same to all");
}

}  // namespace

bool is_more_accurate(const Worth& a, const Worth& b) {
    const auto bits = [](const Worth& w) { return std::isnan(w.kept_bits) ? -1 : w.kept_bits; };
    return a.wrong_fraction() != b.wrong_fraction() ? a.wrong_fraction() < b.wrong_fraction() : bits(a) > bits(b);
}

std::vector<Worth> Judge::worth_of(const std::vector<Tape>& tapes) {
    std::vector<Worth> all;
    for (std::size_t begin = 0; begin < tapes.size(); begin += at_once) {
        const std::size_t end = std::min(begin + at_once, tapes.size());
        std::vector<std::unique_ptr<TapeForm>> forms;
        std::vector<MapRow> rows;
        for (std::size_t k = begin; k < end; ++k) {
            forms.push_back(
                std::make_unique<TapeForm>(*request_.row.form, request_.row.format, tapes[k], "candidate", ""));
            rows.push_back(row_like(request_.row, *forms.back()));
        }
        const auto worth = choice::worth_of(asked(request_, scene_, std::move(rows)));
        all.insert(all.end(), worth.begin(), worth.end());
        tried_ += end - begin;
        request_.progress(end - begin);
    }
    return all;
}

Tape with_wider(const Mended& mended, const std::vector<NodeId>& operations) {
    return tape::widened(mended.tape, operations, mended.wider);
}

Mended mend(const MendRequest& request, std::uint64_t affordable) {
    Mended m{.tape = tape::tape_of(*request.row.form, request.row.format),
             .wider = tape::wider_than(request.row.format.shape, request.two_words)};
    const std::vector<NodeId> all = tape::rounded_operations(m.tape);
    m.operations = all.size();
    m.own = own_worth(request, m.tape);
    Judge judge(request, *request.scene);
    m.all = judge.worth_of({with_wider(m, all)}).front();
    if (m.own.meets(request.wish)) m.set = WiderSet{.operations = {}, .worth = m.own};
    else if (m.all.meets(request.wish)) m.set = Search(m, request, judge, all).smallest(affordable);
    m.tried = judge.tried();
    m.apart = in_other_pixels(*request.scene);
    Judge apart(request, m.apart);
    const auto there = apart.worth_of({m.tape, with_wider(m, m.set ? m.set->operations : all)});
    m.own_apart = there[0];
    m.apart_worth = there[1];
    return m;
}

}  // namespace lostbits::measure::mend
