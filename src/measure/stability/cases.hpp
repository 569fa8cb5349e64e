// All cases of a formula over enclosures: one run for each answer to the comparisons that the enclosures leave open.
#pragma once

#include <optional>
#include <vector>

#include "measure/stability/neighbours.hpp"

namespace lostbits::measure::stability {

/// Runs a formula over all problems near one. Where Kleene's logic does not decide its result, the first comparison
/// that is open is answered with yes and with no, and the formula runs again for each. Every problem is in one of the
/// cases, so a result that they share holds for all problems. A sign that decides nothing, such as that of v·d for a
/// ray across a cylinder, then limits nothing.
inline long all_runs = 0, all_holds = 0, all_exact = 0;
class Cases : Near::Open {
public:
    /// A number and the sign that it has in a case: −1 for at most 0, +1 for at least 0, 0 for either.
    struct Sign {
        Near of;
        int sign;
    };

    /// True if `run()`, a pair of (result is known, result is the expected one), is known and expected in every case;
    /// after `most_runs` no more is split.
    template <class Run>
    bool all(const Run& run, int most_runs) {
        most_runs_ = most_runs;
        answers_.clear(), contradiction_.clear();
        runs_ = 0;
        Near::Open* const outer = Near::open;
        Near::open = this;
        const bool same = all_from_here(run);
        Near::open = outer;
        return same;
    }
    /// Numbers whose signs lead to another result, after `all` has returned false: those of the last case that it ran.
    [[nodiscard]] const std::vector<Sign>& contradiction() const { return contradiction_; }
    /// A number that would change the result at 0, of a formula that decides without a comparison.
    void watch(const Near& x) { watched_.push_back({x, 0}); }

    Tri is_below(const Near& x, bool or_equal) override {
        const unsigned yes = or_equal ? below | zero : below;
        unsigned possible = below | zero | above;
        for (const Known& known : known_)
            if (const int k = known.x.is_multiple_of(x); k != 0)
                possible &= k > 0 ? known.signs : mirrored(known.signs);
        if ((possible & ~yes) == 0) return Tri::yes;
        if ((possible & yes) == 0) return Tri::no;
        if (used_ == answers_.size()) {
            if (!is_open_) next_ = x;
            is_open_ = true;
            return Tri::unknown;
        }
        const bool answer = answers_[used_++];
        known_.push_back({x, possible & (answer ? yes : ~yes)});
        return answer ? Tri::yes : Tri::no;
    }

private:
    enum : unsigned { below = 1, zero = 2, above = 4 };
    static unsigned mirrored(unsigned signs) {
        return (signs & zero) | ((signs & below) != 0 ? above : 0U) | ((signs & above) != 0 ? below : 0U);
    }
    struct Known {
        Near x;
        unsigned signs;
    };

    template <class Run>
    bool all_from_here(const Run& run) {
        used_ = 0, is_open_ = false;
        known_.clear(), watched_.clear();
        const bool spent = ++runs_ > most_runs_;
        ++all_runs;
        const auto [known, expected] = run();
        if (known && expected) return true;
        if (known || !is_open_ || spent) {
            contradict(known);
            return false;
        }
        for (const bool answer : {true, false}) {
            answers_.push_back(answer);
            const bool same = all_from_here(run);
            answers_.pop_back();
            if (!same) return false;
        }
        return true;
    }
    void contradict(bool known) {
        contradiction_ = watched_;
        for (const Known& k : known_)
            contradiction_.push_back({k.x, (k.signs & above) == 0 ? -1 : (k.signs & below) == 0 ? 1 : 0});
        if (!known && is_open_) contradiction_.push_back({next_, 0});
    }

    std::vector<bool> answers_;  ///< to the first comparisons that are open
    std::size_t used_ = 0;
    int runs_ = 0, most_runs_ = 0;
    bool is_open_ = false;  ///< a comparison behind those is open: that of `next_` with 0
    Near next_;
    std::vector<Known> known_;
    std::vector<Sign> watched_, contradiction_;
};

}  // namespace lostbits::measure::stability
